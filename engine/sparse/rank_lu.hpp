// Rank-revealing sparse LU of a rectangular matrix, left-looking with threshold partial pivoting (Gilbert, Peierls 1988).
//
//   A Q = L U on the pivot rows: columns are taken in a given order; each column picks its pivot among the rows that no
//   column before it has taken. A column without an acceptable pivot depends on those before it and is left out.
//
// On the scaled transpose of a constraint matrix D the pivot rows are the dependent coordinates, the columns left out are
// redundant constraints, and the factors give the linear dependency behind each. On a Newton matrix the columns left out
// are free directions. |L| is bounded by 1/threshold, so T = -L2 L1^-1 stays small however large the system.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sparse/csc.hpp"

namespace bramah::sparse {

struct RankLuOptions {
  double threshold = 0.5;                    // a pivot is at least this part of the largest candidate
  double rank_tolerance = 1e-9;              // relative to the column's own norm: below it, the column is dependent
  std::span<const std::int64_t> order = {};  // columns in the order of elimination; empty: COLAMD
  std::span<const int> row_class = {};       // rows of a higher class are pivots only where no lower class serves
  std::int64_t late = -1;                    // columns from this place of the order on go by late_row_class; -1: none
  std::span<const int> late_row_class = {};
  std::int64_t most_entries = std::numeric_limits<std::int64_t>::max();  // of L and U: beyond them factor gives up
};

/// Fill-reducing order of all columns for LU with row pivoting: COLAMD.
std::vector<std::int64_t> fill_reducing_order(const CscView& a);

/// The first `count` columns: those that cause no fill, in an order of elimination, and the others as they stand.
struct Singletons {
  std::vector<std::int64_t> columns, others;
};
/// Takes a column that alone has an entry in some row, if that entry is an acceptable pivot; then again in what is left.
/// Open chains are taken whole, from their tips inward. No column taken so has entries in the pivot rows before it.
Singletons find_singletons(const CscView& a, std::int64_t count, const RankLuOptions& options = {});

/// A column as a combination of pivot columns: (column, coefficient).
using Dependency = std::vector<std::pair<std::int64_t, double>>;

class RankLu {
 public:
  /// Factors `a`; the pattern of the factors is found on the way. False: they have more than options.most_entries.
  bool factor(const CscView& a, const RankLuOptions& options = {});

  [[nodiscard]] std::int64_t rank() const { return static_cast<std::int64_t>(pivot_columns_.size()); }
  /// Row and column of pivot k, in the order of elimination.
  [[nodiscard]] const std::vector<std::int64_t>& pivot_rows() const { return pivot_rows_; }
  [[nodiscard]] const std::vector<std::int64_t>& pivot_columns() const { return pivot_columns_; }
  /// Columns without a pivot, in the order of elimination.
  [[nodiscard]] const std::vector<std::int64_t>& dependent_columns() const { return dependent_columns_; }
  /// Smallest accepted and largest refused pivot, relative to their columns' norms: the gap that decided the rank.
  [[nodiscard]] double smallest_accepted() const { return smallest_accepted_; }
  [[nodiscard]] double largest_refused() const { return largest_refused_; }
  /// max |L|: growth of the eliminated rows, hence of T = -L2 L1^-1.
  [[nodiscard]] double growth() const;

  /// For every dependent column:  column(dependent k) = sum of coefficient * column(pivot column).
  [[nodiscard]] std::vector<Dependency> dependencies() const;

  /// Solves the pivot rows and columns of A x = b: x (columns) is zero at dependent columns, b (rows) is read only.
  void solve(std::span<const double> b, std::span<double> x) const;
  /// Solves A^T y = c on the pivots: y (rows) is zero at rows without pivot.
  void solve_transposed(std::span<const double> c, std::span<double> y) const;

 private:
  std::int64_t rows_ = 0, columns_ = 0;
  std::vector<std::int64_t> pivot_rows_, pivot_columns_, dependent_columns_;
  std::vector<std::int64_t> pivot_of_row_;  // (rows) position of the pivot in this row, or -1
  // L by columns with a unit diagonal that is not stored, rows as in A; U by columns, rows as pivot positions.
  std::vector<std::int64_t> l_start_, l_row_, u_start_, u_position_;
  std::vector<double> l_value_, u_value_, diagonal_;
  std::vector<std::vector<std::pair<std::int64_t, double>>> dependent_u_;  // U columns of dependent columns
  double smallest_accepted_ = 1.0, largest_refused_ = 0.0;
};

}  // namespace bramah::sparse
