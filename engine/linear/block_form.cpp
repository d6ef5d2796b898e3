#include "linear/block_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "linear/lapack.hpp"
#include "linear/staircase.hpp"
#include "linear/strong_components.hpp"

namespace bramah {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;
using Indices = std::vector<Index>;

constexpr double eps = std::numeric_limits<double>::epsilon();
// Of the sum of the sizes of its terms: where they cancel to so little, a coupling of zeros is none.
constexpr double cancelled = 1e-9;
// Of the norm of all that is coupled, for each of its states: what rounding of the data leaves of a zero.
constexpr double rounded_data = 1e-15;

/// The place of the first row of the diagonal block of a quasi triangular matrix that row i belongs to.
Index first_of_block(const MatrixXd& R, Index i) { return i > 0 && R(i, i - 1) != 0.0 ? i - 1 : i; }

/// x with R x = b, R quasi triangular. LAPACK's dtrsyl would lift diagonal entries below eps of the largest: slow parts
/// beside fast ones have them.
VectorXd solve(const MatrixXd& R, VectorXd b) {
  for (Index last = R.rows() - 1; last >= 0;) {
    const Index first = first_of_block(R, last), size = last - first + 1;
    if (size == 1) {
      b(first) /= R(first, first);
    } else {
      b.segment<2>(first) = R.block<2, 2>(first, first).fullPivLu().solve(b.segment<2>(first)).eval();
    }
    b.head(first).noalias() -= R.block(0, first, first, size) * b.segment(first, size);
    last = first - 1;
  }
  return b;
}

/// x with R^T x = b.
VectorXd solve_transposed(const MatrixXd& R, VectorXd b) {
  const Index n = R.rows();
  for (Index first = 0; first < n;) {
    const Index size = first + 1 < n && R(first + 1, first) != 0.0 ? 2 : 1;
    if (size == 1) {
      b(first) /= R(first, first);
    } else {
      b.segment<2>(first) = R.block<2, 2>(first, first).transpose().fullPivLu().solve(b.segment<2>(first)).eval();
    }
    const Index after = first + size;
    b.tail(n - after).noalias() -= R.block(first, after, size, n - after).transpose() * b.segment(first, size);
    first = after;
  }
  return b;
}

/// A part taken for itself: A S = S T, T = [N *; 0 R] as in BlockForm.
struct Reduced {
  MatrixXd S, inverse, T;
  VectorXd balance;
  Indices steps;
  std::vector<Complex> nonzero;
  double norm = 0.0, accepted = 1.0, refused = 0.0;
  [[nodiscard]] Index zeros() const { return T.rows() - static_cast<Index>(nonzero.size()); }
};

Reduced reduce_number(double a, double rounding) {
  Reduced result;
  result.S = result.inverse = MatrixXd::Ones(1, 1);
  result.T = MatrixXd::Constant(1, 1, a);
  result.balance = VectorXd::Ones(1);
  result.norm = std::abs(a);
  if (std::abs(a) <= rounding_margin * rounding) {
    result.T(0, 0) = 0.0;
    result.steps = {1};
  } else {
    result.nonzero = {a};
  }
  return result;
}

Reduced reduce(const MatrixXd& A, const VectorXd& rounding) {
  if (A.rows() == 1) return reduce_number(A(0, 0), rounding(0));
  Reduced result;
  MatrixXd balanced = A;
  result.balance = lapack::balance(balanced);
  result.norm = balanced.norm();
  // Rounding is a part of its row.
  const VectorXd parts = rounding.cwiseQuotient(A.rowwise().norm()).cwiseProduct(balanced.rowwise().norm());
  const Staircase stairs = find_staircase(balanced, parts);
  result.steps = stairs.steps;
  result.accepted = stairs.accepted;
  result.refused = stairs.refused;
  const Index z = stairs.zeros(), rest = A.rows() - z;
  MatrixXd R = stairs.triangular.bottomRightCorner(rest, rest), Z;
  const VectorXd again = lapack::balance(R);
  lapack::schur(R, Z, result.nonzero);
  if (z == 0) {  // nothing was turned, and balancing twice is balancing once
    const VectorXd D = result.balance.cwiseProduct(again);
    result.S = D.asDiagonal() * Z;
    result.inverse = Z.transpose() * D.cwiseInverse().asDiagonal();
    result.T = std::move(R);
    return result;
  }
  result.S = result.balance.asDiagonal() * stairs.Q;
  result.inverse = stairs.Q.transpose() * result.balance.cwiseInverse().asDiagonal();
  const MatrixXd turn = again.asDiagonal() * Z;
  result.S.rightCols(rest) = (result.S.rightCols(rest) * turn).eval();
  result.inverse.bottomRows(rest) =
      (Z.transpose() * again.cwiseInverse().asDiagonal() * result.inverse.bottomRows(rest)).eval();
  result.T = MatrixXd::Zero(A.rows(), A.rows());
  result.T.topLeftCorner(z, z) = stairs.triangular.topLeftCorner(z, z);
  result.T.topRightCorner(z, rest) = stairs.triangular.topRightCorner(z, rest) * turn;
  result.T.bottomRightCorner(rest, rest) = R;
  return result;
}

/// left^T A right for parts that stand in their order, each with its zeros first.
void put_together(const MatrixXd& A, const std::vector<Reduced>& reduced, BlockForm& form) {
  Indices order;
  for (const BlockForm::Part& part : form.parts) order.insert(order.end(), part.states.begin(), part.states.end());
  const Index n = A.rows();
  form.right = form.left = MatrixXd::Zero(n, n);
  form.triangular = A(order, order);
  Index first = 0;
  for (std::size_t b = 0; b < reduced.size(); ++b) {
    const Reduced& part = reduced[b];
    const Indices& states = form.parts[b].states;
    const Index size = part.S.rows(), after = n - first - size;
    const auto places = Eigen::seqN(first, size);
    form.right(states, places) = part.S;
    form.left(states, places) = part.inverse.transpose();
    MatrixXd& T = form.triangular;
    if (size > 1) {
      T.block(first, first + size, size, after) = (part.inverse * T.block(first, first + size, size, after)).eval();
      T.block(0, first, first, size) = (T.block(0, first, first, size) * part.S).eval();
    }
    T.block(first, first, size, size) = part.T;
    first += size;
  }
}

/// Puts the zeros of all parts first, in their order.
void zeros_first(const std::vector<Reduced>& reduced, BlockForm& form) {
  Indices zeros, rest;
  Index first = 0;
  for (const Reduced& part : reduced) {
    for (Index i = 0; i < part.T.rows(); ++i) (i < part.zeros() ? zeros : rest).push_back(first + i);
    first += part.T.rows();
  }
  Indices order = zeros;
  order.insert(order.end(), rest.begin(), rest.end());
  form.triangular = form.triangular(order, order).eval();
  form.right = form.right(Eigen::all, order).eval();
  form.left = form.left(Eigen::all, order).eval();
}

/// Takes out what zeros move in parts that they drive: [T_zz T_zr; T_rz T_rr] becomes [N C; 0 R]. The diagonal blocks of
/// T_rr stay as they are.
void uncouple(Index z, BlockForm& form) {
  const Index n = form.triangular.rows(), rest = n - z;
  MatrixXd& T = form.triangular;
  for (Index j = 0; j < z; ++j) {
    if (T.col(j).tail(rest).isZero(0.0)) continue;
    const VectorXd y = solve(T.bottomRightCorner(rest, rest), -T.col(j).tail(rest));
    T.col(j).head(z) += T.topRightCorner(z, rest) * y;
    T.col(j).tail(rest).setZero();
    const Eigen::RowVectorXd row = T.row(j);
    T.bottomRows(rest) -= y * row;
    form.right.col(j) += form.right.rightCols(rest) * y;
    form.left.rightCols(rest) -= form.left.col(j) * y.transpose();
  }
}

/// How large entries of `vectors` of A may be by what rounding does to them: in a part as the largest of it.
MatrixXd blurred(const BlockForm& form, const Eigen::Ref<const MatrixXd>& vectors, const VectorXd& balance) {
  MatrixXd sizes = vectors.cwiseAbs();
  for (const BlockForm::Part& part : form.parts) {
    if (part.states.size() == 1) continue;
    const VectorXd D = balance(part.states);
    const Eigen::RowVectorXd largest =
        (D.cwiseInverse().asDiagonal() * sizes(part.states, Eigen::all)).colwise().maxCoeff();
    sizes(part.states, Eigen::all) = D * largest;
  }
  return sizes;
}

/// Jordan structure of zeros of several parts: ranks of N, whose entries are zero where rounding explains them.
void chain_zeros(const MatrixXd& A, const VectorXd& rounding, Index z, BlockForm& form) {
  MatrixXd uncertain = eps * A.cwiseAbs();
  for (Index i = 0; i < A.rows(); ++i) {
    for (Index j = 0; j < A.cols(); ++j) {
      if (A(i, j) != 0.0) uncertain(i, j) += rounding(i);
    }
  }
  const MatrixXd noise = blurred(form, form.left.leftCols(z), form.balance.cwiseInverse()).transpose() * uncertain *
                         blurred(form, form.right.leftCols(z), form.balance);
  MatrixXd N = form.triangular.topLeftCorner(z, z);
  const MatrixXd terms =
      form.left.leftCols(z).cwiseAbs().transpose() * A.cwiseAbs() * form.right.leftCols(z).cwiseAbs();
  N = (N.cwiseAbs().array() > (rounding_margin * noise.array()).max(cancelled * terms.array())).select(N, 0.0);
  const Staircase stairs = find_staircase_of_nilpotent(N);
  form.steps = stairs.steps;
  form.accepted = std::min(form.accepted, stairs.accepted);
  form.refused = std::max(form.refused, stairs.refused);
  form.triangular.topLeftCorner(z, z) = stairs.triangular;
  form.triangular.topRightCorner(z, A.rows() - z) =
      (stairs.Q.transpose() * form.triangular.topRightCorner(z, A.rows() - z)).eval();
  form.right.leftCols(z) = (form.right.leftCols(z) * stairs.Q).eval();
  form.left.leftCols(z) = (form.left.leftCols(z) * stairs.Q).eval();
}

/// `rounding`, but at least what the data of what a row is coupled to, in either direction, are rounded by: its state is
/// known to a double, and entries that are zero at the state that was meant are of the size of this rounding.
VectorXd with_data(const MatrixXd& A, VectorXd rounding) {
  const Index n = A.rows();
  Indices root(static_cast<std::size_t>(n));
  std::iota(root.begin(), root.end(), Index{0});
  const auto find = [&](Index i) {
    while (root[static_cast<std::size_t>(i)] != i) i = root[static_cast<std::size_t>(i)];
    return i;
  };
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      if (A(i, j) != 0.0) root[static_cast<std::size_t>(find(i))] = find(j);
    }
  }
  VectorXd squares = VectorXd::Zero(n), sizes = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    squares(find(i)) += A.row(i).squaredNorm();
    sizes(find(i)) += 1.0;
  }
  for (Index i = 0; i < n; ++i)
    rounding(i) = std::max(rounding(i), rounded_data / rounding_margin * sizes(find(i)) * std::sqrt(squares(find(i))));
  return rounding;
}

}  // namespace

BlockForm find_block_form(MatrixXd A, const VectorXd& rounding) {
  const Index n = A.rows();
  const VectorXd rows = with_data(A, rounding.size() == n ? rounding : VectorXd::Zero(n));
  for (Index i = 0; i < n; ++i) A.row(i) = (A.row(i).array().abs() > rounding_margin * rows(i)).select(A.row(i), 0.0);
  BlockForm form;
  form.balance = VectorXd::Ones(n);
  std::vector<Reduced> reduced;
  std::size_t with_zeros = 0;
  for (Indices& states : strong_components(A)) {
    reduced.push_back(reduce(A(states, states), rows(states)));
    const Reduced& part = reduced.back();
    form.balance(states) = part.balance;
    form.nonzero.insert(form.nonzero.end(), part.nonzero.begin(), part.nonzero.end());
    form.part_of.insert(form.part_of.end(), part.nonzero.size(), form.parts.size());
    form.accepted = std::min(form.accepted, part.accepted);
    form.refused = std::max(form.refused, part.refused);
    if (part.zeros() > 0 && ++with_zeros == 1) form.steps = part.steps;
    const auto count = static_cast<Index>(part.nonzero.size()),
               before = static_cast<Index>(form.nonzero.size()) - count;
    form.parts.push_back({std::move(states), before, count, part.norm, part.accepted});
  }
  put_together(A, reduced, form);
  if (with_zeros == 0) return form;
  zeros_first(reduced, form);
  const Index z = n - static_cast<Index>(form.nonzero.size());
  uncouple(z, form);
  if (with_zeros > 1) chain_zeros(A, rows, z, form);
  return form;
}

MatrixXd BlockForm::left_null_space() const {
  const Index z = zeros(), rest = triangular.rows() - z, count = steps.empty() ? 0 : steps.front();
  if (count == 0) return {triangular.rows(), 0};
  // u^T N = 0, then (u, k) with k^T R = -u^T C.
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(triangular.topLeftCorner(z, z));
  const MatrixXd u = (qr.householderQ() * MatrixXd::Identity(z, z)).rightCols(count);
  MatrixXd vectors = left.leftCols(z) * u;
  const MatrixXd R = triangular.bottomRightCorner(rest, rest);
  for (Index j = 0; j < count; ++j)
    vectors.col(j) +=
        left.rightCols(rest) * solve_transposed(R, -(triangular.topRightCorner(z, rest).transpose() * u.col(j)));
  return vectors;
}

}  // namespace bramah
