#include "linear/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "system/analysis_error.hpp"

// LAPACK has no C header of its own; this is its published calling sequence.
extern "C" void dgeevx_(const char* balanc, const char* jobvl, const char* jobvr, const char* sense, const int* n, double* a,
                        const int* lda, double* wr, double* wi, double* vl, const int* ldvl, double* vr, const int* ldvr,
                        int* ilo, int* ihi, double* scale, double* abnrm, double* rconde, double* rcondv, double* work,
                        const int* lwork, int* iwork, int* info);

namespace bramah {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// How far above its first-order error bound eps |A| condition a computed zero may sit.
constexpr double zero_factor = 50.0;

Spectrum eigenvalues(MatrixXd A, const VectorXd& nominal, const std::vector<std::string>& names) {
  const auto n = static_cast<int>(A.rows());
  Spectrum spectrum;
  if (n == 0) return spectrum;
  if (!A.allFinite()) throw AnalysisError("modes", "a Jacobian with entries that are not finite", "a finite Jacobian", "linearize at another state");
  A = nominal.cwiseInverse().asDiagonal() * A * nominal.asDiagonal();
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> wr(size), wi(size), scale(size), rconde(size), rcondv(size);
  MatrixXd vl(n, n), vr(n, n);
  std::vector<int> iwork(2 * size);
  int ilo = 0, ihi = 0, info = 0, lwork = -1;
  double optimal = 0.0;
  const auto call = [&](double* work) {
    dgeevx_("B", "V", "V", "E", &n, A.data(), &n, wr.data(), wi.data(), vl.data(), &n, vr.data(), &n, &ilo, &ihi, scale.data(),
            &spectrum.norm, rconde.data(), rcondv.data(), work, &lwork, iwork.data(), &info);
  };
  call(&optimal);
  lwork = static_cast<int>(optimal);
  std::vector<double> work(static_cast<std::size_t>(lwork));
  call(work.data());
  if (info != 0) throw AnalysisError("modes", "the QR iteration did not converge", "eigenvalues of the Jacobian", "check the model's scales");

  std::vector<Mode> modes(size);
  Eigen::MatrixXcd right(n, n);
  for (std::size_t k = 0; k < size; ++k) {
    const auto column = static_cast<int>(k);
    Mode& mode = modes[k];
    mode.eigenvalue = {wr[k], wi[k]};
    mode.condition = rconde[k] > 0.0 ? 1.0 / rconde[k] : std::numeric_limits<double>::infinity();
    const double bound = zero_factor * std::numeric_limits<double>::epsilon() * spectrum.norm * mode.condition;
    mode.zero = std::abs(mode.eigenvalue) <= bound;
    if (wi[k] > 0.0) {
      right.col(column) = vr.col(column).cast<std::complex<double>>() + std::complex<double>(0, 1) * vr.col(column + 1);
    } else if (wi[k] < 0.0) {
      right.col(column) = right.col(column - 1).conjugate();
    } else {
      right.col(column) = vr.col(column).cast<std::complex<double>>();
    }
  }
  std::vector<std::size_t> order(size);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Mode &p = modes[a], &q = modes[b];
    if (p.zero != q.zero) return q.zero;
    if (p.eigenvalue.real() != q.eigenvalue.real()) return p.eigenvalue.real() > q.eigenvalue.real();
    return p.eigenvalue.imag() > q.eigenvalue.imag();
  });
  spectrum.right.resize(n, n);
  for (std::size_t k = 0; k < size; ++k) {
    Eigen::VectorXcd vector = right.col(static_cast<int>(order[k]));
    Eigen::Index largest = 0;
    vector.cwiseAbs().maxCoeff(&largest);
    vector /= vector(largest);
    Mode mode = modes[order[k]];
    if (mode.zero) {
      for (int i = 0; i < n; ++i) {
        if (std::abs(vector(i)) > 1e-6) mode.cause += (mode.cause.empty() ? "a family of equilibria that moves " : ", ") + names[static_cast<std::size_t>(i)];
      }
    }
    spectrum.modes.push_back(std::move(mode));
    spectrum.right.col(static_cast<int>(k)) = nominal.cast<std::complex<double>>().asDiagonal() * vector;
  }
  return spectrum;
}

}  // namespace

Spectrum find_spectrum(const LinearModel& model) {
  VectorXd nominal(model.A.rows());
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < nominal.size(); ++i) {
    nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
    names.push_back(model.states[static_cast<std::size_t>(i)].name);
  }
  return eigenvalues(model.A, nominal, names);
}

Spectrum find_spectrum(const MatrixXd& A) {
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < A.rows(); ++i) names.push_back("state " + std::to_string(i + 1));
  return eigenvalues(A, VectorXd::Ones(A.rows()), names);
}

}  // namespace bramah
