// Modes followed along a parameter: crossings, veerings, coincident modes, branch points; and the root finder.
#include "linear/track.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;

using Family = std::function<MatrixXd(double)>;

ModeSet modes_of(const MatrixXd& A) {
  LinearModel model;
  model.A = A;
  for (Eigen::Index i = 0; i < A.rows(); ++i) model.states.push_back({"s" + std::to_string(i), "1", 1.0, "x_ai"});
  const Spectrum spectrum = find_spectrum(model);
  ModeSet set;
  for (Eigen::Index k = 0; k < spectrum.left.cols(); ++k)
    set.values.push_back(spectrum.modes[static_cast<std::size_t>(k)].eigenvalue);
  set.right = spectrum.right.leftCols(spectrum.left.cols());
  set.left = spectrum.left;
  set.zeros = spectrum.zero_count();
  return set;
}

Tracks follow(const Family& A, const std::vector<double>& points) {
  return ModeFollower().follow(points, [&](const std::vector<double>& list) {
    std::vector<std::optional<ModeSet>> sets;
    for (const double p : list) sets.emplace_back(modes_of(A(p)));
    return sets;
  });
}

std::vector<Tracks::Point> asked(const Tracks& tracks) {
  std::vector<Tracks::Point> points;
  for (const Tracks::Point& point : tracks.points) {
    if (point.asked) points.push_back(point);
  }
  return points;
}

std::vector<double> range(double from, double to, int count) {
  std::vector<double> list;
  for (int k = 0; k < count; ++k) list.push_back(from + (to - from) * k / (count - 1));
  return list;
}

MatrixXd random_matrix(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MatrixXd G(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) G(i, j) = normal(random);
  }
  return G;
}

TEST(Track, CrossingModesKeepTheirNamesWithoutMorePoints) {
  // X diag(d(p)) X^-1 with fixed X: every crossing is a true one.
  const MatrixXd X = random_matrix(4, 1) + 3.0 * MatrixXd::Identity(4, 4);
  const Family A = [&](double p) -> MatrixXd {
    return X * Eigen::Vector4d(-1.0 - p, -2.0 + p, -3.0 + 2.0 * p, -2.5).asDiagonal() * X.inverse();
  };
  const std::vector<double> points = range(0.03, 3.07, 6);
  const Tracks tracks = follow(A, points);
  ASSERT_EQ(tracks.points.size(), points.size());
  for (const Tracks::Point& point : tracks.points) {
    const double p = point.at;
    const std::vector<double> expected = {-1.0 - p, -2.0 + p, -2.5, -3.0 + 2.0 * p};  // as numbered at the first point
    for (std::size_t k = 0; k < 4; ++k) EXPECT_TRUE(close(point.value[k].real(), expected[k], 1e-12, 1.0)) << "p " << p;
  }
  EXPECT_TRUE(tracks.doubts.empty());
}

TEST(Track, VeeringModesAreNotMixedUp) {
  // -3 +- sqrt(p^2 + g^2): they exchange their shapes within g of p = 0, between two points.
  for (const double gap : {1e-1, 1e-3, 1e-4}) {
    const Family A = [&](double p) -> MatrixXd { return (MatrixXd(2, 2) << -3.0 + p, gap, gap, -3.0 - p).finished(); };
    const Tracks tracks = follow(A, {-1.0, -0.3, 0.4, 1.0});
    for (const Tracks::Point& point : tracks.points) {
      const double half = std::hypot(point.at, gap);
      EXPECT_TRUE(close(point.value[0].real(), -3.0 + half, 1e-13)) << "gap " << gap << ", p " << point.at;
      EXPECT_TRUE(close(point.value[1].real(), -3.0 - half, 1e-13)) << "gap " << gap << ", p " << point.at;
    }
    EXPECT_TRUE(tracks.doubts.empty());
  }
}

TEST(Track, SymmetricMatricesKeepTheirOrder) {
  // Eigenvalues of a generic symmetric family never cross (von Neumann and Wigner 1929).
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const MatrixXd G = random_matrix(10, seed), H = random_matrix(10, seed + 100);
    const Family A = [&](double p) -> MatrixXd { return G + G.transpose() + p * (H + H.transpose()); };
    const Tracks tracks = follow(A, range(-2.0, 2.0, 5));
    for (const Tracks::Point& point : tracks.points) {
      for (std::size_t k = 1; k < point.value.size(); ++k)
        EXPECT_GT(point.value[k - 1].real(), point.value[k].real()) << "seed " << seed << ", p " << point.at;
    }
  }
}

TEST(Track, CoincidentModesCarryTheirShapes) {
  // Between -0.3 and 0.3 the matrix is -2 I with arbitrary vectors, others at each point; two modes coincide always.
  const auto beyond = [](double p) { return std::copysign(std::max(std::abs(p) - 0.3, 0.0), p); };
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const MatrixXd G = random_matrix(4, seed);
    const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(G).householderQ();
    const Family A = [&](double p) -> MatrixXd {
      MatrixXd X = Q;
      X.col(0) = std::cos(0.3 * p) * Q.col(0) + std::sin(0.3 * p) * Q.col(2);
      X.col(2) = std::cos(0.3 * p) * Q.col(2) - std::sin(0.3 * p) * Q.col(0);
      const double s = beyond(p);
      return X * Eigen::Vector4d(-2.0 + s, -2.0 - s, -2.0 + 3.0 * s, -2.0 + 3.0 * s).asDiagonal() * X.transpose();
    };
    const Tracks tracks = follow(A, {-1.0, -0.6, -0.25, -0.1, 0.0, 0.15, 0.2, 0.6, 1.0});
    for (const Tracks::Point& point : asked(tracks)) {
      const std::vector<double> slopes = {-1.0, 1.0, 3.0, 3.0};
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_TRUE(close(point.value[k].real(), -2.0 + slopes[k] * beyond(point.at), 1e-11))
            << "seed " << seed << ", p " << point.at << ", mode " << k;
      }
    }
  }
}

TEST(Track, PairsBecomeRealAtBranchPoints) {
  // -1 +- sqrt(p)
  const Family A = [](double p) -> MatrixXd { return (MatrixXd(2, 2) << -1.0, 1.0, p, -1.0).finished(); };
  for (const bool forward : {true, false}) {
    const Tracks tracks = forward ? follow(A, range(-0.7, 0.8, 6)) : follow(A, range(0.8, -0.7, 6));
    ASSERT_EQ(tracks.branches.size(), 1U);
    EXPECT_EQ(tracks.branches[0].splits, forward);
    EXPECT_LT(tracks.points[tracks.branches[0].before].at * tracks.points[tracks.branches[0].after].at, 0.0);
    for (const Tracks::Point& point : tracks.points) {
      const Complex root = std::sqrt(Complex(point.at));
      EXPECT_LT(std::abs(point.value[0] - (-1.0 + root)), 1e-12) << "p " << point.at;
      EXPECT_LT(std::abs(point.value[1] - (-1.0 - root)), 1e-12) << "p " << point.at;
    }
  }
}

TEST(Track, ZerosTakeNoPart) {
  // One structural zero; at p = 0, which is asked for, the first mode is a zero as well.
  const MatrixXd X = random_matrix(3, 3) + 3.0 * MatrixXd::Identity(3, 3);
  const Family A = [&](double p) -> MatrixXd {
    return X * Eigen::Vector3d(p, -1.0 - p, 0.0).asDiagonal() * X.inverse();
  };
  const Tracks tracks = follow(A, {-0.4, -0.2, 0.0, 0.2, 0.4});
  ASSERT_EQ(tracks.points.size(), 5U);
  for (const Tracks::Point& point : tracks.points) {
    ASSERT_EQ(point.value.size(), 2U);
    EXPECT_EQ(point.zeros, point.at == 0.0 ? 2 : 1);
    EXPECT_EQ(point.mode[0] < 0, point.at == 0.0);
    EXPECT_TRUE(close(point.value[0].real(), point.at, 1e-13, 1.0));
    EXPECT_TRUE(close(point.value[1].real(), -1.0 - point.at, 1e-13, 1.0));
  }
}

TEST(Track, FailedPointsAreStepped) {
  const Family A = [](double p) -> MatrixXd {
    return (MatrixXd(2, 2) << -1.0 - p, 0.1, 0.0, -4.0 + 3.0 * p).finished();
  };
  const std::vector<double> points = range(0.0, 2.0, 70);  // more than one window
  const Tracks tracks = ModeFollower().follow(points, [&](const std::vector<double>& list) {
    std::vector<std::optional<ModeSet>> sets;
    for (const double p : list)
      sets.push_back(p > 0.8 && p < 1.1 ? std::nullopt : std::optional<ModeSet>(modes_of(A(p))));
    return sets;
  });
  for (const Tracks::Point& point : asked(tracks)) {
    EXPECT_EQ(point.failed, point.at > 0.8 && point.at < 1.1);
    if (point.failed) continue;
    EXPECT_TRUE(close(point.value[0].real(), -1.0 - point.at, 1e-13));
    EXPECT_TRUE(close(point.value[1].real(), -4.0 + 3.0 * point.at, 1e-13, 1.0));
  }
}

TEST(Root, IsBracketedForAnyShape) {
  struct Case {
    std::function<double(double)> f;
    double a, b, root;
  };
  const std::vector<Case> cases = {
      {[](double x) { return std::cos(x) - x; }, 0.0, 1.0, 0.73908513321516064166},
      {[](double x) { return std::exp(x) - 2.0; }, -10.0, 10.0, std::numbers::ln2},
      {[](double x) { return std::pow(x - 1.0, 9); }, 0.0, 3.0, 1.0},
      {[](double x) { return x < 0.3 ? -1.0 : 1e6; }, -1.0, 1.0, 0.3},
      {[](double x) { return std::copysign(std::sqrt(std::abs(x - 2.0)), x - 2.0); }, 5.0, 1.0, 2.0}};
  for (const Case& one : cases) {
    int calls = 0;
    const auto f = [&](double x) {
      ++calls;
      return one.f(x);
    };
    const double tolerance = 1e-15;
    const double found = bracketed_root(f, one.a, one.f(one.a), one.b, one.f(one.b), tolerance);
    EXPECT_TRUE(close(found, one.root, 1e-15, 2.0));
    EXPECT_LE(calls, 60);  // bisection takes about 52
  }
}

}  // namespace
}  // namespace bramah::testing
