// Rows that are redundant where a run starts, and not along its motion: every integrator chooses the rows anew and goes on
// along the velocity that it has, or names the joints. None goes on with a row open.
#include "solve/dropped_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <regex>
#include <string>
#include <utility>

#include "io/read_scene.hpp"
#include "solve/near_assembly.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"
#include "support/property.hpp"
#include "support/scene_parts.hpp"

namespace bramah::testing {
namespace {

using support::Method;

/// A bar from `x` along the x axis, `length` long, by name.
std::string bar(const std::string& name, double x, double length, const std::string& gravity) {
  return "\"" + name + R"(": { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [)" +
         std::to_string(x + 0.5 * length) + ", 0]" + gravity + "},";
}

/// A parallelogram four-bar with all links in line: 2 m of coupler and ground, cranks of 1 m.
const std::string in_line = R"({ "bramah": 1, "libraries": ["mechanics", "signals"], "components": {
    "ground": { "type": "mechanics/ground" },)" +
                            bar("a", 0.0, 1.0, "") + bar("b", 2.0, 1.0, "") + bar("c", 1.0, 2.0, "") + R"(
    "O": { "type": "mechanics/planar_revolute", "a": "ground", "b": "a", "point_b": [-0.5, 0] },
    "P": { "type": "mechanics/planar_revolute", "a": "ground", "point_a": [2, 0], "b": "b", "point_b": [-0.5, 0] },
    "A": { "type": "mechanics/planar_revolute", "a": "a", "point_a": [0.5, 0], "b": "c", "point_b": [-1, 0] },
    "B": { "type": "mechanics/planar_revolute", "a": "b", "point_a": [0.5, 0], "b": "c", "point_b": [1, 0] } },
  "simulate": { "to_time": 1 }, "start": )";

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

TEST_P(SingularStart, OfAFourBarGoesOnAlongItsVelocity) {
  const Compiled machine = compile(
      read_scene_text(in_line + R"({ "a.angle.rate": 2, "b.angle.rate": 2, "c.angle.rate": 0 } })", "parallel.json"),
      registry());
  const SimulateOptions options = support::with(machine.options.simulate, GetParam());
  const Simulation run = simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
  const auto angle = [&](const char* name) {
    return run.last.x[static_cast<std::size_t>(machine.system.find_x(name))];
  };
  // A parallelogram without forces turns on at a constant rate. The fixed step of 1 ms leaves 4e-7.
  EXPECT_NEAR(angle("a.angle"), 2.0, 1e-6);
  EXPECT_NEAR(angle("b.angle"), 2.0, 1e-6);
  EXPECT_NEAR(angle("c.angle"), 0.0, 1e-6);
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_THAT(run.events[0].name, ::testing::HasSubstr("constraints chosen anew"));
}

TEST_P(SingularStart, OfAFourBarAtRestBetweenItsBranchesIsNamed) {
  const std::string pushed = R"({ } })";
  std::string scene = in_line + pushed;
  const std::string ground = R"("ground": { "type": "mechanics/ground" },)";
  scene.replace(scene.find(ground), ground.size(),
                ground + R"( "motor": { "type": "mechanics/coordinate_force", "on": "a.angle", "force": "T" },
                "T": { "type": "signals/table", "unit": "N.m", "times": [0, 9], "values": [3, 3] },)");
  EXPECT_THAT(error(scene),
              ::testing::AllOf(::testing::HasSubstr("the constraint B."), ::testing::HasSubstr("singular position")));
}

TEST_P(SingularStart, OfAFlatArchIsNamed) {
  EXPECT_THAT(error(flat_arch),
              ::testing::AllOf(::testing::HasSubstr("the constraint P."), ::testing::HasSubstr("singular position")));
}

/// What find_singular_position says of a parallelogram of cranks at `angle`, on a ground turned by `heading` and moved.
std::optional<SingularPosition> of_parallelogram(double angle, double heading, double moved) {
  const auto turned = [&](double x, double y) {
    return "[" + support::exact(moved + x * std::cos(heading) - y * std::sin(heading)) + ", " +
           support::exact(-moved + x * std::sin(heading) + y * std::cos(heading)) + "]";
  };
  const double c = std::cos(angle), s = std::sin(angle);
  const auto body = [&](const char* name, double x, double y, double turn) {
    return std::string("\"") + name +
           R"(": { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": )" + turned(x, y) +
           R"(, "angle": )" + support::exact(heading + turn) + " },";
  };
  const std::string scene =
      R"({ "bramah": 1, "libraries": ["mechanics"], "components": { "ground": { "type": "mechanics/ground" },)" +
      body("a", 0.5 * c, 0.5 * s, angle) + body("b", 2.0 + 0.5 * c, 0.5 * s, angle) + body("c", 1.0 + c, s, 0.0) + R"(
    "O": { "type": "mechanics/planar_revolute", "a": "ground", "point_a": )" +
      turned(0.0, 0.0) + R"(, "b": "a", "point_b": [-0.5, 0] },
    "P": { "type": "mechanics/planar_revolute", "a": "ground", "point_a": )" +
      turned(2.0, 0.0) + R"(, "b": "b", "point_b": [-0.5, 0] },
    "A": { "type": "mechanics/planar_revolute", "a": "a", "point_a": [0.5, 0], "b": "c", "point_b": [-1, 0] },
    "B": { "type": "mechanics/planar_revolute", "a": "b", "point_a": [0.5, 0], "b": "c", "point_b": [1, 0] } } })";
  const Compiled machine = compile(read_scene_text(scene, "parallelogram.json"), registry());
  return find_singular_position(machine.system, consistent_start(machine.system, machine.options, 0.0));
}

TEST(SingularPosition, IsFoundWhereverTheMachineStands) {
  using Kind = SingularPosition::Kind;
  const int count = support::property_runs(20);
  for (int k = 0; k < count; ++k) {
    std::mt19937_64 random(support::property_seed(k));
    const double heading = std::uniform_real_distribution<double>(-3.1, 3.1)(random),
                 moved = std::uniform_real_distribution<double>(-100.0, 100.0)(random);
    const auto between = of_parallelogram(0.0, heading, moved);
    ASSERT_TRUE(between) << "heading " << heading << ", moved " << moved;
    EXPECT_EQ(between->kind, Kind::bifurcation);
    const auto beside = of_parallelogram(1e-6, heading, moved);
    ASSERT_TRUE(beside) << "heading " << heading << ", moved " << moved;
    EXPECT_EQ(beside->kind, Kind::near);
    EXPECT_LT(beside->digits, 6.0);
    EXPECT_FALSE(of_parallelogram(0.5, heading, moved)) << "heading " << heading << ", moved " << moved;
  }
}

TEST(SingularPosition, TellsLockedStructuresFromBifurcationsAndBothFromTwoHinges) {
  const Compiled arch = compile(read_scene_text(flat_arch, "arch.json"), registry());
  const auto locked = find_singular_position(arch.system, consistent_start(arch.system, arch.options, 0.0));
  ASSERT_TRUE(locked);
  EXPECT_EQ(locked->kind, SingularPosition::Kind::locked);
  for (const char* scene : {"scenes/redundant/door.json", "scenes/four_bar/spatial.json"}) {
    const Machine machine = load(scene);
    const Compiled& compiled = machine.compiled;
    EXPECT_FALSE(find_singular_position(compiled.system, consistent_start(compiled.system, compiled.options, 0.0)))
        << scene;
  }
}

class TurningCart : public ::testing::TestWithParam<Method> {
 protected:
  /// Two driven wheels, its first heading turned by `heading`; torque pulses turn it by 90 degrees.
  static std::string scene(double heading) {
    const std::string h = support::exact(heading), c = support::exact(0.5 * std::cos(heading)),
                      s = support::exact(0.5 * std::sin(heading));
    std::string text = R"({ "bramah": 1, "libraries": ["mechanics", "signals"], "components": {
      "ch": { "type": "mechanics/rigid_body", "mass": 20, "inertia": [1, 0.8, 1.2], "position": [0, 0, 0.15],
              "rotation": [0, 0, )" +
                       h + R"(], "velocity": [)" + c + ", " + s + R"(, 0] },
      "TR": { "type": "signals/table", "unit": "N.m", "times": [0, 1, 1, 2, 2, 3, 3],
              "values": [0, 0, 1.3312498869427947, 1.3312498869427947, -1.3312498869427947, -1.3312498869427947, 0] },
      "TL": { "type": "signals/table", "unit": "N.m", "times": [0, 1, 1, 2, 2, 3, 3],
              "values": [0, 0, -1.3312498869427947, -1.3312498869427947, 1.3312498869427947, 1.3312498869427947, 0] })";
    for (const auto& [side, y] : {std::pair{"L", "0.4"}, std::pair{"R", "-0.4"}}) {
      std::string wheel = R"(,
      "wS": { "type": "mechanics/wheel", "carrier": "ch", "mass": 2, "A": 0.05, "C": 0.09, "point": [0, Y, 0.15],
              "rate": 1.6666666666666667 },
      "rS": { "type": "mechanics/rolling_wheel", "carrier": "ch", "spin": "wS.spin", "point": [0, Y, 0.15], "a": 0.3 },
      "mS": { "type": "mechanics/coordinate_force", "on": "wS.spin", "force": "TS" })";
      wheel = std::regex_replace(wheel, std::regex("\\b([wrmT])S\\b"), std::string("$1") + side);
      text += std::regex_replace(wheel, std::regex("Y"), y);
    }
    return text + R"( }, "simulate": { "to_time": 6 } })";
  }
};
INSTANTIATE_TEST_SUITE_P(All, TurningCart, ::testing::ValuesIn(support::methods), support::name_of);
INSTANTIATE_TEST_SUITE_P(Automatic, TurningCart, ::testing::Values(support::automatic), support::name_of);

TEST_P(TurningCart, RollsOnFromAnyHeading) {
  const int count = support::property_runs(3);
  for (int k = 0; k < count; ++k) {
    std::mt19937_64 random(support::property_seed(k));
    const double heading = k == 0 ? 0.0 : std::uniform_real_distribution<double>(-3.0, 3.0)(random);
    const Compiled machine = compile(read_scene_text(scene(heading), "cart.json"), registry());
    const SimulateOptions options = support::with(machine.options.simulate, GetParam());
    const Simulation run =
        simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
    const auto spin = [&](const char* name) {
      return run.last.x[static_cast<std::size_t>(machine.system.find_x(name))];
    };
    // 6 s at 0.5 m/s over 0.3 m is 10 rad for the mean; the pulses yaw by pi/2, so the difference is 0.8/0.3 pi/2.
    const double half = 0.4 / 0.3 * 1.5707963267948966;
    EXPECT_NEAR(spin("wR.spin"), 10.0 + half, 1e-5) << "heading " << heading;
    EXPECT_NEAR(spin("wL.spin"), 10.0 - half, 1e-5) << "heading " << heading;
    // What a checkpoint continues has the rows of the run that it comes from.
    SimulateOptions longer = options;
    longer.to_time = 7.0;
    const Simulation on = resume(machine.system, longer, run.checkpoint, {});
    EXPECT_NEAR(on.last.x[static_cast<std::size_t>(machine.system.find_x("wR.spin"))], spin("wR.spin") + 0.5 / 0.3,
                1e-5);
  }
}

}  // namespace
}  // namespace bramah::testing
