#include "system/measure.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "system/analysis_error.hpp"
#include "system/compile_parts.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

bool visit_energetic(const System& s, const std::function<bool(const Measured&)>& visit) {
  using K = Measured::Kind;
  for (std::size_t c = 0; c < s.components.size(); ++c) {
    const Component& component = s.components[c];
    const auto i = static_cast<Index>(c);
    if (component.type == nullptr) continue;  // it has faults
    if (says_energy(*component.type) && !visit({K::energy, i, component.name + ".energy", "J"})) return false;
    if (!visit({K::power, i, component.name + ".power", "W"})) return false;
  }
  return visit({K::energy, -1, "energy", "J"}) && visit({K::power, -1, "power", "W"});
}

/// Names and finders of one kind of measurement, visited in a fixed order.
void visit_measured(const System& s, const std::function<bool(const Measured&)>& visit) {
  const auto each = [&](Measured::Kind kind, Index count, auto&& name, auto&& unit) {
    for (Index i = 0; i < count; ++i) {
      if (!visit({kind, i, name(static_cast<std::size_t>(i)), unit(static_cast<std::size_t>(i))})) return false;
    }
    return true;
  };
  using K = Measured::Kind;
  using std::size_t;
  each(
      K::x, s.n(), [&](size_t i) { return s.x[i].name; }, [&](size_t i) { return s.x[i].unit; }) &&
      each(
          K::v, s.n(), [&](size_t i) { return s.x[i].name + ".rate"; },
          [&](size_t i) { return compiling::rate_unit(s.x[i].unit); }) &&
      each(
          K::a, s.n(), [&](size_t i) { return s.x[i].name + ".acceleration"; },
          [&](size_t i) { return s.x[i].unit == "1" ? std::string("1/s^2") : s.x[i].unit + "/s^2"; }) &&
      each(
          K::z, s.nz(), [&](size_t i) { return s.z[i].name; }, [&](size_t i) { return s.z[i].unit; }) &&
      each(
          K::zdot, s.nz(), [&](size_t i) { return s.z[i].name + ".rate"; },
          [&](size_t i) { return compiling::rate_unit(s.z[i].unit); }) &&
      each(
          K::lambda, s.m() + s.l(), [&](size_t i) { return s.multiplier_name(static_cast<Index>(i)); },
          [&](size_t i) { return s.multiplier_unit(static_cast<Index>(i)); }) &&
      each(
          K::y, s.ny(), [&](size_t i) { return s.outputs[i].name; }, [&](size_t i) { return s.outputs[i].unit; }) &&
      each(
          K::input, s.nu(), [&](size_t i) { return s.inputs[i].name; }, [&](size_t i) { return s.inputs[i].unit; }) &&
      visit_energetic(s, visit);
}

}  // namespace

bool find_measured(const System& system, std::string_view name, Measured& found) {
  bool success = false;
  visit_measured(system, [&](const Measured& candidate) {
    if (candidate.name != name) return true;
    found = candidate;
    success = true;
    return false;
  });
  return success;
}

std::vector<std::string> measured_names(const System& system) {
  std::vector<std::string> names;
  visit_measured(system, [&](const Measured& candidate) {
    names.push_back(candidate.name);
    return true;
  });
  return names;
}

namespace {

bool is_output(const Measured& m) { return m.kind == Measured::Kind::y; }
bool is_energetic(const Measured& m) { return m.kind == Measured::Kind::energy || m.kind == Measured::Kind::power; }
bool is_energy_of_whole(const Measured& m) { return m.kind == Measured::Kind::energy && m.index < 0; }

}  // namespace

Meter::Meter(const System& system, std::vector<Measured> columns)
    : system_(system), columns_(std::move(columns)), values_(columns_.size()) {
  if (std::any_of(columns_.begin(), columns_.end(), is_output)) blocks_ = std::make_unique<Blocks>(system);
  if (std::any_of(columns_.begin(), columns_.end(), is_energetic)) energies_ = std::make_unique<Energies>(system);
}

void Meter::read_energies(const State& state) {
  const Outcome outcome = energies_->evaluate(state, true);
  if (!outcome.ok())
    throw AnalysisError("outputs", outcome.message, "finite energies", "take energies and powers out of the outputs");
  if (energies_->unsaid().empty() || std::none_of(columns_.begin(), columns_.end(), is_energy_of_whole)) return;
  const Component& mute = system_.components[static_cast<std::size_t>(energies_->unsaid().front())];
  throw AnalysisError("outputs",
                      "the energy of the whole is asked for, but not all that " + mute.name + " (" + mute.type->name +
                          ") stores is in its energy",
                      "types with a function `energy`", "ask for energies of other components by name",
                      pointer("/components", mute.name));
}

const Vector& Meter::read(const State& state) {
  if (blocks_ != nullptr) {
    const Outcome outcome = blocks_->evaluate(system_, state, Request{}.rows("y"));
    if (!outcome.ok())
      throw AnalysisError("outputs", outcome.message, "finite outputs", "take the output out of the scene");
  }
  if (energies_ != nullptr) read_energies(state);
  const auto part = [](const Vector& all, const Measured& of) {
    return of.index < 0 ? std::accumulate(all.begin(), all.end(), 0.0) : all[static_cast<std::size_t>(of.index)];
  };
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto i = static_cast<std::size_t>(columns_[k].index);
    switch (columns_[k].kind) {
      case Measured::Kind::x: values_[k] = state.x[i]; break;
      case Measured::Kind::v: values_[k] = state.v[i]; break;
      case Measured::Kind::a: values_[k] = state.a[i]; break;
      case Measured::Kind::z: values_[k] = state.z[i]; break;
      case Measured::Kind::zdot: values_[k] = state.zdot[i]; break;
      case Measured::Kind::lambda: values_[k] = state.lambda[i]; break;
      case Measured::Kind::y: values_[k] = blocks_->y[i]; break;
      case Measured::Kind::input: values_[k] = state.z[system_.z.size() + i]; break;
      case Measured::Kind::energy: values_[k] = part(energies_->energy(), columns_[k]); break;
      case Measured::Kind::power: values_[k] = part(energies_->power(), columns_[k]); break;
    }
  }
  return values_;
}

}  // namespace bramah
