// From a component struct to the C border: tables, configuration, structure and batch evaluation with exact partials.
//
// Partials come in passes of eight seeds (Dual<8>): the width that stays in registers. Constraint rows ride on series in
// time, so that one pass yields c, cdot, cddot and their partials; d(D^T lambda)/dx takes one direction at a time.
#pragma once

#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include "bramah/describe.hpp"
#include "bramah/rows.hpp"

namespace bramah::detail {

inline constexpr std::size_t width = 8;
inline constexpr std::size_t most_columns = 256;  // 3 nx + 2 nz + nu + multipliers of one component
using Seeded = Dual<width>;

template <class C>
concept HasBalance = requires(const C& c, const At<double>& at, Rows<double>& rows) {
  c.balance(at, rows);
};
template <class C>
concept HasHolonomic = requires(const C& c, const Positions<double>& at, Values<double>& rows) {
  c.holonomic(at, rows);
};
template <class C>
concept HasNonholonomic = requires(const C& c, const Motion<double>& at, Values<double>& rows) {
  c.nonholonomic(at, rows);
};
template <class C>
concept HasOutput = requires(const C& c, const At<double>& at, Values<double>& y) {
  c.output(at, y);
};
template <class C>
concept HasSwitches = requires(const C& c, const At<double>& at, Values<double>& y) {
  c.switches(at, y);
};
template <class C>
concept HasCheck = requires(const C& c, Faults& faults) {
  c.check(faults);
};
template <class C>
concept HasStart = requires(const C& c, Start& start) {
  c.start(start);
};
template <class C>
concept HasConstants = requires(const C& c, double* values) {
  c.constants(values);
};
template <class C>
concept HasSignal = requires(const C& c) {
  { c.signal(0.0, 1) } -> std::convertible_to<double>;
  { c.next_breakpoint(0.0) } -> std::convertible_to<double>;
};

/// What the border knows of one component type: its tables and the C struct that points into them.
struct TypeEntry {
  TypeTables tables;
  bramah_type type{};
};

// Families of columns in one evaluation, in the order of their storage.
enum Family : std::size_t { X, V, A, Z, ZDOT, U, LAMBDA, families };

/// Local values of one instance on the scalar T, all families after one another.
template <class T>
struct Local {
  T values[most_columns];
  std::size_t start[families + 1];

  explicit Local(const bramah_type& type) {
    const auto nx = static_cast<std::size_t>(type.nx), nz = static_cast<std::size_t>(type.nz);
    const std::size_t counts[families] = {
        nx,
        nx,
        nx,
        nz,
        nz,
        static_cast<std::size_t>(type.nu),
        static_cast<std::size_t>(type.holonomic_count) + static_cast<std::size_t>(type.nonholonomic_count)};
    start[0] = 0;
    for (std::size_t f = 0; f < families; ++f) start[f + 1] = start[f] + counts[f];
  }
  void load(std::size_t family, const double* from, std::size_t record) {
    const std::size_t count = start[family + 1] - start[family];
    for (std::size_t k = 0; k < count; ++k) {
      values[start[family] + k] = T(from == nullptr ? 0.0 : from[record * count + k]);
    }
  }
  [[nodiscard]] T* operator[](std::size_t family) { return values + start[family]; }
};

template <class T>
At<T> look(Local<T>& local, const bramah_batch& b) {
  return At<T>(local[X], local[V], local[A], local[Z], local[ZDOT], local[U], local[LAMBDA], T(b.time), b.side);
}

inline void load_all(auto& local, const bramah_batch& b, std::size_t i) {
  local.load(X, b.x, i);
  local.load(V, b.v, i);
  local.load(A, b.a, i);
  local.load(Z, b.z, i);
  local.load(ZDOT, b.zdot, i);
  local.load(U, b.u, i);
  local.load(LAMBDA, b.lambda, i);
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
inline void write_column(const bramah_batch& b, int block, std::size_t i, std::size_t column, const Seeded* rows,
                         std::size_t row_count, std::size_t first_row, std::size_t lane, double scale = 1.0) {
  if (!wanted(b, block)) return;
  const bramah_pattern& p = b.patterns[block];
  double* out = record(b, block, i);
  for (std::int32_t e = p.start[column]; e < p.start[column + 1]; ++e) {
    const auto row = static_cast<std::size_t>(p.row[e]);
    if (row >= first_row && row < first_row + row_count) out[e] = scale * rows[row - first_row].derivative(lane);
  }
}

struct BlockPair {  // the two row groups of a balance that a family of columns meets; -1 where there is no such block
  int first, second;
};
inline constexpr BlockPair balance_blocks[families] = {
    {BRAMAH_F_X, BRAMAH_G_X}, {BRAMAH_F_V, BRAMAH_G_V}, {BRAMAH_F_A, -1}, {BRAMAH_F_Z, BRAMAH_G_Z},
    {-1, BRAMAH_G_ZDOT},      {BRAMAH_F_U, BRAMAH_G_U}, {-1, -1}};
inline constexpr BlockPair output_blocks[families] = {{BRAMAH_Y_X, -1},     {BRAMAH_Y_V, -1}, {BRAMAH_Y_A, -1},
                                                      {BRAMAH_Y_Z, -1},     {-1, -1},         {BRAMAH_Y_U, -1},
                                                      {BRAMAH_Y_LAMBDA, -1}};

inline std::size_t family_size(const bramah_type& t, std::size_t family) {
  switch (family) {
    case X:
    case V:
    case A: return static_cast<std::size_t>(t.nx);
    case Z:
    case ZDOT: return static_cast<std::size_t>(t.nz);
    case U: return static_cast<std::size_t>(t.nu);
    default: return static_cast<std::size_t>(t.holonomic_count) + static_cast<std::size_t>(t.nonholonomic_count);
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
template <class C, class Law>
void evaluate_rows(const bramah_type& type, const bramah_batch& b, const BlockPair (&blocks)[families],
                   std::size_t first_count, std::size_t second_count, double* first_out, double* second_out,
                   const Law& law) {
  const Columns columns = seeded_columns(type, b, blocks);
  const auto* instances = static_cast<const C*>(b.instances);
  for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
    if (columns.count == 0) {
      Local<double> local(type);
      load_all(local, b, i);
      double rows[most_columns] = {};
      law(instances[i], look(local, b), rows, rows + first_count);
      if (first_out != nullptr) std::memcpy(first_out + i * first_count, rows, first_count * sizeof(double));
      if (second_out != nullptr)
        std::memcpy(second_out + i * second_count, rows + first_count, second_count * sizeof(double));
      continue;
    }
    Local<Seeded> local(type);
    load_all(local, b, i);
    const At<Seeded> at = look(local, b);
    Seeded rows[most_columns];
    for (std::size_t pass = 0; pass < columns.count; pass += width) {
      const std::size_t end = columns.count < pass + width ? columns.count : pass + width;
      for (std::size_t k = pass; k < end; ++k) {
        local[columns.list[k].family][columns.list[k].index].set_derivative(k - pass, 1.0);
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
        local[family][index].set_derivative(k - pass, 0.0);
      }
    }
    for (std::size_t r = 0; first_out != nullptr && r < first_count; ++r)
      first_out[i * first_count + r] = rows[r].value();
    for (std::size_t r = 0; second_out != nullptr && r < second_count; ++r) {
      second_out[i * second_count + r] = rows[first_count + r].value();
    }
  }
}

// ---- constraint rows -------------------------------------------------------------------------------------------------

/// x(t), v(t) of one instance as series, optionally seeded.
template <class S>
struct Path {
  S x[most_columns], v[most_columns];
};

template <class T>
void series_of(Taylor<T, 2>& s, double x, double v, double a) {
  s.c[0] = T(x);
  s.c[1] = T(v);
  s.c[2] = T(0.5 * a);
}
template <class T>
void series_of(Taylor<T, 1>& s, double x, double v, double) {
  s.c[0] = T(x);
  s.c[1] = T(v);
}
template <class S>
S clock(double t) {
  S time(t);
  time.c[1] = 1.0;
  return time;
}
inline double number(const double* from, std::size_t k) { return from == nullptr ? 0.0 : from[k]; }

template <class C>
void evaluate_holonomic(const bramah_type& type, const bramah_batch& b) {
  const auto nx = static_cast<std::size_t>(type.nx), mh = static_cast<std::size_t>(type.holonomic_count);
  const std::size_t rows_all = mh + static_cast<std::size_t>(type.nonholonomic_count);
  const auto* instances = static_cast<const C*>(b.instances);
  const bool gradients = wanted(b, BRAMAH_C_X) || wanted(b, BRAMAH_R_V);
  const bool curvature = wanted(b, BRAMAH_R_X) || wanted(b, BRAMAH_S_X) || wanted(b, BRAMAH_S_V);
  const bool values = b.c != nullptr || b.r != nullptr || b.s != nullptr;

  Columns curved, straight;  // coordinates that enter nonlinearly, and the others
  for (std::size_t j = 0; j < nx; ++j) {
    if (has_entries(b, BRAMAH_R_X, j) || has_entries(b, BRAMAH_L_X, j)) {
      curved.add(X, j);
    } else if (has_entries(b, BRAMAH_C_X, j) || has_entries(b, BRAMAH_R_V, j)) {
      straight.add(X, j);
    }
  }

  for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
    const C& component = instances[i];
    const double *x = b.x + i * nx, *v = b.v == nullptr ? nullptr : b.v + i * nx,
                 *a = b.a == nullptr ? nullptr : b.a + i * nx;
    const auto store_values = [&](std::size_t row, double c0, double c1, double c2) {
      if (b.c != nullptr) b.c[i * mh + row] = c0;
      if (b.r != nullptr) b.r[i * rows_all + row] = c1;
      if (b.s != nullptr) b.s[i * rows_all + row] = 2.0 * c2;
    };

    if (curvature) {
      using S = Taylor<Seeded, 2>;
      S q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) series_of(q[j], x[j], number(v, j), number(a, j));
      for (std::size_t pass = 0; pass < curved.count; pass += width) {
        const std::size_t end = curved.count < pass + width ? curved.count : pass + width;
        for (std::size_t k = pass; k < end; ++k) q[curved.list[k].index].c[0].set_derivative(k - pass, 1.0);
        for (std::size_t row = 0; row < mh; ++row) c[row] = S(0.0);
        Values<S> out(c);
        component.holonomic(Positions<S>(q, clock<S>(b.time), b.side), out);
        Seeded level[3][most_columns];
        for (std::size_t row = 0; row < mh; ++row) {
          for (std::size_t order = 0; order < 3; ++order) level[order][row] = c[row].c[order];
        }
        for (std::size_t k = pass; k < end; ++k) {
          const std::size_t j = curved.list[k].index;
          write_column(b, BRAMAH_C_X, i, j, level[0], mh, 0, k - pass);
          write_column(b, BRAMAH_R_V, i, j, level[0], mh, 0, k - pass);
          write_column(b, BRAMAH_R_X, i, j, level[1], mh, 0, k - pass);
          write_column(b, BRAMAH_S_V, i, j, level[1], mh, 0, k - pass, 2.0);  // d(cddot)/dv = 2 d(cdot)/dx
          write_column(b, BRAMAH_S_X, i, j, level[2], mh, 0, k - pass, 2.0);
          q[j].c[0].set_derivative(k - pass, 0.0);
        }
        if (pass == 0) {
          for (std::size_t row = 0; row < mh; ++row) {
            store_values(row, level[0][row].value(), level[1][row].value(), level[2][row].value());
          }
        }
      }
    }
    if (gradients) {
      Seeded q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) q[j] = Seeded(x[j]);
      const auto sweep = [&](const Columns& columns) {
        for (std::size_t pass = 0; pass < columns.count; pass += width) {
          const std::size_t end = columns.count < pass + width ? columns.count : pass + width;
          for (std::size_t k = pass; k < end; ++k) q[columns.list[k].index].set_derivative(k - pass, 1.0);
          for (std::size_t row = 0; row < mh; ++row) c[row] = Seeded(0.0);
          Values<Seeded> out(c);
          component.holonomic(Positions<Seeded>(q, Seeded(b.time), b.side), out);
          for (std::size_t k = pass; k < end; ++k) {
            const std::size_t j = columns.list[k].index;
            write_column(b, BRAMAH_C_X, i, j, c, mh, 0, k - pass);
            write_column(b, BRAMAH_R_V, i, j, c, mh, 0, k - pass);
            q[j].set_derivative(k - pass, 0.0);
          }
        }
      };
      sweep(straight);
      if (!curvature) sweep(curved);
    }
    if (values && !(curvature && curved.count > 0)) {
      using S = Taylor<double, 2>;
      S q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) series_of(q[j], x[j], number(v, j), number(a, j));
      for (std::size_t row = 0; row < mh; ++row) c[row] = S(0.0);
      Values<S> out(c);
      component.holonomic(Positions<S>(q, clock<S>(b.time), b.side), out);
      for (std::size_t row = 0; row < mh; ++row) store_values(row, c[row].c[0], c[row].c[1], c[row].c[2]);
    }
    if (wanted(b, BRAMAH_L_X)) {
      // Row j of d(c_x^T lambda)/dx: the gradient of lambda . (c_x e_j), with c_x e_j the first-order term along x + t e_j.
      using S = Taylor<Seeded, 1>;
      const double* lambda = b.lambda + i * rows_all;
      const bramah_pattern& p = b.patterns[BRAMAH_L_X];
      double* out = record(b, BRAMAH_L_X, i);
      S q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) q[j] = S(x[j]);
      for (std::size_t pass = 0; pass < curved.count; pass += width) {
        const std::size_t end = curved.count < pass + width ? curved.count : pass + width;
        std::size_t lane_of[most_columns];
        for (std::size_t j = 0; j < nx; ++j) lane_of[j] = width;
        for (std::size_t k = pass; k < end; ++k) {
          q[curved.list[k].index].c[0].set_derivative(k - pass, 1.0);
          lane_of[curved.list[k].index] = k - pass;
        }
        for (std::size_t d = 0; d < curved.count; ++d) {
          const std::size_t along = curved.list[d].index;
          if (!has_entries(b, BRAMAH_L_X, along)) continue;
          q[along].c[1] = Seeded(1.0);
          for (std::size_t row = 0; row < mh; ++row) c[row] = S(0.0);
          Values<S> values_out(c);
          component.holonomic(Positions<S>(q, S(b.time), b.side), values_out);
          Seeded sum(0.0);
          for (std::size_t row = 0; row < mh; ++row) sum += lambda[row] * c[row].c[1];
          // The matrix is symmetric, so the row is written as the column.
          for (std::int32_t e = p.start[along]; e < p.start[along + 1]; ++e) {
            const std::size_t lane = lane_of[p.row[e]];
            if (lane < width) out[e] += sum.derivative(lane);
          }
          q[along].c[1] = Seeded(0.0);
        }
        for (std::size_t k = pass; k < end; ++k) q[curved.list[k].index].c[0].set_derivative(k - pass, 0.0);
      }
    }
  }
}

template <class C>
void evaluate_nonholonomic(const bramah_type& type, const bramah_batch& b) {
  const auto nx = static_cast<std::size_t>(type.nx), mh = static_cast<std::size_t>(type.holonomic_count);
  const auto ml = static_cast<std::size_t>(type.nonholonomic_count);
  const auto* instances = static_cast<const C*>(b.instances);
  const bool partials =
      wanted(b, BRAMAH_R_X) || wanted(b, BRAMAH_R_V) || wanted(b, BRAMAH_S_X) || wanted(b, BRAMAH_S_V);
  Columns columns;
  for (std::size_t j = 0; j < nx; ++j) {
    if (has_entries(b, BRAMAH_R_X, j) || has_entries(b, BRAMAH_S_X, j)) columns.add(X, j);
  }
  const std::size_t position_columns = columns.count;
  for (std::size_t j = 0; j < nx; ++j) {
    if (has_entries(b, BRAMAH_R_V, j) || has_entries(b, BRAMAH_S_V, j)) columns.add(V, j);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(b.count); ++i) {
    const C& component = instances[i];
    const double *x = b.x + i * nx, *v = b.v == nullptr ? nullptr : b.v + i * nx,
                 *a = b.a == nullptr ? nullptr : b.a + i * nx;
    const auto store_values = [&](std::size_t row, double b0, double b1) {
      if (b.r != nullptr) b.r[i * (mh + ml) + mh + row] = b0;
      if (b.s != nullptr) b.s[i * (mh + ml) + mh + row] = b1;
    };
    if (partials) {
      using S = Taylor<Seeded, 1>;
      S q[most_columns], w[most_columns], rows[most_columns];
      for (std::size_t j = 0; j < nx; ++j) {
        series_of(q[j], x[j], number(v, j), 0.0);
        series_of(w[j], number(v, j), number(a, j), 0.0);
      }
      for (std::size_t pass = 0; pass < columns.count; pass += width) {
        const std::size_t end = columns.count < pass + width ? columns.count : pass + width;
        const auto seed = [&](std::size_t k, double one) {
          const auto [family, j] = columns.list[k];
          if (family == X) {
            q[j].c[0].set_derivative(k - pass, one);
          } else {  // v moves both the velocity and the slope of the path
            q[j].c[1].set_derivative(k - pass, one);
            w[j].c[0].set_derivative(k - pass, one);
          }
        };
        for (std::size_t k = pass; k < end; ++k) seed(k, 1.0);
        for (std::size_t row = 0; row < ml; ++row) rows[row] = S(0.0);
        Values<S> out(rows, type.holonomic_count);  // row handles count on after the holonomic rows
        component.nonholonomic(Motion<S>(q, w, clock<S>(b.time), b.side), out);
        Seeded level[2][most_columns];
        for (std::size_t row = 0; row < ml; ++row) {
          level[0][row] = rows[row].c[0];
          level[1][row] = rows[row].c[1];
        }
        for (std::size_t k = pass; k < end; ++k) {
          const auto [family, j] = columns.list[k];
          write_column(b, family == X ? BRAMAH_R_X : BRAMAH_R_V, i, j, level[0], ml, mh, k - pass);
          write_column(b, family == X ? BRAMAH_S_X : BRAMAH_S_V, i, j, level[1], ml, mh, k - pass);
          seed(k, 0.0);
        }
        if (pass == 0) {
          for (std::size_t row = 0; row < ml; ++row) store_values(row, level[0][row].value(), level[1][row].value());
        }
      }
    } else if (b.r != nullptr || b.s != nullptr) {
      using S = Taylor<double, 1>;
      S q[most_columns], w[most_columns], rows[most_columns];
      for (std::size_t j = 0; j < nx; ++j) {
        series_of(q[j], x[j], number(v, j), 0.0);
        series_of(w[j], number(v, j), number(a, j), 0.0);
      }
      for (std::size_t row = 0; row < ml; ++row) rows[row] = S(0.0);
      Values<S> out(rows, type.holonomic_count);
      component.nonholonomic(Motion<S>(q, w, clock<S>(b.time), b.side), out);
      for (std::size_t row = 0; row < ml; ++row) store_values(row, rows[row].c[0], rows[row].c[1]);
    }
    if (wanted(b, BRAMAH_L_X)) {
      // Row j of d(B^T lambda)/dx: B e_j is b(x, e_j), because b is linear in v.
      const double* lambda = b.lambda + i * (mh + ml) + mh;
      const bramah_pattern& p = b.patterns[BRAMAH_L_X];
      double* out = record(b, BRAMAH_L_X, i);
      Seeded q[most_columns], w[most_columns], rows[most_columns];
      for (std::size_t j = 0; j < nx; ++j) {
        q[j] = Seeded(x[j]);
        w[j] = Seeded(0.0);
      }
      for (std::size_t pass = 0; pass < position_columns; pass += width) {
        const std::size_t end = position_columns < pass + width ? position_columns : pass + width;
        for (std::size_t k = pass; k < end; ++k) q[columns.list[k].index].set_derivative(k - pass, 1.0);
        for (std::size_t d = position_columns; d < columns.count; ++d) {
          const std::size_t along = columns.list[d].index;
          w[along] = Seeded(1.0);
          for (std::size_t row = 0; row < ml; ++row) rows[row] = Seeded(0.0);
          Values<Seeded> values_out(rows, type.holonomic_count);
          component.nonholonomic(Motion<Seeded>(q, w, Seeded(b.time), b.side), values_out);
          Seeded sum(0.0);
          for (std::size_t row = 0; row < ml; ++row) sum += lambda[row] * rows[row];
          for (std::size_t k = pass; k < end; ++k) {
            const std::size_t j = columns.list[k].index;
            for (std::int32_t e = p.start[j]; e < p.start[j + 1]; ++e) {
              if (static_cast<std::size_t>(p.row[e]) == along) out[e] += sum.derivative(k - pass);
            }
          }
          w[along] = Seeded(0.0);
        }
        for (std::size_t k = pass; k < end; ++k) q[columns.list[k].index].set_derivative(k - pass, 0.0);
      }
    }
  }
}

// ---- structure -------------------------------------------------------------------------------------------------------

/// Marks from one evaluation on Trace: exact for laws that do not branch on the state, everything where they do.
class Structure {
 public:
  Structure(const bramah_type& type, std::uint8_t* const* mark) : type_(type), mark_(mark) {}

  [[nodiscard]] std::size_t columns(int block) const {
    switch (block) {
      case BRAMAH_F_Z:
      case BRAMAH_G_Z:
      case BRAMAH_G_ZDOT:
      case BRAMAH_Y_Z: return family_size(type_, Z);
      case BRAMAH_F_U:
      case BRAMAH_G_U:
      case BRAMAH_Y_U: return family_size(type_, U);
      case BRAMAH_Y_LAMBDA: return family_size(type_, LAMBDA);
      default: return family_size(type_, X);
    }
  }
  void set(int block, std::size_t row, std::size_t column) { mark_[block][row * columns(block) + column] = 1; }

 private:
  const bramah_type& type_;
  std::uint8_t* const* mark_;
};

inline void seed_all(Local<Trace>& local) {
  // Generic numbers: no zero, no equal pair, small enough for every law's domain. Only the dependence is used.
  for (std::size_t k = 0; k < local.start[families]; ++k) {
    local.values[k] = Trace::seed(0.31 + 0.017 * static_cast<double>(k), k);
  }
}

/// Returns the name of a dependence that no block can hold, or null.
template <class C, class Law>
const char* trace_rows(const bramah_type& type, const C& component, Structure& marks,
                       const BlockPair (&blocks)[families], std::size_t first_count, std::size_t second_count,
                       const Law& law) {
  auto local = std::make_unique<Local<Trace>>(type);
  seed_all(*local);
  std::vector<Trace> rows(first_count + second_count + 1);
  // clang-format off
  const bramah_batch b{.size = sizeof(bramah_batch), .count = 1, .instances = nullptr, .time = 0.4, .side = 1,
                       .x = nullptr, .v = nullptr, .a = nullptr, .z = nullptr, .zdot = nullptr, .u = nullptr,
                       .lambda = nullptr, .f = nullptr, .g = nullptr, .c = nullptr, .r = nullptr, .s = nullptr,
                       .y = nullptr, .partials = {}, .patterns = nullptr, .failed = 0, .message = {}};
  // clang-format on
  Trace::compared() = false;
  law(component, look(*local, b), rows.data(), rows.data() + first_count);
  const bool branches = Trace::compared();
  for (std::size_t row = 0; row < first_count + second_count; ++row) {
    const bool second = row >= first_count;
    for (std::size_t family = 0; family < families; ++family) {
      const int block = second ? blocks[family].second : blocks[family].first;
      for (std::size_t j = 0; j < family_size(type, family); ++j) {
        const bool depends = rows[row].depends().test(local->start[family] + j);
        if (block < 0) {
          if (depends && family == A) return "a storage balance or output on an acceleration";
          if (depends && family == ZDOT) return "a force balance or output on the rate of a first-order variable";
          if (depends && family == LAMBDA) return "a balance on a multiplier";
        } else if (depends || branches) {
          marks.set(block, second ? row - first_count : row, j);
        }
      }
    }
  }
  return nullptr;
}

template <class C>
void trace_holonomic(const bramah_type& type, const C& component, Structure& marks) {
  const auto nx = static_cast<std::size_t>(type.nx), mh = static_cast<std::size_t>(type.holonomic_count);
  auto local = std::make_unique<Local<Trace>>(type);
  seed_all(*local);
  std::vector<Trace> c(mh + 1);
  Values<Trace> out(c.data());
  Trace::compared() = false;
  // Time is a seed beyond all variables: c(t, x) with a factor of t has curvature in x just as well.
  component.holonomic(Positions<Trace>((*local)[X], Trace::seed(0.4, Trace::most_seeds - 1), 1), out);
  const bool branches = Trace::compared();
  for (std::size_t row = 0; row < mh; ++row) {
    const auto curved = [&](std::size_t j) { return branches || c[row].nonlinear().test(local->start[X] + j); };
    for (std::size_t j = 0; j < nx; ++j) {
      if (!branches && !c[row].depends().test(local->start[X] + j)) continue;
      marks.set(BRAMAH_C_X, row, j);
      marks.set(BRAMAH_R_V, row, j);
      if (!curved(j)) continue;
      marks.set(BRAMAH_R_X, row, j);
      marks.set(BRAMAH_S_X, row, j);
      marks.set(BRAMAH_S_V, row, j);
      for (std::size_t k = 0; k < nx; ++k) {
        if (curved(k)) marks.set(BRAMAH_L_X, j, k);
      }
    }
  }
}

template <class C>
void trace_nonholonomic(const bramah_type& type, const C& component, Structure& marks) {
  const auto nx = static_cast<std::size_t>(type.nx), mh = static_cast<std::size_t>(type.holonomic_count);
  const auto ml = static_cast<std::size_t>(type.nonholonomic_count);
  auto local = std::make_unique<Local<Trace>>(type);
  seed_all(*local);
  std::vector<Trace> rows(mh + ml + 1);
  Values<Trace> out(rows.data());
  Trace::compared() = false;
  component.nonholonomic(Motion<Trace>((*local)[X], (*local)[V], Trace::seed(0.4, Trace::most_seeds - 1), 1), out);
  const bool branches = Trace::compared();
  for (std::size_t row = mh; row < mh + ml; ++row) {
    const auto depends = [&](Family f, std::size_t j) {
      return branches || rows[row].depends().test(local->start[f] + j);
    };
    for (std::size_t j = 0; j < nx; ++j) {
      if (depends(V, j)) {
        marks.set(BRAMAH_R_V, row, j);
        marks.set(BRAMAH_S_V, row, j);
        for (std::size_t k = 0; k < nx; ++k) {
          if (depends(X, k)) marks.set(BRAMAH_L_X, j, k);
        }
      }
      if (depends(X, j)) {
        marks.set(BRAMAH_R_X, row, j);
        marks.set(BRAMAH_S_X, row, j);
        marks.set(BRAMAH_S_V, row, j);
      }
    }
  }
}

// ---- the functions of a bramah_type ----------------------------------------------------------------------------------

inline constexpr auto balance_law = [](const auto& component, const auto& at, auto* f, auto* g) {
  Rows rows(at, f, g);
  component.balance(at, rows);
};
inline constexpr auto output_law = [](const auto& component, const auto& at, auto* y, auto*) {
  Values values(y);
  component.output(at, values);
};

template <class C>
struct Border {
  static const TypeEntry& entry(const void* self) { return *static_cast<const TypeEntry*>(self); }

  static int configure(const void* self, void* memory, const bramah_value* values) noexcept {
    try {
      C* component = new (memory) C{};
      Description is(entry(self).tables, values);
      component->describe(is);
      return 0;
    } catch (...) {
      return -1;
    }
  }
  static void destroy(const void*, void* instance) noexcept { static_cast<C*>(instance)->~C(); }

  static void check(const void*, const void* instance, bramah_report report, void* context) noexcept {
    if constexpr (HasCheck<C>) {
      try {
        Faults faults(report, context);
        static_cast<const C*>(instance)->check(faults);
      } catch (...) {
        report(context, nullptr, "the component's check failed with an exception", "a check that reports faults");
      }
    }
  }
  static void start(const void* self, const void* instance, double* x, double* v, double* z) noexcept {
    if constexpr (HasStart<C>) {
      Start start(entry(self).tables, x, v, z);
      static_cast<const C*>(instance)->start(start);
    }
  }
  static int structure(const void* self, const void* instance, std::uint8_t* const* mark) noexcept {
    try {
      const bramah_type& type = entry(self).type;
      const C& component = *static_cast<const C*>(instance);
      Structure marks(type, mark);
      const char* refused = nullptr;
      if constexpr (HasBalance<C>) {
        refused =
            trace_rows(type, component, marks, balance_blocks, family_size(type, X), family_size(type, Z), balance_law);
      }
      if constexpr (HasHolonomic<C>) trace_holonomic(type, component, marks);
      if constexpr (HasNonholonomic<C>) trace_nonholonomic(type, component, marks);
      if constexpr (HasOutput<C>) {
        const char* also = trace_rows(type, component, marks, output_blocks,
                                      static_cast<std::size_t>(type.output_count), 0, output_law);
        if (refused == nullptr) refused = also;
      }
      return refused == nullptr ? 0 : -1;
    } catch (...) {
      return -2;
    }
  }
  static int evaluate(const void* self, bramah_batch* b) noexcept {
    try {
      const bramah_type& type = entry(self).type;
      if (wanted(*b, BRAMAH_L_X)) {
        std::memset(b->partials[BRAMAH_L_X], 0,
                    static_cast<std::size_t>(b->count * b->patterns[BRAMAH_L_X].count) * sizeof(double));
      }
      if constexpr (HasBalance<C>) {
        const auto nx = family_size(type, X), nz = family_size(type, Z);
        if (b->f != nullptr || b->g != nullptr || wants_any(*b, BRAMAH_F_X, BRAMAH_G_U)) {
          evaluate_rows<C>(type, *b, balance_blocks, nx, nz, b->f, b->g, balance_law);
        }
      } else {
        // Joints and volumes add nothing themselves; whoever sums the balances still reads their records.
        if (b->f != nullptr) std::memset(b->f, 0, static_cast<std::size_t>(b->count * type.nx) * sizeof(double));
        if (b->g != nullptr) std::memset(b->g, 0, static_cast<std::size_t>(b->count * type.nz) * sizeof(double));
      }
      if constexpr (HasHolonomic<C>) evaluate_holonomic<C>(type, *b);
      if constexpr (HasNonholonomic<C>) evaluate_nonholonomic<C>(type, *b);
      if constexpr (HasOutput<C>) {
        if (b->y != nullptr || wants_any(*b, BRAMAH_Y_X, BRAMAH_Y_LAMBDA)) {
          evaluate_rows<C>(type, *b, output_blocks, static_cast<std::size_t>(type.output_count), 0, b->y, nullptr,
                           output_law);
        }
      }
      return 0;
    } catch (const std::exception& error) {
      std::snprintf(b->message, sizeof b->message, "%s", error.what());
      return -1;
    } catch (...) {
      std::snprintf(b->message, sizeof b->message, "unknown exception");
      return -1;
    }
  }
  static bool wants_any(const bramah_batch& b, int first, int last) {
    for (int block = first; block <= last; ++block) {
      if (wanted(b, block)) return true;
    }
    return false;
  }

  static void constants(const void*, const void* instance, double* values) noexcept {
    if constexpr (HasConstants<C>) static_cast<const C*>(instance)->constants(values);
  }
  static double signal(const void*, const void* instance, double t, std::int32_t side) noexcept {
    if constexpr (HasSignal<C>) return static_cast<const C*>(instance)->signal(t, side);
    return 0.0;
  }
  static double next_breakpoint(const void*, const void* instance, double t) noexcept {
    if constexpr (HasSignal<C>) return static_cast<const C*>(instance)->next_breakpoint(t);
    return HUGE_VAL;
  }
  static int switch_values(const void* self, const bramah_batch* b, double* values) noexcept {
    if constexpr (HasSwitches<C>) {
      const TypeEntry& e = entry(self);
      const auto* instances = static_cast<const C*>(b->instances);
      for (std::size_t i = 0; i < static_cast<std::size_t>(b->count); ++i) {
        Local<double> local(e.type);
        load_all(local, *b, i);
        Values<double> out(values + i * e.tables.switches.size());
        instances[i].switches(look(local, *b), out);
      }
    }
    return 0;
  }
  static const void* extension(const void* self, const char* id) noexcept {
    if constexpr (HasConstants<C>) {
      static bramah_constants table{sizeof(bramah_constants), entry(self).tables.constants, &Border::constants};
      if (std::strcmp(id, BRAMAH_EXTENSION_CONSTANTS) == 0) return &table;
    }
    if constexpr (HasSignal<C>) {
      static bramah_signal table{sizeof(bramah_signal), &Border::signal, &Border::next_breakpoint};
      if (std::strcmp(id, BRAMAH_EXTENSION_SIGNAL) == 0) return &table;
    }
    if constexpr (HasSwitches<C>) {
      static bramah_switches table{
          sizeof(bramah_switches), static_cast<std::int32_t>(entry(self).tables.switches.size()),
          entry(self).tables.switches.data(), entry(self).tables.switch_nominal.data(), &Border::switch_values};
      if (std::strcmp(id, BRAMAH_EXTENSION_SWITCHES) == 0) return &table;
    }
    return nullptr;
  }
};

/// Fills `entry` for component C.
template <class C>
void describe_type(TypeEntry& entry) {
  C prototype{};
  Description is(entry.tables);
  prototype.describe(is);
  const TypeTables& t = entry.tables;
  const auto rows = static_cast<int>(t.holonomic.size() + t.nonholonomic.size());
  if (3 * t.slots(BRAMAH_X) + 2 * t.slots(BRAMAH_Z) + t.slots(BRAMAH_U) + rows > static_cast<int>(most_columns)) {
    throw std::length_error(t.name + " has more local variables than one component may have");
  }
  const auto count = [](const auto& list) { return static_cast<std::int32_t>(list.size()); };
  entry.type = bramah_type{
      .size = sizeof(bramah_type),
      .name = t.name.c_str(),
      .doc = t.doc.c_str(),
      .parameters = t.parameters.data(),
      .ports = t.ports.data(),
      .variables = t.variables.data(),
      .terminals = t.terminals.data(),
      .holonomic = t.holonomic.data(),
      .nonholonomic = t.nonholonomic.data(),
      .outputs = t.outputs.data(),
      .parameter_count = count(t.parameters),
      .port_count = count(t.ports),
      .variable_count = count(t.variables),
      .terminal_count = count(t.terminals),
      .holonomic_count = count(t.holonomic),
      .nonholonomic_count = count(t.nonholonomic),
      .output_count = count(t.outputs),
      .nx = t.slots(BRAMAH_X),
      .nz = t.slots(BRAMAH_Z),
      .nu = t.slots(BRAMAH_U),
      .instance_bytes = sizeof(C),
      .instance_align = alignof(C),
      .self = &entry,
      .configure = &Border<C>::configure,
      .destroy = &Border<C>::destroy,
      .check = &Border<C>::check,
      .start = &Border<C>::start,
      .structure = &Border<C>::structure,
      .evaluate = &Border<C>::evaluate,
      .extension = &Border<C>::extension,
  };
}

template <class... Cs>
const bramah_library* library(const char* name, const char* version) noexcept try {
  struct Tables {
    TypeEntry entries[sizeof...(Cs)];
    const bramah_type* types[sizeof...(Cs)];
    bramah_library library;
  };
  static const std::unique_ptr<Tables> tables = [&] {
    auto made = std::make_unique<Tables>();
    std::size_t k = 0;
    (describe_type<Cs>(made->entries[k++]), ...);
    for (std::size_t i = 0; i < sizeof...(Cs); ++i) made->types[i] = &made->entries[i].type;
    made->library = {sizeof(bramah_library),
                     BRAMAH_ABI_EPOCH,
                     BRAMAH_ABI_MINOR,
                     name,
                     version,
                     __VERSION__,
                     made->types,
                     static_cast<std::int32_t>(sizeof...(Cs))};
    return made;
  }();
  return &tables->library;
} catch (...) {
  return nullptr;  // no exception crosses the border; the engine says what to look for
}

}  // namespace bramah::detail

/// The one exported function of a library: BRAMAH_LIBRARY("valves", "1.0.0", ThrottleValve, CheckValve)
#define BRAMAH_LIBRARY(name, version, ...)                                                          \
  extern "C" __attribute__((visibility("default"))) const bramah_library* bramah_library_v1(void) { \
    return bramah::detail::library<__VA_ARGS__>(name, version);                                     \
  }
