#include "sparse/klu.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <cmath>

namespace bramah::testing {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

sparse::CscView view(const Sparse& A) {
  return {A.rows(), A.cols(), A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr()};
}

Sparse tridiagonal(int n, double diagonal) {
  Sparse A(n, n);
  for (int i = 0; i < n; ++i) {
    A.coeffRef(i, i) = diagonal;
    if (i > 0) A.coeffRef(i, i - 1) = -1.0;
    if (i + 1 < n) A.coeffRef(i, i + 1) = -2.0;
  }
  A.makeCompressed();
  return A;
}

TEST(Klu, SolvesManyRightHandSidesAndTheTranspose) {
  const Sparse A = tridiagonal(30, 5.0);
  sparse::Klu lu;
  lu.analyze(view(A));
  ASSERT_TRUE(lu.factor(view(A)));
  const Eigen::MatrixXd exact = Eigen::MatrixXd::Random(30, 7);
  Eigen::MatrixXd b = A * exact;
  lu.solve({b.data(), static_cast<std::size_t>(b.size())}, 7);
  EXPECT_LT((b - exact).norm(), 1e-13 * exact.norm());
  Eigen::MatrixXd c = A.transpose() * exact;
  lu.solve_transposed({c.data(), static_cast<std::size_t>(c.size())}, 7);
  EXPECT_LT((c - exact).norm(), 1e-13 * exact.norm());
}

TEST(Klu, SolvesBlocksOfRightHandSidesWithTheLatestFactors) {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, sparse::Klu::block, Eigen::RowMajor>;
  sparse::Klu lu;
  lu.analyze(view(tridiagonal(30, 5.0)));
  for (const double diagonal : {5.0, 4.0, 0.0}) {  // fresh pivots, old pivots, fresh ones off the diagonal
    Eigen::VectorXd scales(30);                    // which KLU takes from the rows
    for (int i = 0; i < 30; ++i) scales(i) = std::pow(10.0, i % 7);
    const Sparse A = scales.asDiagonal() * tridiagonal(30, diagonal);
    ASSERT_TRUE(lu.factor(view(A)));
    const Block exact = Block::Random(30, sparse::Klu::block);
    Block b = A * exact;
    lu.solve_block({b.data(), static_cast<std::size_t>(b.size())});
    // Without its diagonal the matrix has a condition of 2^15.
    EXPECT_LT((b - exact).norm(), 1e-11 * exact.norm()) << "diagonal " << diagonal;
  }
}

TEST(Klu, RefactorsAndRepivotsWhereOldPivotsFail) {
  Sparse A = tridiagonal(20, 5.0);
  sparse::Klu lu;
  lu.analyze(view(A));
  ASSERT_TRUE(lu.factor(view(A)));
  // A zero diagonal: the pivots of the first factorization are gone, the matrix is regular (even size).
  for (int i = 0; i < 20; ++i) A.coeffRef(i, i) = 0.0;
  ASSERT_TRUE(lu.factor(view(A)));
  const Eigen::VectorXd exact = Eigen::VectorXd::LinSpaced(20, 1.0, 3.0);
  Eigen::VectorXd b = A * exact;
  lu.solve({b.data(), 20});
  EXPECT_LT((b - exact).norm(), 1e-12 * exact.norm());
}

TEST(Klu, ForgetsWhatItFactoredBefore) {
  const Sparse other = tridiagonal(40, 0.0);  // its pivots lie beside the diagonal
  const Sparse A = tridiagonal(40, 0.5);
  const auto solved = [&](const auto& prepare) {
    sparse::Klu lu;
    lu.analyze(view(A));
    prepare(lu);
    EXPECT_TRUE(lu.factor(view(A)));
    Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(40, 1.0, 2.0);
    lu.solve({b.data(), 40});
    return b;
  };
  const Eigen::VectorXd alone = solved([](sparse::Klu&) {});
  EXPECT_NE(alone, solved([&](sparse::Klu& lu) { EXPECT_TRUE(lu.factor(view(other))); })) << "rounded otherwise";
  EXPECT_EQ(alone, solved([&](sparse::Klu& lu) {
              EXPECT_TRUE(lu.factor(view(other)));
              lu.forget_pivots();
            }));
}

TEST(Klu, TellsSingularMatrices) {
  Sparse A = tridiagonal(5, 0.0);  // odd size, zero diagonal: singular
  sparse::Klu lu;
  lu.analyze(view(A));
  EXPECT_FALSE(lu.factor(view(A)));
  EXPECT_GE(lu.singular_column(), 0);
  EXPECT_LT(lu.singular_column(), 5);
}

TEST(Klu, EstimatesTheCondition) {
  Sparse A(3, 3);
  A.coeffRef(0, 0) = 1.0;
  A.coeffRef(1, 1) = 1e-6;
  A.coeffRef(2, 2) = 2.0;
  A.makeCompressed();
  sparse::Klu lu;
  lu.analyze(view(A));
  ASSERT_TRUE(lu.factor(view(A)));
  EXPECT_NEAR(lu.condition(view(A)), 2e6, 1.0);
}

TEST(ComplexKlu, SolvesAndTellsThePhaseOfTheDeterminant) {
  using Complex = std::complex<double>;
  using ComplexSparse = Eigen::SparseMatrix<Complex, Eigen::ColMajor, std::int64_t>;
  for (const Complex shift : {Complex(0.3, 1.7), Complex(-2.0, 0.1), Complex(4.0, -3.0)}) {
    ComplexSparse A = tridiagonal(9, 1.0).cast<Complex>();
    for (int i = 0; i < 9; ++i) A.coeffRef(i, i) = shift + static_cast<double>(i % 3);
    A.makeCompressed();
    const sparse::ComplexKlu::View seen{A.rows(), A.cols(), A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr()};
    sparse::ComplexKlu lu;
    lu.analyze(seen);
    ASSERT_TRUE(lu.factor(seen));
    const Eigen::VectorXcd exact = Eigen::VectorXcd::Random(9);
    Eigen::VectorXcd b = A * exact, c = A.transpose() * exact;
    lu.solve({b.data(), 9});
    lu.solve_transposed({c.data(), 9});
    EXPECT_LT((b - exact).norm(), 1e-13 * exact.norm());
    EXPECT_LT((c - exact).norm(), 1e-13 * exact.norm());
    const Complex determinant = Eigen::MatrixXcd(A).determinant();
    EXPECT_LT(std::abs(lu.determinant_phase() - determinant / std::abs(determinant)), 1e-12);
  }
}

}  // namespace
}  // namespace bramah::testing
