#include "system/direction.hpp"

#include <algorithm>
#include <set>

#include "plugin/border.hpp"
#include "system/analysis_error.hpp"
#include "system/scene.hpp"

namespace bramah {

Direction::Direction(const System& system) {
  const State at = initial_state(system);
  state.x.assign(at.x.size(), 0.0);
  state.v = state.a = state.x;
  state.z.assign(at.z.size(), 0.0);
  state.zdot = state.z;
  state.lambda.assign(at.lambda.size(), 0.0);
}

Direction::Direction(const System& system, const SceneNumber& number) : Direction(system) {
  starts_ = number.starts;
  std::set<Index> components;
  for (const ParameterRef& p : number.parameters) components.insert(p.component);
  for (const Index component : components) move_component(system, number, component);
}

void Direction::move_component(const System& system, const SceneNumber& number, Index index) {
  const Component& component = system.components[static_cast<std::size_t>(index)];
  const bramah_type& type = *component.type;
  const auto* tangent = extension<bramah_tangent>(type, BRAMAH_EXTENSION_TANGENT);
  std::vector<std::vector<double>> moves = component.numbers;
  for (auto& list : moves) std::fill(list.begin(), list.end(), 0.0);
  for (const ParameterRef& p : number.parameters) {
    if (p.component == index) moves[static_cast<std::size_t>(p.parameter)][static_cast<std::size_t>(p.element)] = 1.0;
  }
  const AtBorder at("configure of tangents", component.name.c_str(), type);
  Moving& made = moving_.emplace_back(Moving{&component, tangent, Instances(type, 1)});
  void* instance = made.instance.next();
  if (tangent == nullptr ||
      tangent->configure(type.self, instance, parameter_values(component.numbers, component.texts).data(),
                         parameter_values(moves, component.texts).data()) != 0) {
    throw AnalysisError("derivatives by " + number.name,
                        component.name + " (" + type.name + ") could not be configured with moving parameters",
                        "a working component", "this is a fault of its library",
                        pointer("/components", component.name));
  }
  made.instance.constructed();
  if (tangent->constants == nullptr || (component.x_constants < 0 && component.z_constants < 0)) return;
  const auto* constants = extension<bramah_constants>(type, BRAMAH_EXTENSION_CONSTANTS);
  Vector values(static_cast<std::size_t>(constants->count));
  tangent->constants(type.self, instance, values.data());
  if (component.x_constants >= 0) std::copy(values.begin(), values.end(), state.x.begin() + component.x_constants);
  if (component.z_constants >= 0) std::copy(values.begin(), values.end(), state.z.begin() + component.z_constants);
}

void Direction::apply_inputs(const System& system, const State& at) {
  std::fill_n(state.z.begin() + system.nz(), system.nu(), 0.0);
  for (const Moving& m : moving_) {
    const Component& component = *m.component;
    if (component.input < 0 || m.tangent->signal == nullptr) continue;
    const AtBorder border("signal of tangents", component.name.c_str(), *component.type);
    state.z[static_cast<std::size_t>(system.nz() + component.input)] =
        m.tangent->signal(component.type->self, m.instance.at(0), at.t, at.side);
  }
}

void Direction::add_start(const System& system) {
  for (const Moving& m : moving_) {
    if (m.tangent->start == nullptr) continue;
    const Component& component = *m.component;
    const bramah_type& type = *component.type;
    Index own[2] = {};  // x, z
    for (std::int32_t i = 0; i < type.variable_count; ++i) ++own[type.variables[i].family == BRAMAH_X ? 0 : 1];
    Vector x(static_cast<std::size_t>(own[0])), v(x.size()), z(static_cast<std::size_t>(own[1]));
    const AtBorder border("start of tangents", component.name.c_str(), type);
    m.tangent->start(type.self, m.instance.at(0), x.data(), v.data(), z.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const std::size_t i = static_cast<std::size_t>(component.first_x) + k;
      if (!system.x[i].start_given) state.x[i] += x[k];
      if (!system.x[i].start_rate_given) state.v[i] += v[k];
    }
    for (std::size_t k = 0; k < z.size(); ++k) {
      const std::size_t i = static_cast<std::size_t>(component.first_z) + k;
      if (!system.z[i].start_given) state.z[i] += z[k];
    }
  }
  for (const StartRef& s : starts_) {
    Vector& to = s.kind == StartRef::Kind::x ? state.x : s.kind == StartRef::Kind::v ? state.v : state.z;
    to[static_cast<std::size_t>(s.index)] += 1.0;
  }
}

std::pair<const void*, Index> Direction::instances(const Group& group, Index first, Index most) const {
  Index count = most;
  for (const Moving& m : moving_) {
    const Index position = m.component->position;
    if (m.component->type != group.type || position < first) continue;
    if (position == first) return {m.instance.at(0), 1};
    count = std::min(count, position - first);
  }
  return {group.instances.at(first), count};
}

}  // namespace bramah
