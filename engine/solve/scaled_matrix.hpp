// A Newton matrix in the machine's own sizes, factored so that its rank shows.
//
// Columns are multiplied by the sizes of their unknowns, rows then divided by their largest entry: ranks and pivots depend
// on no unit.
#pragma once

#include <span>
#include <vector>

#include "sparse/rank_lu.hpp"
#include "system/blocks.hpp"

namespace bramah {

class ScaledMatrix {
 public:
  ScaledMatrix() = default;
  explicit ScaledMatrix(SparsePlan plan);

  /// Takes the values of `blocks`, as they are.
  void fill(const Blocks& blocks, std::span<const double> weights);
  /// Scales what `fill` took; `sizes` (columns): of the unknowns.
  void scale(std::span<const double> sizes);
  /// `rank_tolerance`: relative to a scaled column.
  void factor(double rank_tolerance = sparse::RankLuOptions{}.rank_tolerance);
  /// Solves A step = -residual after factor: `residual` (rows) in SI, `step` (columns) in sizes of the unknowns; zero at
  /// columns that depend on others.
  void solve(std::span<const double> residual, std::span<double> step);

  /// Visits every entry as function(row, column, value), values in SI; before and after scale.
  template <class Function>
  void each_entry(Function&& function) const {
    for (std::size_t j = 0; j + 1 < plan_.start().size(); ++j) {
      for (Index e = plan_.start()[j]; e < plan_.start()[j + 1]; ++e) {
        const auto at = static_cast<std::size_t>(e);
        function(static_cast<std::size_t>(plan_.row()[at]), j, plan_.values()[at]);
      }
    }
  }

  [[nodiscard]] Index rows() const { return plan_.rows(); }
  [[nodiscard]] Index columns() const { return plan_.columns(); }
  /// (rows) one over the largest scaled entry; 0 where the row has none.
  [[nodiscard]] const Vector& row_scale() const { return row_scale_; }
  [[nodiscard]] const sparse::RankLu& lu() const { return lu_; }
  /// The scaled matrix, as it is factored.
  [[nodiscard]] sparse::CscView view() const {
    return {plan_.rows(), plan_.columns(), plan_.start().data(), plan_.row().data(), scaled_.data()};
  }

 private:
  SparsePlan plan_;
  sparse::RankLu lu_;
  std::vector<Index> order_;
  Vector row_scale_, scaled_, rhs_;
};

/// Multipliers have no nominal. The size of one is its own value, or what the forces of the coordinates that it acts on are
/// worth: their terms and stiffnesses, all as work along a nominal. The first nominal.size() rows of `matrix` are forces, of
/// coordinates with these nominals and terms of these sizes; the last lambda.size() of `sizes` are set, the others are read.
/// `instead`: where the machine has no force at all.
void size_multipliers(const ScaledMatrix& matrix, std::span<const double> nominal, std::span<const double> terms,
                      std::span<const double> lambda, double instead, std::span<double> sizes);

}  // namespace bramah
