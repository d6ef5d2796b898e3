// What a model does not depend on: the coordinates that are chosen as independent. And when they are chosen again.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "io/read_scene.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "system/analysis_error.hpp"

namespace bramah::testing {
namespace {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;

State reference_of(const Machine& machine) {
  const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
  State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
  state.side = machine.options().linearize.side;
  return state;
}

/// C (s - A)^-1 B + D, solved in nominals.
MatrixXcd transfer(const LinearModel& model, std::complex<double> s) {
  const Eigen::Index n = model.A.rows();
  Eigen::VectorXd nominal(n);
  for (Eigen::Index i = 0; i < n; ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
  const MatrixXd A = nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal(),
                 B = nominal.cwiseInverse().asDiagonal() * model.B, C = model.C * nominal.asDiagonal();
  const MatrixXcd resolvent = s * MatrixXcd::Identity(n, n) - A.cast<std::complex<double>>();
  if (model.inputs.empty())
    return model.D.cast<std::complex<double>>();  // Eigen solves for no column with null pointers
  return C.cast<std::complex<double>>() * resolvent.fullPivLu().solve(B.cast<std::complex<double>>()) +
         model.D.cast<std::complex<double>>();
}

std::vector<int> zero_structure(const Spectrum& spectrum) {
  std::vector<int> sizes;
  for (const ZeroBlock& block : spectrum.zeros) sizes.push_back(block.size);
  std::sort(sizes.begin(), sizes.end());
  return sizes;
}

/// Eigenvalues, zeros and transfer function agree with those of `expected`.
void expect_same(const LinearModel& model, const LinearModel& expected, double tolerance, const std::string& which) {
  SCOPED_TRACE(which);
  const Spectrum found = find_spectrum(model), known = find_spectrum(expected);
  EXPECT_EQ(zero_structure(found), zero_structure(known));
  std::vector<std::complex<double>> left;
  for (const Mode& mode : found.modes) {
    if (!mode.zero) left.push_back(mode.eigenvalue);
  }
  double fastest = 0.0;
  for (const Mode& mode : known.modes) fastest = std::max(fastest, std::abs(mode.eigenvalue));
  for (const Mode& mode : known.modes) {
    if (mode.zero) continue;
    // Rounding of A, a thousand eps, moves a slow eigenvalue by its condition times the size of A.
    const double rounding = 1e3 * 2.2e-16 * mode.condition * fastest / std::abs(mode.eigenvalue);
    EXPECT_TRUE(take_nearest(left, mode.eigenvalue, std::max(tolerance, rounding)));
  }
  EXPECT_TRUE(left.empty());
  for (const std::complex<double> s : {std::complex<double>(0.7, 0.0), {0.0, 3.0}, {1.0, 40.0}}) {
    const MatrixXcd a = transfer(model, s), b = transfer(expected, s);
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      EXPECT_LE((a.row(i) - b.row(i)).norm(), tolerance * b.row(i).norm())
          << model.outputs[static_cast<std::size_t>(i)].name;
  }
}

std::string names(const System& system, const std::vector<Index>& list) {
  std::string text;
  for (const Index i : list) text += system.x[static_cast<std::size_t>(i)].name + " ";
  return text;
}

/// The model of a partition, and the condition of that.
double model_of(const Machine& machine, const State& state, const Partition& partition, LinearModel& model) {
  Linearizer linearizer(machine.system(), partition, machine.options().outputs);
  linearizer.linearize(state, model);
  return linearizer.conditions().worst();
}

class Invariance : public ::testing::TestWithParam<const char*> {};

// Every coordinate that can be the only independent one, or partitions drawn at random where there are more.
TEST_P(Invariance, OfTheChoiceOfCoordinates) {
  const Machine machine = load(GetParam());
  const System& system = machine.system();
  const State state = reference_of(machine);
  LinearModel expected, model;
  const Partition chosen = choose_partition(system, state);
  const double condition = model_of(machine, state, chosen, expected);
  int compared = 0;
  const auto compare = [&](const Prescribed& prescribed) {
    const Partition other = choose_partition(system, state, prescribed);
    const double worse = model_of(machine, state, other, model) / condition;
    if (worse > 1e3) return;
    ++compared;
    // Asked: 1e-10. Of a choice that is more than five times worse conditioned, each digit lost there is lost here.
    expect_same(model, expected, 1e-10 * std::max(1.0, worse / 5.0),
                names(system, other.ai) + "/ " + names(system, other.ad));
  };
  if (chosen.ai.size() == 1) {
    for (Index i = 0; i < system.n(); ++i) {
      try {
        compare({{i}, {}});
      } catch (const AnalysisError&) {  // tied by the constraints at this state
      }
    }
  } else {
    std::mt19937 random(7);
    for (int trial = 0; trial < 8; ++trial) {
      std::vector<Index> order = shifted(system.n(), 0);
      std::shuffle(order.begin(), order.end(), random);
      Prescribed drawn;
      for (const Index i : order) {
        const bool dependent = drawn.independent.size() == chosen.ai.size();
        if (dependent && drawn.admissible_dependent.size() == chosen.ad.size()) break;
        std::vector<Index>& list = dependent ? drawn.admissible_dependent : drawn.independent;
        list.push_back(i);
        try {
          if (choose_partition(system, state, drawn).smallest_pivot < 1e-2) list.pop_back();
        } catch (const AnalysisError&) {
          list.pop_back();
        }
      }
      compare(drawn);
    }
  }
  EXPECT_GE(compared, 3);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Invariance,
                         ::testing::Values("scenes/four_bar/overdamped.json", "scenes/four_bar/spatial.json",
                                           "scenes/bicycle/benchmark.json", "scenes/articulated_vehicle/straight.json",
                                           "scenes/redundant/stewart.json", "scenes/redundant/scott_russell.json",
                                           "scenes/linear/hanging_chain.json"),
                         [](const auto& p) {
                           std::string name = p.param;
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

/// A rotor on a hinge along x, at `angle`, turning with 2 rad/s.
State turned(const System& system, double angle) {
  State state = initial_state(system);
  const auto e = static_cast<std::size_t>(system.find_x("rotor.e0"));
  state.x[e] = std::cos(0.5 * angle), state.x[e + 1] = std::sin(0.5 * angle);
  state.v[e] = -std::sin(0.5 * angle), state.v[e + 1] = std::cos(0.5 * angle);
  complete(system, state);
  return state;
}

// e1 describes the angle of a rotor until it has made half a turn; then e0 has to.
TEST(LinearizerAlong, ChoosesAgainWhereThePartitionIsPoor) {
  const char* text = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "rotor": { "type": "mechanics/rigid_body", "mass": 1, "inertia": [2, 1, 1] },
    "axle": { "type": "mechanics/revolute", "a": "ground", "b": "rotor", "axis_a": [1, 0, 0], "axis_b": [1, 0, 0] }
  } })";
  const Compiled compiled = compile(read_scene_text(text, "rotor.json"), registry());
  const System& system = compiled.system;
  const State start = turned(system, 0.1);
  LinearizerAlong along(system, {});
  Linearizer fixed(system, choose_partition(system, start));
  LinearModel model, poor;
  along.linearize(start, model);
  EXPECT_EQ(model.states[0].name, "rotor.e1");
  along.linearize(turned(system, 2.0), model);
  EXPECT_EQ(along.choices(), 1) << "not before it is needed";
  const State half = turned(system, std::numbers::pi - 1e-8);
  fixed.linearize(half, poor);
  EXPECT_GT(fixed.conditions().worst(), LinearizerAlong::worst_condition);
  along.linearize(half, model);
  EXPECT_EQ(along.choices(), 2);
  EXPECT_EQ(model.states[0].name, "rotor.e0");
  EXPECT_LT(along.conditions().worst(), 10.0);
  // e0 = cos(angle / 2): e0'' = -(omega / 2)^2 e0, whatever the angle.
  EXPECT_TRUE(close(model.A(1, 0), -1.0, 1e-9));
  // Exactly there the old partition is singular.
  State upside_down = turned(system, std::numbers::pi);
  upside_down.x[static_cast<std::size_t>(system.find_x("rotor.e0"))] = 0.0;
  EXPECT_THROW(fixed.linearize(upside_down, poor), AnalysisError);
  along.linearize(upside_down, model);
  EXPECT_EQ(along.choices(), 2);
}

TEST(Prescribed, AdmissibleDependentCoordinates) {
  const Machine machine = load("scenes/rolling/skate.json");
  const System& system = machine.system();
  const State state = reference_of(machine);
  const Index x = system.find_x("skate.x"), y = system.find_x("skate.y"), angle = system.find_x("skate.angle");
  const Partition partition = choose_partition(system, state, {{}, {y}});
  EXPECT_EQ(partition.ad, std::vector<Index>{y});
  EXPECT_EQ(partition.ai, (std::vector<Index>{x, angle}));
  EXPECT_EQ(choose_partition(system, state, {{angle, x}, {y}}).ai, (std::vector<Index>{angle, x}));
}

}  // namespace
}  // namespace bramah::testing
