#include "solve/scaled_state.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace bramah {
namespace {

// Errors are relative to how far a variable has moved, but never to less than this part of its size, nor to less than
// this part of what the others of its kind have moved: below lies rounding.
constexpr double least_motion = 1e-5;
constexpr double least_share = 0.1;
// Rounding itself, relative to the largest variable of the kind: the extent of the machine.
constexpr double least_tolerance = 1e-13;
constexpr double slow = 0.1;  // of the size of a rate: as fast as a machine is taken to be at least
// And of coordinates relative to the largest of all: joints turn the rounding of places into angles.
constexpr double least_tolerance_of_joints = 2e-14;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

ScaledState::ScaledState(const System& system, double rel_tol) : n_(system.n()), nz_(system.nz()), rel_tol_(rel_tol) {
  std::map<std::pair<int, std::string>, std::size_t> kinds;
  const auto add = [&](int family, const Variable& variable) {
    const bool rate = family == 1;
    scale_.push_back(rate ? variable.nominal / system.scales.time : variable.nominal);
    size_.push_back((rate ? variable.size / system.sizes.time : variable.size) / scale_.back());
    kind_.push_back(kinds.try_emplace({family, variable.unit}, kinds.size()).first->second);
  };
  for (const Variable& x : system.x) add(0, x);
  for (const Variable& x : system.x) add(1, x);
  for (const Variable& z : system.z) add(2, z);
  low_.assign(scale_.size(), HUGE_VAL);
  high_.assign(scale_.size(), -HUGE_VAL);
  // Rest is the natural reference of a rate.
  std::fill_n(low_.begin() + n_, n_, 0.0);
  std::fill_n(high_.begin() + n_, n_, 0.0);
  motion_.resize(kinds.size());
  extent_.resize(kinds.size());
}

void ScaledState::pack(const State& state, double* y) const {
  for (std::size_t i = 0, n = at(n_); i < n; ++i) {
    y[i] = state.x[i] / scale_[i];
    y[n + i] = state.v[i] / scale_[n + i];
  }
  for (std::size_t i = 0; i < at(nz_); ++i) y[at(2 * n_) + i] = state.z[i] / scale_[at(2 * n_) + i];
}

void ScaledState::pack_rates(const State& state, double* yp) const {
  for (std::size_t i = 0, n = at(n_); i < n; ++i) {
    yp[i] = state.v[i] / scale_[i];
    yp[n + i] = state.a[i] / scale_[n + i];
  }
  for (std::size_t i = 0; i < at(nz_); ++i) yp[at(2 * n_) + i] = state.zdot[i] / scale_[at(2 * n_) + i];
}

void ScaledState::unpack(const double* y, State& state) const {
  for (std::size_t i = 0, n = at(n_); i < n; ++i) {
    state.x[i] = y[i] * scale_[i];
    state.v[i] = y[n + i] * scale_[n + i];
  }
  for (std::size_t i = 0; i < at(nz_); ++i) state.z[i] = y[at(2 * n_) + i] * scale_[at(2 * n_) + i];
}

void ScaledState::unpack_rates(const double* yp, State& state) const {
  for (std::size_t i = 0, n = at(n_); i < n; ++i) state.a[i] = yp[n + i] * scale_[n + i];
  for (std::size_t i = 0; i < at(nz_); ++i) state.zdot[i] = yp[at(2 * n_) + i] * scale_[at(2 * n_) + i];
}

void ScaledState::weigh(const double* y, double* weight) {
  std::fill(motion_.begin(), motion_.end(), 0.0);
  for (std::size_t i = 0; i < scale_.size(); ++i) {
    const bool rate = i >= at(n_) && i < at(2 * n_);
    extent_[kind_[i]] = rate ? slow * size_[i] : size_[i];
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < scale_.size(); ++i) {
    low_[i] = std::min(low_[i], y[i]);
    high_[i] = std::max(high_[i], y[i]);
    motion_[kind_[i]] = std::max(motion_[kind_[i]], high_[i] - low_[i]);
    extent_[kind_[i]] = std::max(extent_[kind_[i]], std::abs(y[i]));
    if (i < at(n_)) largest = std::max(largest, std::abs(y[i]) / size_[i]);
  }
  for (std::size_t i = 0; i < scale_.size(); ++i) {
    const double motion = std::max({high_[i] - low_[i], least_share * motion_[kind_[i]], least_motion * size_[i]});
    const double rounding = i < at(n_) ? least_tolerance_of_joints * largest * size_[i] : 0.0;
    weight[i] = 1.0 / std::max({rel_tol_ * motion, least_tolerance * extent_[kind_[i]], rounding});
  }
}

Index ScaledState::worst(const double* weight, const double* error) const {
  Index found = -1;
  double largest = 0.0;
  for (Index i = 0; i < size(); ++i) {
    const double weighted = std::abs(weight[i] * error[i]);
    if (weighted <= largest) continue;
    largest = weighted;
    found = i;
  }
  return found;
}

}  // namespace bramah
