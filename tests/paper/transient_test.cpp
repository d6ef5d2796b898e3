// The response to the torque of Eq. (92), nonlinear and linear.
#include <gtest/gtest.h>

#include <array>

#include "four_bar.hpp"
#include "linear/respond.hpp"
#include "solve/assemble.hpp"
#include "solve/simulate.hpp"
#include "support/numbers.hpp"
#include "support/reference.hpp"

namespace bramah::testing {
namespace {

struct Sample {
  double t;
  std::array<double, 5> y;  // phi2 - 60 deg, its rate, p1, p2, p3 minus equilibrium
};

std::vector<Sample> samples(const nlohmann::json& rows) {
  std::vector<Sample> list;
  for (const auto& row : rows) {
    Sample s{};
    const std::vector<double> all = numbers(row);
    s.t = all[0];
    std::copy_n(all.begin() + 1, 5, s.y.begin());
    list.push_back(s);
  }
  return list;
}

constexpr std::array<const char*, 5> names = {"crank.angle", "crank.angle.rate", "V1.p", "V2.p", "V3.p"};

struct Recording {
  std::vector<State> states;
  double worst_position = 0.0;
  Simulation simulation;
};

Recording record(const Machine& machine, const State& start, const std::vector<Sample>& expected, double rel_tol) {
  SimulateOptions options = machine.options().simulate;
  options.output_step = 0.0;
  options.to_time = expected.back().t;
  for (const Sample& s : expected) options.output_times.push_back(s.t);
  if (rel_tol > 0.0) options.rel_tol = rel_tol;
  Recording result;
  Blocks blocks(machine.system());
  Observer observer;
  observer.output = [&](const State& state) {
    result.worst_position =
        std::max(result.worst_position, constraint_violation(machine.system(), state, blocks).position);
    result.states.push_back(state);
  };
  result.simulation = simulate(machine.system(), options, start, observer);
  result.worst_position = std::max(result.worst_position, result.simulation.statistics.worst_position);
  return result;
}

const State& at(const Recording& run, double t) {
  const auto it =
      std::find_if(run.states.begin(), run.states.end(), [&](const State& s) { return std::abs(s.t - t) < 1e-12; });
  EXPECT_NE(it, run.states.end()) << "no output at t = " << t;
  return *it;
}

class Transient : public ::testing::TestWithParam<Friction> {};

TEST_P(Transient, NonlinearAgainstTheReference) {
  const auto all = reference("four_bar_transient.json");
  const std::vector<Sample> expected = samples(all["scenarios"][GetParam().name]["nonlinear"]);
  const Machine machine = load("scenes/four_bar/overdamped.json", GetParam().settings);
  const State start = find_equilibrium(machine.system(), machine.options().equilibrium).state;
  std::array<double, 5> peak{};
  for (const Sample& s : expected) {
    for (std::size_t k = 0; k < 5; ++k) peak[k] = std::max(peak[k], std::abs(s.y[k]));
  }
  // Default tolerance: 1e-6 of each variable's peak; tight: 1e-8.
  for (const auto& [rel_tol, tolerance] : {std::pair{0.0, 1e-6}, {3e-12, 1e-8}}) {
    const Recording result = record(machine, start, expected, rel_tol);
    for (const Sample& s : expected) {
      for (std::size_t k = 0; k < 5; ++k) {
        const double found = machine.value(at(result, s.t), names[k]) - machine.value(start, names[k]);
        EXPECT_TRUE(close(found, s.y[k], tolerance, peak[k]))
            << names[k] << " at t = " << s.t << ", rel_tol " << rel_tol;
      }
    }
    EXPECT_LT(result.worst_position, 1e-10);
    EXPECT_EQ(result.simulation.statistics.restarts, 2);  // at t1 = 1 s and t2 = 1.5 s, met exactly
  }
}

TEST_P(Transient, LinearModelOverlaid) {
  const auto all = reference("four_bar_transient.json");
  const auto& scenario = all["scenarios"][GetParam().name];
  const std::vector<Sample> nonlinear = samples(scenario["nonlinear"]), linear = samples(scenario["linear_from_t2"]);
  const Machine machine = load("scenes/four_bar/overdamped.json", GetParam().settings);
  const State start = find_equilibrium(machine.system(), machine.options().equilibrium).state;
  const Recording result = record(machine, start, nonlinear, 3e-12);
  const Partition partition = choose_partition(machine.system(), start, machine.options().linearize.prescribed);
  const LinearModel model = linear_model(machine, start);
  const State& release = at(result, 1.5);
  // NOLINTNEXTLINE(readability-suspicious-call-argument): the names are not swapped, only alike
  const Eigen::VectorXd X0 = reduced_deviation(machine.system(), partition, release, start);

  std::vector<double> times;
  for (const Sample& s : linear) times.push_back(s.t);
  const Eigen::MatrixXd X = free_response(model, X0, 1.5, times);
  std::array<double, 5> peak{};
  for (const Sample& s : linear) {
    for (std::size_t k = 0; k < 5; ++k) peak[k] = std::max(peak[k], std::abs(s.y[k]));
  }
  double deviation = 0.0;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    for (std::size_t k = 0; k < 5; ++k) {
      EXPECT_TRUE(close(X(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)), linear[i].y[k], 2e-8, peak[k]))
          << names[k] << " at t = " << linear[i].t;
    }
    for (const Sample& s : nonlinear) {
      if (s.t == linear[i].t)
        deviation = std::max(
            deviation, std::abs(X(0, static_cast<Eigen::Index>(i)) -
                                (machine.value(at(result, s.t), "crank.angle") - machine.value(start, "crank.angle"))));
    }
  }
  // 3.4, 10.6 and 11.0 %: largest over the reference's own finer grid, so the coarse one here may only be lower, a little.
  const double relative = deviation / X0(0), expected = number(scenario["relative_to_phi_at_t2"]);
  EXPECT_LE(relative, expected * 1.001);
  EXPECT_GE(relative, expected * 0.9);
}

INSTANTIATE_TEST_SUITE_P(Frictions, Transient, ::testing::ValuesIn(frictions), [](const auto& p) {
  std::string name = "friction_" + p.param.name;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
});

}  // namespace
}  // namespace bramah::testing
