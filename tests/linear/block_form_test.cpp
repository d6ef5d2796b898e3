// Eigenvalues by the structure of a matrix: each part has its own, whatever else the matrix holds.
#include "linear/block_form.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "linear/strong_components.hpp"
#include "support/property.hpp"

namespace bramah::testing {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Random = std::mt19937_64;

Index index(Random& random, Index first, Index last) {
  return std::uniform_int_distribution<Index>(first, last)(random);
}
double number(Random& random, double first, double last) {
  return std::uniform_real_distribution<double>(first, last)(random);
}

std::vector<Index> permutation(Random& random, Index n) {
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

MatrixXd sparse(Random& random, Index n, double density) {
  MatrixXd A = MatrixXd::Zero(n, n);
  for (double& entry : A.reshaped()) {
    if (number(random, 0.0, 1.0) < density) entry = number(random, -1.0, 1.0);
  }
  return A;
}

/// What leads to what, by Warshall's closure.
Eigen::MatrixX<bool> reaches(const MatrixXd& A) {
  const Index n = A.rows();
  Eigen::MatrixX<bool> R = (A.array() != 0.0).matrix();
  R.diagonal().setConstant(true);
  for (Index k = 0; k < n; ++k) {
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) R(i, j) = R(i, j) || (R(i, k) && R(k, j));
    }
  }
  return R;
}

TEST(StrongComponents, AreThoseOfTheClosureInTheirOrder) {
  for (int k = 0; k < support::property_runs(300); ++k) {
    Random random(support::property_seed(k));
    SCOPED_TRACE("case " + std::to_string(k));
    const Index n = index(random, 1, 25);
    const MatrixXd A = sparse(random, n, number(random, 0.0, 0.2));
    const Eigen::MatrixX<bool> R = reaches(A);
    std::vector<Index> place(static_cast<std::size_t>(n), -1);
    Index at = 0;
    for (const std::vector<Index>& component : strong_components(A)) {
      EXPECT_TRUE(std::is_sorted(component.begin(), component.end()));
      for (const Index i : component) place[static_cast<std::size_t>(i)] = at;
      ++at;
    }
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const Index of_i = place[static_cast<std::size_t>(i)], of_j = place[static_cast<std::size_t>(j)];
        ASSERT_EQ(of_i == of_j, R(i, j) && R(j, i)) << i << " and " << j;
        ASSERT_TRUE(A(i, j) == 0.0 || of_i <= of_j) << i << " and " << j;
      }
    }
  }
}

/// A block triangular matrix in a random order of its states, with the eigenvalues of its diagonal blocks.
struct Known {
  MatrixXd A;
  std::vector<Complex> eigenvalues;
  Index zeros = 0;
};

Known random_known(Random& random) {
  Known known;
  std::vector<Index> first;
  std::vector<MatrixXd> blocks;
  Index n = 0;
  const Index count = index(random, 1, 8);
  for (Index b = 0; b < count; ++b) {
    const double size = std::pow(10.0, number(random, -4.5, 4.5));
    first.push_back(n);
    switch (index(random, 0, 2)) {
      case 0:
        blocks.emplace_back(MatrixXd::Zero(1, 1));
        ++known.zeros;
        break;
      case 1:
        blocks.emplace_back(MatrixXd::Constant(1, 1, -size));
        known.eigenvalues.emplace_back(-size);
        break;
      default: {  // size (-zeta +- i), the entries of its coupling as different as those of position and rate
        const double zeta = number(random, 0.1, 1.0), ratio = std::exp2(index(random, -3, 3));
        blocks.emplace_back(size * (MatrixXd(2, 2) << -zeta, ratio, -1.0 / ratio, -zeta).finished());
        known.eigenvalues.emplace_back(-zeta * size, size);
        known.eigenvalues.emplace_back(-zeta * size, -size);
      }
    }
    n += blocks.back().rows();
  }
  MatrixXd A = MatrixXd::Zero(n, n);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Index at = first[b], size = blocks[b].rows(), after = at + size;
    A.block(at, at, size, size) = blocks[b];
    for (Index j = after; j < n; ++j) {
      for (Index i = at; i < after; ++i) {
        if (index(random, 0, 2) == 0) A(i, j) = number(random, -1.0, 1.0);
      }
    }
  }
  const std::vector<Index> order = permutation(random, n);
  known.A = A(order, order);
  return known;
}

/// Greatest relative error of `found`, each against the nearest of `expected`.
double worst(const std::vector<Complex>& found, const std::vector<Complex>& expected) {
  double error = 0.0;
  for (const Complex& value : found) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Complex& other : expected) nearest = std::min(nearest, std::abs(value - other) / std::abs(other));
    error = std::max(error, nearest);
  }
  return error;
}

TEST(BlockForm, EveryPartKeepsTheDigitsOfItsEigenvalues) {
  for (int k = 0; k < support::property_runs(500); ++k) {
    Random random(support::property_seed(k));
    SCOPED_TRACE("case " + std::to_string(k));
    const Known known = random_known(random);
    const BlockForm form = find_block_form(known.A);
    ASSERT_EQ(form.nonzero.size(), known.eigenvalues.size()) << known.A;
    EXPECT_EQ(form.zeros(), known.zeros);
    // A 2 x 2 part is balanced and turned: a few roundings of it.
    EXPECT_LE(worst(form.nonzero, known.eigenvalues), 1e-14) << known.A;
    EXPECT_LE(worst(known.eigenvalues, form.nonzero), 1e-14) << known.A;
  }
}

TEST(BlockForm, IsASimilarityTransformation) {
  int unclear = 0;
  const int cases = support::property_runs(300);
  for (int k = 0; k < cases; ++k) {
    Random random(support::property_seed(k));
    SCOPED_TRACE("case " + std::to_string(k));
    const Index n = index(random, 1, 12);
    const MatrixXd A = sparse(random, n, number(random, 0.05, 0.5));
    const BlockForm form = find_block_form(A);
    const Index z = form.zeros();
    // Of a long chain of zeros with weak links rounding decides the last ranks; the pivot that was refused says so.
    if (form.refused > 1e-10) {
      ++unclear;
      continue;
    }
    const double size = form.left.norm() * form.right.norm();
    EXPECT_LE((form.left.transpose() * form.right - MatrixXd::Identity(n, n)).norm(), 1e-13 * size) << A;
    EXPECT_LE((form.left.transpose() * A * form.right - form.triangular).norm(), 1e-13 * size * A.norm()) << A;
    EXPECT_TRUE(form.triangular.bottomLeftCorner(n - z, z).isZero(0.0));
    MatrixXd power = MatrixXd::Identity(z, z);
    for (std::size_t step = 0; step < form.steps.size(); ++step) power = power * form.triangular.topLeftCorner(z, z);
    EXPECT_LE(power.norm(), 1e-13 * size);
    EXPECT_EQ(std::accumulate(form.steps.begin(), form.steps.end(), Index{0}), z);
    const MatrixXd conserved = form.left_null_space();
    EXPECT_EQ(conserved.cols(), form.steps.empty() ? 0 : form.steps.front());
    EXPECT_LE((conserved.transpose() * A).norm(), 1e-12 * size * std::max(1.0, conserved.norm())) << A;
  }
  EXPECT_LE(unclear, cases / 100);
}

TEST(BlockForm, UnitsChangeNoBitOfATriangularMatrix) {
  for (int k = 0; k < support::property_runs(200); ++k) {
    Random random(support::property_seed(k));
    SCOPED_TRACE("case " + std::to_string(k));
    const Index n = index(random, 1, 12);
    MatrixXd A = sparse(random, n, 0.4).triangularView<Eigen::Upper>();
    const std::vector<Index> order = permutation(random, n);
    A = A(order, order).eval();
    VectorXd units(n);
    for (double& unit : units) unit = std::exp2(4 * static_cast<int>(index(random, -2, 2)));
    const MatrixXd scaled = units.cwiseInverse().asDiagonal() * A * units.asDiagonal();
    for (const MatrixXd& matrix : {A, scaled}) {
      std::vector<double> found, expected;
      for (const Complex& value : find_block_form(matrix).nonzero) found.push_back(value.real());
      for (const double value : A.diagonal()) {
        if (value != 0.0) expected.push_back(value);
      }
      std::sort(found.begin(), found.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(found, expected) << matrix;
    }
  }
}

// Chains of zeros that run through parts: the second oscillator's part has no zero, the integrators around it have.
TEST(BlockForm, ChainsOfZerosRunThroughOtherParts) {
  // x0' = x1, x1' = y0, (y0, y1)' = oscillator driven by x2, x2' = 0: one chain x2 -> y0 -> x1 -> x0 of three zeros.
  MatrixXd A = MatrixXd::Zero(5, 5);
  A(0, 1) = 1.0;
  A(1, 2) = 3.0;
  A(2, 3) = 2.0;
  A(3, 2) = -8.0;
  A(3, 4) = 5.0;
  const BlockForm form = find_block_form(A);
  EXPECT_EQ(form.zeros(), 3);
  EXPECT_EQ(form.steps, (std::vector<Index>{1, 1, 1}));
  ASSERT_EQ(form.nonzero.size(), 2U);
  EXPECT_DOUBLE_EQ(form.nonzero[0].imag(), 4.0);
  // What drives nothing is a zero of its own.
  A(3, 4) = 0.0;
  EXPECT_EQ(find_block_form(A).steps, (std::vector<Index>{2, 1}));
}

}  // namespace
}  // namespace bramah::testing
