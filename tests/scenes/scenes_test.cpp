// Every scene that we ship does what it asks for.
#include <gtest/gtest.h>

#include "solve/assemble.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"
#include "support/shipped.hpp"

namespace bramah::testing {
namespace {

class Shipped : public ::testing::TestWithParam<std::string> {};

TEST_P(Shipped, CompilesAndReachesItsReferenceState) {
  const Machine machine = load(GetParam());
  EXPECT_FALSE(machine.options().study.title.empty()) << "a scene has a title";
  EXPECT_FALSE(machine.options().study.description.empty()) << "a scene says what it shows";
  const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
  const State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
  Blocks blocks(machine.system());
  const Violation violation = constraint_violation(machine.system(), state, blocks);
  EXPECT_LT(violation.position, 1e-10);
  EXPECT_LT(violation.velocity, 1e-10);
  if (machine.options().linearize.asked) {
    const LinearModel model = linear_model(machine, state);
    EXPECT_TRUE(model.A.allFinite());
    EXPECT_TRUE(model.B.allFinite());
  }
}

TEST_P(Shipped, Simulates) {
  const Machine machine = load(GetParam());
  SimulateOptions options = machine.options().simulate;
  const bool equilibrium = options.from == SimulateOptions::From::equilibrium;
  const State start = reference_state(machine.system(), machine.options(), equilibrium, options.from_time);
  long outputs = 0;
  Observer observer;
  observer.output = [&](const State&) { ++outputs; };
  const Simulation run = simulate(machine.system(), options, start, observer);
  EXPECT_DOUBLE_EQ(run.last.t, options.to_time);
  EXPECT_GT(outputs, 1);
  EXPECT_LT(run.statistics.worst_position, 10.0 * options.rel_tol) << run.statistics.worst_position_row;
  EXPECT_EQ(run.statistics.energy.unknown, "");
  EXPECT_LT(run.statistics.energy.relative(), 1e3 * options.rel_tol) << run.statistics.energy.unaccounted << " J";
}

INSTANTIATE_TEST_SUITE_P(Scenes, Shipped, ::testing::ValuesIn(shipped_scenes()), shipped_name);

}  // namespace
}  // namespace bramah::testing
