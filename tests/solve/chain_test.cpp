// Chains against closed forms: statics of a hanging chain, energy and constraints of a swinging one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solve/equilibrium.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"

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

class HangingChain : public testing::TestWithParam<int> {};

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

INSTANTIATE_TEST_SUITE_P(Links, HangingChain, testing::Values(1, 10, 100));

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

}  // namespace
}  // namespace bramah
