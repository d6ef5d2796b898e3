#include "sparse/rank_lu.hpp"

#include <colamd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

namespace bramah::sparse {

std::vector<std::int64_t> fill_reducing_order(const CscView& a) {
  const std::int64_t entries = a.start[a.columns];
  const std::size_t length = colamd_l_recommended(entries, a.rows, a.columns);
  std::vector<SuiteSparse_long> work(std::max<std::size_t>(length, 1)), start(a.start, a.start + a.columns + 1);
  std::copy(a.row, a.row + entries, work.begin());
  double knobs[COLAMD_KNOBS];
  colamd_l_set_defaults(knobs);
  SuiteSparse_long stats[COLAMD_STATS];
  std::vector<std::int64_t> order(static_cast<std::size_t>(a.columns));
  if (colamd_l(a.rows, a.columns, static_cast<SuiteSparse_long>(length), work.data(), start.data(), knobs, stats) ==
      0) {
    std::iota(order.begin(), order.end(), 0);
    return order;
  }
  std::copy(start.begin(), start.end() - 1, order.begin());
  return order;
}

Singletons find_singletons(const CscView& a, std::int64_t count, const RankLuOptions& options) {
  const auto rows = static_cast<std::size_t>(a.rows), columns = static_cast<std::size_t>(count);
  // Of each row how many columns are left, and the sum of their numbers: the column itself where one is left.
  std::vector<std::int64_t> left(rows, 0), sum(rows, 0), single;
  for (std::int64_t j = 0; j < a.columns; ++j) {
    for (std::int64_t e = a.start[j]; e < a.start[j + 1]; ++e) {
      ++left[static_cast<std::size_t>(a.row[e])];
      sum[static_cast<std::size_t>(a.row[e])] += j;
    }
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (left[i] == 1) single.push_back(static_cast<std::int64_t>(i));
  }
  const auto class_of = [&](std::int64_t row) {
    return options.row_class.empty() ? 0 : options.row_class[static_cast<std::size_t>(row)];
  };
  const auto is_pivot = [&](std::int64_t row, std::int64_t column) {
    double own = 0.0, largest = 0.0;
    for (std::int64_t e = a.start[column]; e < a.start[column + 1]; ++e) {
      if (class_of(a.row[e]) < class_of(row) && a.value[e] != 0.0) return false;
      largest = std::max(largest, std::abs(a.value[e]));
      if (a.row[e] == row) own = std::abs(a.value[e]);
    }
    return own > 0.0 && own >= options.threshold * largest;
  };
  Singletons result;
  std::vector<bool> taken(columns, false);
  for (std::size_t next = 0; next < single.size(); ++next) {
    const std::int64_t row = single[next];
    if (left[static_cast<std::size_t>(row)] != 1) continue;
    const std::int64_t column = sum[static_cast<std::size_t>(row)];
    if (column >= count || !is_pivot(row, column)) continue;
    taken[static_cast<std::size_t>(column)] = true;
    result.columns.push_back(column);
    for (std::int64_t e = a.start[column]; e < a.start[column + 1]; ++e) {
      const auto other = static_cast<std::size_t>(a.row[e]);
      sum[other] -= column;
      if (--left[other] == 1) single.push_back(a.row[e]);
    }
  }
  for (std::int64_t j = 0; j < count; ++j) {
    if (!taken[static_cast<std::size_t>(j)]) result.others.push_back(j);
  }
  return result;
}
bool RankLu::factor(const CscView& a, const RankLuOptions& options) {
  rows_ = a.rows;
  columns_ = a.columns;
  const auto rows = static_cast<std::size_t>(rows_);
  pivot_rows_.clear();
  pivot_columns_.clear();
  dependent_columns_.clear();
  dependent_u_.clear();
  l_start_.assign(1, 0);
  u_start_.assign(1, 0);
  l_row_.clear();
  l_value_.clear();
  u_position_.clear();
  u_value_.clear();
  diagonal_.clear();
  pivot_of_row_.assign(rows, -1);
  smallest_accepted_ = 1.0;
  largest_refused_ = 0.0;

  const std::vector<std::int64_t> order = options.order.empty()
                                              ? fill_reducing_order(a)
                                              : std::vector<std::int64_t>(options.order.begin(), options.order.end());
  std::vector<double> work(rows, 0.0);
  std::vector<std::int64_t> mark(rows, -1), pattern, topological;
  std::vector<std::pair<std::int64_t, std::int64_t>> stack;  // row, next child
  std::vector<std::int64_t> row_count(rows, 0);              // columns to come: the tie-break among good pivots
  for (std::int64_t e = 0; e < a.start[a.columns]; ++e) ++row_count[static_cast<std::size_t>(a.row[e])];

  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::int64_t column = order[place];
    const bool is_late = options.late >= 0 && static_cast<std::int64_t>(place) >= options.late;
    const std::span<const int> row_class = is_late ? options.late_row_class : options.row_class;
    // Pattern of L^-1 a_j: rows reached from the column's entries through the columns of L, in topological order.
    pattern.clear();
    topological.clear();
    double norm = 0.0;
    for (std::int64_t e = a.start[column]; e < a.start[column + 1]; ++e) {
      norm = std::max(norm, std::abs(a.value[e]));
      if (mark[static_cast<std::size_t>(a.row[e])] == column) continue;
      stack.emplace_back(a.row[e], 0);
      mark[static_cast<std::size_t>(a.row[e])] = column;
      while (!stack.empty()) {
        auto& [row, next] = stack.back();
        const std::int64_t k = pivot_of_row_[static_cast<std::size_t>(row)];
        if (k < 0) {
          pattern.push_back(row);
          stack.pop_back();
          continue;
        }
        const auto position = static_cast<std::size_t>(k);
        bool descended = false;
        for (std::int64_t p = l_start_[position] + next; p < l_start_[position + 1]; ++p) {
          ++next;
          const std::int64_t child = l_row_[static_cast<std::size_t>(p)];
          if (mark[static_cast<std::size_t>(child)] == column) continue;
          mark[static_cast<std::size_t>(child)] = column;
          stack.emplace_back(child, 0);
          descended = true;
          break;
        }
        if (descended) continue;
        topological.push_back(k);
        stack.pop_back();
      }
    }
    for (std::int64_t e = a.start[column]; e < a.start[column + 1]; ++e)
      work[static_cast<std::size_t>(a.row[e])] = a.value[e];
    // NOLINTNEXTLINE(modernize-loop-convert): clang 14 cannot read the ranges of GCC's library
    for (auto it = topological.rbegin(); it != topological.rend(); ++it) {
      const auto k = static_cast<std::size_t>(*it);
      const double u = work[static_cast<std::size_t>(pivot_rows_[k])];
      if (u == 0.0) continue;
      for (std::int64_t p = l_start_[k]; p < l_start_[k + 1]; ++p) {
        work[static_cast<std::size_t>(l_row_[static_cast<std::size_t>(p)])] -=
            u * l_value_[static_cast<std::size_t>(p)];
      }
    }

    // Pivot: lowest class first, then within the threshold the row that fewest columns still need, then the first.
    std::int64_t pivot = -1;
    double largest = 0.0;
    const auto class_of = [&](std::int64_t row) {
      return row_class.empty() ? 0 : row_class[static_cast<std::size_t>(row)];
    };
    int lowest = std::numeric_limits<int>::max();
    for (const std::int64_t row : pattern) {
      const double size = std::abs(work[static_cast<std::size_t>(row)]);
      largest = std::max(largest, size);
      if (size > options.rank_tolerance * norm) lowest = std::min(lowest, class_of(row));
    }
    double candidate = 0.0;
    for (const std::int64_t row : pattern) {
      if (class_of(row) == lowest) candidate = std::max(candidate, std::abs(work[static_cast<std::size_t>(row)]));
    }
    for (const std::int64_t row : pattern) {
      if (class_of(row) != lowest || std::abs(work[static_cast<std::size_t>(row)]) < options.threshold * candidate)
        continue;
      const auto better = [&](std::int64_t r) { return std::pair{row_count[static_cast<std::size_t>(r)], r}; };
      if (pivot < 0 || better(row) < better(pivot)) pivot = row;
    }
    const bool accepted = pivot >= 0 && largest > options.rank_tolerance * norm && norm > 0.0;
    if (accepted) {
      smallest_accepted_ = std::min(smallest_accepted_, candidate / norm);
      for (const std::int64_t k : topological) {
        u_position_.push_back(k);
        u_value_.push_back(work[static_cast<std::size_t>(pivot_rows_[static_cast<std::size_t>(k)])]);
      }
      const double value = work[static_cast<std::size_t>(pivot)];
      for (const std::int64_t row : pattern) {
        if (row == pivot) continue;
        const double l = work[static_cast<std::size_t>(row)] / value;
        if (l == 0.0) continue;
        l_row_.push_back(row);
        l_value_.push_back(l);
      }
      pivot_of_row_[static_cast<std::size_t>(pivot)] = static_cast<std::int64_t>(pivot_rows_.size());
      pivot_rows_.push_back(pivot);
      pivot_columns_.push_back(column);
      diagonal_.push_back(value);
      l_start_.push_back(static_cast<std::int64_t>(l_row_.size()));
      u_start_.push_back(static_cast<std::int64_t>(u_position_.size()));
      if (l_start_.back() + u_start_.back() > options.most_entries) return false;
    } else {
      if (norm > 0.0) largest_refused_ = std::max(largest_refused_, largest / norm);
      dependent_columns_.push_back(column);
      auto& u = dependent_u_.emplace_back();
      for (const std::int64_t k : topological)
        u.emplace_back(k, work[static_cast<std::size_t>(pivot_rows_[static_cast<std::size_t>(k)])]);
    }
    for (std::int64_t e = a.start[column]; e < a.start[column + 1]; ++e)
      --row_count[static_cast<std::size_t>(a.row[e])];
    for (const std::int64_t row : pattern) work[static_cast<std::size_t>(row)] = 0.0;
    for (const std::int64_t k : topological)
      work[static_cast<std::size_t>(pivot_rows_[static_cast<std::size_t>(k)])] = 0.0;
  }
  return true;
}

double RankLu::growth() const {
  double largest = 1.0;
  for (const double l : l_value_) largest = std::max(largest, std::abs(l));
  return largest;
}

std::vector<Dependency> RankLu::dependencies() const {
  // A[:, dependent] = L u and A[:, pivots] = L U, hence U c = u: back substitution over the positions that u reaches.
  std::vector<Dependency> all;
  std::vector<double> c(pivot_rows_.size(), 0.0);
  std::vector<bool> reached(pivot_rows_.size(), false);
  std::priority_queue<std::int64_t> positions;
  const auto add = [&](std::int64_t position, double value) {
    const auto at = static_cast<std::size_t>(position);
    c[at] += value;
    if (reached[at]) return;
    reached[at] = true;
    positions.push(position);
  };
  for (const auto& u : dependent_u_) {
    Dependency& dependency = all.emplace_back();
    for (const auto& [position, value] : u) add(position, value);
    while (!positions.empty()) {
      const auto k = static_cast<std::size_t>(positions.top());
      positions.pop();
      const double value = std::exchange(c[k], 0.0) / diagonal_[k];
      reached[k] = false;
      if (value == 0.0) continue;
      dependency.emplace_back(pivot_columns_[k], value);
      for (std::int64_t p = u_start_[k]; p < u_start_[k + 1]; ++p)
        add(u_position_[static_cast<std::size_t>(p)], -u_value_[static_cast<std::size_t>(p)] * value);
    }
    std::reverse(dependency.begin(), dependency.end());
  }
  return all;
}

void RankLu::solve(std::span<const double> b, std::span<double> x) const {
  std::vector<double> work(b.begin(), b.end());
  const std::size_t rank = pivot_rows_.size();
  for (std::size_t k = 0; k < rank; ++k) {
    const double y = work[static_cast<std::size_t>(pivot_rows_[k])];
    if (y == 0.0) continue;
    for (std::int64_t p = l_start_[k]; p < l_start_[k + 1]; ++p) {
      work[static_cast<std::size_t>(l_row_[static_cast<std::size_t>(p)])] -= y * l_value_[static_cast<std::size_t>(p)];
    }
  }
  std::fill(x.begin(), x.end(), 0.0);
  for (std::size_t k = rank; k-- > 0;) {
    const double value = work[static_cast<std::size_t>(pivot_rows_[k])] / diagonal_[k];
    x[static_cast<std::size_t>(pivot_columns_[k])] = value;
    if (value == 0.0) continue;
    for (std::int64_t p = u_start_[k]; p < u_start_[k + 1]; ++p) {
      work[static_cast<std::size_t>(pivot_rows_[static_cast<std::size_t>(u_position_[static_cast<std::size_t>(p)])])] -=
          u_value_[static_cast<std::size_t>(p)] * value;
    }
  }
}

void RankLu::solve_transposed(std::span<const double> c, std::span<double> y) const {
  const std::size_t rank = pivot_rows_.size();
  std::vector<double> w(rank);
  for (std::size_t k = 0; k < rank; ++k) {  // U^T w = c
    double sum = c[static_cast<std::size_t>(pivot_columns_[k])];
    for (std::int64_t p = u_start_[k]; p < u_start_[k + 1]; ++p) {
      sum -=
          u_value_[static_cast<std::size_t>(p)] * w[static_cast<std::size_t>(u_position_[static_cast<std::size_t>(p)])];
    }
    w[k] = sum / diagonal_[k];
  }
  std::fill(y.begin(), y.end(), 0.0);
  for (std::size_t k = rank; k-- > 0;) {  // L^T y = w
    double sum = w[k];
    for (std::int64_t p = l_start_[k]; p < l_start_[k + 1]; ++p) {
      sum -= l_value_[static_cast<std::size_t>(p)] * y[static_cast<std::size_t>(l_row_[static_cast<std::size_t>(p)])];
    }
    y[static_cast<std::size_t>(pivot_rows_[k])] = sum;
  }
}

}  // namespace bramah::sparse
