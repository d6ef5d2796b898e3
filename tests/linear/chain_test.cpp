// The spectrum of hanging chains against the linearized multi-pendulum in absolute angles, made independently:
//
//   M_ii = m L^2 (N - i + 1/3),  M_ij = m L^2 (N - max(i, j) + 1/2),  K_ii = m g L (N - i + 1/2)     i, j = 1 ... N
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "io/read_scene.hpp"
#include "linear/linearize.hpp"
#include "linear/spectrum.hpp"
#include "solve/equilibrium.hpp"
#include "support/generators.hpp"

namespace bramah {
namespace {

using namespace support;
using Eigen::MatrixXd;

/// Circular frequencies, ascending, of `links` hanging rods of which link i turns with coordinate group[i]; -1: it does
/// not turn.
std::vector<double> pendulum_frequencies(int links, const std::vector<int>& group) {
  const int size = 1 + *std::max_element(group.begin(), group.end());
  if (size == 0) return {};
  MatrixXd M = MatrixXd::Zero(links, links), K = M, P = MatrixXd::Zero(links, size);
  constexpr double mL2 = rod_mass * rod_length * rod_length, mgL = rod_mass * gravity * rod_length;
  for (int i = 0; i < links; ++i) {
    for (int j = 0; j < links; ++j) M(i, j) = mL2 * (i == j ? links - i - 2.0 / 3.0 : links - std::max(i, j) - 0.5);
    K(i, i) = mgL * (links - i - 0.5);
    if (group[static_cast<std::size_t>(i)] >= 0) P(i, group[static_cast<std::size_t>(i)]) = 1.0;
  }
  const MatrixXd mass = P.transpose() * M * P, stiffness = P.transpose() * K * P;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(stiffness, mass, Eigen::EigenvaluesOnly);
  std::vector<double> frequencies;
  for (Eigen::Index k = 0; k < size; ++k) frequencies.push_back(std::sqrt(solver.eigenvalues()(k)));
  return frequencies;
}

std::vector<int> each_on_its_own(int links) {
  std::vector<int> group(static_cast<std::size_t>(links));
  for (int i = 0; i < links; ++i) group[static_cast<std::size_t>(i)] = i;
  return group;
}

/// With axes along y and x in turn the planes decouple, and in each every second joint is rigid. Links 1 and 2, 3 and 4,
/// ... turn together about y; link 1 does not turn about x, links 2 and 3, 4 and 5, ... turn together.
std::vector<double> frequencies_in_turn(int links) {
  std::vector<int> about_y, about_x;
  for (int i = 1; i <= links; ++i) {
    about_y.push_back((i - 1) / 2);
    about_x.push_back(i / 2 - 1);
  }
  std::vector<double> all = pendulum_frequencies(links, about_y);
  const std::vector<double> others = pendulum_frequencies(links, about_x);
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

/// A linearizer at the equilibrium of a scene.
struct Hanging {
  explicit Hanging(const Scene& scene)
      : machine(compiled(scene)),
        state(find_equilibrium(machine.system, machine.options.equilibrium).state),
        linearizer(machine.system, choose_partition(machine.system, state)) {}
  Spectrum reduced() {
    linearizer.linearize(state, model);
    return find_spectrum(model);
  }
  Spectrum augmented() {
    linearizer.linearize_augmented(state, model);
    return find_spectrum(model);
  }
  Compiled machine;
  State state;
  Linearizer linearizer;
  LinearModel model;
};

/// The spectrum holds +-i omega for every one of `expected` and nothing else.
void expect_oscillations(const Spectrum& spectrum, std::vector<double> expected) {
  std::sort(expected.begin(), expected.end());
  std::vector<double> found;
  for (const Mode& mode : spectrum.modes) {
    const double omega = std::abs(mode.eigenvalue.imag());
    EXPECT_NEAR(mode.eigenvalue.real(), 0.0, 1e-10 * omega);
    EXPECT_FALSE(mode.zero);
    if (mode.eigenvalue.imag() > 0.0) found.push_back(omega);
  }
  ASSERT_EQ(spectrum.modes.size(), 2 * expected.size());
  ASSERT_EQ(found.size(), expected.size());
  std::sort(found.begin(), found.end());
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k], expected[k], 1e-10 * expected[k]) << "frequency " << k;
}

class ChainSpectrum : public testing::TestWithParam<int> {};

TEST_P(ChainSpectrum, OfPlanarRodsIsThatOfTheMultiPendulum) {
  const int links = GetParam();
  expect_oscillations(Hanging(planar_chain(links)).reduced(), pendulum_frequencies(links, each_on_its_own(links)));
}

TEST_P(ChainSpectrum, WithParallelAxesInSpaceIsThatOfTheMultiPendulum) {
  const int links = GetParam();
  expect_oscillations(Hanging(spatial_chain(links, Axes::parallel)).reduced(),
                      pendulum_frequencies(links, each_on_its_own(links)));
}

TEST_P(ChainSpectrum, WithAxesInTurnIsThatOfTwoMultiPendulums) {
  const int links = GetParam();
  expect_oscillations(Hanging(spatial_chain(links, Axes::alternating)).reduced(), frequencies_in_turn(links));
}

TEST(ChainScene, HangsInThePlane) {
  const std::string folder = std::string(BRAMAH_SOURCE_DIR) + "/scenes/linear/";
  expect_oscillations(Hanging(read_scene(folder + "hanging_chain.json")).reduced(),
                      pendulum_frequencies(10, each_on_its_own(10)));
}
TEST(ChainScene, HangsInSpace) {
  const std::string folder = std::string(BRAMAH_SOURCE_DIR) + "/scenes/linear/";
  expect_oscillations(Hanging(read_scene(folder + "hanging_chain_spatial.json")).reduced(), frequencies_in_turn(10));
}

/// The unreduced Jacobian has every reduced eigenvalue; all others are zeros that stand for the constraints.
void expect_in_augmented(const Scene& scene) {
  Hanging chain(scene);
  const Spectrum reduced = chain.reduced(), augmented = chain.augmented();
  std::vector<bool> used(augmented.modes.size(), false);
  for (const Mode& mode : reduced.modes) {
    std::size_t nearest = 0;
    double distance = HUGE_VAL;
    for (std::size_t k = 0; k < augmented.modes.size(); ++k) {
      const double d = std::abs(augmented.modes[k].eigenvalue - mode.eigenvalue);
      if (!used[k] && d < distance) {
        distance = d;
        nearest = k;
      }
    }
    used[nearest] = true;
    EXPECT_LT(distance, 1e-9 * std::abs(mode.eigenvalue));
  }
  double smallest = HUGE_VAL;
  for (const Mode& mode : reduced.modes) smallest = std::min(smallest, std::abs(mode.eigenvalue));
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k]) continue;
    EXPECT_LT(std::abs(augmented.modes[k].eigenvalue), 1e-3 * smallest);  // defective zeros split by sqrt(eps)
  }
}

TEST_P(ChainSpectrum, IsInTheAugmentedSpectrum) {
  expect_in_augmented(planar_chain(GetParam()));
  expect_in_augmented(spatial_chain(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Links, ChainSpectrum, testing::Values(1, 2, 5, 20));

}  // namespace
}  // namespace bramah
