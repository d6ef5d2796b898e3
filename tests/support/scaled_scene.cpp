#include "support/scaled_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "system/units.hpp"

namespace bramah::testing {
namespace {

std::string per_second(const std::string& unit) { return unit + "/s"; }

Value list_of(const std::vector<double>& numbers, double factor) {
  Value::List list;
  for (const double number : numbers) list.emplace_back(number * factor);
  return list;
}

/// The parameters of a component; ports, choices and texts stay as the scene writes them.
void scale_parameters(const Component& component, const Factors& factors, Value& written) {
  const bramah_type& type = *component.type;
  for (std::int32_t p = 0; p < type.parameter_count; ++p) {
    const bramah_parameter_info& info = type.parameters[p];
    const std::vector<double>& numbers = component.numbers[static_cast<std::size_t>(p)];
    const double factor = info.kind == BRAMAH_CHOICE || info.kind == BRAMAH_TEXT
                              ? 1.0
                              : factors.of(parameter_unit(type, info.unit, component.texts));
    if (info.kind == BRAMAH_NUMBER) written.set(info.name, numbers[0] * factor);
    if (info.kind == BRAMAH_VECTOR || info.kind == BRAMAH_LIST) written.set(info.name, list_of(numbers, factor));
  }
}

Value start_of(const System& system, const Factors& factors) {
  Value start = Value::Object{};
  for (const Variable& x : system.x) {
    if (x.start_given) start.set(x.name, x.start * factors.of(x.unit));
    if (x.start_rate_given) start.set(x.name + ".rate", x.start_rate * factors.of(per_second(x.unit)));
  }
  for (const Variable& z : system.z) {
    start.set(z.name, z.start * factors.of(z.unit));
  }
  return start;
}

Value simulate_of(const Value& written, const SimulateOptions& options, double time) {
  Value simulate = written;
  simulate.set("to_time", options.to_time * time);
  for (const auto& [key, seconds] : {std::pair{"from_time", options.from_time},
                                     {"output_step", options.output_step},
                                     {"max_step", options.max_step},
                                     {"step", options.step}}) {
    if (written.find(key) != nullptr) simulate.set(key, seconds * time);
  }
  if (written.find("output_times") != nullptr) simulate.set("output_times", list_of(options.output_times, time));
  return simulate;
}

}  // namespace

double Factors::of(const std::string& unit) const {
  const std::optional<Unit> parsed = parse_unit(unit);
  if (!parsed) throw std::logic_error("no unit: " + unit);
  return std::pow(length, 0.5 * parsed->twice[0]) * std::pow(mass, 0.5 * parsed->twice[1]) *
         std::pow(time, 0.5 * parsed->twice[2]);
}

Scene scaled_scene(const Machine& machine, const Factors& factors) {
  const System& system = machine.system();
  const Options& options = machine.options();
  Scene scene;
  scene.root = Value::Object{};
  for (const Member& member : *machine.scene.root.object()) {
    const std::array unchanged{"bramah", "title", "description", "libraries", "hold", "outputs"};
    const std::array left_out{"constants", "study", "compare", "sweep", "vary", "start", "simulate"};
    const auto is_one_of = [&](const auto& keys) {
      return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return member.key == key; });
    };
    if (is_one_of(left_out)) continue;
    Value value = member.value;
    if (member.key == "components") {
      for (const Component& component : system.components)
        scale_parameters(component, factors, *value.find(component.name));
    } else if (member.key == "linearize") {
      if (value.find("times") != nullptr) value.set("times", list_of(options.linearize.times, factors.time));
    } else if (member.key == "assembly") {
      value.set("tolerance", options.assembly.tolerance * factors.length);
    } else if (!is_one_of(unchanged)) {
      throw std::logic_error("scaled_scene does not know the section " + member.key);
    }
    scene.root.set(member.key, std::move(value));
  }
  const Value* simulate = machine.scene.root.find("simulate");
  if (simulate != nullptr && simulate->find("events") != nullptr)
    throw std::logic_error("scaled_scene does not know events");
  scene.root.set("simulate",
                 simulate_of(simulate != nullptr ? *simulate : Value::Object{}, options.simulate, factors.time));
  scene.root.set("start", start_of(system, factors));
  return scene;
}

Machine scaled(const Machine& machine, const Factors& factors) {
  Machine made;
  made.scene = scaled_scene(machine, factors);
  made.compiled = compile(made.scene, registry());
  return made;
}

}  // namespace bramah::testing
