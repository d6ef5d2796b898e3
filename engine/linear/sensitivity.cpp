#include "linear/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/equilibrium.hpp"

namespace bramah {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;

// Eigenvalues nearer than this part of their size are treated as one: w^H v loses its digits between them.
constexpr double together = 1e-7;

Direction direction_of(const System& system, const EquilibriumOptions& options, Follows follows, const State& state,
                       Linearizer& linearizer, const SceneNumber& number) {
  Direction along(system, number);
  along.apply_inputs(system, state);
  if (follows == Follows::equilibrium) {
    move_equilibrium(system, options, state, along);
  } else {
    along.add_start(system);
    linearizer.complete(state, along);
  }
  return along;
}

/// Eigenvalues of (W^H V)^-1 W^H dA V for vectors of one eigenvalue.
std::vector<Complex> derivatives(const Eigen::MatrixXd& dA, const MatrixXcd& W, const MatrixXcd& V) {
  const MatrixXcd product = W.adjoint() * V, change = W.adjoint() * (dA.cast<Complex>() * V);
  if (product.cols() == 1) return {change(0, 0) / product(0, 0)};
  const Eigen::FullPivLU<MatrixXcd> lu(product);
  if (std::abs(lu.matrixLU()(product.rows() - 1, product.cols() - 1)) < together) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<Complex> undetermined(static_cast<std::size_t>(product.cols()), {none, none});
    return undetermined;
  }
  const Eigen::VectorXcd values = Eigen::ComplexEigenSolver<MatrixXcd>(lu.solve(change), false).eigenvalues();
  std::vector<Complex> list(values.data(), values.data() + values.size());
  return list;
}

/// trace(W^H dA V) / size; real where the mean is.
Complex derivative_of_mean(const Eigen::MatrixXd& dA, const DefectiveGroup& group) {
  const Complex sum = (group.left.adjoint() * (dA.cast<Complex>() * group.right)).trace();
  const Complex derivative = sum / static_cast<double>(group.size);
  return group.mean.imag() == 0.0 ? Complex(derivative.real(), 0.0) : derivative;
}

}  // namespace

Sensitivity find_sensitivity(const System& system, const EquilibriumOptions& options, Follows follows,
                             const State& state, Linearizer& linearizer, const Spectrum& spectrum,
                             const SceneNumber& number) {
  const Direction along = direction_of(system, options, follows, state, linearizer, number);
  const Eigen::MatrixXd dA = linearizer.derivative(state, along);
  const auto count = static_cast<std::size_t>(spectrum.left.cols());
  Sensitivity result{number, std::vector<Complex>(count), {}, 0.0};
  std::vector<bool> done(count, false);
  for (std::size_t k = 0; k < count; ++k) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    done[k] = spectrum.modes[k].group >= 0;
    if (done[k]) result.eigenvalues[k] = {none, none};
  }
  for (const DefectiveGroup& group : spectrum.defective) result.means.push_back(derivative_of_mean(dA, group));
  for (std::size_t k = 0; k < count; ++k) {
    if (done[k]) continue;
    const Complex eigenvalue = spectrum.modes[k].eigenvalue;
    std::vector<std::size_t> group;
    for (std::size_t j = k; j < count; ++j) {
      if (!done[j] && std::abs(spectrum.modes[j].eigenvalue - eigenvalue) <= together * std::abs(eigenvalue))
        group.push_back(j);
    }
    MatrixXcd W(dA.rows(), static_cast<Index>(group.size())), V = W;
    for (std::size_t j = 0; j < group.size(); ++j) {
      W.col(static_cast<Index>(j)) = spectrum.left.col(static_cast<Index>(group[j]));
      V.col(static_cast<Index>(j)) = spectrum.right.col(static_cast<Index>(group[j]));
    }
    const std::vector<Complex> change = derivatives(dA, W, V);
    for (std::size_t j = 0; j < group.size(); ++j) {
      result.eigenvalues[group[j]] = change[j];
      done[group[j]] = true;
    }
  }
  const auto count_in = [&](Complex derivative, Complex eigenvalue) {
    const double relative = std::abs(derivative * number.value / eigenvalue);
    if (std::isfinite(relative)) result.importance = std::max(result.importance, relative);
  };
  for (std::size_t k = 0; k < count; ++k) count_in(result.eigenvalues[k], spectrum.modes[k].eigenvalue);
  for (std::size_t k = 0; k < result.means.size(); ++k) count_in(result.means[k], spectrum.defective[k].mean);
  return result;
}

}  // namespace bramah
