// Chains against closed forms: statics of a hanging chain, energy and constraints of a swinging one.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "io/read_scene.hpp"
#include "solve/equilibrium.hpp"
#include "solve/rates.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/property.hpp"

namespace bramah {
namespace {

using namespace support;

double multiplier(const System& system, const State& state, const std::string& row) {
  for (std::size_t i = 0; i < state.lambda.size(); ++i) {
    if (system.constraint(static_cast<Index>(i)).name == row) return state.lambda[i];
  }
  ADD_FAILURE() << "no row " << row;
  return NAN;
}
double position(const System& system, const State& state, const std::string& name) {
  const Index i = system.find_x(name);
  if (i >= 0) return state.x[static_cast<std::size_t>(i)];
  ADD_FAILURE() << "no variable " << name;
  return NAN;
}
double velocity(const System& system, const State& state, const std::string& name) {
  return state.v[static_cast<std::size_t>(system.find_x(name))];
}

class HangingChain : public ::testing::TestWithParam<int> {};

// Each joint carries the weight of all links below it, whatever the chain's length; multipliers start from zero.
TEST_P(HangingChain, PlanarJointsCarryTheWeightBelow) {
  const int links = GetParam();
  const Compiled chain = compiled(planar_chain(links, bent(0.1)));
  const State state = find_equilibrium(chain.system, chain.options.equilibrium).state;
  const double weight = links * rod_mass * gravity;
  for (int i = 1; i <= links; ++i) {
    const std::string joint = "joint_" + std::to_string(i), link = "link_" + std::to_string(i);
    EXPECT_NEAR(multiplier(chain.system, state, joint + ".y"), (links - i + 1) * rod_mass * gravity, 1e-11 * weight)
        << joint;
    EXPECT_NEAR(multiplier(chain.system, state, joint + ".x"), 0.0, 1e-11 * weight) << joint;
    EXPECT_NEAR(position(chain.system, state, link + ".angle"), -0.5 * std::numbers::pi, 1e-10) << link;
    EXPECT_NEAR(position(chain.system, state, link + ".y"), -(i - 0.5) * rod_length, 1e-11 * links) << link;
  }
}

TEST_P(HangingChain, SpatialJointsCarryTheWeightBelow) {
  const int links = GetParam();
  const Compiled chain = compiled(spatial_chain(links, Axes::alternating, bent(0.1)));
  const State state = find_equilibrium(chain.system, chain.options.equilibrium).state;
  const double weight = links * rod_mass * gravity;
  for (int i = 1; i <= links; ++i) {
    const std::string joint = "joint_" + std::to_string(i), link = "link_" + std::to_string(i);
    EXPECT_NEAR(multiplier(chain.system, state, joint + ".z"), (links - i + 1) * rod_mass * gravity, 1e-11 * weight)
        << joint;
    for (const char* row : {".x", ".y", ".tilt_1", ".tilt_2"}) {
      EXPECT_NEAR(multiplier(chain.system, state, joint + row), 0.0, 1e-11 * weight) << joint << row;
    }
    EXPECT_NEAR(position(chain.system, state, link + ".z"), -(i - 0.5) * rod_length, 1e-11 * links) << link;
  }
}

INSTANTIATE_TEST_SUITE_P(Links, HangingChain, ::testing::Values(1, 10, 100));

double energy(const System& system, const State& state, int links) {
  double sum = 0.0;
  for (int i = 1; i <= links; ++i) {
    const std::string link = "link_" + std::to_string(i);
    const double vx = velocity(system, state, link + ".x"), vy = velocity(system, state, link + ".y"),
                 rate = velocity(system, state, link + ".angle");
    sum += 0.5 * rod_mass * (vx * vx + vy * vy) + 0.5 * rod_inertia * rate * rate +
           rod_mass * gravity * position(system, state, link + ".y");
  }
  return sum;
}

TEST(SwingingChain, KeepsItsEnergyAndItsJoints) {
  constexpr int links = 5;
  const Compiled chain = compiled(planar_chain(links, bent(0.5)));
  const State start = consistent_start(chain.system, chain.options, 0.0);
  const State rest = initial_state(compiled(planar_chain(links)).system);
  const double before = energy(chain.system, start, links), lowest = energy(chain.system, rest, links);
  double drift = 0.0;
  Observer observer;
  observer.output = [&](const State& state) {
    drift = std::max(drift, std::abs(energy(chain.system, state, links) - before));
  };
  SimulateOptions options;
  options.to_time = 1.0;
  options.output_step = 0.02;
  const Simulation run = simulate(chain.system, options, start, observer);
  EXPECT_DOUBLE_EQ(run.last.t, 1.0);
  EXPECT_GT(before - lowest, 1.0);
  EXPECT_LT(drift, 1e-6 * (before - lowest));
  EXPECT_LT(run.statistics.worst_position, 1e-9);  // what Newton's method leaves at the default tolerance
  EXPECT_LT(run.statistics.worst_velocity, 1e-7);
}

// With parallel axes the bodies with Euler parameters move as the planar ones do.
TEST(SwingingChain, IsTheSameInSpaceAndInThePlane) {
  constexpr int links = 3;
  const Compiled flat = compiled(planar_chain(links, bent(0.4))),
                 spatial = compiled(spatial_chain(links, Axes::parallel, bent(-0.4)));
  SimulateOptions options;
  options.to_time = 1.0;
  options.output_step = 1.0;
  const auto end = [&](const Compiled& chain) {
    return simulate(chain.system, options, consistent_start(chain.system, chain.options, 0.0), {}).last;
  };
  const State a = end(flat), b = end(spatial);
  for (int i = 1; i <= links; ++i) {
    const std::string link = "link_" + std::to_string(i);
    EXPECT_NEAR(position(flat.system, a, link + ".x"), position(spatial.system, b, link + ".x"), 1e-7) << link;
    EXPECT_NEAR(position(flat.system, a, link + ".y"), position(spatial.system, b, link + ".z"), 1e-7) << link;
    EXPECT_NEAR(position(spatial.system, b, link + ".y"), 0.0, 1e-12) << link;
  }
}

// The other families hold together: consistent at their start, with the degrees of freedom that they claim.
TEST(Families, StartAssembled) {
  const auto check = [](const Scene& scene, Index freedoms) {
    const Compiled machine = compiled(scene);
    const State state = initial_state(machine.system);
    Blocks blocks(machine.system);
    const Outcome outcome = blocks.evaluate(machine.system, state, Request{}.rows("cr"));
    ASSERT_TRUE(outcome.ok()) << outcome.message;
    for (const double c : blocks.c) EXPECT_NEAR(c, 0.0, 1e-13);
    for (const double r : blocks.r) EXPECT_NEAR(r, 0.0, 1e-13);
    EXPECT_EQ(static_cast<Index>(choose_partition(machine.system, state).ai.size()), freedoms);
  };
  check(planar_chain(7, bent(0.4)), 7);
  check(spatial_chain(7, Axes::alternating, bent(0.4)), 7);
  check(hydraulic_chain(7, 3, bent(0.2)), 7);
  check(four_bar_ladder(4), 1);
}

TEST(Families, HydraulicChainFindsItsEquilibrium) {
  const Compiled chain = compiled(hydraulic_chain(7, 3, bent(0.1)));
  const Equilibrium equilibrium = find_equilibrium(chain.system, chain.options.equilibrium);
  EXPECT_TRUE(equilibrium.free_directions.empty());
  for (Index i = 0; i < chain.system.nz(); ++i) {
    EXPECT_NEAR(equilibrium.state.z[static_cast<std::size_t>(i)], 1e5, 1e-4);  // the throttles level the pressures
  }
}

// A kilometre of links: joints turn the rounding of places far away into angles, which no error test may take for errors.
TEST(FallingChain, OfAKilometreIsNotHeldUpByRounding) {
  const Compiled chain = compiled(planar_chain(1000, bent(0.3)));
  SimulateOptions options = chain.options.simulate;
  options.integrator = SimulateOptions::Integrator::ida;
  options.to_time = options.output_step = 0.02;
  const Simulation run = simulate(chain.system, options, consistent_start(chain.system, chain.options, 0.0), {});
  EXPECT_LT(run.statistics.steps, 300);
  EXPECT_LT(run.statistics.error_test_failures, 30);
  EXPECT_LT(run.statistics.energy.relative(), 1e-7);
}

/// `stages` of two rods (1 m, 1 kg, pinned in the middle) at 45 degrees, at rest: one degree of freedom, and a KKT matrix
/// whose condition grows with the third power of the stages.
Compiled scissor_lift(int stages) {
  const double half = 0.5 * std::sqrt(0.5);
  std::string text =
      R"({ "bramah": 1, "libraries": ["mechanics"], "components": { "ground": { "type": "mechanics/ground" },
    "gravity": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] })";
  const auto body = [&](const std::string& name, int stage, double angle) {
    char numbers[200];
    std::snprintf(numbers, sizeof numbers, R"("inertia": %.17g, "position": [%.17g, %.17g], "angle": %.17g })",
                  1.0 / 12, half, (2 * stage - 1) * half, angle);
    text += R"(, ")" + name + R"(": { "type": "mechanics/planar_body", "gravity": "gravity", "mass": 1, )" + numbers;
  };
  const auto pin = [&](const std::string& name, const std::string& a, const std::string& at_a, const std::string& b,
                       const std::string& at_b) {
    text += ", \"" + name + R"(": { "type": "mechanics/planar_revolute", "a": ")" + a + R"(", "point_a": [)" + at_a +
            R"(, 0], "b": ")" + b + R"(", "point_b": [)" + at_b + ", 0] }";
  };
  for (int k = 1; k <= stages; ++k) {
    const std::string here = std::to_string(k), below = std::to_string(k - 1);
    body("A" + here, k, 0.25 * std::numbers::pi);
    body("B" + here, k, -0.25 * std::numbers::pi);
    pin("C" + here, "A" + here, "0", "B" + here, "0");
    if (k == 1) continue;
    pin("L" + here, "B" + below, "-0.5", "A" + here, "-0.5");
    pin("R" + here, "A" + below, "0.5", "B" + here, "0.5");
  }
  pin("base", "ground", "0", "A1", "-0.5");
  text += R"(, "rail": { "type": "mechanics/planar_slot", "a": "ground", "b": "B1", "point_b": [0.5, 0] } } })";
  return compile(read_scene_text(text, "scissor_lift.json"), shared_registry());
}

class ScissorLift : public ::testing::TestWithParam<int> {};

// Lagrange's equation of the angle; the sideways forces on all rods give base.x, their moments and weights base.y.
void expect_reactions(const System& system, const State& state, int stages, double tolerance) {
  const double N = stages, sine = std::sqrt(0.5), cosine = sine;
  const double J = 2 * N * (sine * sine / 4 + 1.0 / 12) + cosine * cosine * N * (4 * N * N - 1) / 6;
  const double acceleration = -gravity * cosine * N * N / J;
  const double sideways = -N * sine * acceleration;
  EXPECT_TRUE(
      bramah::testing::close(state.a[static_cast<std::size_t>(system.find_x("A1.angle"))], acceleration, tolerance));
  EXPECT_TRUE(bramah::testing::close(multiplier(system, state, "base.x"), sideways, tolerance));
  EXPECT_TRUE(bramah::testing::close(multiplier(system, state, "base.y"), N * gravity, tolerance));
}

TEST_P(ScissorLift, ReactionsKeepTheirDigits) {
  const Compiled lift = scissor_lift(GetParam());
  expect_reactions(lift.system, consistent_start(lift.system, lift.options, 0.0), GetParam(), 1e-10);
}

// One-step methods integrate the accelerations of a matrix with softness.
TEST(ScissorLiftOf100, SoftnessLeavesNothing) {
  constexpr int stages = 100;
  const Compiled lift = scissor_lift(stages);
  State state = consistent_start(lift.system, lift.options, 0.0);
  Rates rates(lift.system, state);
  rates.evaluate(state);
  expect_reactions(lift.system, state, stages, 1e-10);
}

// Where refinement cannot reach, the run says so: of 300 stages accelerations with softness have three digits.
TEST(ScissorLiftOf300, RunCountsAccelerationsWithoutDigits) {
  for (const int stages : {30, 300}) {
    const Compiled lift = scissor_lift(stages);
    SimulateOptions options = lift.options.simulate;
    options.to_time = 1e-3;
    options.integrator = SimulateOptions::Integrator::explicit_one_step;
    const SimulationStatistics run =
        simulate(lift.system, options, consistent_start(lift.system, lift.options, 0.0), {}).statistics;
    EXPECT_LT(run.worst_shown, 1e-6);
    if (stages == 30) {
      EXPECT_EQ(run.imprecise, 0);
    } else {
      EXPECT_GE(run.imprecise, run.evaluations - 2);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Stages, ScissorLift, ::testing::Values(10, 100, 300, 1000));

using Vector_l = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using Matrix_l = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Links of masses and lengths of all sizes, at any angles and rates, from the ground downward.
struct UnevenChain {
  std::vector<double> mass, length, angle, rate;

  explicit UnevenChain(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto from = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
    };
    const int links = 2 + static_cast<int>(random() % 39);
    for (int i = 0; i < links; ++i) {
      mass.push_back(std::pow(10.0, from(-3, 3)));
      length.push_back(std::pow(10.0, from(-1, 1)));
      angle.push_back(from(-3, 3));
      rate.push_back(from(-5, 5));
    }
  }
  [[nodiscard]] double inertia(std::size_t i) const { return mass[i] * length[i] * length[i] / 12.0; }

  [[nodiscard]] Compiled compiled() const {
    std::string text =
        R"({ "bramah": 1, "libraries": ["mechanics"], "components": { "ground": { "type": "mechanics/ground" },
      "gravity": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] })";
    double x = 0.0, y = 0.0;
    for (std::size_t i = 0; i < mass.size(); ++i) {
      const double across = std::cos(angle[i]) * length[i], up = std::sin(angle[i]) * length[i];
      const std::string name = std::to_string(i + 1);
      char numbers[400];
      std::snprintf(numbers, sizeof numbers,
                    R"("mass": %.17g, "inertia": %.17g, "position": [%.17g, %.17g], "angle": %.17g })", mass[i],
                    inertia(i), x + 0.5 * across, y + 0.5 * up, angle[i]);
      text += R"(, "link_)" + name + R"(": { "type": "mechanics/planar_body", "gravity": "gravity", )" + numbers;
      std::snprintf(numbers, sizeof numbers, R"("point_a": [%.17g, 0], "point_b": [%.17g, 0] })",
                    i == 0 ? 0.0 : 0.5 * length[i - 1], -0.5 * length[i]);
      text += R"(, "joint_)" + name + R"(": { "type": "mechanics/planar_revolute", "a": ")" +
              (i == 0 ? "ground" : "link_" + std::to_string(i)) + R"(", "b": "link_)" + name + "\", " + numbers;
      x += across;
      y += up;
    }
    return compile(read_scene_text(text + " } }", "uneven_chain.json"), shared_registry());
  }

  /// Accelerations of the angles, then the forces in the joints, x and y of each: Lagrange's equations of the angles, then
  /// Newton's law of all links below. Sine or cosine `rounded` (0, 1 of the first link, and so on) is changed
  /// by half a last digit.
  [[nodiscard]] std::pair<Vector_l, Vector_l> solution(int rounded = -1) const {
    const auto n = static_cast<Eigen::Index>(mass.size());
    Matrix_l across = Matrix_l::Zero(n, n), up = across, M = across;  // of centre k by angle i
    Vector_l Q = Vector_l::Zero(n), weight = Q, ax = Q, ay = Q;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto value = [&](long double exact, Eigen::Index which) {
        return which == rounded ? exact * (1 + 0x1p-53L) : exact;
      };
      const long double L = length[at], phi = angle[at], cosine = value(std::cos(phi), 2 * i + 1),
                        sine = value(std::sin(phi), 2 * i);
      for (Eigen::Index k = i; k < n; ++k) {
        const long double arm = k == i ? L / 2 : L;
        across(k, i) = -arm * sine;
        up(k, i) = arm * cosine;
        const long double w = rate[at];
        ax(k) -= arm * cosine * w * w;  // what the rates alone give
        ay(k) -= arm * sine * w * w;
      }
      weight(i) = mass[at];
      M(i, i) = inertia(at);
    }
    const Vector_l down = ay.array() + 9.81L;
    M += across.transpose() * weight.asDiagonal() * across + up.transpose() * weight.asDiagonal() * up;
    Q -= across.transpose() * weight.cwiseProduct(ax) + up.transpose() * weight.cwiseProduct(down);
    const Vector_l turned = M.ldlt().solve(Q);
    const Vector_l Fx = weight.cwiseProduct(ax + across * turned), Fy = weight.cwiseProduct(down + up * turned);
    Vector_l forces(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      forces(2 * i) = Fx.tail(n - i).sum();
      forces(2 * i + 1) = Fy.tail(n - i).sum();
    }
    return {turned, forces};
  }
};

// Whatever the masses and lengths, accelerations and reactions are as good as the rounding of their sines allows; the
// accelerations that one-step methods integrate may lose 1e-11 of the largest besides (worst of 2000 chains: 1.5e-12).
TEST(UnevenChains, AgreeWithTheirMinimalCoordinates) {
  for (int k = 0; k < property_runs(20); ++k) {
    SCOPED_TRACE("seed " + std::to_string(property_seed(k)));
    const UnevenChain chain(property_seed(k));
    const Compiled machine = chain.compiled();
    const System& system = machine.system;
    State state = initial_state(system);
    double vx = 0.0, vy = 0.0;
    for (std::size_t i = 0; i < chain.mass.size(); ++i) {
      const std::string link = "link_" + std::to_string(i + 1);
      const auto v = [&](const char* name) -> double& {
        return state.v[static_cast<std::size_t>(system.find_x(link + name))];
      };
      const double across = -std::sin(chain.angle[i]) * chain.length[i] * chain.rate[i],
                   up = std::cos(chain.angle[i]) * chain.length[i] * chain.rate[i];
      v(".x") = vx + 0.5 * across;
      v(".y") = vy + 0.5 * up;
      v(".angle") = chain.rate[i];
      vx += across;
      vy += up;
    }
    const auto [turned, forces] = chain.solution();
    // Each sine and cosine has its own rounding: first-order bounds of what they do together.
    double rounding_turned = 0.0, rounding_forces = 0.0;
    for (int i = 0; i < 2 * static_cast<int>(chain.mass.size()); ++i) {
      const auto [turned_near, forces_near] = chain.solution(i);
      rounding_turned += static_cast<double>((turned_near - turned).cwiseAbs().maxCoeff());
      rounding_forces += static_cast<double>((forces_near - forces).cwiseAbs().maxCoeff());
    }
    const double largest = static_cast<double>(turned.cwiseAbs().maxCoeff());
    const auto expect_accelerations = [&](double part, const char* how) {
      for (Eigen::Index i = 0; i < turned.size(); ++i) {
        const Index angle = system.find_x("link_" + std::to_string(i + 1) + ".angle");
        EXPECT_NEAR(state.a[static_cast<std::size_t>(angle)], static_cast<double>(turned(i)),
                    3 * rounding_turned + part * largest)
            << how;
      }
    };
    complete(system, state);
    expect_accelerations(1e-15, "without softness");
    const double largest_force = static_cast<double>(forces.cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < forces.size(); ++i) {
      const std::string row = "joint_" + std::to_string(i / 2 + 1) + (i % 2 == 0 ? ".x" : ".y");
      EXPECT_NEAR(multiplier(system, state, row), static_cast<double>(forces(i)),
                  3 * rounding_forces + 1e-15 * largest_force)
          << row;
    }
    Rates(system, state).evaluate(state);
    expect_accelerations(1e-11, "with softness");
  }
}

}  // namespace
}  // namespace bramah
