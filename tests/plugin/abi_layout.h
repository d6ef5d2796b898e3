/* Every struct of the border with its size, and every member with its offset, in the order of abi.h. For C and C++. */
#ifndef BRAMAH_TESTS_ABI_LAYOUT_H
#define BRAMAH_TESTS_ABI_LAYOUT_H

#include <stddef.h>

typedef struct layout_entry {
  const char* name;
  size_t number;
} layout_entry;

#define SIZE(s) \
  { #s, sizeof(s) }
#define AT(s, member) \
  { #s "." #member, offsetof(s, member) }

#define LAYOUT                                                                                                         \
  SIZE(bramah_parameter_info), AT(bramah_parameter_info, name), AT(bramah_parameter_info, doc),                        \
      AT(bramah_parameter_info, unit), AT(bramah_parameter_info, kind), AT(bramah_parameter_info, required),           \
      AT(bramah_parameter_info, count), AT(bramah_parameter_info, lower), AT(bramah_parameter_info, upper),            \
      AT(bramah_parameter_info, lower_open), AT(bramah_parameter_info, upper_open),                                    \
      AT(bramah_parameter_info, default_numbers), AT(bramah_parameter_info, default_count),                            \
      AT(bramah_parameter_info, default_text), AT(bramah_parameter_info, choices), SIZE(bramah_port_info),             \
      AT(bramah_port_info, name), AT(bramah_port_info, doc), AT(bramah_port_info, kind), AT(bramah_port_info, unit),   \
      AT(bramah_port_info, family), AT(bramah_port_info, slots), AT(bramah_port_info, required),                       \
      AT(bramah_port_info, rest), SIZE(bramah_variable_info), AT(bramah_variable_info, name),                          \
      AT(bramah_variable_info, doc), AT(bramah_variable_info, unit), AT(bramah_variable_info, family),                 \
      AT(bramah_variable_info, nominal), AT(bramah_variable_info, start), SIZE(bramah_terminal_info),                  \
      AT(bramah_terminal_info, name), AT(bramah_terminal_info, doc), AT(bramah_terminal_info, kind),                   \
      AT(bramah_terminal_info, unit), AT(bramah_terminal_info, family), AT(bramah_terminal_info, slots),               \
      AT(bramah_terminal_info, source), AT(bramah_terminal_info, first), SIZE(bramah_row_info),                        \
      AT(bramah_row_info, name), AT(bramah_row_info, doc), AT(bramah_row_info, unit), SIZE(bramah_value),              \
      AT(bramah_value, numbers), AT(bramah_value, count), AT(bramah_value, text), SIZE(bramah_pattern),                \
      AT(bramah_pattern, rows), AT(bramah_pattern, columns), AT(bramah_pattern, count), AT(bramah_pattern, start),     \
      AT(bramah_pattern, row), SIZE(bramah_batch), AT(bramah_batch, count), AT(bramah_batch, instances),               \
      AT(bramah_batch, time), AT(bramah_batch, side), AT(bramah_batch, x), AT(bramah_batch, v), AT(bramah_batch, a),   \
      AT(bramah_batch, z), AT(bramah_batch, zdot), AT(bramah_batch, u), AT(bramah_batch, lambda), AT(bramah_batch, f), \
      AT(bramah_batch, g), AT(bramah_batch, c), AT(bramah_batch, r), AT(bramah_batch, s), AT(bramah_batch, y),         \
      AT(bramah_batch, partials), AT(bramah_batch, patterns), AT(bramah_batch, failed), AT(bramah_batch, message),     \
      SIZE(bramah_type), AT(bramah_type, name), AT(bramah_type, doc), AT(bramah_type, parameters),                     \
      AT(bramah_type, ports), AT(bramah_type, variables), AT(bramah_type, terminals), AT(bramah_type, holonomic),      \
      AT(bramah_type, nonholonomic), AT(bramah_type, outputs), AT(bramah_type, parameter_count),                       \
      AT(bramah_type, port_count), AT(bramah_type, variable_count), AT(bramah_type, terminal_count),                   \
      AT(bramah_type, holonomic_count), AT(bramah_type, nonholonomic_count), AT(bramah_type, output_count),            \
      AT(bramah_type, nx), AT(bramah_type, nz), AT(bramah_type, nu), AT(bramah_type, instance_bytes),                  \
      AT(bramah_type, instance_align), AT(bramah_type, self), AT(bramah_type, configure), AT(bramah_type, destroy),    \
      AT(bramah_type, check), AT(bramah_type, start), AT(bramah_type, structure), AT(bramah_type, evaluate),           \
      AT(bramah_type, extension), SIZE(bramah_library), AT(bramah_library, epoch), AT(bramah_library, minor),          \
      AT(bramah_library, name), AT(bramah_library, version), AT(bramah_library, made_with), AT(bramah_library, types), \
      AT(bramah_library, type_count), SIZE(bramah_constants), AT(bramah_constants, count),                             \
      AT(bramah_constants, values), SIZE(bramah_signal), AT(bramah_signal, value), AT(bramah_signal, next_breakpoint), \
      SIZE(bramah_switches), AT(bramah_switches, count), AT(bramah_switches, info), AT(bramah_switches, nominal),      \
      AT(bramah_switches, values), SIZE(bramah_direction), AT(bramah_direction, x), AT(bramah_direction, v),           \
      AT(bramah_direction, a), AT(bramah_direction, z), AT(bramah_direction, zdot), AT(bramah_direction, u),           \
      AT(bramah_direction, lambda), SIZE(bramah_tangent), AT(bramah_tangent, differentiable),                          \
      AT(bramah_tangent, configure), AT(bramah_tangent, evaluate), AT(bramah_tangent, start),                          \
      AT(bramah_tangent, constants), AT(bramah_tangent, signal), SIZE(bramah_energy), AT(bramah_energy, values),       \
      SIZE(bramah_limit_info), AT(bramah_limit_info, name), AT(bramah_limit_info, doc), AT(bramah_limit_info, unit),   \
      AT(bramah_limit_info, lower), AT(bramah_limit_info, upper), AT(bramah_limit_info, lowest),                       \
      AT(bramah_limit_info, highest), AT(bramah_limit_info, nominal), SIZE(bramah_validity),                           \
      AT(bramah_validity, count), AT(bramah_validity, info), AT(bramah_validity, values), SIZE(bramah_typical),        \
      AT(bramah_typical, lower), AT(bramah_typical, upper), SIZE(bramah_fault), AT(bramah_fault, take)

#endif
