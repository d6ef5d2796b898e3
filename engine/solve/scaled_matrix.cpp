#include "solve/scaled_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bramah {

ScaledMatrix::ScaledMatrix(SparsePlan plan)
    : plan_(std::move(plan)),
      row_scale_(static_cast<std::size_t>(plan_.rows())),
      scaled_(plan_.row().size()),
      rhs_(static_cast<std::size_t>(plan_.rows())) {}

void ScaledMatrix::fill(const Blocks& blocks, std::span<const double> weights) { plan_.fill(blocks, weights); }

void ScaledMatrix::scale(std::span<const double> sizes) {
  std::fill(row_scale_.begin(), row_scale_.end(), 0.0);
  std::size_t e = 0;
  each_entry([&](std::size_t row, std::size_t column, double value) {
    scaled_[e] = value * sizes[column];
    row_scale_[row] = std::max(row_scale_[row], std::abs(scaled_[e]));
    ++e;
  });
  for (double& r : row_scale_) r = r > 0.0 ? 1.0 / r : 0.0;
  e = 0;
  each_entry([&](std::size_t row, std::size_t, double) { scaled_[e++] *= row_scale_[row]; });
}

void ScaledMatrix::factor(double rank_tolerance) {
  if (order_.empty()) order_ = sparse::fill_reducing_order(view());  // the pattern stays
  lu_.factor(view(), {.rank_tolerance = rank_tolerance, .order = order_});
}

void ScaledMatrix::solve(std::span<const double> residual, std::span<double> step) {
  for (std::size_t i = 0; i < rhs_.size(); ++i) rhs_[i] = -residual[i] * row_scale_[i];
  lu_.solve(rhs_, step);
}

void size_multipliers(const ScaledMatrix& matrix, std::span<const double> nominal, std::span<const double> terms,
                      std::span<const double> lambda, double instead, std::span<double> sizes) {
  const std::size_t first = sizes.size() - lambda.size(), forces = nominal.size();
  Vector work(terms.begin(), terms.begin() + static_cast<std::ptrdiff_t>(forces));
  matrix.each_entry([&](std::size_t row, std::size_t column, double value) {
    if (row < forces && column < first) work[row] = std::max(work[row], std::abs(value) * sizes[column]);
  });
  for (std::size_t i = 0; i < forces; ++i) work[i] *= nominal[i];
  Vector acting(lambda.size(), 0.0), most(lambda.size(), 0.0);
  matrix.each_entry([&](std::size_t row, std::size_t column, double value) {
    if (row >= forces || column < first || value == 0.0) return;
    acting[column - first] = std::max(acting[column - first], std::abs(value) * nominal[row]);
    most[column - first] = std::max(most[column - first], work[row]);
  });
  double largest = 0.0;
  for (std::size_t k = 0; k < lambda.size(); ++k) {
    sizes[first + k] = std::max(std::abs(lambda[k]), acting[k] > 0.0 ? most[k] / acting[k] : 0.0);
    largest = std::max(largest, sizes[first + k]);
  }
  for (double& size : sizes.subspan(first)) {
    if (size == 0.0) size = largest > 0.0 ? largest : instead;  // nothing acts there
  }
}

}  // namespace bramah
