// The passes of compile, in their order:
//
//   libraries, constants, components   compile.cpp, compile_numbers.cpp
//     each with type and parameters    compile_parameters.cpp
//   instances, numbers of variables    compile_instances.cpp
//   connections                        compile_connections.cpp
//   start                              compile_instances.cpp
//   options                            compile_options.cpp
//   patterns, structure                compile_patterns.cpp
//
// Patterns are made of scenes without faults only.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "system/compile.hpp"
#include "system/compile_parts.hpp"

namespace bramah::compiling {

/// One component of the scene on its way into the system.
struct Draft {
  std::string name;
  std::string where;
  const Value* value = nullptr;
  const bramah_type* type = nullptr;
  std::vector<std::vector<double>> numbers;  // per parameter
  std::vector<std::string> texts;
  bool sound = false;           // parameters complete; only sound components become instances
  std::set<std::string> meant;  // keys that misspelt ones probably stand for: they are not missing, too
  Index group = -1, position = -1;
  Index first_x = 0, first_z = 0, first_holonomic = 0, first_nonholonomic = 0, first_output = 0;
  Index input = -1;                          // of a signal
  std::vector<double> constants;             // of the constants extension
  Index x_constants = -1, z_constants = -1;  // where they went
};

class Compiler {
 public:
  Compiler(const Scene& scene, std::shared_ptr<Registry> registry, std::vector<Diagnostic> earlier)
      : scene_(scene), registry_(std::move(registry)), earlier_(std::move(earlier)), numbers_(faults_) {}

  /// Goes on after faults as far as sense allows, so that one run reports all of them. Components with faults have no
  /// instance, those of unknown type nothing but a name; what they would have been asked for is not judged.
  Compiled run();

 private:
  System& system() { return compiled_.system; }
  void set_assembly_tolerance();
  void stop_if_faulty();
  void load_libraries();
  void read_components();

  void find_type(Draft& draft);
  /// Names of all types of one of the scene's libraries, or of all of them.
  [[nodiscard]] std::vector<std::string> known_types(std::string_view library) const;
  void read_parameters(Draft& draft);
  void read_parameter(Draft& draft, const bramah_parameter_info& info, std::size_t index);
  void check_type_units(const Draft& draft);
  void check_typical(const Draft& draft, std::size_t index, double number, std::string_view unit,
                     const std::string& where);
  void check_limits(const bramah_parameter_info& info, double number, std::string_view unit, const std::string& where);

  void make_instances();
  void number_variables();
  void read_start();

  void connect();
  /// What the scene offers to a port: names as it would write them.
  [[nodiscard]] std::vector<std::string> fitting(const bramah_port_info& port) const;
  [[nodiscard]] std::string wanted(const bramah_port_info& port) const;
  /// Connections that are possible and make no sense: both ends on one body, both sides on one volume.
  void check_sense(const Draft& draft, const Group& group);
  /// Fields of gravity that some bodies do not feel, or that have no part in the plane of planar bodies.
  void check_gravity();
  void check_connected(const Draft& draft, const bramah_port_info& port);
  /// Position in State's vectors of what the port connects to; 0 after a fault.
  Index resolve(const Draft& draft, const bramah_port_info& port, const Value& value);
  void check_units(const bramah_port_info& port, const bramah_terminal_info& terminal, const Draft& other,
                   const std::string& where);
  /// Position in State's vectors of constants; made on first use.
  Index constants_of(Draft& draft, int family);

  void make_patterns();
  /// The pattern of a law that branches on the state is full, so that it seems to store wherever it is connected: clears
  /// variables whose storage is zero at the start and at states around it.
  void drop_without_storage(std::vector<bool>& stored) const;
  /// A coordinate without inertia or constraint and a first-order variable without storage have no equation.
  void check_structure();
  /// Where the numbers of the scene went: what derivatives with respect to them need.
  void keep_origins();

  const Scene& scene_;
  std::shared_ptr<Registry> registry_;
  std::vector<Diagnostic> earlier_;
  Faults faults_;
  Numbers numbers_;
  std::vector<std::string> libraries_;
  bool libraries_unread_ = false;  // there is something in their place, and it is reported
  std::set<std::string> broken_libraries_, forgotten_libraries_;
  std::set<std::string> known_units_;  // types whose units have been looked at
  std::vector<Draft> drafts_;
  std::unordered_map<std::string, std::size_t> by_name_;
  Compiled compiled_;
};

/// The machine's own sizes at its start values; defaults where its rows say nothing.
Scales sizes_of(const System& system);
/// Sets sizes and scales of `system`, and by them those of its variables and rows: nominals of types are for a machine of
/// the default sizes.
void take_scales(System& system);

}  // namespace bramah::compiling
