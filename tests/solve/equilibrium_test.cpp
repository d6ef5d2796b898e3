// Equilibria are found from any start, and what is said of them is true.
#include "solve/equilibrium.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "io/read_scene.hpp"
#include "linear/stability.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "support/property.hpp"
#include "support/scene_parts.hpp"
#include "system/analysis_error.hpp"

namespace bramah::testing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using support::list;
using support::names;
using support::numbered;

constexpr double pi = std::numbers::pi;

/// Numbers drawn at random, the same with every standard library.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double spread(double low, double high) { return low * std::exp(between(0.0, std::log(high / low))); }
  int pick(int count) { return static_cast<int>(between(0.0, count)); }
  Vector3d direction() {
    for (;;) {
      const Vector3d v(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
      if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
    }
  }

 private:
  std::mt19937_64 bits_;
};

Value point(const Vector2d& p) { return list({p.x(), p.y()}); }
Value point(const Vector3d& p) { return list({p.x(), p.y(), p.z()}); }

Value::Object parts() {
  Value::Object parts;
  parts.push_back({"ground", Value::Object{{"type", "mechanics/ground"}}});
  parts.push_back({"down", Value::Object{{"type", "mechanics/gravity"}, {"acceleration", list({0.0, -9.81, 0.0})}}});
  return parts;
}

/// Bars from corner to corner, pinned to each other and to the ground at the first corner, and at the last if it closes.
Scene bars_between(const std::vector<Vector2d>& corner, bool closes, Draw& draw, double springs) {
  Value::Object all = parts();
  double angle_before = 0.0, half_before = 0.0;
  const std::size_t count = corner.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<int>(i);
    const Vector2d along = corner[i + 1] - corner[i], centre = 0.5 * (corner[i] + corner[i + 1]);
    const double half = 0.5 * along.norm(), angle = std::atan2(along.y(), along.x()), mass = draw.spread(0.2, 20.0);
    all.push_back({numbered("bar", k), Value::Object{{"type", "mechanics/planar_body"},
                                                     {"gravity", "down"},
                                                     {"mass", mass},
                                                     {"inertia", mass * half * half / 3.0},
                                                     {"position", point(centre)},
                                                     {"angle", angle}}});
    all.push_back({numbered("pin", k), Value::Object{{"type", "mechanics/planar_revolute"},
                                                     {"a", i == 0 ? std::string("ground") : numbered("bar", k - 1)},
                                                     {"point_a", i == 0 ? point(corner[0]) : list({half_before, 0.0})},
                                                     {"b", numbered("bar", k)},
                                                     {"point_b", list({-half, 0.0})}}});
    if (draw.between(0.0, 1.0) < springs) {
      Value::Object spring = {{"type", "mechanics/torsion_spring"},
                              {"to", numbered("bar", k) + ".angle"},
                              {"stiffness", draw.spread(0.3, 300.0)},
                              {"free_angle", angle - angle_before + draw.between(-1.0, 1.0)}};
      if (i > 0) spring.push_back({"from", numbered("bar", k - 1) + ".angle"});
      all.push_back({numbered("torsion", k), std::move(spring)});
    }
    angle_before = angle;
    half_before = half;
  }
  if (closes) {
    all.push_back({"pin_end", Value::Object{{"type", "mechanics/planar_revolute"},
                                            {"a", "ground"},
                                            {"point_a", point(corner.back())},
                                            {"b", numbered("bar", static_cast<int>(count) - 1)},
                                            {"point_b", list({half_before, 0.0})}}});
  }
  return support::scene_of("bars", names({"mechanics"}), std::move(all));
}

std::vector<Vector2d> random_corners(Draw& draw, int bars) {
  std::vector<Vector2d> corner = {Vector2d(0.0, 0.0)};
  for (int i = 0; i < bars; ++i) {
    const double angle = draw.between(-pi, pi);
    corner.emplace_back(corner.back() + draw.spread(0.2, 2.0) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corner;
}

Scene random_chain(Draw& draw) { return bars_between(random_corners(draw, 1 + draw.pick(8)), false, draw, 0.4); }
Scene random_loop(Draw& draw) { return bars_between(random_corners(draw, 3 + draw.pick(4)), true, draw, 0.3); }

/// Joints of all kinds, one body after the other, any pose.
Scene random_arm(Draw& draw) {
  Value::Object all = parts();
  const int count = 1 + draw.pick(6);
  Vector3d at = Vector3d::Zero(), centre_before = at;
  Eigen::AngleAxisd turn_before = Eigen::AngleAxisd::Identity();
  for (int i = 0; i < count; ++i) {
    const double half = draw.spread(0.1, 0.8), mass = draw.spread(0.3, 10.0);
    const Vector3d along = draw.direction(), centre = at + half * along, about = draw.direction(),
                   axis = draw.direction();
    const Eigen::AngleAxisd turn(draw.between(-2.5, 2.5), about);
    const auto inertia = [&] { return mass * half * half * draw.between(0.2, 0.38); };
    const double i_1 = inertia(), i_2 = inertia(), i_3 = inertia();
    all.push_back({numbered("link", i), Value::Object{{"type", "mechanics/rigid_body"},
                                                      {"gravity", "down"},
                                                      {"mass", mass},
                                                      {"inertia", list({i_1, i_2, i_3})},
                                                      {"position", point(centre)},
                                                      {"rotation", point(Vector3d(turn.angle() * about))}}});
    Value::Object joint = {{"a", i == 0 ? std::string("ground") : numbered("link", i - 1)},
                           {"b", numbered("link", i)},
                           {"point_a", point(Vector3d(turn_before.inverse() * (at - centre_before)))},
                           {"point_b", point(Vector3d(turn.inverse() * (at - centre)))}};
    const int kind = draw.pick(3);
    joint.push_back({"type", kind == 0   ? "mechanics/spherical"
                             : kind == 1 ? "mechanics/revolute"
                                         : "mechanics/universal"});
    if (kind > 0) {
      const Vector3d other = kind == 1 ? axis : axis.unitOrthogonal();
      joint.push_back({"axis_a", point(Vector3d(turn_before.inverse() * axis))});
      joint.push_back({"axis_b", point(Vector3d(turn.inverse() * other))});
    }
    all.push_back({numbered("joint", i), std::move(joint)});
    at = centre + half * along;
    centre_before = centre;
    turn_before = turn;
  }
  return support::scene_of("arm", names({"mechanics"}), std::move(all));
}

/// Masses on a line between springs, far from where they rest.
Scene random_train(Draw& draw) {
  Value::Object all;
  const int count = 1 + draw.pick(10);
  for (int i = 0; i < count; ++i) {
    all.push_back({numbered("m", i), Value::Object{{"type", "mechanics/mass"},
                                                   {"mass", draw.spread(0.01, 100.0)},
                                                   {"position", draw.between(-30.0, 30.0)}}});
    Value::Object spring = {{"type", "mechanics/spring_damper"},
                            {"to", numbered("m", i) + ".x"},
                            {"stiffness", draw.spread(0.1, 1e5)},
                            {"free_length", draw.between(-2.0, 2.0)}};
    if (i > 0) spring.push_back({"from", numbered("m", draw.pick(i)) + ".x"});
    all.push_back({numbered("k", i), std::move(spring)});
  }
  return support::scene_of("train", names({"mechanics"}), std::move(all));
}

/// Volumes in a tree of throttles and gaps, fed by a source, some by a pump with a relief valve.
Scene random_circuit(Draw& draw) {
  Value::Object all;
  all.push_back({"tank", Value::Object{{"type", "hydraulics/pressure_source"}, {"p", 1e5}}});
  all.push_back({"supply", Value::Object{{"type", "hydraulics/pressure_source"}, {"p", draw.spread(5e5, 4e7)}}});
  const int count = 1 + draw.pick(8);
  const auto volume = [&](const std::string& name) {
    all.push_back({name, Value::Object{{"type", "hydraulics/volume"}}});
    all.push_back({"hose_" + name, Value::Object{{"type", "hydraulics/hose"},
                                                 {"volume", name},
                                                 {"V_h", draw.spread(1e-5, 1e-2)},
                                                 {"B_h", draw.spread(1e8, 2e9)},
                                                 {"B_oil", 1.5e9}}});
  };
  const auto passage = [&](const std::string& name, std::string a, std::string b) {
    Value::Object members = {{"a", std::move(a)}, {"b", std::move(b)}};
    if (draw.pick(3) == 0) {
      members.push_back({"type", "hydraulics/leakage"});
      members.push_back({"C_L", draw.spread(1e-13, 1e-9)});
    } else {
      members.push_back({"type", "hydraulics/throttle"});
      members.push_back({"C_d", 0.7});
      members.push_back({"A_t", draw.spread(1e-8, 1e-4)});
      members.push_back({"rho_oil", 850.0});
    }
    all.push_back({name, std::move(members)});
  };
  for (int i = 0; i < count; ++i) {
    volume(numbered("V", i));
    passage(numbered("way", i), i == 0 ? "supply" : numbered("V", draw.pick(i)), numbered("V", i));
    if (draw.pick(2) == 0) passage(numbered("out", i), numbered("V", i), "tank");
  }
  Value libraries = names({"hydraulics"});
  if (draw.pick(2) == 0) {
    libraries = names({"hydraulics", "signals"});
    volume("P");
    all.push_back(
        {"speed",
         Value::Object{{"type", "signals/constant"}, {"unit", "rad/s"}, {"value", draw.between(20.0, 200.0)}}});
    all.push_back({"pump", Value::Object{{"type", "hydraulics/pump"},
                                         {"inlet", "tank"},
                                         {"outlet", "P"},
                                         {"speed", "speed"},
                                         {"q", draw.spread(1e-7, 1e-4)},
                                         {"p_set", draw.spread(1e6, 3e7)},
                                         {"alpha_min", draw.pick(2) == 0 ? 1.0 : 0.0}}});
    all.push_back({"relief", Value::Object{{"type", "hydraulics/relief_valve"},
                                           {"a", "P"},
                                           {"b", "tank"},
                                           {"p_crack", draw.spread(1e6, 3e7)},
                                           {"G_v", draw.spread(1e-11, 1e-8)}}});
    passage("load", "P", "V0");
  }
  return support::scene_of("circuit", std::move(libraries), std::move(all));
}

/// How far the machine would go in its own time if it were let go at rest: an independent look at the balances.
double unrest(const System& system, const State& rest) {
  State state = rest;
  complete(system, state);
  double largest = 0.0;
  const double time = system.scales.time;
  for (std::size_t i = 0; i < system.x.size(); ++i)
    largest = std::max(largest, std::abs(state.a[i]) * time * time / system.x[i].nominal);
  for (std::size_t i = 0; i < system.z.size(); ++i)
    largest = std::max(largest, std::abs(state.zdot[i]) * time / std::max(system.z[i].nominal, std::abs(state.z[i])));
  return largest;
}

struct Family {
  const char* name;
  Scene (*make)(Draw&);
  int in_ci;
};
class RandomMachines : public ::testing::TestWithParam<Family> {};

// Gravity over joints, springs between the ground and everything, throttles between sources: all of these have an
// equilibrium, so that a refusal is a failure. What has a potential ends at a minimum of it.
TEST_P(RandomMachines, Settle) {
  for (int k = 0; k < support::property_runs(GetParam().in_ci); ++k) {
    Draw draw(support::property_seed(k));
    const Scene scene = GetParam().make(draw);
    const Compiled machine = compile(scene, registry());
    SCOPED_TRACE(GetParam().name + (" of seed " + std::to_string(support::property_seed(k))));
    Equilibrium found;
    try {
      found = find_equilibrium(machine.system, machine.options.equilibrium);
    } catch (const AnalysisError& error) {
      ADD_FAILURE() << error.what() << "\n" << support::scene_text(scene);
      continue;
    }
    EXPECT_LT(unrest(machine.system, found.state), 1e-6) << support::scene_text(scene);
    const Stability stability = judge_stability(machine.system, found.state, 400);
    EXPECT_NE(stability.verdict, Stability::Verdict::unstable) << support::scene_text(scene);
  }
}

INSTANTIATE_TEST_SUITE_P(Equilibria, RandomMachines,
                         ::testing::Values(Family{"chain", random_chain, 250}, Family{"loop", random_loop, 250},
                                           Family{"arm", random_arm, 200}, Family{"train", random_train, 150},
                                           Family{"circuit", random_circuit, 150}),
                         [](const auto& of) { return std::string(of.param.name); });

Compiled pendulum(double angle, const std::string& more = "") {
  char text[1000];
  std::snprintf(text, sizeof text, R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "down": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] },
    "bar": { "type": "mechanics/planar_body", "gravity": "down", "mass": 2, "inertia": 0.1,
             "position": [%.17g, %.17g], "angle": %.17g },
    "pin": { "type": "mechanics/planar_revolute", "a": "bar", "point_a": [0, 1], "b": "ground" } }%s })",
                std::sin(angle), -std::cos(angle), angle, more.c_str());
  return compile(read_scene_text(text, "pendulum.json"), registry());
}

double angle_found(const Compiled& machine, const Equilibrium& found) {
  return found.state.x[static_cast<std::size_t>(machine.system.find_x("bar.angle"))];
}

TEST(Equilibria, AStartThatBalancesIsKept) {
  for (const char* more : {"", R"(, "equilibrium": { "stability": "nearest" })"}) {
    const Compiled machine = pendulum(pi, more);
    const Equilibrium found = find_equilibrium(machine.system, machine.options.equilibrium);
    EXPECT_TRUE(close(angle_found(machine, found), pi, 1e-12));
    EXPECT_TRUE(found.moved.empty());
    const Stability stability = judge_stability(machine.system, found.state, 400);
    EXPECT_EQ(stability.verdict, Stability::Verdict::unstable);
    EXPECT_EQ(stability.directions, 1);
    ASSERT_EQ(stability.modes.size(), 1U);
    // m r^2 + J = 2.1 kg m^2, m g r = 19.62 N m
    EXPECT_TRUE(close(stability.modes[0].eigenvalue.real(), std::sqrt(19.62 / 2.1), 1e-12));
  }
}

TEST(Equilibria, ASearchEndsAtAMinimumUnlessItShallBeTheNearest) {
  for (const double start : {0.3, 1.6, 2.5, 3.0, 3.14, -3.1}) {
    const Compiled machine = pendulum(start);
    const Equilibrium found = find_equilibrium(machine.system, machine.options.equilibrium);
    EXPECT_TRUE(close(std::remainder(angle_found(machine, found), 2.0 * pi), 0.0, 1e-9)) << "from " << start;
    ASSERT_FALSE(found.moved.empty());
    const auto angle = std::find_if(found.moved.begin(), found.moved.end(),
                                    [](const Moved& moved) { return moved.name == "bar.angle"; });
    ASSERT_NE(angle, found.moved.end());
    EXPECT_TRUE(close(angle->from, start, 1e-12));
    EXPECT_TRUE(close(angle->to, angle_found(machine, found), 1e-15, 1.0));
  }
  const Compiled machine = pendulum(3.0, R"(, "equilibrium": { "stability": "nearest" })");
  const Equilibrium found = find_equilibrium(machine.system, machine.options.equilibrium);
  EXPECT_TRUE(close(angle_found(machine, found), pi, 1e-9));
}

TEST(Equilibria, AreTheSameBitForBitInEveryRun) {
  Draw draw(5);
  const Compiled machine = compile(random_loop(draw), registry());
  const Equilibrium first = find_equilibrium(machine.system, machine.options.equilibrium);
  const Equilibrium second = find_equilibrium(machine.system, machine.options.equilibrium);
  EXPECT_EQ(first.state.x, second.state.x);
  EXPECT_EQ(first.state.lambda, second.state.lambda);
}

TEST(Equilibria, ADriveThatMovesIsRefusedByName) {
  // x = A sin(2 pi t + phase): at t = 0 it has a speed, at the end of its way an acceleration.
  for (const double phase : {0.0, 0.5 * pi}) {
    Value::Object all = parts();
    all.push_back({"bar", Value::Object{{"type", "mechanics/planar_body"}, {"mass", 1.0}, {"inertia", 1.0}}});
    all.push_back({"shaker", Value::Object{{"type", "mechanics/planar_shaker"},
                                           {"body", "bar"},
                                           {"amplitude", 0.1},
                                           {"direction", list({1.0, 0.0})},
                                           {"omega", 6.0},
                                           {"phase", phase}}});
    const Compiled machine = compile(support::scene_of("shaken", names({"mechanics"}), std::move(all)), registry());
    try {
      find_equilibrium(machine.system, machine.options.equilibrium);
      ADD_FAILURE() << "an equilibrium on a moving drive, phase " << phase;
    } catch (const AnalysisError& error) {
      EXPECT_NE(error.found().find("shaker"), std::string::npos) << error.what();
      EXPECT_NE(error.found().find(phase == 0.0 ? "a velocity of" : "an acceleration of"), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace bramah::testing
