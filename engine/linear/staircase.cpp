#include "linear/staircase.hpp"

#include <algorithm>
#include <cmath>

namespace bramah {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the norm of a matrix, for each of its rows: what an orthogonal transformation leaves of an exact zero.
constexpr double turning = 1e-15;

/// An orthonormal basis [null space, complement] of M's columns; `rank` by pivoted QR of the row-equilibrated matrix,
/// which has the same null space and comparable rows: a fast row cannot hide a slow one.
/// At least `least` columns are taken for the null space.
MatrixXd split(MatrixXd M, double tolerance, Index least, Index& nullity, double& accepted, double& refused) {
  const Index n = M.rows();
  for (Index i = 0; i < n; ++i) {
    const double norm = M.row(i).norm();
    if (norm > 0.0) M.row(i) /= norm;
  }
  // M^T P = Q R: the last columns of Q span the null space of M.
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(M.transpose());
  Index rank = 0;
  for (Index i = 0; i < n; ++i) {
    const double pivot = std::abs(qr.matrixQR()(i, i));
    if (pivot <= tolerance || i >= n - least) {
      refused = std::max(refused, pivot);
    } else {
      accepted = std::min(accepted, pivot);
      rank = i + 1;
    }
  }
  nullity = n - rank;
  const MatrixXd Q = qr.householderQ();
  MatrixXd ordered(n, n);
  ordered << Q.rightCols(nullity), Q.leftCols(rank);
  return ordered;
}

Staircase climb(const MatrixXd& A, const VectorXd& rounding, double tolerance, Index least) {
  Staircase result;
  const Index n = A.rows();
  result.Q = MatrixXd::Identity(n, n);
  result.triangular = A;
  const double norm = A.norm();
  for (Index done = 0; done < n;) {
    const Index size = n - done;
    Index nullity = 0;
    const MatrixXd rest = result.triangular.bottomRightCorner(size, size);
    VectorXd limit = VectorXd::Zero(size);
    if (rounding.size() == n)
      limit = (result.Q.rightCols(size).cwiseAbs2().transpose() * rounding.cwiseAbs2()).cwiseSqrt();
    // A itself has not been turned yet.
    if (done > 0) limit = limit.cwiseMax(turning / rounding_margin * static_cast<double>(size) * norm);
    const MatrixXd cleaned = without_rounding(rest, limit);
    const MatrixXd Z = split(cleaned, tolerance, least, nullity, result.accepted, result.refused);
    if (nullity == 0) break;
    result.Q.rightCols(size) = (result.Q.rightCols(size) * Z).eval();
    result.triangular.rightCols(size) = (result.triangular.rightCols(size) * Z).eval();
    result.triangular.bottomRows(size) = (Z.transpose() * result.triangular.bottomRows(size)).eval();
    result.triangular.block(done, done, size, nullity).setZero();
    result.steps.push_back(nullity);
    done += nullity;
  }
  return result;
}

}  // namespace

Index Staircase::zeros() const {
  Index sum = 0;
  for (const Index step : steps) sum += step;
  return sum;
}

std::vector<int> Staircase::block_sizes() const {
  if (steps.empty()) return {};
  std::vector<int> sizes(static_cast<std::size_t>(steps.front()), 0);
  for (const Index step : steps) {
    for (Index k = 0; k < step; ++k) ++sizes[static_cast<std::size_t>(k)];
  }
  return sizes;
}

MatrixXd without_rounding(MatrixXd A, const VectorXd& rounding) {
  for (Index i = 0; i < A.rows(); ++i) {
    if (A.row(i).norm() <= rounding_margin * rounding(i)) A.row(i).setZero();
  }
  return A;
}

Staircase find_staircase(const MatrixXd& A, const VectorXd& rounding, double tolerance) {
  return climb(A, rounding, tolerance, 0);
}

Staircase find_staircase_of_nilpotent(const MatrixXd& N, double tolerance) { return climb(N, {}, tolerance, 1); }

}  // namespace bramah
