#include "solve/curvature.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

namespace bramah {
namespace {

constexpr Index most_motions = 400;   // dense matrices of their number
constexpr double asymmetry = 1e-8;    // of the terms: more is a force without a potential
constexpr double negligible = 1e-10;  // curvature relative to its terms

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

/// The plan's matrix with rows and columns in units of the nominals.
Sparse scaled(const SparsePlan& plan, const Vector& row, const Vector& column) {
  Sparse matrix = Eigen::Map<const Sparse>(plan.rows(), plan.columns(), plan.nonzeros(), plan.start().data(),
                                           plan.row().data(), plan.values().data());
  return Eigen::Map<const Eigen::VectorXd>(row.data(), plan.rows()).asDiagonal() * matrix *
         Eigen::Map<const Eigen::VectorXd>(column.data(), plan.columns()).asDiagonal();
}

}  // namespace

Curvature::Curvature(const System& system, const EquilibriumOptions& options)
    : system_(system), free_(shifted(system.n(), 0)), blocks_(system) {
  for (const Index i : options.hold_x) free_[static_cast<std::size_t>(i)] = -1;
  for (Index& row : free_) {
    if (row >= 0) row = count_++;
  }
  const std::vector<Index> c = shifted(system.m(), 0);
  const Term stiffness[] = {{BRAMAH_F_X, free_, free_, false, 0}, {BRAMAH_L_X, free_, free_, false, 0}};
  const Term mass[] = {{BRAMAH_F_A, free_, free_, false, 0}};
  const Term gradients[] = {{BRAMAH_C_X, c, free_, true, 0}};
  stiffness_ = SparsePlan(system, count_, count_, stiffness);
  mass_ = SparsePlan(system, count_, count_, mass);
  gradients_ = SparsePlan(system, count_, system.m(), gradients);
}

bool Curvature::coupled_to_pressures() const {
  for (std::size_t k = 0; k < system_.groups.size(); ++k) {
    const Group& group = system_.groups[k];
    const bramah_pattern& pattern = group.pattern_views[BRAMAH_F_Z];
    const std::span<const double> values = blocks_.block(k, BRAMAH_F_Z);
    for (Index i = 0; i < group.count && pattern.count > 0; ++i) {
      for (std::int32_t j = 0; j < pattern.columns; ++j) {
        const std::int32_t z = group.z[static_cast<std::size_t>(i * group.type->nz + j)];
        if (z >= system_.nz()) continue;
        for (std::int32_t e = pattern.start[j]; e < pattern.start[j + 1]; ++e) {
          if (values[static_cast<std::size_t>(i * pattern.count + e)] != 0.0) return true;
        }
      }
    }
  }
  return false;
}

/// T in nominals: of each coordinate without a pivot in D^T one motion, with the others that follow it.
void Curvature::take_motions() {
  std::vector<double> values(gradients_.values().begin(), gradients_.values().end());
  Vector nominal(static_cast<std::size_t>(count_));
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (free_[i] >= 0) nominal[static_cast<std::size_t>(free_[i])] = system_.x[i].nominal;
  }
  for (std::size_t e = 0; e < values.size(); ++e) values[e] *= nominal[static_cast<std::size_t>(gradients_.row()[e])];
  sparse::RankLu lu;
  const sparse::CscView D{count_, system_.m(), gradients_.start().data(), gradients_.row().data(), values.data()};
  lu.factor(D);
  std::vector<bool> is_pivot(static_cast<std::size_t>(count_), false);
  for (const std::int64_t row : lu.pivot_rows()) is_pivot[static_cast<std::size_t>(row)] = true;
  T_.setZero(count_, count_ - lu.rank());
  if (T_.cols() > most_motions) return;
  Vector c(static_cast<std::size_t>(system_.m())), y(static_cast<std::size_t>(count_));
  Index motion = 0;
  for (Index i = 0; i < count_; ++i) {
    if (is_pivot[static_cast<std::size_t>(i)]) continue;
    std::fill(c.begin(), c.end(), 0.0);
    for (std::int64_t j = 0; j < D.columns; ++j) {
      for (std::int64_t e = D.start[j]; e < D.start[j + 1]; ++e) {
        if (D.row[e] == i) c[static_cast<std::size_t>(j)] = values[static_cast<std::size_t>(e)];
      }
    }
    lu.solve_transposed(c, y);
    for (Index k = 0; k < count_; ++k) T_(k, motion) = -y[static_cast<std::size_t>(k)];
    T_(i, motion++) = 1.0;
  }
}

bool Curvature::evaluate(const State& state) {
  if (system_.l() > 0 || count_ == 0) return false;
  State at = state;
  std::fill_n(at.v.begin(), system_.n(), 0.0);
  std::fill_n(at.a.begin(), system_.n(), 0.0);
  const Request request = Request{}.blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_C_X, BRAMAH_R_V});
  if (!blocks_.evaluate(system_, at, request).ok() || coupled_to_pressures()) return false;
  const double one = 1.0;
  for (SparsePlan* plan : {&stiffness_, &mass_, &gradients_}) plan->fill(blocks_, {&one, 1});
  take_motions();
  if (T_.cols() > most_motions) return false;
  Vector nominal;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (free_[i] >= 0) nominal.push_back(system_.x[i].nominal);
  }
  const Sparse H = scaled(stiffness_, nominal, nominal), M = scaled(mass_, nominal, nominal);
  H_ = T_.transpose() * (H * T_);
  M_ = T_.transpose() * (M * T_);
  size_ = (T_.cwiseAbs().cwiseProduct(H.cwiseAbs() * T_.cwiseAbs())).colwise().sum();
  for (Index i = 0; i < H_.rows(); ++i) {
    for (Index j = 0; j < i; ++j) {
      if (std::abs(H_(i, j) - H_(j, i)) > asymmetry * std::sqrt(size_(i) * size_(j))) return false;
    }
  }
  H_ = 0.5 * (H_ + H_.transpose().eval());
  return true;
}

/// H raised by what rounding may have taken from it.
Eigen::MatrixXd Curvature::lifted() const {
  Eigen::MatrixXd H = H_;
  const double floor = negligible * negligible * size_.maxCoeff();
  for (Index i = 0; i < H.rows(); ++i) H(i, i) += std::max(negligible * size_(i), floor);
  return H;
}

bool Curvature::definite(double share, const Vector& mass) const {
  if (H_.rows() == 0) return true;
  Eigen::VectorXd added(count_);
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const double nominal = system_.x[i].nominal;
    if (free_[i] >= 0) added(free_[i]) = mass[i] * nominal * nominal;
  }
  const Eigen::MatrixXd metric = M_ + T_.transpose() * (added.asDiagonal() * T_);
  return Eigen::LLT<Eigen::MatrixXd>(lifted() + share * metric).info() == Eigen::Success;
}

bool Curvature::minimum() const {
  if (H_.rows() == 0 || size_.maxCoeff() == 0.0) return true;
  return Eigen::LLT<Eigen::MatrixXd>(lifted()).info() == Eigen::Success;
}

}  // namespace bramah
