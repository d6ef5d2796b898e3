// Sparsity from one evaluation on Trace: exact for laws that do not branch on the state, everything where they do.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bramah/local.hpp"

namespace bramah::detail {

/// The marks of `structure`, block by block.
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

/// Seed of rows before a law is evaluated: what still depends on it afterwards was not written. The seed beyond is time.
inline constexpr std::size_t unwritten = Trace::most_seeds - 2;

inline std::vector<Trace> unwritten_rows(std::size_t count) {
  return std::vector<Trace>(count + 1, Trace::seed(0.0, unwritten));
}
inline void require_written(const Trace& row, const char* what, const char* name) {
  if (row.depends().test(unwritten))
    throw std::logic_error(std::string("the ") + what + " \"" + name + "\" is declared and never given a value");
}

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
  // Balances add to zeros; outputs are written.
  const bool outputs = blocks[X].first == BRAMAH_Y_X;
  std::vector<Trace> rows = outputs ? unwritten_rows(first_count) : std::vector<Trace>(first_count + second_count + 1);
  Trace::compared() = false;
  law(component, local->at(0.4, 1), rows.data(), rows.data() + first_count);
  const bool branches = Trace::compared();
  for (std::size_t row = 0; outputs && row < first_count; ++row)
    require_written(rows[row], "output", type.outputs[row].name);
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

/// That `law` gives a value to everything that `infos` declare.
template <class Info, class Law>
void trace_values(const bramah_type& type, const std::vector<Info>& infos, const char* what, const Law& law) {
  auto local = std::make_unique<Local<Trace>>(type);
  seed_all(*local);
  std::vector<Trace> rows = unwritten_rows(infos.size());
  Values<Trace> out(rows.data());
  law(local->at(0.4, 1), out);
  for (std::size_t k = 0; k < infos.size(); ++k) require_written(rows[k], what, infos[k].name);
}

template <class C>
void trace_holonomic(const bramah_type& type, const C& component, Structure& marks) {
  const auto nx = static_cast<std::size_t>(type.nx), mh = static_cast<std::size_t>(type.holonomic_count);
  auto local = std::make_unique<Local<Trace>>(type);
  seed_all(*local);
  std::vector<Trace> c = unwritten_rows(mh);
  Values<Trace> out(c.data());
  Trace::compared() = false;
  // Time is a seed beyond all variables: c(t, x) with a factor of t has curvature in x just as well.
  component.holonomic(Positions<Trace>((*local)[X], Trace::seed(0.4, Trace::most_seeds - 1), 1), out);
  const bool branches = Trace::compared();
  for (std::size_t row = 0; row < mh; ++row) {
    require_written(c[row], "holonomic row", type.holonomic[row].name);
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
  std::vector<Trace> rows = unwritten_rows(mh + ml);
  Values<Trace> out(rows.data());
  Trace::compared() = false;
  component.nonholonomic(Motion<Trace>((*local)[X], (*local)[V], Trace::seed(0.4, Trace::most_seeds - 1), 1), out);
  const bool branches = Trace::compared();
  for (std::size_t row = mh; row < mh + ml; ++row) {
    require_written(rows[row], "nonholonomic row", type.nonholonomic[row - mh].name);
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

/// That nonholonomic rows are affine in v, b = B(t, x) v + b_0(t, x): b(v) - 2 b(0) + b(-v) is zero at any v.
template <class C>
void check_affine(const bramah_type& type, const C& component) {
  const auto nx = static_cast<std::size_t>(type.nx), ml = static_cast<std::size_t>(type.nonholonomic_count);
  std::vector<Real> x(nx + 1), v(nx + 1), rows(ml + 1);
  std::vector<double> sum(ml), size(ml);
  for (const double sign : {1.0, 0.0, -1.0}) {
    for (std::size_t j = 0; j < nx; ++j) {
      x[j] = 0.31 + 0.017 * static_cast<double>(j);
      v[j] = sign * (0.7 + 0.13 * static_cast<double>(j));
    }
    Values<Real> out(rows.data(), type.holonomic_count);
    component.nonholonomic(Motion<Real>(x.data(), v.data(), Real(0.4), 1), out);
    for (std::size_t row = 0; row < ml; ++row) {
      sum[row] += (sign == 0.0 ? -2.0 : 1.0) * rows[row].value();
      size[row] += std::abs(rows[row].value());
    }
  }
  for (std::size_t row = 0; row < ml; ++row) {
    if (std::abs(sum[row]) > 1e-9 * size[row])
      throw std::logic_error(std::string("the nonholonomic row \"") + type.nonholonomic[row].name +
                             "\" is not affine in the rates; write b = B(t, x) v + b_0(t, x)");
  }
}

}  // namespace bramah::detail
