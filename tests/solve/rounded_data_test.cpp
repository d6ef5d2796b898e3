// Joints that repeat each other but for rounding of their data: a door on two to four hinges, anywhere in space.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "io/read_scene.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"
#include "support/property.hpp"
#include "support/scene_parts.hpp"

namespace bramah::testing {
namespace {

using support::Method;
using Three = std::array<double, 3>;

constexpr double mass = 30.0, arm = 0.45, about_axis = 2.0, pull = 0.5;  // kg, m, kg m^2, m/s^2

/// a turned by a rotation vector.
Three turned(const Three& by, const Three& a) {
  const double angle = std::hypot(by[0], by[1], by[2]);
  if (angle == 0.0) return a;
  const Three n = {by[0] / angle, by[1] / angle, by[2] / angle};
  const double along = n[0] * a[0] + n[1] * a[1] + n[2] * a[2], c = std::cos(angle), s = std::sin(angle);
  const Three cross = {n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0]};
  Three result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = c * a[k] + s * cross[k] + (1.0 - c) * along * n[k];
  return result;
}

std::string text(const Three& a) {
  return "[" + support::exact(a[0]) + ", " + support::exact(a[1]) + ", " + support::exact(a[2]) + "]";
}

struct Door {
  Three rotation{};
  int hinges = 2;
  double off = 0.0;  // m and rad: of every number of a hinge on the ground
  std::string more;  // of the scene

  [[nodiscard]] std::string scene(std::mt19937_64& random) const {
    std::uniform_real_distribution<double> rounding(-off, off);
    const auto rounded = [&](Three a) {
      for (double& value : a) value += rounding(random);
      return text(a);
    };
    std::string all = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
      "ground": { "type": "mechanics/ground" },
      "gravity": { "type": "mechanics/gravity", "acceleration": )" +
                      text(turned(rotation, {pull, 0.0, -9.8})) + R"( },
      "leaf": { "type": "mechanics/rigid_body", "gravity": "gravity", "mass": 30, "inertia": [10, 12, 2], "position": )" +
                      text(turned(rotation, {arm, 0.0, 1.0})) + R"(, "rotation": )" + text(rotation) +
                      R"(, "velocity": )" + text(turned(rotation, {0.0, arm, 0.0})) +
                      R"(, "angular_velocity": [0, 0, 1] })";
    for (int k = 0; k < hinges; ++k) {
      const double height = 0.2 + 1.6 * k / (hinges - 1);
      all += ",\n" + support::numbered("\"hinge", k) +
             R"(": { "type": "mechanics/revolute", "a": "ground", "b": "leaf", "point_a": )" +
             rounded(turned(rotation, {0.0, 0.0, height})) + R"(, "axis_a": )" +
             rounded(turned(rotation, {0.0, 0.0, 1.0})) + R"(, "point_b": )" + text({-arm, 0.0, height - 1.0}) + " }";
    }
    return all + R"( }, "simulate": { "to_time": 2 })" + more + " }";
  }
};

/// The angle of the door after `time`, from its one equation of motion, by Runge and Kutta.
double angle_after(double time) {
  const auto acceleration = [](double phi) {
    return -mass * pull * arm * std::sin(phi) / (about_axis + mass * arm * arm);
  };
  double phi = 0.0, rate = 1.0;
  constexpr int steps = 4000;
  const double h = time / steps;
  for (int k = 0; k < steps; ++k) {
    const double a1 = acceleration(phi), a2 = acceleration(phi + 0.5 * h * rate),
                 a3 = acceleration(phi + 0.5 * h * (rate + 0.5 * h * a1)),
                 a4 = acceleration(phi + h * (rate + 0.5 * h * a2));
    phi += h * rate + h * h / 6.0 * (a1 + a2 + a3);
    rate += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return phi;
}

/// How far the leaf is from where it shall be at the end, m.
double error(const Compiled& machine, const Door& door, const Method& method) {
  const SimulateOptions options = support::with(machine.options.simulate, method);
  const Simulation run = simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
  const double phi = angle_after(2.0);
  const Three expected = turned(door.rotation, {arm * std::cos(phi), arm * std::sin(phi), 1.0});
  return std::hypot(run.last.x[0] - expected[0], run.last.x[1] - expected[1], run.last.x[2] - expected[2]);
}

class RoundedDoor : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, RoundedDoor, ::testing::ValuesIn(support::methods), support::name_of);
INSTANTIATE_TEST_SUITE_P(Automatic, RoundedDoor, ::testing::Values(support::automatic), support::name_of);

TEST_P(RoundedDoor, MovesAsTheExactOneInAnyOrientation) {
  const int count = support::property_runs(4);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = support::property_seed(k);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> turn(-1.5, 1.5);
    Door door;
    // Orientations beside the axes too: what is zero there in exact arithmetic is rounding beside them.
    const double small = k % 2 == 0 ? 1.0 : std::pow(10.0, -3.0 - 4.0 * (k % 4));
    for (double& value : door.rotation) value = small * turn(random);
    door.hinges = 2 + k % 3;
    door.off = k % 2 == 0 ? 1e-9 : 0.0;
    const Compiled machine = compile(read_scene_text(door.scene(random), "door.json"), registry());
    // Ten times what the tolerance of 1e-9 and a fixed step of 1 ms leave, 8e-8 m.
    EXPECT_LT(error(machine, door, GetParam()), 1e-6) << "seed " << seed;
  }
}

TEST(RoundedData, IsAcceptedUpToTheToleranceOfTheSceneAndSaid) {
  std::mt19937_64 random(1);
  Door door;
  door.off = 4e-7;
  EXPECT_THROW(
      {
        const Compiled machine = compile(read_scene_text(door.scene(random), "door.json"), registry());
        consistent_start(machine.system, machine.options, 0.0);
      },
      AnalysisError);
  door.more = R"(, "assembly": { "tolerance": "2 um" })";
  const Compiled machine = compile(read_scene_text(door.scene(random), "door.json"), registry());
  const std::vector<StartNote> notes = start_notes(machine.system, machine.options, false, 0.0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].kind, "rounded data");
  EXPECT_THAT(notes[0].found, ::testing::HasSubstr("stays open by"));
  EXPECT_LT(error(machine, door, support::automatic), 1e-5);
  // The state of rest, and what is free there, are those of a door.
  const Equilibrium rest = find_equilibrium(machine.system, machine.options.equilibrium, 0.0);
  EXPECT_TRUE(rest.free_directions.empty());
}

TEST(RoundedData, ToleranceBeyondAThousandthOfTheMachineIsRefused) {
  std::mt19937_64 random(1);
  Door door;
  door.more = R"(, "assembly": { "tolerance": "0.1 m" })";
  try {
    compile(read_scene_text(door.scene(random), "door.json"), registry());
    FAIL() << "accepted";
  } catch (const SceneError& refused) {
    EXPECT_EQ(refused.diagnostics().front().pointer, "/assembly/tolerance");
  }
}

}  // namespace
}  // namespace bramah::testing
