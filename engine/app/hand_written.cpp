#include "app/hand_written.hpp"

#include <algorithm>
#include <bramah/conformance.hpp>
#include <optional>

#include "plugin/border.hpp"
#include "system/state_functions.hpp"

namespace bramah {
namespace {

/// Its parameters and the start values of its local variables.
Sample sample_of(const System& system, const Group& group, const State& start) {
  const bramah_type& type = *group.type;
  const Component& component = system.components[static_cast<std::size_t>(group.component[0])];
  Sample sample;
  for (std::int32_t p = 0; p < type.parameter_count; ++p) {
    const auto k = static_cast<std::size_t>(p);
    const bool is_text = type.parameters[p].kind == BRAMAH_TEXT;
    sample.parameters.emplace(type.parameters[p].name,
                              is_text ? Setting(component.texts[k].c_str()) : Setting(component.numbers[k]));
  }
  gather(start.x, group.x, 0, type.nx, sample.x);
  gather(start.v, group.x, 0, type.nx, sample.v);
  gather(start.z, group.z, 0, type.nz, sample.z);
  gather(start.z, group.u, 0, type.nu, sample.u);
  sample.time = start.t;
  sample.side = start.side;
  return sample;
}

}  // namespace

std::vector<Diagnostic> examine_hand_written(const Compiled& compiled) {
  const System& system = compiled.system;
  std::vector<Diagnostic> warnings;
  std::optional<State> start;  // of the scenes that have such types
  for (const Group& group : system.groups) {
    const bramah_type& type = *group.type;
    if (extension<bramah_tangent>(type, BRAMAH_EXTENSION_TANGENT) != nullptr) continue;
    const std::string& name = system.component_name(group.component[0]);
    const AtBorder border("an examination", name.c_str(), type);
    if (!start) start = initial_state(system, compiled.options.simulate.from_time);
    const Conformance verdict = detail::Examination(type).run({sample_of(system, group, *start)});
    if (verdict.ok) continue;
    Diagnostic warning;
    warning.severity = Diagnostic::Severity::warning;
    warning.code = "broken-promise";
    warning.pointer = pointer("/components", name);
    std::string faults = verdict.message;
    std::replace(faults.begin(), faults.end(), '\n', ';');
    warning.found = name + " does not keep what its table promises: " + faults;
    warning.expected = "partials that are those of its rows, all that structure marks and nothing else";
    warning.remedy = "mend " + std::string(file_of(type) == nullptr ? "its library" : file_of(type)) +
                     ", and test it with `conforms`; linear models and steps of integrators rest on these numbers";
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace bramah
