// Zeros by rank decisions, Jordan blocks, vectors, and what moves.
#include "linear/spectrum.hpp"

#include <gtest/gtest.h>

#include <random>

#include "linear/staircase.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

using Eigen::MatrixXd;

/// X J X^-1 with Jordan blocks of zero and given other eigenvalues, X random and well conditioned.
MatrixXd with_blocks(const std::vector<int>& blocks, const std::vector<double>& others, unsigned seed) {
  int n = static_cast<int>(others.size());
  for (const int size : blocks) n += size;
  MatrixXd J = MatrixXd::Zero(n, n);
  int at = 0;
  for (const int size : blocks) {
    for (int k = 1; k < size; ++k) J(at + k - 1, at + k) = 1.0;
    at += size;
  }
  for (const double value : others) {
    J(at, at) = value;
    ++at;
  }
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MatrixXd G(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) G(i, j) = normal(random);
  }
  const Eigen::HouseholderQR<MatrixXd> qr(G);
  const MatrixXd Q = qr.householderQ();
  const Eigen::VectorXd stretch = Eigen::VectorXd::LinSpaced(n, 0.5, 3.0);
  const MatrixXd X = Q * stretch.asDiagonal();
  return X * J * X.inverse();
}

LinearModel bare(const MatrixXd& A) {
  LinearModel model;
  model.A = A;
  for (Eigen::Index i = 0; i < A.rows(); ++i) model.states.push_back({"s" + std::to_string(i), "1", 1.0, "x_ai"});
  return model;
}

TEST(Staircase, FindsJordanBlocks) {
  const std::vector<std::vector<int>> cases = {{}, {1}, {2}, {1, 1}, {3, 2, 1}, {4, 4}, {3, 1, 1, 1}};
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const std::vector<int>& blocks : cases) {
      const MatrixXd A = with_blocks(blocks, {-1e-3, -0.1, -2.0, -30.0, -400.0}, seed);
      const Staircase stairs = find_staircase(A);
      EXPECT_EQ(stairs.block_sizes(), blocks) << "seed " << seed;
      EXPECT_LT((stairs.Q.transpose() * A * stairs.Q - stairs.triangular).norm(), 1e-11 * A.norm());
      EXPECT_LT(stairs.refused, 1e-11);
      EXPECT_GT(stairs.accepted, 1e-9);
    }
  }
}

TEST(Spectrum, NonzeroEigenvaluesSurviveDefectiveZeros) {
  // Plain QR scatters three zeros of a block by eps^(1/3); here they are exact, and the slow eigenvalue keeps its digits.
  const MatrixXd A = with_blocks({3, 2}, {-1e-4, -1.0, -100.0}, 3);
  const Spectrum spectrum = find_spectrum(bare(A));
  EXPECT_EQ(spectrum.zero_count(), 5);
  ASSERT_EQ(spectrum.zeros.size(), 2U);
  EXPECT_EQ(spectrum.zeros[0].size, 3);
  EXPECT_EQ(spectrum.zeros[1].size, 2);
  EXPECT_TRUE(close(spectrum.modes[0].eigenvalue.real(), -1e-4, 1e-8));
  EXPECT_TRUE(close(spectrum.modes[1].eigenvalue.real(), -1.0, 1e-11));
  EXPECT_TRUE(close(spectrum.modes[2].eigenvalue.real(), -100.0, 1e-12));
  double scatter = 0.0;
  bool unstable = false;
  for (const std::complex<double>& lambda : plain_eigenvalues(A)) {
    if (std::abs(lambda) < 5e-5) scatter = std::max(scatter, std::abs(lambda));
    unstable = unstable || lambda.real() > 1e-9;
  }
  EXPECT_GT(scatter, 1e-7);
  EXPECT_TRUE(unstable);  // the naive reading of the same matrix
  for (const Mode& mode : spectrum.modes) EXPECT_LE(mode.eigenvalue.real(), 0.0);
}

TEST(Spectrum, SlowEigenvalueAtTheEndOfAZeroChain) {
  // [0 1 0; 0 0 1; 0 0 s]: two zeros and s, whose condition is near 1/s^2.
  const MatrixXd G = with_blocks({}, {1.0, 1.1, 1.2, 1.3}, 5);
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(G).householderQ();
  for (const double s : {-1e-3, -1e-5, 1e-7}) {
    MatrixXd J = MatrixXd::Zero(4, 4);
    J(0, 1) = J(1, 2) = 1.0;
    J(2, 2) = s;
    J(3, 3) = -7.0;
    const Spectrum spectrum = find_spectrum(bare(Q * J * Q.transpose()));
    ASSERT_EQ(spectrum.zero_count(), 2);
    EXPECT_TRUE(close(spectrum.modes[0].eigenvalue.real(), s, 1e-13 / std::abs(s)));
  }
}

/// X J X^-1 as above, J with blocks of (eigenvalue, size).
MatrixXd with_defects(const std::vector<std::pair<double, int>>& blocks, unsigned seed) {
  int n = 0;
  for (const auto& [value, size] : blocks) n += size;
  MatrixXd J = MatrixXd::Zero(n, n);
  int at = 0;
  for (const auto& [value, size] : blocks) {
    for (int k = 0; k < size; ++k) {
      J(at, at) = value;
      if (k > 0) J(at - 1, at) = 1.0;
      ++at;
    }
  }
  std::vector<double> others;
  for (int k = 0; k < n; ++k) others.push_back(1.0 + k);
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(with_blocks({}, others, seed)).householderQ();
  const MatrixXd X = Q * Eigen::VectorXd::LinSpaced(n, 0.5, 3.0).asDiagonal();
  return X * J * X.inverse();
}

TEST(Spectrum, DefectiveEigenvaluesAwayFromZeroAreNotZeros) {
  // Vectors of equal eigenvalues are parallel: as single ones they have no condition, together they have a good one.
  using Blocks = std::vector<std::pair<double, int>>;
  struct Case {
    Blocks blocks;
    std::vector<double> means;  // of the groups that are expected
  };
  const Case cases[] = {{{{-1.0, 2}}, {-1.0}},
                        {{{-1.0, 2}, {-7.0, 1}}, {-1.0}},
                        {{{2.0, 2}, {-5.0, 2}}, {2.0, -5.0}},
                        {{{-3.0, 3}, {-40.0, 1}}, {-3.0}},
                        {{{0.0, 2}, {-1.0, 2}, {-9.0, 1}}, {-1.0}}};
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const Case& one : cases) {
      const MatrixXd A = with_defects(one.blocks, seed);
      const Spectrum spectrum = find_spectrum(bare(A));
      std::vector<std::complex<double>> means;
      for (const DefectiveGroup& group : spectrum.defective) {
        means.push_back(group.mean);
        EXPECT_LT((A.cast<std::complex<double>>() * group.right -
                   group.right * (group.left.adjoint() * A.cast<std::complex<double>>() * group.right))
                      .norm(),
                  1e-12 * A.norm() * group.right.norm());
      }
      ASSERT_EQ(means.size(), one.means.size()) << "seed " << seed;
      for (const double mean : one.means) EXPECT_TRUE(take_nearest(means, mean, 1e-11)) << "seed " << seed;
      Eigen::Index unstable = 0;
      for (const auto& [value, size] : one.blocks) unstable += value > 0.0 ? size : 0;
      EXPECT_EQ(spectrum.unstable_count(), unstable) << "seed " << seed;
      for (const Mode& mode : spectrum.modes) EXPECT_FALSE(mode.doubtful) << mode.eigenvalue << ", seed " << seed;
    }
  }
}

TEST(Spectrum, EqualEigenvaluesWithVectorsOfTheirOwnAreNotDefective) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Spectrum spectrum = find_spectrum(bare(with_blocks({}, {-1.0, -1.0, -1.0, -4.0, -4.0}, seed)));
    EXPECT_TRUE(spectrum.defective.empty()) << "seed " << seed;
    for (const Mode& mode : spectrum.modes) EXPECT_FALSE(mode.doubtful);
  }
}

TEST(Spectrum, DefectiveEigenvalueThatRoundingReachesStaysDoubtful) {
  // A block of size 3 at 1e-6: rounding moves it by the cube root of 1e-14.
  MatrixXd J = MatrixXd::Zero(4, 4);
  J.diagonal() << 1e-6, 1e-6, 1e-6, -1.0;
  J(0, 1) = J(1, 2) = 1.0;
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(with_blocks({}, {1.0, 1.1, 1.2, 1.3}, 5)).householderQ();
  const Spectrum spectrum = find_spectrum(bare(Q * J * Q.transpose()));
  const auto doubtful =
      std::count_if(spectrum.modes.begin(), spectrum.modes.end(), [](const Mode& m) { return m.doubtful || m.zero; });
  EXPECT_EQ(doubtful, 3);
  EXPECT_TRUE(spectrum.defective.empty());
}

TEST(Spectrum, VectorsBelongToTheMatrix) {
  for (const std::string scene : {"scenes/four_bar/underdamped_high_friction.json",
                                  "scenes/articulated_vehicle/straight.json", "scenes/bicycle/benchmark.json"}) {
    const Machine machine = load(scene);
    const State state = reference_state(machine.system(), machine.options(),
                                        machine.options().linearize.at == LinearizeOptions::At::equilibrium, 0.0);
    const LinearModel model = linear_model(machine, state);
    const Spectrum spectrum = find_spectrum(model);
    const Eigen::Index modes = spectrum.left.cols();
    ASSERT_EQ(modes + spectrum.zero_count(), model.A.rows());
    Eigen::VectorXd nominal(model.A.rows());
    for (Eigen::Index i = 0; i < nominal.size(); ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
    const MatrixXd A = nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal();
    for (Eigen::Index k = 0; k < modes; ++k) {
      const std::complex<double> lambda = spectrum.modes[static_cast<std::size_t>(k)].eigenvalue;
      const Eigen::VectorXcd v =
          nominal.cwiseInverse().cast<std::complex<double>>().cwiseProduct(spectrum.right.col(k));
      const Eigen::VectorXcd w = nominal.cast<std::complex<double>>().cwiseProduct(spectrum.left.col(k));
      EXPECT_LT((A.cast<std::complex<double>>() * v - lambda * v).norm(), 1e-11 * A.norm() * v.norm())
          << scene << ", mode " << k;
      EXPECT_LT((A.transpose().cast<std::complex<double>>() * w.conjugate() - lambda * w.conjugate()).norm(),
                1e-11 * A.norm() * w.norm())
          << scene << ", mode " << k;
    }
    const Eigen::MatrixXcd product = spectrum.left.adjoint() * spectrum.right.leftCols(modes);
    EXPECT_LT((product - Eigen::MatrixXcd::Identity(modes, modes)).cwiseAbs().maxCoeff(), 1e-8) << scene;
    const MatrixXd shares = participation(spectrum);
    for (Eigen::Index k = 0; k < modes; ++k) EXPECT_TRUE(close(shares.col(k).sum(), 1.0, 1e-12));
  }
}

TEST(Zeros, AreExplained) {
  struct Expected {
    std::string scene;
    std::vector<int> blocks;
    std::string first_kind;
  };
  const std::vector<Expected> cases = {{"scenes/four_bar/overdamped.json", {1, 1}, "trapped oil volume"},
                                       {"scenes/four_bar/spatial.json", {1, 1}, "trapped oil volume"},
                                       {"scenes/linear/trapped_volumes.json", {1, 1}, "trapped oil volume"},
                                       {"scenes/linear/sleeping_top.json", {2}, "rigid-body or cyclic coordinate"},
                                       {"scenes/rolling/disc.json", {3, 2, 1}, "nonholonomic drift"},
                                       {"scenes/rolling/torus.json", {3, 2, 1}, "nonholonomic drift"},
                                       {"scenes/rolling/skate.json", {2}, "rigid-body or cyclic coordinate"}};
  for (const Expected& expected : cases) {
    const Machine machine = load(expected.scene);
    const State state = reference_state(machine.system(), machine.options(),
                                        machine.options().linearize.at == LinearizeOptions::At::equilibrium, 0.0);
    const LinearModel model = linear_model(machine, state);
    const Spectrum spectrum = find_spectrum(model);
    std::vector<int> sizes;
    for (const ZeroBlock& block : spectrum.zeros) {
      sizes.push_back(block.size);
      EXPECT_FALSE(block.moves.empty());
      // What is said to move must be a null vector.
      Eigen::VectorXd v = Eigen::VectorXd::Zero(model.A.rows());
      for (const auto& [name, share] : block.moves) {
        const auto at = std::find_if(model.states.begin(), model.states.end(),
                                     [&, wanted = name](const NamedQuantity& q) { return q.name == wanted; });
        v(at - model.states.begin()) = share;
      }
      const Eigen::VectorXd rest = model.A * v, terms = model.A.cwiseAbs() * v.cwiseAbs();
      for (Eigen::Index i = 0; i < rest.size(); ++i)
        EXPECT_LE(std::abs(rest(i)), 1e-9 * terms(i) + 1e-12) << expected.scene;
    }
    EXPECT_EQ(sizes, expected.blocks) << expected.scene;
    ASSERT_FALSE(spectrum.zeros.empty());
    EXPECT_EQ(spectrum.zeros.front().kind, expected.first_kind) << expected.scene;
    for (const Mode& mode : spectrum.modes) EXPECT_FALSE(mode.doubtful) << expected.scene;
  }
}

}  // namespace
}  // namespace bramah::testing
