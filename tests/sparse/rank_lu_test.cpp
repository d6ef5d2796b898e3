// Our rank-revealing LU against SPQR (rank) and against dense algebra (solutions, dependencies).
#include "sparse/rank_lu.hpp"

#include <gtest/gtest.h>
#include <SuiteSparseQR.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

struct Csc {
  std::int64_t rows = 0, columns = 0;
  std::vector<std::int64_t> start, row;
  std::vector<double> value;
  [[nodiscard]] sparse::CscView view() const { return {rows, columns, start.data(), row.data(), value.data()}; }
};

Csc compressed(const Eigen::MatrixXd& A) {
  Csc m;
  m.rows = A.rows();
  m.columns = A.cols();
  m.start.push_back(0);
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      if (A(i, j) == 0.0) continue;
      m.row.push_back(i);
      m.value.push_back(A(i, j));
    }
    m.start.push_back(static_cast<std::int64_t>(m.row.size()));
  }
  return m;
}

/// Sparse random matrix of a given rank: `rank` random columns, the others small integer combinations of two of them.
Eigen::MatrixXd of_rank(Eigen::Index rows, Eigen::Index columns, Eigen::Index rank, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::uniform_int_distribution<Eigen::Index> any_row(0, rows - 1), any_column(0, rank - 1);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    if (j < rank) {
      A(j, j) = 1.0 + number(random);
      for (int k = 0; k < 3; ++k) A(any_row(random), j) += number(random);
    } else {
      A.col(j) = 2.0 * A.col(any_column(random)) - 3.0 * A.col(any_column(random));
    }
  }
  // Shuffled, so that no order helps.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(columns));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), random);
  Eigen::MatrixXd shuffled(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) shuffled.col(j) = A.col(order[static_cast<std::size_t>(j)]);
  return shuffled;
}

std::int64_t rank_by_spqr(const Csc& m) {
  cholmod_common common;
  cholmod_l_start(&common);
  cholmod_sparse* A = cholmod_l_allocate_sparse(static_cast<std::size_t>(m.rows), static_cast<std::size_t>(m.columns),
                                                m.value.size(), 1, 1, 0, CHOLMOD_REAL, &common);
  std::copy(m.start.begin(), m.start.end(), static_cast<SuiteSparse_long*>(A->p));
  std::copy(m.row.begin(), m.row.end(), static_cast<SuiteSparse_long*>(A->i));
  std::copy(m.value.begin(), m.value.end(), static_cast<double*>(A->x));
  SuiteSparseQR_factorization<double>* QR =
      SuiteSparseQR_factorize<double>(SPQR_ORDERING_DEFAULT, SPQR_DEFAULT_TOL, A, &common);
  const std::int64_t rank = QR->rank;
  SuiteSparseQR_free(&QR, &common);
  cholmod_l_free_sparse(&A, &common);
  cholmod_l_finish(&common);
  return rank;
}

class RankLuOn : public ::testing::TestWithParam<unsigned> {};

TEST_P(RankLuOn, RankIsThatOfSpqr) {
  const Eigen::MatrixXd A = of_rank(60, 50, 37, GetParam());
  const Csc m = compressed(A);
  sparse::RankLu lu;
  lu.factor(m.view());
  EXPECT_EQ(lu.rank(), rank_by_spqr(m));
  EXPECT_EQ(lu.rank() + static_cast<std::int64_t>(lu.dependent_columns().size()), 50);
  EXPECT_LE(lu.growth(), 2.0 + 1e-12);  // threshold 0.5 bounds |L|
  EXPECT_GT(lu.smallest_accepted(), 1e-6);
  EXPECT_LT(lu.largest_refused(), 1e-12);
}

TEST_P(RankLuOn, DependenciesReproduceTheColumns) {
  const Eigen::MatrixXd A = of_rank(40, 45, 30, GetParam());
  const Csc m = compressed(A);
  sparse::RankLu lu;
  lu.factor(m.view());
  ASSERT_EQ(lu.rank(), Eigen::FullPivLU<Eigen::MatrixXd>(A).rank());
  const std::vector<sparse::Dependency> dependencies = lu.dependencies();
  ASSERT_EQ(dependencies.size(), 15U);
  for (std::size_t k = 0; k < dependencies.size(); ++k) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(40);
    for (const auto& [column, coefficient] : dependencies[k]) sum += coefficient * A.col(column);
    EXPECT_LT((sum - A.col(lu.dependent_columns()[k])).norm(), 1e-11 * A.norm());
  }
}

TEST_P(RankLuOn, SolvesConsistentSystems) {
  const Eigen::MatrixXd A = of_rank(50, 40, 33, GetParam());
  const Csc m = compressed(A);
  sparse::RankLu lu;
  lu.factor(m.view());
  const Eigen::VectorXd b = A * Eigen::VectorXd::LinSpaced(40, -1.0, 2.0);
  std::vector<double> x(40), y(50);
  lu.solve({b.data(), 50}, x);
  EXPECT_LT((A * Eigen::Map<Eigen::VectorXd>(x.data(), 40) - b).norm(), 1e-10 * b.norm());
  for (const std::int64_t column : lu.dependent_columns()) EXPECT_EQ(x[static_cast<std::size_t>(column)], 0.0);
  const Eigen::VectorXd c = A.transpose() * Eigen::VectorXd::LinSpaced(50, 0.5, -1.0);
  lu.solve_transposed({c.data(), 40}, y);
  EXPECT_LT((A.transpose() * Eigen::Map<Eigen::VectorXd>(y.data(), 50) - c).norm(), 1e-10 * c.norm());
}

TEST_P(RankLuOn, OrderAndClassesAreKept) {
  const Eigen::MatrixXd A = of_rank(30, 20, 20, GetParam());
  const Csc m = compressed(A);
  std::vector<std::int64_t> order(20);
  std::iota(order.rbegin(), order.rend(), std::int64_t{0});
  std::vector<int> row_class(30, 0);
  for (const std::size_t row : {0U, 3U, 7U}) row_class[row] = 1;
  sparse::RankLu lu;
  lu.factor(m.view(), {.order = order, .row_class = row_class});
  EXPECT_EQ(lu.rank(), 20);
  EXPECT_EQ(lu.pivot_columns(), order);
  // The rows set apart are pivots only as often as the others cannot do: the rank of the rows without them.
  Eigen::MatrixXd others(27, 20);
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < 30; ++i) {
    if (row_class[static_cast<std::size_t>(i)] == 0) others.row(next++) = A.row(i);
  }
  const Eigen::Index rank_of_others = Eigen::FullPivLU<Eigen::MatrixXd>(others).rank();
  std::int64_t of_class_1 = 0;
  for (const std::int64_t row : lu.pivot_rows()) of_class_1 += row_class[static_cast<std::size_t>(row)];
  EXPECT_EQ(of_class_1, 20 - rank_of_others);
}

INSTANTIATE_TEST_SUITE_P(RandomMatrices, RankLuOn, ::testing::Range(1U, 9U));

/// Rows of an open chain of `links` with 2 unknowns and 1 angle each: column pairs (i, i + 1) and angles.
Eigen::MatrixXd chain(Eigen::Index links) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * links, 2 * links);
  for (Eigen::Index i = 0; i < links; ++i) {
    for (Eigen::Index k = 0; k < 2; ++k) {
      const double slope = std::sin(static_cast<double>(3 * i + k));
      A(3 * i + k, 2 * i + k) = 1.0;
      A(3 * i + 2, 2 * i + k) = slope;
      if (i == 0) continue;
      A(3 * i - 3 + k, 2 * i + k) = -1.0;
      A(3 * i - 1, 2 * i + k) = slope;
    }
  }
  return A;
}

TEST(Singletons, TakeAnOpenChainWholeFromItsTip) {
  const Eigen::MatrixXd A = chain(40);
  const Csc m = compressed(A);
  const sparse::Singletons found = sparse::find_singletons(m.view(), A.cols());
  EXPECT_TRUE(found.others.empty());
  ASSERT_EQ(found.columns.size(), 80U);
  EXPECT_EQ(found.columns.front() / 2, 39);
  EXPECT_EQ(found.columns.back() / 2, 0);
  sparse::RankLu lu;
  lu.factor(m.view(), {.order = found.columns});
  EXPECT_EQ(lu.rank(), 80);
  // No column taken has an entry in the pivot rows of those before it: the factors are the columns themselves.
  for (std::int64_t k = 0; k < 80; ++k) {
    for (std::int64_t j = k + 1; j < 80; ++j)
      EXPECT_EQ(A(lu.pivot_rows()[static_cast<std::size_t>(k)], lu.pivot_columns()[static_cast<std::size_t>(j)]), 0.0);
  }
}

TEST(Singletons, StopAtLoopsSmallPivotsAndClasses) {
  Eigen::MatrixXd loop = Eigen::MatrixXd::Zero(3, 3);
  loop << 1, 0, 1, 1, 1, 0, 0, 1, 1;
  EXPECT_TRUE(sparse::find_singletons(compressed(loop).view(), 3).columns.empty());
  Eigen::MatrixXd pair(3, 2);
  pair << 0.4, 0, 1, 1, 0, 1;
  // Row 0 belongs to column 0 alone, but is less than half of its largest entry; row 2 belongs to column 1 and will do.
  EXPECT_EQ(sparse::find_singletons(compressed(pair).view(), 2).columns, (std::vector<std::int64_t>{1, 0}));
  EXPECT_EQ(sparse::find_singletons(compressed(pair).view(), 1).columns, std::vector<std::int64_t>{});
  const std::vector<int> row_class = {0, 0, 1};
  EXPECT_TRUE(sparse::find_singletons(compressed(pair).view(), 2, {.row_class = row_class}).columns.empty());
}

TEST(RankLu, GivesUpBeyondTheEntriesAllowed) {
  const Eigen::MatrixXd A = of_rank(60, 50, 50, 1);
  const Csc m = compressed(A);
  sparse::RankLu lu;
  EXPECT_TRUE(lu.factor(m.view(), {.most_entries = 3000}));
  EXPECT_FALSE(lu.factor(m.view(), {.most_entries = 20}));
  EXPECT_TRUE(lu.factor(m.view()));
  EXPECT_EQ(lu.rank(), 50);
}

TEST(RankLu, EmptyAndZeroColumns) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 4);
  A(1, 2) = 5.0;
  const Csc m = compressed(A);
  sparse::RankLu lu;
  lu.factor(m.view());
  EXPECT_EQ(lu.rank(), 1);
  EXPECT_EQ(lu.pivot_rows(), std::vector<std::int64_t>{1});
  EXPECT_EQ(lu.dependent_columns().size(), 3U);
  const Csc none = compressed(Eigen::MatrixXd(0, 0));
  lu.factor(none.view());
  EXPECT_EQ(lu.rank(), 0);
}

}  // namespace
}  // namespace bramah::testing
