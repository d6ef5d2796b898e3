#include "linear/defective.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace bramah {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;

// A group whose coupling is below this multiple of the distances in it has vectors of its own for each member.
constexpr double coupled = 1e3;

/// X with A X - X B = C, A and B upper triangular.
MatrixXcd solve_sylvester(const MatrixXcd& A, const MatrixXcd& B, const MatrixXcd& C) {
  MatrixXcd X(C.rows(), C.cols());
  for (Index j = 0; j < C.cols(); ++j) {
    MatrixXcd shifted = A;
    shifted.diagonal().array() -= B(j, j);
    X.col(j) = shifted.triangularView<Eigen::Upper>().solve(C.col(j) + X.leftCols(j) * B.col(j).head(j));
  }
  return X;
}

double norm_of_coupling(const MatrixXcd& T) { return MatrixXcd(T.triangularView<Eigen::StrictlyUpper>()).norm(); }

/// How far a perturbation moves the eigenvalues of an upper triangular matrix (Henrici 1962), in its own unit of time:
/// `coupling max(t, t^(1/m))`, t = m perturbation / coupling.
double henrici_bound(const MatrixXcd& T, double perturbation) {
  const auto size = static_cast<double>(T.rows());
  const double coupling = norm_of_coupling(T);
  if (coupling <= perturbation) return size * perturbation;
  const double part = size * perturbation / coupling;
  return coupling * std::max(part, std::pow(part, 1.0 / size));
}

double spread(const MatrixXcd& T, Complex mean) { return (T.diagonal().array() - mean).abs().maxCoeff(); }

}  // namespace

InvariantSubspaces::InvariantSubspaces(const Eigen::MatrixXd& triangular, Index zeros, double perturbation)
    : zero_(triangular.topLeftCorner(zeros, zeros).cast<Complex>()), perturbation_(perturbation) {
  const Index rest = triangular.rows() - zeros;
  const Eigen::ComplexSchur<MatrixXcd> schur(triangular.bottomRightCorner(rest, rest).cast<Complex>());
  schur_ = schur.matrixT();
  vectors_ = schur.matrixU();
  coupling_ = triangular.topRightCorner(zeros, rest).cast<Complex>() * vectors_;
}

void InvariantSubspaces::bring_forward(Index from, Index to) {
  for (Index i = from - 1; i >= to; --i) {
    Eigen::JacobiRotation<Complex> turn;
    turn.makeGivens(schur_(i, i + 1), schur_(i + 1, i + 1) - schur_(i, i));
    schur_.applyOnTheLeft(i, i + 1, turn.adjoint());
    schur_.applyOnTheRight(i, i + 1, turn);
    schur_(i + 1, i) = 0.0;
    vectors_.applyOnTheRight(i, i + 1, turn);
    if (coupling_.rows() > 0) coupling_.applyOnTheRight(i, i + 1, turn);  // Eigen refers to its first element
  }
}

DefectiveGroup InvariantSubspaces::leading(Index size) const {
  const Index zeros = zero_.rows(), rest = schur_.rows(), others = rest - size;
  const MatrixXcd T = schur_.topLeftCorner(size, size);
  // A [Z; I; 0] = [Z; I; 0] T and [0, I, L] A = T [0, I, L].
  const MatrixXcd Z = solve_sylvester(zero_, T, -coupling_.leftCols(size));
  const MatrixXcd L = solve_sylvester(T, schur_.bottomRightCorner(others, others), schur_.topRightCorner(size, others));
  DefectiveGroup group;
  group.size = size;
  group.mean = T.trace() / static_cast<double>(size);
  group.right.resize(zeros + rest, size);
  group.right << Z, vectors_.leftCols(size);
  group.left = MatrixXcd::Zero(zeros + rest, size);
  group.left.bottomRows(rest) = vectors_.leftCols(size) + vectors_.rightCols(others) * L.adjoint();
  const double projector = std::sqrt((1.0 + Z.squaredNorm()) * (1.0 + L.squaredNorm()));
  group.rounding = henrici_bound(T, perturbation_ * projector);
  if (std::abs(group.mean.imag()) <= group.rounding) group.mean.imag(0.0);
  return group;
}

std::optional<DefectiveGroup> InvariantSubspaces::defective_group(Complex near) {
  const Index rest = schur_.rows();
  Complex mean = near;
  for (Index size = 0; size < rest;) {
    Index nearest = 0;
    const double distance = (schur_.diagonal().tail(rest - size).array() - mean).abs().minCoeff(&nearest);
    if (distance >= std::abs(mean)) return std::nullopt;  // zero is nearer
    bring_forward(size + nearest, size);
    ++size;
    const MatrixXcd T = schur_.topLeftCorner(size, size);
    mean = T.trace() / static_cast<double>(size);
    const double outside =
        size == rest ? std::abs(mean)
                     : std::min(std::abs(mean), (schur_.diagonal().tail(rest - size).array() - mean).abs().minCoeff());
    const DefectiveGroup group = leading(size);
    // Not a number where a member is still outside.
    if (!(group.rounding + spread(T, mean) < outside)) continue;
    const double own = group.right.norm() * group.left.norm() * perturbation_;
    if (size == 1 || norm_of_coupling(T) <= coupled * (spread(T, mean) + own)) return std::nullopt;
    return group;
  }
  return std::nullopt;
}

}  // namespace bramah
