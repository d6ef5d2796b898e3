#include "linear/respond.hpp"

#include <unsupported/Eigen/MatrixFunctions>

namespace bramah {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd nominals(const LinearModel& model) {
  VectorXd nominal(static_cast<Eigen::Index>(model.states.size()));
  for (Eigen::Index i = 0; i < nominal.size(); ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
  return nominal;
}

}  // namespace

VectorXd reduced_deviation(const System& system, const Partition& partition, const State& state,
                           const State& reference) {
  std::vector<double> X;
  const auto push = [&](const Vector& a, const Vector& b, Index i) {
    X.push_back(a[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(i)]);
  };
  for (const Index i : partition.ai) push(state.x, reference.x, i);
  for (const Index i : partition.ai) push(state.v, reference.v, i);
  for (const Index i : partition.ad) push(state.x, reference.x, i);
  for (Index i = 0; i < system.nz(); ++i) push(state.z, reference.z, i);
  return Eigen::Map<VectorXd>(X.data(), static_cast<Eigen::Index>(X.size()));
}

MatrixXd free_response(const LinearModel& model, const VectorXd& X0, double t0, std::span<const double> times) {
  std::vector<double> all = {t0};
  all.insert(all.end(), times.begin(), times.end());
  const MatrixXd u =
      MatrixXd::Zero(static_cast<Eigen::Index>(model.inputs.size()), static_cast<Eigen::Index>(all.size()));
  return forced_response(model, X0, all, u).rightCols(static_cast<Eigen::Index>(times.size()));
}

MatrixXd forced_response(const LinearModel& model, const VectorXd& X0, std::span<const double> times,
                         const MatrixXd& u) {
  // One step of length h is exact with the exponential of [A B 0; 0 0 I/h; 0 0 0] h acting on (X, u, change of u).
  const Eigen::Index n = model.A.rows(), nu = model.B.cols();
  const VectorXd nominal = nominals(model);
  const MatrixXd A = nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal();
  const MatrixXd B = nominal.cwiseInverse().asDiagonal() * model.B;
  MatrixXd result(n, static_cast<Eigen::Index>(times.size()));
  VectorXd X = nominal.cwiseInverse().asDiagonal() * X0;
  result.col(0) = X0;
  MatrixXd E;
  double h_of_E = -1.0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double h = times[k] - times[k - 1];
    const auto column = static_cast<Eigen::Index>(k);
    if (h > 0.0) {
      if (std::abs(h - h_of_E) > 1e-14 * std::abs(h)) {  // equal steps share their exponential
        MatrixXd M = MatrixXd::Zero(n + 2 * nu, n + 2 * nu);
        M.topLeftCorner(n, n) = A * h;
        M.block(0, n, n, nu) = B * h;
        M.block(n, n + nu, nu, nu).setIdentity();
        E = M.exp();
        h_of_E = h;
      }
      X = E.topLeftCorner(n, n) * X + E.block(0, n, n, nu) * u.col(column - 1) +
          E.block(0, n + nu, n, nu) * (u.col(column) - u.col(column - 1));
    }
    result.col(column) = nominal.asDiagonal() * X;
  }
  return result;
}

}  // namespace bramah
