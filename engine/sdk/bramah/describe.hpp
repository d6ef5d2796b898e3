// Description: the one place where a component says what it is called, what it connects to, what it owns and what it
// takes from the scene. The same `describe` serves the engine's tables, the reference pages and the reading of a scene.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "bramah/abi.h"
#include "bramah/handles.hpp"
#include "bramah/vector.hpp"

namespace bramah {

/// What `describe` collected, in the form that the border wants. Owns every array that a bramah_type points to.
struct TypeTables {
  std::string name, doc;
  std::vector<bramah_parameter_info> parameters;
  std::vector<std::uint8_t> differentiable;  // per parameter, 1: kept in a Parameter
  std::vector<bramah_port_info> ports;
  std::vector<bramah_variable_info> variables;
  std::vector<bramah_terminal_info> terminals;
  std::vector<bramah_row_info> holonomic, nonholonomic, outputs, switches;
  std::vector<double> switch_nominal;
  std::vector<bramah_limit_info> limits;
  std::vector<double> typical_lower, typical_upper;  // per parameter
  std::deque<std::vector<double>> numbers;           // stable addresses
  std::deque<std::vector<const char*>> texts;
  int port_slots[3] = {}, own_slots[3] = {};  // by bramah_family
  int constants = 0, signals = 0;

  [[nodiscard]] int slots(int family) const { return port_slots[family] + own_slots[family]; }
};

/// Limits, default and documentation of one parameter, said after one another.
class ParameterDescription {
 public:
  ParameterDescription(TypeTables* tables, std::size_t index) : tables_(tables), index_(index) {}
  ParameterDescription& doc(const char* text) {
    if (tables_ != nullptr) info().doc = text;
    return *this;
  }
  /// The parameter may be left out; vectors repeat the number.
  ParameterDescription& by_default(double number) {
    if (tables_ == nullptr) return *this;
    const auto count = info().kind == BRAMAH_VECTOR ? static_cast<std::size_t>(info().count) : 1U;
    return keep_default(std::vector<double>(count, number));
  }
  ParameterDescription& by_default(std::initializer_list<double> list) {
    return tables_ == nullptr ? *this : keep_default(std::vector<double>(list));
  }
  ParameterDescription& by_default(const char* text) {
    if (tables_ == nullptr) return *this;
    info().required = 0;
    info().default_text = text;
    return *this;
  }
  ParameterDescription& above(double limit) { return lower(limit, 1); }
  ParameterDescription& at_least(double limit) { return lower(limit, 0); }
  ParameterDescription& below(double limit) { return upper(limit, 1); }
  ParameterDescription& at_most(double limit) { return upper(limit, 0); }
  /// What is found in practice, SI: a number outside is accepted with a warning.
  ParameterDescription& typical(double from, double to) {
    if (tables_ == nullptr) return *this;
    tables_->typical_lower[index_] = from;
    tables_->typical_upper[index_] = to;
    return *this;
  }

 private:
  bramah_parameter_info& info() { return tables_->parameters[index_]; }
  ParameterDescription& keep_default(std::vector<double> list) {
    info().required = 0;
    tables_->numbers.push_back(std::move(list));
    info().default_numbers = tables_->numbers.back().data();
    info().default_count = static_cast<int64_t>(tables_->numbers.back().size());
    return *this;
  }
  ParameterDescription& lower(double limit, int open) {
    if (tables_ != nullptr) {
      info().lower = limit;
      info().lower_open = open;
    }
    return *this;
  }
  ParameterDescription& upper(double limit, int open) {
    if (tables_ != nullptr) {
      info().upper = limit;
      info().upper_open = open;
    }
    return *this;
  }
  TypeTables* tables_;
  std::size_t index_;
};

/// Typical magnitude and start value of an own variable.
class VariableDescription {
 public:
  explicit VariableDescription(bramah_variable_info* info) : info_(info) {}
  VariableDescription& nominal(double magnitude) {
    if (info_ != nullptr) info_->nominal = magnitude;
    return *this;
  }
  VariableDescription& start(double value) {
    if (info_ != nullptr) info_->start = value;
    return *this;
  }

 private:
  bramah_variable_info* info_;
};

/// Limits of a quantity of the state, within which a law holds.
class LimitDescription {
 public:
  explicit LimitDescription(bramah_limit_info* info) : info_(info) {}
  /// The law ends at `limit`, or a warning says that it was beyond, and it goes on as far as `lowest`.
  LimitDescription& at_least(double limit) { return at_least(limit, limit); }
  LimitDescription& at_least(double limit, double lowest) {
    if (info_ == nullptr) return *this;
    info_->lower = limit;
    info_->lowest = lowest;
    return *this;
  }
  LimitDescription& at_most(double limit) { return at_most(limit, limit); }
  LimitDescription& at_most(double limit, double highest) {
    if (info_ == nullptr) return *this;
    info_->upper = limit;
    info_->highest = highest;
    return *this;
  }

 private:
  bramah_limit_info* info_;
};

class PortDescription {
 public:
  PortDescription(TypeTables* tables, std::size_t index) : tables_(tables), index_(index) {}
  /// The port may stay unconnected; it then reads these numbers and what is added to its rows goes nowhere.
  PortDescription& optional(std::initializer_list<double> rest) {
    if (tables_ == nullptr) return *this;
    tables_->ports[index_].required = 0;
    tables_->numbers.emplace_back(rest);
    tables_->ports[index_].rest = tables_->numbers.back().data();
    return *this;
  }

 private:
  TypeTables* tables_;
  std::size_t index_;
};

namespace detail {
template <class H>
constexpr int family_of() {
  if constexpr (std::is_base_of_v<FirstOrder, H>) {
    return BRAMAH_Z;
  } else if constexpr (std::is_same_v<H, Input> || std::is_same_v<H, Gravity>) {
    return BRAMAH_U;
  } else {
    return BRAMAH_X;
  }
}
/// What a member that takes numbers of the scene is made of.
template <class N>
concept ParameterNumber = std::same_as<N, double> || std::same_as<N, Parameter>;
}  // namespace detail

class Description {
 public:
  /// Collecting: fills `tables`, ties no handle.
  explicit Description(TypeTables& tables) : collecting_(&tables), tables_(tables) {}
  /// Configuring: ties the handles of one instance and gives its parameters their values (in the order of `tables`).
  /// `tangents` are the derivatives of these values, or null: all zero.
  Description(const TypeTables& tables, const bramah_value* values, const bramah_value* tangents = nullptr)
      : tables_(tables), values_(values), tangents_(tangents) {}

  void called(const char* name, const char* doc) {
    if (collecting_ == nullptr) return;
    collecting_->name = name;
    collecting_->doc = doc;
  }

  /// A variable of another component, or ground, or a signal. `unit` matters for single variables only.
  template <class H>
  PortDescription port(const char* name, H& handle, const char* doc, const char* unit = "") {
    constexpr int family = detail::family_of<H>();
    handle.slot = next_port_[family];
    next_port_[family] += H::slots;
    if (collecting_ == nullptr) return {nullptr, 0};
    collecting_->ports.push_back({sizeof(bramah_port_info), name, doc, H::kind, unit, family, H::slots, 1, nullptr});
    collecting_->port_slots[family] += H::slots;
    return {collecting_, collecting_->ports.size() - 1};
  }

  /// A variable of this component; others connect to it as "component.name".
  template <class H>
  VariableDescription own(const char* name, H& handle, const char* unit, const char* doc) {
    static_assert(H::slots == 1, "frames are owned by own(name, frame, doc)");
    constexpr int family = detail::family_of<H>();
    static_assert(family != BRAMAH_U, "a signal is given, not owned");
    terminal(name, doc, H::kind, unit, family, 1, BRAMAH_OWN, own_[family]);
    return variable(handle, name, family, unit, doc);
  }
  /// The seven variables x, y, z, e0, e1, e2, e3 of a body; the component adds the row |e|^2 = 1.
  void own(const char* name, Frame& frame, const char* doc) {
    terminal(name, doc, Frame::kind, "", BRAMAH_X, Frame::slots, BRAMAH_OWN, own_[BRAMAH_X]);
    variable(frame, "x", BRAMAH_X, "m", "position of the frame");
    const int first = frame.slot;
    Coordinate rest;
    variable(rest, "y", BRAMAH_X, "m", "position of the frame");
    variable(rest, "z", BRAMAH_X, "m", "position of the frame");
    variable(rest, "e0", BRAMAH_X, "1", "Euler parameter").start(1.0);
    variable(rest, "e1", BRAMAH_X, "1", "Euler parameter");
    variable(rest, "e2", BRAMAH_X, "1", "Euler parameter");
    variable(rest, "e3", BRAMAH_X, "1", "Euler parameter");
    frame.slot = first;
  }
  /// The three variables x, y, angle of a planar body.
  void own(const char* name, PlanarFrame& frame, const char* doc) {
    terminal(name, doc, PlanarFrame::kind, "", BRAMAH_X, PlanarFrame::slots, BRAMAH_OWN, own_[BRAMAH_X]);
    variable(frame, "x", BRAMAH_X, "m", "position of the frame");
    const int first = frame.slot;
    Coordinate angle;
    variable(angle, "y", BRAMAH_X, "m", "position of the frame");
    terminal("angle", "rotation of the frame", Coordinate::kind, "rad", BRAMAH_X, 1, BRAMAH_OWN, own_[BRAMAH_X]);
    variable(angle, "angle", BRAMAH_X, "rad", "rotation of the frame");
    frame.slot = first;
  }
  /// Fixed numbers that others connect to (ground, gravity); the component's `constants` gives them.
  template <class H>
  void provide_constants(const char* name, const char* doc) {
    const int first = constants_;
    constants_ += H::slots;
    if (collecting_ != nullptr) collecting_->constants = constants_;
    terminal(name, doc, H::kind, "", detail::family_of<H>(), H::slots, BRAMAH_CONSTANT, first);
  }
  /// An input of the system whose value in time is the component's `signal(t, side)`. H is what it connects to: Input
  /// fits every single first-order or signal port of the same unit, Pressure only pressures. "@unit" takes the unit
  /// from the text parameter `unit`.
  template <class H>
  void provide_signal(const char* name, const char* unit, const char* doc) {
    if (collecting_ != nullptr) collecting_->signals += 1;
    terminal(name, doc, H::kind, unit, detail::family_of<H>(), 1, BRAMAH_SIGNAL, 0);
  }

  /// A number of the scene. Derivatives with respect to it are exact if it is kept in a Parameter; a double is a number
  /// that nothing is differentiated by. The same holds for vectors and lists.
  template <detail::ParameterNumber P>
  ParameterDescription parameter(const char* name, P& number, const char* unit) {
    if (const Given given = next_value(); given.value != nullptr) number = given.number<P>(0);
    return parameter_info(name, unit, BRAMAH_NUMBER, 1, std::same_as<P, Parameter>);
  }
  template <detail::ParameterNumber P, std::size_t N>
  ParameterDescription parameter(const char* name, std::array<P, N>& vector, const char* unit) {
    if (const Given given = next_value(); given.value != nullptr) {
      for (std::size_t i = 0; i < N; ++i) vector[i] = given.number<P>(i);
    }
    return parameter_info(name, unit, BRAMAH_VECTOR, static_cast<int64_t>(N), std::same_as<P, Parameter>);
  }
  template <detail::ParameterNumber P>
  ParameterDescription parameter(const char* name, std::vector<P>& list, const char* unit) {
    if (const Given given = next_value(); given.value != nullptr) {
      list.resize(static_cast<std::size_t>(given.value->count));
      for (std::size_t i = 0; i < list.size(); ++i) list[i] = given.number<P>(i);
    }
    return parameter_info(name, unit, BRAMAH_LIST, 0, std::same_as<P, Parameter>);
  }
  ParameterDescription parameter(const char* name, std::string& text) {
    if (const Given given = next_value(); given.value != nullptr) text = given.value->text;
    return parameter_info(name, "", BRAMAH_TEXT, 0, false);
  }
  /// One of a few words; `index` is its place in the list.
  ParameterDescription choice(const char* name, int& index, std::initializer_list<const char*> choices) {
    if (const Given given = next_value(); given.value != nullptr) index = static_cast<int>(given.value->numbers[0]);
    ParameterDescription p = parameter_info(name, "", BRAMAH_CHOICE, 1, false);
    if (collecting_ != nullptr) {
      std::vector<const char*>& list = collecting_->texts.emplace_back(choices);
      list.push_back(nullptr);
      collecting_->parameters.back().choices = list.data();
    }
    return p;
  }

  /// A constraint row of this component and the unit of its multiplier's dual (m, rad, 1, m/s).
  void holonomic(const char* name, HolonomicRow& row, const char* unit, const char* doc) {
    row.slot = next_holonomic_++;
    if (collecting_ != nullptr) collecting_->holonomic.push_back({sizeof(bramah_row_info), name, doc, unit});
  }
  void nonholonomic(const char* name, NonholonomicRow& row, const char* unit, const char* doc) {
    // Multipliers count on after the holonomic rows, whose number configuring knows from the tables.
    row.slot = static_cast<int>(tables_.holonomic.size()) + next_nonholonomic_++;
    if (collecting_ != nullptr) collecting_->nonholonomic.push_back({sizeof(bramah_row_info), name, doc, unit});
  }
  void output(const char* name, Output& output, const char* unit, const char* doc) {
    output.slot = next_output_++;
    if (collecting_ != nullptr) collecting_->outputs.push_back({sizeof(bramah_row_info), name, doc, unit});
  }
  /// A function of the state at whose zero the law has a kink; `nominal` is its typical magnitude.
  void switching(const char* name, Switch& function, const char* unit, double nominal, const char* doc) {
    function.slot = next_switch_++;
    if (collecting_ == nullptr) return;
    collecting_->switches.push_back({sizeof(bramah_row_info), name, doc, unit});
    collecting_->switch_nominal.push_back(nominal);
  }
  /// A quantity of the state that has to stay within limits for the law to hold, see LimitDescription; the component's
  /// `validity` gives it. A run that leaves them ends with an error that names them; no analysis begins outside.
  /// `nominal` is its typical magnitude, `doc` says what it is.
  LimitDescription valid(const char* name, Limit& quantity, const char* unit, double nominal, const char* doc) {
    quantity.slot = next_limit_++;
    if (collecting_ == nullptr) return LimitDescription(nullptr);
    collecting_->limits.push_back(
        {sizeof(bramah_limit_info), name, doc, unit, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, HUGE_VAL, nominal});
    return LimitDescription(&collecting_->limits.back());
  }
  /// Whether describe has said again what it said when the tables were made.
  [[nodiscard]] bool repeats() const {
    const auto same = [](int count, const auto& list) { return static_cast<std::size_t>(count) == list.size(); };
    for (int family = 0; family < 3; ++family) {
      if (next_port_[family] != tables_.port_slots[family] || own_[family] != tables_.own_slots[family]) return false;
    }
    return next_parameter_ == tables_.parameters.size() && same(next_holonomic_, tables_.holonomic) &&
           same(next_nonholonomic_, tables_.nonholonomic) && same(next_output_, tables_.outputs) &&
           same(next_switch_, tables_.switches) && same(next_limit_, tables_.limits) && constants_ == tables_.constants;
  }

 private:
  /// What the engine gives for one parameter; `value` is null while collecting.
  struct Given {
    const bramah_value *value = nullptr, *tangent = nullptr;
    template <class P>
    [[nodiscard]] P number(std::size_t k) const {
      if constexpr (std::same_as<P, double>) {
        return value->numbers[k];
      } else {
        return P(value->numbers[k], tangent == nullptr || tangent->numbers == nullptr ? 0.0 : tangent->numbers[k]);
      }
    }
  };
  Given next_value() {
    if (values_ == nullptr) return {};
    const std::size_t k = next_parameter_++;
    if (k >= tables_.parameters.size()) return {};  // describe says more than before; `repeats` tells
    return {&values_[k], tangents_ == nullptr ? nullptr : &tangents_[k]};
  }

  ParameterDescription parameter_info(const char* name, const char* unit, int kind, int64_t count,
                                      bool differentiable) {
    if (collecting_ == nullptr) return {nullptr, 0};
    collecting_->differentiable.push_back(differentiable ? 1 : 0);
    collecting_->typical_lower.push_back(-HUGE_VAL);
    collecting_->typical_upper.push_back(HUGE_VAL);
    collecting_->parameters.push_back({sizeof(bramah_parameter_info), name, "", unit, kind, 1, count, -HUGE_VAL,
                                       HUGE_VAL, 0, 0, nullptr, 0, nullptr, nullptr});
    return {collecting_, collecting_->parameters.size() - 1};
  }
  VariableDescription variable(Handle& handle, const char* name, int family, const char* unit, const char* doc) {
    // Own variables follow those of all ports, whose number configuring knows from the tables.
    handle.slot = tables_.port_slots[family] + own_[family]++;
    if (collecting_ == nullptr) return VariableDescription(nullptr);
    collecting_->own_slots[family] = own_[family];
    collecting_->variables.push_back({sizeof(bramah_variable_info), name, doc, unit, family, 1.0, 0.0});
    return VariableDescription(&collecting_->variables.back());
  }
  void terminal(const char* name, const char* doc, const char* kind, const char* unit, int family, int slots,
                int source, int first) {
    if (collecting_ == nullptr) return;
    collecting_->terminals.push_back(
        {sizeof(bramah_terminal_info), name, doc, kind, unit, family, slots, source, first});
  }

  TypeTables* collecting_ = nullptr;
  const TypeTables& tables_;
  const bramah_value *values_ = nullptr, *tangents_ = nullptr;
  int next_port_[3] = {}, own_[3] = {};
  std::size_t next_parameter_ = 0;
  int next_holonomic_ = 0, next_nonholonomic_ = 0, next_output_ = 0, next_switch_ = 0, next_limit_ = 0, constants_ = 0;
};

/// Faults that single limits cannot express: `faults.add("F_s", "830 N", "at least F_c = 900 N")`.
class Faults {
 public:
  Faults(bramah_report report, void* context) : report_(report), context_(context) {}
  void add(const char* parameter, const std::string& found, const std::string& expected) {
    report_(context_, parameter, found.c_str(), expected.c_str());
  }

 private:
  bramah_report report_;
  void* context_;
};

/// Start values of own variables that follow from parameters; all preset to their defaults.
class Start {
 public:
  Start(const TypeTables& tables, Parameter* x, Parameter* v, Parameter* z)
      : x_(x), v_(v), z_(z), first_x_(tables.port_slots[BRAMAH_X]), first_z_(tables.port_slots[BRAMAH_Z]) {}
  Parameter& operator()(Coordinate q) { return x_[q.slot - first_x_]; }
  Parameter& rate(Coordinate q) { return v_[q.slot - first_x_]; }
  Parameter& operator()(FirstOrder p) { return z_[p.slot - first_z_]; }
  /// The own variables of a frame: pointers to its first x and v.
  Parameter* frame(Handle f) { return x_ + (f.slot - first_x_); }
  Parameter* frame_rate(Handle f) { return v_ + (f.slot - first_x_); }

 private:
  Parameter *x_, *v_, *z_;
  int first_x_, first_z_;
};

}  // namespace bramah
