#include "linear/transfer.hpp"

#include <cmath>
#include <limits>

#include "linear/respond.hpp"
#include "system/analysis_error.hpp"

// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void dggev_(const char* jobvl, const char* jobvr, const int* n, double* a, const int* lda, double* b,
                       const int* ldb, double* alphar, double* alphai, double* beta, double* vl, const int* ldvl,
                       double* vr, const int* ldvr, double* work, const int* lwork, int* info);

namespace bramah {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

/// The model with its states in nominals: what ranks, angles and pencils are judged on.
struct Scaled {
  MatrixXd A, B, C;
  explicit Scaled(const LinearModel& model) {
    VectorXd nominal(model.A.rows());
    for (Index i = 0; i < nominal.size(); ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
    A = nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal();
    B = nominal.cwiseInverse().asDiagonal() * model.B;
    C = model.C * nominal.asDiagonal();
  }
};

}  // namespace

std::vector<MatrixXcd> frequency_response(const LinearModel& model, std::span<const double> frequencies) {
  const Scaled scaled(model);
  const Index n = scaled.A.rows();
  // One Hessenberg form A = Q H Q^T serves all frequencies.
  const Eigen::HessenbergDecomposition<MatrixXd> form(scaled.A);
  const MatrixXd H = form.matrixH(), Q = form.matrixQ();
  const MatrixXcd B = (Q.transpose() * scaled.B).cast<Complex>(), C = (scaled.C * Q).cast<Complex>();
  std::vector<MatrixXcd> result;
  for (const double w : frequencies) {
    const MatrixXcd shifted = Complex(0.0, w) * MatrixXcd::Identity(n, n) - H.cast<Complex>();
    result.emplace_back(C * shifted.partialPivLu().solve(B) + model.D.cast<Complex>());
  }
  return result;
}

std::vector<Complex> transfer_zeros(const LinearModel& model, Index input, Index output) {
  const Scaled scaled(model);
  const Index states = scaled.A.rows();
  const auto n = static_cast<int>(states + 1);
  VectorXd b = scaled.B.col(input), c = scaled.C.row(output).transpose();
  double d = model.D(output, input);
  // Scaling input and output moves no zero and keeps the pencil balanced.
  const double b_norm = b.norm(), c_norm = c.norm();
  if (b_norm > 0.0) {
    b /= b_norm;
    d /= b_norm;
  }
  if (c_norm > 0.0) {
    c /= c_norm;
    d /= c_norm;
  }
  MatrixXd P(n, n), E = MatrixXd::Zero(n, n);
  P << scaled.A, b, c.transpose(), d;
  E.topLeftCorner(states, states).setIdentity();
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> alphar(size), alphai(size), beta(size), work(64 * size + 64);
  const int one = 1, lwork = static_cast<int>(work.size());
  double unused = 0.0;
  int info = 0;
  const double norm = P.norm();
  dggev_("N", "N", &n, P.data(), &n, E.data(), &n, alphar.data(), alphai.data(), beta.data(), &unused, &one, &unused,
         &one, work.data(), &lwork, &info);
  if (info != 0)
    throw AnalysisError("zeros", "the QZ iteration did not converge", "zeros of the transfer function",
                        "check the model's scales");
  std::vector<Complex> zeros;
  for (std::size_t k = 0; k < size; ++k) {
    const Complex alpha(alphar[k], alphai[k]);
    // Infinite zeros come out as alpha / 0, and defective ones as huge numbers: beyond what the pencil can resolve.
    if (std::abs(beta[k]) * norm <= 1e3 * std::numeric_limits<double>::epsilon() * std::abs(alpha) || beta[k] == 0.0)
      continue;
    zeros.push_back(alpha / beta[k]);
  }
  return zeros;
}

ModalAccess modal_access(const LinearModel& model, const Spectrum& spectrum) {
  const Scaled scaled(model);
  VectorXd nominal(model.A.rows());
  for (Index i = 0; i < nominal.size(); ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
  const Index modes = spectrum.left.cols();
  ModalAccess access{MatrixXd(modes, scaled.B.cols()), MatrixXd(modes, scaled.C.rows())};
  for (Index k = 0; k < modes; ++k) {
    const Eigen::VectorXcd w = nominal.cast<Complex>().cwiseProduct(spectrum.left.col(k));
    const Eigen::VectorXcd v = nominal.cwiseInverse().cast<Complex>().cwiseProduct(spectrum.right.col(k));
    for (Index j = 0; j < scaled.B.cols(); ++j) {
      const double size = w.norm() * scaled.B.col(j).norm();
      access.controllability(k, j) = size > 0.0 ? std::abs(w.dot(scaled.B.col(j).cast<Complex>())) / size : 0.0;
    }
    for (Index j = 0; j < scaled.C.rows(); ++j) {
      const double size = v.norm() * scaled.C.row(j).norm();
      access.observability(k, j) = size > 0.0 ? std::abs((scaled.C.row(j).cast<Complex>() * v)(0)) / size : 0.0;
    }
  }
  return access;
}

MatrixXd step_response(const LinearModel& model, Index input, std::span<const double> times) {
  MatrixXd u = MatrixXd::Zero(model.B.cols(), static_cast<Index>(times.size()));
  u.row(input).setOnes();
  const MatrixXd X = forced_response(model, VectorXd::Zero(model.A.rows()), times, u);
  return model.C * X + model.D * u;
}

MatrixXd impulse_response(const LinearModel& model, Index input, std::span<const double> times) {
  // An impulse leaves the state B e_j behind; a direct path D would pass the impulse itself, which is not a number.
  return model.C * forced_response(model, model.B.col(input), times,
                                   MatrixXd::Zero(model.B.cols(), static_cast<Index>(times.size())));
}

}  // namespace bramah
