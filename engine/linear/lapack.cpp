#include "linear/lapack.hpp"

#include <cmath>

#include "system/analysis_error.hpp"

// LAPACK has no C header of its own; these are its published calling sequences.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {
void dgebal_(const char* job, const int* n, double* a, const int* lda, int* ilo, int* ihi, double* scale, int* info);
void dgehrd_(const int* n, const int* ilo, const int* ihi, double* a, const int* lda, double* tau, double* work,
             const int* lwork, int* info);
void dorghr_(const int* n, const int* ilo, const int* ihi, double* a, const int* lda, const double* tau, double* work,
             const int* lwork, int* info);
void dhseqr_(const char* job, const char* compz, const int* n, const int* ilo, const int* ihi, double* h,
             const int* ldh, double* wr, double* wi, double* z, const int* ldz, double* work, const int* lwork,
             int* info);
void dtrevc3_(const char* side, const char* howmny, int* select, const int* n, const double* t, const int* ldt,
              double* vl, const int* ldvl, double* vr, const int* ldvr, const int* mm, int* m, double* work,
              const int* lwork, int* info);
void dgeevx_(const char* balanc, const char* jobvl, const char* jobvr, const char* sense, const int* n, double* a,
             const int* lda, double* wr, double* wi, double* vl, const int* ldvl, double* vr, const int* ldvr, int* ilo,
             int* ihi, double* scale, double* abnrm, double* rconde, double* rcondv, double* work, const int* lwork,
             int* iwork, int* info);
}
// NOLINTEND(readability-identifier-naming)

namespace bramah::lapack {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Calls `routine(work, lwork)` for the best size of its workspace, then with it.
template <class Routine>
void with_workspace(const Routine& routine) {
  double optimal = 0.0;
  int size = -1;
  routine(&optimal, &size);
  size = static_cast<int>(optimal);
  std::vector<double> work(static_cast<std::size_t>(size));
  routine(work.data(), &size);
}

void require_convergence(int info) {
  if (info == 0) return;
  throw AnalysisError("modes", "the QR iteration did not converge", "eigenvalues of the Jacobian",
                      "check the model's scales");
}

std::vector<Complex> complex_numbers(const std::vector<double>& re, const std::vector<double>& im) {
  std::vector<Complex> list;
  for (std::size_t k = 0; k < re.size(); ++k) list.emplace_back(re[k], im[k]);
  return list;
}

}  // namespace

VectorXd balance(MatrixXd& A) {
  const auto n = static_cast<int>(A.rows());
  VectorXd D = VectorXd::Ones(n);
  if (n == 0) return D;
  int ilo = 0, ihi = 0, info = 0;
  dgebal_("S", &n, A.data(), &n, &ilo, &ihi, D.data(), &info);
  double exponents = 0.0;
  for (Index i = 0; i < n; ++i) exponents += std::ilogb(D(i));
  return D * std::ldexp(1.0, -static_cast<int>(std::lround(exponents / n)));
}

void schur(MatrixXd& A, MatrixXd& Z, std::vector<Complex>& eigenvalues) {
  const auto n = static_cast<int>(A.rows());
  eigenvalues.clear();
  Z = MatrixXd::Identity(n, n);
  if (n == 0) return;
  const auto size = static_cast<std::size_t>(n);
  const int one = 1;
  int info = 0;
  std::vector<double> tau(size), re(size), im(size);
  with_workspace(
      [&](double* work, int* lwork) { dgehrd_(&n, &one, &n, A.data(), &n, tau.data(), work, lwork, &info); });
  Z = A;
  with_workspace(
      [&](double* work, int* lwork) { dorghr_(&n, &one, &n, Z.data(), &n, tau.data(), work, lwork, &info); });
  with_workspace([&](double* work, int* lwork) {
    dhseqr_("S", "V", &n, &one, &n, A.data(), &n, re.data(), im.data(), Z.data(), &n, work, lwork, &info);
  });
  require_convergence(info);
  // Below the first subdiagonal dgehrd leaves its reflectors.
  for (Index j = 0; j < n; ++j) A.col(j).tail(std::max<Index>(n - j - 2, 0)).setZero();
  eigenvalues = complex_numbers(re, im);
}

void vectors(const MatrixXd& T, Index count, MatrixXd& right, MatrixXd& left) {
  const auto n = static_cast<int>(T.rows()), wanted = static_cast<int>(count);
  right.resize(n, count);
  left.resize(n, count);
  if (wanted == 0) return;
  std::vector<int> select(static_cast<std::size_t>(n), 0);
  std::fill(select.end() - wanted, select.end(), 1);
  int found = 0, info = 0;
  with_workspace([&](double* work, int* lwork) {
    dtrevc3_("B", "S", select.data(), &n, T.data(), &n, left.data(), &n, right.data(), &n, &wanted, &found, work, lwork,
             &info);
  });
}

std::vector<Complex> eigenvalues(MatrixXd A) {
  const auto n = static_cast<int>(A.rows());
  if (n == 0) return {};
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> re(size), im(size), scale(size);
  double norm = 0.0, none = 0.0;
  const int one = 1;
  int ilo = 0, ihi = 0, info = 0;
  with_workspace([&](double* work, int* lwork) {
    dgeevx_("B", "N", "N", "N", &n, A.data(), &n, re.data(), im.data(), &none, &one, &none, &one, &ilo, &ihi,
            scale.data(), &norm, &none, &none, work, lwork, nullptr, &info);
  });
  require_convergence(info);
  return complex_numbers(re, im);
}

}  // namespace bramah::lapack
