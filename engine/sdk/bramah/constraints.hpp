// Batch evaluation of constraint rows: one pass on series in time yields c, cdot, cddot and their partials; d(D^T lambda)/dx
// takes one direction at a time.
#pragma once

#include "bramah/evaluate.hpp"

namespace bramah::detail {

template <class T>
void series_of(Taylor<T, 2>& s, const Parameter& x, const Parameter& v, const Parameter& a) {
  s.c[0] = T(x);
  s.c[1] = T(v);
  s.c[2] = T(0.5 * a);
}
template <class T>
void series_of(Taylor<T, 1>& s, const Parameter& x, const Parameter& v, const Parameter&) {
  s.c[0] = T(x);
  s.c[1] = T(v);
}
template <class S>
S clock(double t) {
  S time(t);
  time.c[1] = 1.0;
  return time;
}
/// x(t), v(t), a(t) of instance i, each with the direction that it moves in.
class Path {
 public:
  Path(const bramah_batch& b, const bramah_direction& along, std::size_t nx, std::size_t i)
      : b_(b), along_(along), first_(i * nx) {}
  [[nodiscard]] Parameter x(std::size_t j) const { return number(b_.x, along_.x, first_ + j); }
  [[nodiscard]] Parameter v(std::size_t j) const { return number(b_.v, along_.v, first_ + j); }
  [[nodiscard]] Parameter a(std::size_t j) const { return number(b_.a, along_.a, first_ + j); }

 private:
  const bramah_batch& b_;
  const bramah_direction& along_;
  std::size_t first_;
};

template <class C, class As>
void evaluate_holonomic(const bramah_type& type, const bramah_batch& b, const bramah_direction& along) {
  using Seeded = typename As::Seeded;
  constexpr std::size_t width = As::width;
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
    const Path path(b, along, nx, i);
    const auto store_values = [&](std::size_t row, double c0, double c1, double c2) {
      if (b.c != nullptr) b.c[i * mh + row] = c0;
      if (b.r != nullptr) b.r[i * rows_all + row] = c1;
      if (b.s != nullptr) b.s[i * rows_all + row] = 2.0 * c2;
    };

    if (curvature) {
      using S = Taylor<Seeded, 2>;
      S q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) series_of(q[j], path.x(j), path.v(j), path.a(j));
      for (std::size_t pass = 0; pass < curved.count; pass += width) {
        const std::size_t end = curved.count < pass + width ? curved.count : pass + width;
        for (std::size_t k = pass; k < end; ++k) seed(q[curved.list[k].index].c[0], k - pass, 1.0);
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
          seed(q[j].c[0], k - pass, 0.0);
        }
        if (pass == 0) {
          for (std::size_t row = 0; row < mh; ++row) {
            store_values(row, result(level[0][row]), result(level[1][row]), result(level[2][row]));
          }
        }
      }
    }
    if (gradients) {
      Seeded q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) q[j] = Seeded(path.x(j));
      const auto sweep = [&](const Columns& columns) {
        for (std::size_t pass = 0; pass < columns.count; pass += width) {
          const std::size_t end = columns.count < pass + width ? columns.count : pass + width;
          for (std::size_t k = pass; k < end; ++k) seed(q[columns.list[k].index], k - pass, 1.0);
          for (std::size_t row = 0; row < mh; ++row) c[row] = Seeded(0.0);
          Values<Seeded> out(c);
          component.holonomic(Positions<Seeded>(q, Seeded(b.time), b.side), out);
          for (std::size_t k = pass; k < end; ++k) {
            const std::size_t j = columns.list[k].index;
            write_column(b, BRAMAH_C_X, i, j, c, mh, 0, k - pass);
            write_column(b, BRAMAH_R_V, i, j, c, mh, 0, k - pass);
            seed(q[j], k - pass, 0.0);
          }
        }
      };
      sweep(straight);
      if (!curvature) sweep(curved);
    }
    if (values && !(curvature && curved.count > 0)) {
      using S = Taylor<typename As::Plain, 2>;
      S q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) series_of(q[j], path.x(j), path.v(j), path.a(j));
      for (std::size_t row = 0; row < mh; ++row) c[row] = S(0.0);
      Values<S> out(c);
      component.holonomic(Positions<S>(q, clock<S>(b.time), b.side), out);
      for (std::size_t row = 0; row < mh; ++row)
        store_values(row, result(c[row].c[0]), result(c[row].c[1]), result(c[row].c[2]));
    }
    if (wanted(b, BRAMAH_L_X)) {
      // Row j of d(c_x^T lambda)/dx: the gradient of lambda . (c_x e_j), with c_x e_j the first-order term along x + t e_j.
      using S = Taylor<Seeded, 1>;
      const auto lambda = [&](std::size_t row) { return number(b.lambda, along.lambda, i * rows_all + row); };
      const bramah_pattern& p = b.patterns[BRAMAH_L_X];
      double* out = record(b, BRAMAH_L_X, i);
      S q[most_columns], c[most_columns];
      for (std::size_t j = 0; j < nx; ++j) q[j] = S(path.x(j));
      for (std::size_t pass = 0; pass < curved.count; pass += width) {
        const std::size_t end = curved.count < pass + width ? curved.count : pass + width;
        std::size_t lane_of[most_columns];
        for (std::size_t j = 0; j < nx; ++j) lane_of[j] = width;
        for (std::size_t k = pass; k < end; ++k) {
          seed(q[curved.list[k].index].c[0], k - pass, 1.0);
          lane_of[curved.list[k].index] = k - pass;
        }
        for (std::size_t d = 0; d < curved.count; ++d) {
          const std::size_t to = curved.list[d].index;
          if (!has_entries(b, BRAMAH_L_X, to)) continue;
          q[to].c[1] = Seeded(1.0);
          for (std::size_t row = 0; row < mh; ++row) c[row] = S(0.0);
          Values<S> values_out(c);
          component.holonomic(Positions<S>(q, S(b.time), b.side), values_out);
          Seeded sum(0.0);
          for (std::size_t row = 0; row < mh; ++row) sum += lambda(row) * c[row].c[1];
          // The matrix is symmetric, so the row is written as the column.
          for (std::int32_t e = p.start[to]; e < p.start[to + 1]; ++e) {
            const std::size_t lane = lane_of[p.row[e]];
            if (lane < width) out[e] += slope(sum, lane);
          }
          q[to].c[1] = Seeded(0.0);
        }
        for (std::size_t k = pass; k < end; ++k) seed(q[curved.list[k].index].c[0], k - pass, 0.0);
      }
    }
  }
}

template <class C, class As>
void evaluate_nonholonomic(const bramah_type& type, const bramah_batch& b, const bramah_direction& along) {
  using Seeded = typename As::Seeded;
  constexpr std::size_t width = As::width;
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
    const Path path(b, along, nx, i);
    const auto store_values = [&](std::size_t row, double b0, double b1) {
      if (b.r != nullptr) b.r[i * (mh + ml) + mh + row] = b0;
      if (b.s != nullptr) b.s[i * (mh + ml) + mh + row] = b1;
    };
    if (partials) {
      using S = Taylor<Seeded, 1>;
      S q[most_columns], w[most_columns], rows[most_columns];
      for (std::size_t j = 0; j < nx; ++j) {
        series_of(q[j], path.x(j), path.v(j), 0.0);
        series_of(w[j], path.v(j), path.a(j), 0.0);
      }
      for (std::size_t pass = 0; pass < columns.count; pass += width) {
        const std::size_t end = columns.count < pass + width ? columns.count : pass + width;
        const auto seed_column = [&](std::size_t k, double one) {
          const auto [family, j] = columns.list[k];
          if (family == X) {
            seed(q[j].c[0], k - pass, one);
          } else {  // v moves both the velocity and the slope of the path
            seed(q[j].c[1], k - pass, one);
            seed(w[j].c[0], k - pass, one);
          }
        };
        for (std::size_t k = pass; k < end; ++k) seed_column(k, 1.0);
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
          seed_column(k, 0.0);
        }
        if (pass == 0) {
          for (std::size_t row = 0; row < ml; ++row) store_values(row, result(level[0][row]), result(level[1][row]));
        }
      }
    } else if (b.r != nullptr || b.s != nullptr) {
      using S = Taylor<typename As::Plain, 1>;
      S q[most_columns], w[most_columns], rows[most_columns];
      for (std::size_t j = 0; j < nx; ++j) {
        series_of(q[j], path.x(j), path.v(j), 0.0);
        series_of(w[j], path.v(j), path.a(j), 0.0);
      }
      for (std::size_t row = 0; row < ml; ++row) rows[row] = S(0.0);
      Values<S> out(rows, type.holonomic_count);
      component.nonholonomic(Motion<S>(q, w, clock<S>(b.time), b.side), out);
      for (std::size_t row = 0; row < ml; ++row) store_values(row, result(rows[row].c[0]), result(rows[row].c[1]));
    }
    if (wanted(b, BRAMAH_L_X)) {
      // Row j of d(B^T lambda)/dx: B e_j is b(x, e_j) - b(x, 0), because b is affine in v.
      const auto lambda = [&](std::size_t row) { return number(b.lambda, along.lambda, i * (mh + ml) + mh + row); };
      const bramah_pattern& p = b.patterns[BRAMAH_L_X];
      double* out = record(b, BRAMAH_L_X, i);
      Seeded q[most_columns], w[most_columns], rows[most_columns];
      for (std::size_t j = 0; j < nx; ++j) {
        q[j] = Seeded(path.x(j));
        w[j] = Seeded(0.0);
      }
      for (std::size_t pass = 0; pass < position_columns; pass += width) {
        const std::size_t end = position_columns < pass + width ? position_columns : pass + width;
        for (std::size_t k = pass; k < end; ++k) seed(q[columns.list[k].index], k - pass, 1.0);
        const auto weighted = [&] {  // lambda^T b(x, w)
          for (std::size_t row = 0; row < ml; ++row) rows[row] = Seeded(0.0);
          Values<Seeded> values_out(rows, type.holonomic_count);
          component.nonholonomic(Motion<Seeded>(q, w, Seeded(b.time), b.side), values_out);
          Seeded sum(0.0);
          for (std::size_t row = 0; row < ml; ++row) sum += lambda(row) * rows[row];
          return sum;
        };
        const Seeded at_rest = weighted();
        for (std::size_t d = position_columns; d < columns.count; ++d) {
          const std::size_t to = columns.list[d].index;
          w[to] = Seeded(1.0);
          const Seeded sum = weighted() - at_rest;
          for (std::size_t k = pass; k < end; ++k) {
            const std::size_t j = columns.list[k].index;
            for (std::int32_t e = p.start[j]; e < p.start[j + 1]; ++e) {
              if (static_cast<std::size_t>(p.row[e]) == to) out[e] += slope(sum, k - pass);
            }
          }
          w[to] = Seeded(0.0);
        }
        for (std::size_t k = pass; k < end; ++k) seed(q[columns.list[k].index], k - pass, 0.0);
      }
    }
  }
}

}  // namespace bramah::detail
