// The local values of one instance, and which rows meet which columns.
#pragma once

#include <cstddef>

#include "bramah/abi.h"
#include "bramah/at.hpp"
#include "bramah/rows.hpp"

namespace bramah::detail {

inline constexpr std::size_t most_columns = 256;  // 3 nx + 2 nz + nu + multipliers of one component

enum Family : std::size_t { X, V, A, Z, ZDOT, U, LAMBDA, families };

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

/// Number k of a batch and of the direction that it moves in; null stands for zeros.
inline Parameter number(const double* from, const double* along, std::size_t k) {
  return {from == nullptr ? 0.0 : from[k], along == nullptr ? 0.0 : along[k]};
}

/// Local values of one instance on the scalar T, all families after one another.
template <class T>
struct Local {
  T values[most_columns];
  std::size_t start[families + 1];

  explicit Local(const bramah_type& type) {
    start[0] = 0;
    for (std::size_t f = 0; f < families; ++f) start[f + 1] = start[f] + family_size(type, f);
  }
  /// Record i of a batch, which moves along `along`.
  Local(const bramah_type& type, const bramah_batch& b, const bramah_direction& along, std::size_t i) : Local(type) {
    load(X, b.x, along.x, i);
    load(V, b.v, along.v, i);
    load(A, b.a, along.a, i);
    load(Z, b.z, along.z, i);
    load(ZDOT, b.zdot, along.zdot, i);
    load(U, b.u, along.u, i);
    load(LAMBDA, b.lambda, along.lambda, i);
  }
  [[nodiscard]] T* operator[](std::size_t family) { return values + start[family]; }
  [[nodiscard]] At<T> at(double time, int side) {
    Local& l = *this;
    return At<T>(l[X], l[V], l[A], l[Z], l[ZDOT], l[U], l[LAMBDA], T(time), side);
  }

 private:
  void load(std::size_t family, const double* from, const double* along, std::size_t record) {
    const std::size_t count = start[family + 1] - start[family];
    for (std::size_t k = 0; k < count; ++k) values[start[family] + k] = T(number(from, along, record * count + k));
  }
};

struct BlockPair {  // the two row groups of a balance that a family of columns meets; -1 where there is no such block
  int first, second;
};
inline constexpr BlockPair balance_blocks[families] = {
    {BRAMAH_F_X, BRAMAH_G_X}, {BRAMAH_F_V, BRAMAH_G_V}, {BRAMAH_F_A, -1}, {BRAMAH_F_Z, BRAMAH_G_Z},
    {-1, BRAMAH_G_ZDOT},      {BRAMAH_F_U, BRAMAH_G_U}, {-1, -1}};
inline constexpr BlockPair output_blocks[families] = {{BRAMAH_Y_X, -1},     {BRAMAH_Y_V, -1}, {BRAMAH_Y_A, -1},
                                                      {BRAMAH_Y_Z, -1},     {-1, -1},         {BRAMAH_Y_U, -1},
                                                      {BRAMAH_Y_LAMBDA, -1}};

inline constexpr auto balance_law = [](const auto& component, const auto& at, auto* f, auto* g) {
  Rows rows(at, f, g);
  component.balance(at, rows);
};
inline constexpr auto output_law = [](const auto& component, const auto& at, auto* y, auto*) {
  Values values(y);
  component.output(at, values);
};

}  // namespace bramah::detail
