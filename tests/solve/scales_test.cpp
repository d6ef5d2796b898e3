// The machine's own sizes: they follow its data exactly, and nothing is judged by a metre, a kilogram or a second.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/read_scene.hpp"
#include "solve/equilibrium.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "support/scene_parts.hpp"
#include "system/analysis_error.hpp"

namespace bramah::testing {
namespace {

using support::exact;

/// A body under gravity, its length, mass and time times L, M, T; with a pin or without.
Compiled body(double L, double M, double T, bool pinned) {
  const std::string text =
      R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "g": { "type": "mechanics/gravity", "acceleration": [0, )" +
      exact(-9.81 * L / (T * T)) + R"(, 0] },
    "b": { "type": "mechanics/planar_body", "gravity": "g", "mass": )" +
      exact(3.0 * M) + R"(, "inertia": )" + exact(0.25 * M * L * L) + R"(, "position": [)" + exact(0.4 * L) + ", " +
      exact(-0.3 * L) + R"(], "angle": -0.6 })" +
      (pinned ? R"(, "p": { "type": "mechanics/planar_revolute", "a": "b", "point_a": [)" + exact(-0.5 * L) +
                    R"(, 0], "b": "ground" })"
              : "") +
      "} }";
  return compile(read_scene_text(text, "body.json"), registry());
}

TEST(Scales, follow_the_data_exactly) {
  const Scales one = body(1.0, 1.0, 1.0, true).system.scales;
  for (const double L : {std::pow(16.0, -5), 1.0, std::pow(16.0, 3)}) {
    for (const double M : {std::pow(16.0, -10), 1.0, std::pow(16.0, 4)}) {
      for (const double T : {std::pow(16.0, -3), 1.0, std::pow(16.0, 2)}) {
        const Scales scales = body(L, M, T, true).system.scales;
        EXPECT_EQ(scales.length, one.length * L);
        EXPECT_EQ(scales.mass, one.mass * M);
        EXPECT_EQ(scales.time, one.time * T);
      }
    }
  }
}

TEST(Scales, pendulum_of_any_size_hangs_down) {
  for (const double L : {1e-6, 1e-3, 1.0}) {
    for (const double M : {1e-14, 1e-6, 1.0, 1e6}) {
      const Compiled machine = body(L, M, 1.0, true);
      const Equilibrium found = find_equilibrium(machine.system, {});
      EXPECT_TRUE(close(found.state.x[static_cast<std::size_t>(machine.system.find_x("b.angle"))],
                        -0.5 * std::numbers::pi, 1e-9))
          << L << " m, " << M << " kg";
    }
  }
}

TEST(Scales, body_of_any_mass_that_nothing_holds_is_refused) {
  for (const double M : {1e-20, 1e-14, 1.0, 1e10}) {
    const Compiled machine = body(std::cbrt(M), M, 1.0, false);
    EXPECT_THROW(find_equilibrium(machine.system, {}), AnalysisError) << M << " kg";
  }
}

}  // namespace
}  // namespace bramah::testing
