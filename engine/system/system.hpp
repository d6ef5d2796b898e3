// The assembled machine: variables, rows, inputs and outputs with names, and the instances grouped by type.
//
//   f(t, x, v, a, z, lambda, u) = M a + D^T lambda - Q = 0   (n)      forces            Eq. (9)
//   g(t, x, v, z, zdot, u)      = K zdot - h = 0             (nz)     storage           Eqs. (12), (13)
//   c(t, x) = 0                                              (m)      holonomic         Eq. (10)
//   b(t, x, v) = 0, affine in v                              (l)      nonholonomic      Eq. (11)
//   y = y(t, x, v, a, z, lambda, u)                                   outputs
//
// A System is immutable and shared; all that changes lives in State and Blocks.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bramah/abi.h"
#include "plugin/registry.hpp"

namespace bramah {

using Index = std::int64_t;
using Vector = std::vector<double>;

struct Variable {
  std::string name;  // "crank.angle"
  std::string unit;
  std::string kind;                                    // what ports see: "frame", "coordinate", "pressure", "spool"
  double size = 1.0;                                   // typical in this machine, of a rate divided by its time
  double nominal = 1.0;                                // the same next to a power of two: to scale by it rounds nothing
  double start = 0.0, start_rate = 0.0;                // rate: coordinates only
  bool start_given = false, start_rate_given = false;  // by the scene's "start"
  bool start_set = false, start_rate_set = false;      // by parameters of the component that the scene writes out
  Index component = 0;
  /// Whether the scene gives the position, or the rate: by "start", or by a parameter of the component.
  [[nodiscard]] bool position_given() const { return start_given || start_set; }
  [[nodiscard]] bool rate_given() const { return start_rate_given || start_rate_set || start_rate != 0.0; }
};

struct Row {
  std::string name;  // "hinge.x"
  std::string unit;
  Index component = 0;
  double size = 1.0;     // of its terms in this machine, in its unit: its length for m, 1 for rad and 1
  double nominal = 1.0;  // the same next to a power of two
};

/// A machine's own sizes, SI: every limit of the engine is a part of these, none is absolute.
struct Scales {
  double length = 1.0;                                                                    // m
  double mass = 1.0;                                                                      // kg
  double time = 1.0;                                                                      // s
  double pressure = 1e6;                                                                  // Pa
  [[nodiscard]] double force() const { return mass * length / (time * time); }            // N
  [[nodiscard]] double energy() const { return mass * length * length / (time * time); }  // J
  /// Of one in `unit`, in a machine of these sizes, against a machine of the sizes above: 1 for "rad", length for "m",
  /// pressure / 1e6 for "Pa".
  [[nodiscard]] double of(std::string_view unit) const;
};

struct InputSignal {
  std::string name;  // "torque"
  std::string unit;
  const bramah_type* type = nullptr;
  const bramah_signal* signal = nullptr;
  const void* instance = nullptr;
  Index component = 0;
};

struct Component {
  std::string name;
  const bramah_type* type = nullptr;
  Index group = 0, position = 0;  // instance `position` of `groups[group]`
  // Parameters in the order of the type, SI, defaults filled in: what its instance was configured with.
  std::vector<std::vector<double>> numbers;
  std::vector<std::string> texts;
  Index first_x = 0, first_z = 0;            // own variables
  Index x_constants = -1, z_constants = -1;  // where State has its fixed numbers; -1: nobody reads them
  Index input = -1;                          // of a signal
};

/// Element `element` of parameter `parameter` of a component.
struct ParameterRef {
  Index component = 0;
  std::int32_t parameter = 0;
  Index element = 0;
};

/// The start value of a coordinate, of its rate, or of a first-order variable.
struct StartRef {
  enum class Kind { x, v, z };
  Kind kind = Kind::x;
  Index index = 0;
};

/// A constant of the scene, and the numbers that are written "=name".
struct Constant {
  std::string name;
  double value = 0.0;  // SI
  std::vector<ParameterRef> parameters;
  std::vector<StartRef> starts;
};

/// Memory for the instances of one type, destroyed through the type.
class Instances {
 public:
  Instances(const bramah_type& type, Index count);
  Instances(Instances&& other) noexcept;
  Instances& operator=(Instances&&) = delete;
  ~Instances();
  [[nodiscard]] void* at(Index i) const { return memory_ + static_cast<std::size_t>(i) * type_->instance_bytes; }
  /// Where the next one is to be made by configure; they are made in order. What lies behind it is marked.
  [[nodiscard]] void* next();
  /// Says that it has been made. False where configure wrote behind its end.
  bool constructed();

 private:
  const bramah_type* type_;
  unsigned char* memory_;
  Index constructed_ = 0;
  static constexpr std::size_t guard_bytes = 64;  // behind each instance while it is made
};

/// Pattern of a block with its storage; columns compressed.
struct BlockPattern {
  Index rows = 0, columns = 0;
  std::vector<std::int32_t> start, row;
};

/// All instances of one type: where their local variables and rows sit in the system.
struct Group {
  explicit Group(const bramah_type& t, Index n) : type(&t), count(n), instances(t, n) {}
  const bramah_type* type;
  Index count;
  Instances instances;
  std::vector<Index> component;  // (count)
  // Positions of local variables in State's vectors, instance after instance. Beyond n (for x) or nz + nu (for z and u)
  // they point to constants: ground, unconnected ports.
  std::vector<std::int32_t> x, z, u;                                     // (count x nx), (count x nz), (count x nu)
  std::vector<Index> first_holonomic, first_nonholonomic, first_output;  // (count), global rows
  std::array<BlockPattern, BRAMAH_BLOCKS> patterns;
  std::array<bramah_pattern, BRAMAH_BLOCKS> pattern_views{};  // what evaluate sees
};

class System {
 public:
  std::vector<Variable> x, z;
  std::vector<Row> holonomic, nonholonomic;  // (m), (l)
  std::vector<InputSignal> inputs;           // (nu)
  std::vector<Row> outputs;                  // outputs of components (ny)
  std::vector<Component> components;
  std::vector<Constant> constants;
  std::vector<Group> groups;
  Vector x_constants, z_constants;  // what ports without a variable read
  Scales sizes;   // the machine's own: what results depend on, the choice among equals, is weighed by these
  Scales scales;  // powers of two next to them, for limits and for equations to be solved
  double assembly_tolerance = 0.0;           // m, by which joints that repeat each other may disagree
  std::shared_ptr<const Registry> registry;  // keeps the libraries' files known for messages

  [[nodiscard]] Index n() const { return static_cast<Index>(x.size()); }
  [[nodiscard]] Index nz() const { return static_cast<Index>(z.size()); }
  [[nodiscard]] Index m() const { return static_cast<Index>(holonomic.size()); }
  [[nodiscard]] Index l() const { return static_cast<Index>(nonholonomic.size()); }
  [[nodiscard]] Index nu() const { return static_cast<Index>(inputs.size()); }
  [[nodiscard]] Index ny() const { return static_cast<Index>(outputs.size()); }
  /// First-order variables of kind spool: the paper's u; the others are its r.
  [[nodiscard]] Index spools() const;

  /// Row i of [c; b].
  [[nodiscard]] const Row& constraint(Index i) const;
  /// Typical size of its rate r: of dc/dt, or of b itself.
  [[nodiscard]] double rate_nominal(Index i) const;
  /// Typical size of its multiplier: the machine's energy over the row's size.
  [[nodiscard]] double multiplier_nominal(Index i) const;
  /// Name of its multiplier: "hinge.lambda_x".
  [[nodiscard]] std::string multiplier_name(Index i) const;
  /// Unit of the force that it gives: N for a row in m, N.m for rad, else "J/" and the row's unit.
  [[nodiscard]] std::string multiplier_unit(Index i) const;
  [[nodiscard]] const std::string& component_name(Index component) const;

  /// By how much a row may stay open where it repeats others, in its unit: what rounding of the scene's numbers leaves.
  [[nodiscard]] double assembly_tolerance_of(const Row& row) const;
  /// Of a rank, relative to the row: rows that others nearly imply, but for rounding of the scene's numbers, repeat them.
  [[nodiscard]] double rank_tolerance() const { return assembly_tolerance / scales.length; }

  /// Index of a variable by name, or -1.
  [[nodiscard]] Index find_x(std::string_view name) const;
  [[nodiscard]] Index find_z(std::string_view name) const;
};

/// A point in time: everything that the rows depend on. Cheap to copy.
struct State {
  double t = 0.0;
  int side = 1;                                // of input jumps and switching points: +1 after, -1 before
  Vector x, v, a;                              // (n + constants); constants have v = a = 0
  Vector z, zdot;                              // (nz + nu + constants): variables, inputs, constants
  Vector lambda;                               // (m + l)
  std::vector<std::pair<Index, double>> held;  // inputs that an event has fixed, and their values
};

/// Parameters as the border takes them; the result points into both lists.
std::vector<bramah_value> parameter_values(const std::vector<std::vector<double>>& numbers,
                                           const std::vector<std::string>& texts);
/// `unit` of a parameter or terminal of a type, or the text of the parameter that it names by "@".
std::string parameter_unit(const bramah_type& type, const char* unit, const std::vector<std::string>& texts);

/// `count` instances of the group from `first` on at time and side of `state`; values and results are to be filled in.
bramah_batch batch_of(const Group& group, const State& state, Index first, Index count);

/// The state of the start values at time t, with inputs taken from their signals.
State initial_state(const System& system, double t = 0.0);
/// Sets the inputs of `state` from the signals at state.t on side state.side, those of `held` to their values.
void apply_inputs(const System& system, State& state);
/// The first time after t where an input jumps or bends; HUGE_VAL where there is none.
double next_breakpoint(const System& system, double t);

}  // namespace bramah
