// Batch evaluation of balances and outputs: rows, their exact partials, and the derivatives of both along a direction.
//
// Partials come in passes of a few seeds: the width that stays in registers. One code serves both evaluations; they
// differ in the scalar and in which part of a result leaves.
#pragma once

#include <cstdint>
#include <cstring>

#include "bramah/local.hpp"

namespace bramah::detail {

/// The rows and partials themselves.
struct Exact {
  using Plain = Real;
  using Seeded = Dual<8>;
  static constexpr std::size_t width = 8;
};
/// Their derivatives by eps.
struct AlongDirection {
  using Plain = Epsilon<Real>;
  using Seeded = Epsilon<Dual<4>>;
  static constexpr std::size_t width = 4;
};

// What leaves: a row, and its derivative by the column in lane `lane`.
BRAMAH_INLINE double result(const Real& a) { return a.value(); }
template <std::size_t N>
BRAMAH_INLINE double result(const Dual<N>& a) {
  return a.value();
}
template <class T>
BRAMAH_INLINE double result(const Epsilon<T>& a) {
  return result(a.d);
}
template <std::size_t N>
BRAMAH_INLINE double slope(const Dual<N>& a, std::size_t lane) {
  return a.derivative(lane);
}
template <class T>
BRAMAH_INLINE double slope(const Epsilon<T>& a, std::size_t lane) {
  return slope(a.d, lane);
}
template <std::size_t N>
BRAMAH_INLINE void seed(Dual<N>& a, std::size_t lane, double one) {
  a.set_derivative(lane, one);
}
template <class T>
BRAMAH_INLINE void seed(Epsilon<T>& a, std::size_t lane, double one) {
  seed(a.v, lane, one);
}

/// Which columns have entries in wanted blocks: what gets a seed.
struct Columns {
  struct Column {
    std::uint16_t family, index;
  };
  Column list[most_columns];
  std::size_t count = 0;

  void add(std::size_t family, std::size_t index) {
    list[count++] = {static_cast<std::uint16_t>(family), static_cast<std::uint16_t>(index)};
  }
};

inline bool has_entries(const bramah_batch& b, int block, std::size_t column) {
  const bramah_pattern& p = b.patterns[block];
  return p.count > 0 && p.start[column + 1] > p.start[column];
}
inline bool wanted(const bramah_batch& b, int block) {
  return b.partials[block] != nullptr && b.patterns[block].count > 0;
}
inline double* record(const bramah_batch& b, int block, std::size_t i) {
  return b.partials[block] + static_cast<int64_t>(i) * b.patterns[block].count;
}

/// Writes column `column` of a block from lane `lane` of the rows' duals, scaled; rows are counted from `first_row`.
template <class S>
void write_column(const bramah_batch& b, int block, std::size_t i, std::size_t column, const S* rows,
                  std::size_t row_count, std::size_t first_row, std::size_t lane, double scale = 1.0) {
  if (!wanted(b, block)) return;
  const bramah_pattern& p = b.patterns[block];
  double* out = record(b, block, i);
  for (std::int32_t e = p.start[column]; e < p.start[column + 1]; ++e) {
    const auto row = static_cast<std::size_t>(p.row[e]);
    if (row >= first_row && row < first_row + row_count) out[e] = scale * slope(rows[row - first_row], lane);
  }
}

inline Columns seeded_columns(const bramah_type& type, const bramah_batch& b, const BlockPair (&blocks)[families]) {
  Columns columns;
  for (std::size_t family = 0; family < families; ++family) {
    for (std::size_t j = 0; j < family_size(type, family); ++j) {
      const auto needs = [&](int block) { return block >= 0 && wanted(b, block) && has_entries(b, block, j); };
      if (needs(blocks[family].first) || needs(blocks[family].second)) columns.add(family, j);
    }
  }
  return columns;
}

/// Evaluates `law(at, first, second)` for every instance: values into first_out and second_out, partials into blocks.
/// Serves balances (rows f and g) and outputs (rows y and none).
template <class C, class As, class Law>
void evaluate_rows(const bramah_type& type, const bramah_batch& b, const bramah_direction& along,
                   const BlockPair (&blocks)[families], std::size_t first_count, std::size_t second_count,
                   double* first_out, double* second_out, const Law& law) {
  using Seeded = typename As::Seeded;
  constexpr std::size_t width = As::width;
  const Columns columns = seeded_columns(type, b, blocks);
  const auto* instances = static_cast<const C*>(b.instances);
  const auto store = [&](const auto* rows, std::size_t i) {
    for (std::size_t r = 0; first_out != nullptr && r < first_count; ++r) {
      first_out[i * first_count + r] = result(rows[r]);
    }
    for (std::size_t r = 0; second_out != nullptr && r < second_count; ++r) {
      second_out[i * second_count + r] = result(rows[first_count + r]);
    }
  };
  for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
    if (columns.count == 0) {
      using T = typename As::Plain;
      Local<T> local(type, b, along, i);
      T rows[most_columns];
      for (std::size_t r = 0; r < first_count + second_count; ++r) rows[r] = T(0.0);
      law(instances[i], local.at(b.time, b.side), rows, rows + first_count);
      store(rows, i);
      continue;
    }
    Local<Seeded> local(type, b, along, i);
    const At<Seeded> at = local.at(b.time, b.side);
    Seeded rows[most_columns];
    for (std::size_t pass = 0; pass < columns.count; pass += width) {
      const std::size_t end = columns.count < pass + width ? columns.count : pass + width;
      for (std::size_t k = pass; k < end; ++k) {
        seed(local[columns.list[k].family][columns.list[k].index], k - pass, 1.0);
      }
      for (std::size_t r = 0; r < first_count + second_count; ++r) rows[r] = Seeded(0.0);
      law(instances[i], at, rows, rows + first_count);
      for (std::size_t k = pass; k < end; ++k) {
        const auto [family, index] = columns.list[k];
        if (blocks[family].first >= 0) {
          write_column(b, blocks[family].first, i, index, rows, first_count, 0, k - pass);
        }
        if (blocks[family].second >= 0) {
          write_column(b, blocks[family].second, i, index, rows + first_count, second_count, 0, k - pass);
        }
        seed(local[family][index], k - pass, 0.0);
      }
    }
    store(rows, i);
  }
}

}  // namespace bramah::detail
