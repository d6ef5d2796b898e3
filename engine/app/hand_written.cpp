#include "app/hand_written.hpp"

#include <algorithm>
#include <bramah/conformance.hpp>

#include "plugin/border.hpp"

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
  const auto pick = [](const Vector& from, const std::vector<std::int32_t>& map, std::int32_t slots) {
    std::vector<double> values;
    for (std::int32_t j = 0; j < slots; ++j)
      values.push_back(from[static_cast<std::size_t>(map[static_cast<std::size_t>(j)])]);
    return values;
  };
  sample.x = pick(start.x, group.x, type.nx);
  sample.v = pick(start.v, group.x, type.nx);
  sample.z = pick(start.z, group.z, type.nz);
  sample.u = pick(start.z, group.u, type.nu);
  sample.time = start.t;
  sample.side = start.side;
  return sample;
}

}  // namespace

std::vector<Diagnostic> examine_hand_written(const Compiled& compiled) {
  const System& system = compiled.system;
  std::vector<Diagnostic> warnings;
  for (const Group& group : system.groups) {
    const bramah_type& type = *group.type;
    if (extension<bramah_tangent>(type, BRAMAH_EXTENSION_TANGENT) != nullptr) continue;
    const std::string& name = system.component_name(group.component[0]);
    const AtBorder border("an examination", name.c_str(), type);
    const Sample sample = sample_of(system, group, initial_state(system, compiled.options.simulate.from_time));
    const Conformance verdict = detail::Examination(type).run({sample});
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
