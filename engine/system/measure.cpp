#include "system/measure.hpp"

#include <algorithm>

#include "system/analysis_error.hpp"

namespace bramah {

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
