// Rows that are redundant at the start of a run only: no integrator goes on with one of them open.
#include "solve/dropped_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "io/read_scene.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"

namespace bramah::testing {
namespace {

using support::Method;

/// A bar from `x` along the x axis, `length` long, by name.
std::string bar(const std::string& name, double x, double length, const std::string& gravity) {
  return "\"" + name + R"(": { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [)" +
         std::to_string(x + 0.5 * length) + ", 0]" + gravity + "},";
}

/// A parallelogram four-bar with all links in line: 2 m of coupler and ground, cranks of 1 m.
const std::string in_line = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },)" +
                            bar("a", 0.0, 1.0, "") + bar("b", 2.0, 1.0, "") + bar("c", 1.0, 2.0, "") + R"(
    "O": { "type": "mechanics/planar_revolute", "a": "ground", "b": "a", "point_b": [-0.5, 0] },
    "P": { "type": "mechanics/planar_revolute", "a": "ground", "point_a": [2, 0], "b": "b", "point_b": [-0.5, 0] },
    "A": { "type": "mechanics/planar_revolute", "a": "a", "point_a": [0.5, 0], "b": "c", "point_b": [-1, 0] },
    "B": { "type": "mechanics/planar_revolute", "a": "b", "point_a": [0.5, 0], "b": "c", "point_b": [1, 0] } },
  "start": { "a.angle.rate": 2, "b.angle.rate": 2, "c.angle.rate": 0 }, "simulate": { "to_time": 1 } })";

/// Two bars in line between two pins: rigid, though its rows leave one velocity free.
const std::string flat_arch = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "gravity": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] },)" +
                              bar("left", 0.0, 1.0, R"(, "gravity": "gravity")") +
                              bar("right", 1.0, 1.0, R"(, "gravity": "gravity")") + R"(
    "O": { "type": "mechanics/planar_revolute", "a": "ground", "b": "left", "point_b": [-0.5, 0] },
    "M": { "type": "mechanics/planar_revolute", "a": "left", "point_a": [0.5, 0], "b": "right", "point_b": [-0.5, 0] },
    "P": { "type": "mechanics/planar_revolute", "a": "ground", "point_a": [2, 0], "b": "right", "point_b": [0.5, 0] } },
  "simulate": { "to_time": 0.5 } })";

class SingularStart : public ::testing::TestWithParam<Method> {
 protected:
  /// What the run from the start ends with; "" where it ends well.
  static std::string error(const std::string& scene) {
    const Compiled machine = compile(read_scene_text(scene, "singular.json"), registry());
    const SimulateOptions options = support::with(machine.options.simulate, GetParam());
    try {
      simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
    } catch (const AnalysisError& e) {
      return e.what();
    }
    return "";
  }
};
INSTANTIATE_TEST_SUITE_P(All, SingularStart, ::testing::ValuesIn(support::methods), support::name_of);
INSTANTIATE_TEST_SUITE_P(Automatic, SingularStart, ::testing::Values(support::automatic), support::name_of);

TEST_P(SingularStart, OfAFourBarInLineIsNamed) {
  EXPECT_THAT(error(in_line),
              ::testing::AllOf(::testing::HasSubstr("the constraint B."), ::testing::HasSubstr("singular position")));
}

TEST_P(SingularStart, OfAFlatArchIsNamed) {
  EXPECT_THAT(error(flat_arch),
              ::testing::AllOf(::testing::HasSubstr("the constraint P."), ::testing::HasSubstr("singular position")));
}

}  // namespace
}  // namespace bramah::testing
