#include "system/measure.hpp"

#include <algorithm>
#include <functional>

#include "system/analysis_error.hpp"
#include "system/compile_parts.hpp"

namespace bramah {
namespace {

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
          K::input, s.nu(), [&](size_t i) { return s.inputs[i].name; }, [&](size_t i) { return s.inputs[i].unit; });
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

void measure(const System& system, const State& state, std::span<const Measured> columns, Blocks& blocks,
             Vector& values) {
  if (std::any_of(columns.begin(), columns.end(), [](const Measured& m) { return m.kind == Measured::Kind::y; })) {
    const Outcome outcome = blocks.evaluate(system, state, Request{}.rows("y"));
    if (!outcome.ok())
      throw AnalysisError("outputs", outcome.message, "finite outputs", "take the output out of the scene");
  }
  values.resize(columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto i = static_cast<std::size_t>(columns[k].index);
    switch (columns[k].kind) {
      case Measured::Kind::x: values[k] = state.x[i]; break;
      case Measured::Kind::v: values[k] = state.v[i]; break;
      case Measured::Kind::a: values[k] = state.a[i]; break;
      case Measured::Kind::z: values[k] = state.z[i]; break;
      case Measured::Kind::zdot: values[k] = state.zdot[i]; break;
      case Measured::Kind::lambda: values[k] = state.lambda[i]; break;
      case Measured::Kind::y: values[k] = blocks.y[i]; break;
      case Measured::Kind::input: values[k] = state.z[system.z.size() + i]; break;
    }
  }
}

}  // namespace bramah
