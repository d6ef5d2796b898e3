#include "linear/augmented.hpp"

#include <Spectra/GenEigsSolver.h>

#include <algorithm>
#include <cmath>

#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void fill(SparsePlan& plan, const Blocks& blocks) {
  const double one = 1.0;
  plan.fill(blocks, {&one, 1});
}

}  // namespace

AugmentedByDifferences::AugmentedByDifferences(const System& system, const Partition& partition, Inverse inverse)
    : system_(system),
      partition_(partition),
      inverse_(inverse),
      blocks_(system),
      kkt_(system, partition.rows),
      mass_(kkt_.matrix()),
      request_(Kkt::needed().rows("fgs")),
      rows_(Request{}.rows("fgs")) {
  request_.multiplier_forces = rows_.multiplier_forces = false;
}

void AugmentedByDifferences::start(const State& reference) {
  state_ = reference;
  std::fill_n(state_.a.begin(), system_.n(), 0.0);
  std::fill_n(state_.zdot.begin(), system_.nz(), 0.0);
  std::fill(state_.lambda.begin(), state_.lambda.end(), 0.0);
  factors_of_reference_ = false;
}

void AugmentedByDifferences::evaluate(const Request& request) {
  const Outcome outcome = blocks_.evaluate(system_, state_, request);
  if (!outcome.ok())
    throw AnalysisError("compare", outcome.message, "finite rows around the state", "use smaller differences");
}

/// Eq. (97) at state_. `factors_hold`: M, D and K are those that were factored last.
VectorXd AugmentedByDifferences::F(bool factors_hold) {
  const Index n = system_.n(), nz = system_.nz(), rows = static_cast<Index>(partition_.rows.size());
  evaluate(factors_hold ? rows_ : request_);
  VectorXd right(n + rows + nz);  // the rows of f below those of dx/dt = v
  for (Index i = 0; i < n; ++i) right(i) = -blocks_.f[static_cast<std::size_t>(i)];
  for (Index i = 0; i < rows; ++i)
    right(n + i) = -blocks_.s[static_cast<std::size_t>(partition_.rows[static_cast<std::size_t>(i)])];
  for (Index i = 0; i < nz; ++i) right(n + rows + i) = -blocks_.g[static_cast<std::size_t>(i)];
  VectorXd result(states());
  const auto v = Eigen::Map<const VectorXd>(state_.v.data(), n);
  if (inverse_ == Inverse::dense) {
    fill(mass_, blocks_);
    MatrixXd A = MatrixXd::Zero(n + right.size(), n + right.size());
    A.topLeftCorner(n, n).setIdentity();
    for (Index j = 0; j < mass_.columns(); ++j) {
      for (Index e = mass_.start()[static_cast<std::size_t>(j)]; e < mass_.start()[static_cast<std::size_t>(j) + 1];
           ++e)
        A(n + mass_.row()[static_cast<std::size_t>(e)], n + j) = mass_.values()[static_cast<std::size_t>(e)];
    }
    VectorXd f(A.rows());
    f << v, right;
    const VectorXd all = A.inverse() * f;
    result << all.head(2 * n), all.tail(nz);
    return result;
  }
  if (!factors_hold) kkt_.factor(blocks_);
  kkt_.solve({right.data(), static_cast<std::size_t>(right.size())});
  result << v, right.head(n), right.tail(nz);
  return result;
}

VectorXd AugmentedByDifferences::column(Index j, double h) {
  const Index n = system_.n();
  const bool velocity = j >= n && j < 2 * n, keeps_factors = velocity && inverse_ == Inverse::sparse;
  if (keeps_factors && !factors_of_reference_) {  // M, D and K do not depend on v
    evaluate(request_);
    kkt_.factor(blocks_);
  }
  factors_of_reference_ = keeps_factors;
  const auto at = static_cast<std::size_t>(j), size = static_cast<std::size_t>(n);
  double& variable = j < n ? state_.x[at] : velocity ? state_.v[at - size] : state_.z[at - 2 * size];
  const double value = variable;
  variable = value + h;
  const VectorXd forward = F(keeps_factors);
  variable = value - h;
  VectorXd difference = (forward - F(keeps_factors)) / (2.0 * h);  // Eq. (100)
  variable = value;
  return difference;
}

MatrixXd AugmentedByDifferences::jacobian(const State& reference, double h) {
  start(reference);
  MatrixXd J(states(), states());
  for (Index j = 0; j < states(); ++j) J.col(j) = column(j, h);
  return J;
}

namespace {

/// What Arnoldi's method applies: (shift E - A)^-1 E.
template <class Sparse>
class Operator {
 public:
  using Scalar = double;  // what the solver asks for
  Operator(const Sparse& E, const sparse::Klu& lu) : E_(E), lu_(lu) {}
  [[nodiscard]] Index rows() const { return E_.rows(); }
  [[nodiscard]] Index cols() const { return E_.cols(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<VectorXd> result(out, rows());
    result = E_ * Eigen::Map<const VectorXd>(in, cols());
    lu_.solve({out, static_cast<std::size_t>(rows())});
  }

 private:
  const Sparse& E_;
  const sparse::Klu& lu_;
};

/// Columns in nominals, then every row over its largest entry in E or A.
template <class Sparse>
void scale(Sparse& E, Sparse& A, const VectorXd& nominal) {
  VectorXd largest = VectorXd::Zero(E.rows());
  for (Sparse* matrix : {&E, &A}) {
    *matrix = *matrix * nominal.asDiagonal();
    for (Index j = 0; j < matrix->outerSize(); ++j) {
      for (typename Sparse::InnerIterator entry(*matrix, j); entry; ++entry)
        largest(entry.row()) = std::max(largest(entry.row()), std::abs(entry.value()));
    }
  }
  const VectorXd row = largest.unaryExpr([](double size) { return size > 0.0 ? 1.0 / size : 1.0; });
  for (Sparse* matrix : {&E, &A}) *matrix = row.asDiagonal() * *matrix;
}

}  // namespace

AugmentedPencil::AugmentedPencil(const Descriptor& descriptor) : states_(descriptor.states()) {
  const FirstOrderForm form = first_order_form(descriptor);
  const auto assembled = [&](const std::vector<Entry>& entries) {
    std::vector<Eigen::Triplet<double, Index>> triplets;
    triplets.reserve(entries.size());
    for (const Entry& entry : entries) triplets.emplace_back(entry.row, entry.column, entry.value);
    const auto size = static_cast<Index>(form.states.size());
    Sparse matrix(size, size);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
  };
  E_ = assembled(form.E);
  A_ = assembled(form.A);
  VectorXd nominal(size());  // x, v, lambda, z
  const auto of_unknowns = Eigen::Map<const VectorXd>(descriptor.nominal().data(), descriptor.size());
  nominal << of_unknowns.head(descriptor.n()), of_unknowns;
  nominal.segment(descriptor.n(), descriptor.n()) /= descriptor.time();
  scale(E_, A_, nominal);
}

void AugmentedPencil::factor(double shift) {
  shift_ = shift;
  shifted_ = shift * E_ - A_;
  shifted_.makeCompressed();
  const sparse::CscView view{size(), size(), shifted_.outerIndexPtr(), shifted_.innerIndexPtr(), shifted_.valuePtr()};
  lu_.analyze(view);
  if (!lu_.factor(view))
    throw AnalysisError("compare", "a singular matrix at the shift " + digits(shift) + " 1/s",
                        "a shift that is no eigenvalue", "move the shift");
}

MatrixXd AugmentedPencil::written_out() const {
  MatrixXd result = E_;
  lu_.solve({result.data(), static_cast<std::size_t>(result.size())}, result.cols());
  return result;
}

std::vector<std::complex<double>> AugmentedPencil::finite(std::vector<std::complex<double>> of_operator) const {
  std::stable_sort(of_operator.begin(), of_operator.end(),
                   [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
  of_operator.resize(std::min(of_operator.size(), static_cast<std::size_t>(states_)));
  for (std::complex<double>& value : of_operator) value = shift_ - 1.0 / value;
  return of_operator;
}

std::vector<std::complex<double>> AugmentedPencil::nearest(Index count) const {
  const Operator<Sparse> op(E_, lu_);
  const Index wanted = std::min(count, states_), basis = std::min(size(), wanted + std::max<Index>(wanted / 2, 20));
  // What belongs to infinite eigenvalues leaves a vector after three applications.
  VectorXd start = VectorXd::NullaryExpr(size(), [](Index i) { return std::cos(1.0 + 1.7 * static_cast<double>(i)); });
  VectorXd next(size());
  for (int k = 0; k < 3; ++k) {
    op.perform_op(start.data(), next.data());
    start = next.normalized();
  }
  constexpr double tolerance = 1e-13;
  constexpr Index restarts = 300;
  Spectra::GenEigsSolver<const Operator<Sparse>> solver(op, wanted, basis);
  solver.init(start.data());
  const Index converged = solver.compute(Spectra::SortRule::LargestMagn, restarts, tolerance);
  if (converged < wanted)
    throw AnalysisError(
        "compare",
        "Arnoldi's method found " + std::to_string(converged) + " of " + std::to_string(wanted) + " eigenvalues",
        "as many as were asked for", "ask for fewer, or move the shift");
  const Eigen::VectorXcd of_operator = solver.eigenvalues();
  return finite({of_operator.begin(), of_operator.end()});
}

}  // namespace bramah
