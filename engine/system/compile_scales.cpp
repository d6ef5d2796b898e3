// The machine's own sizes, from its rows at the start values: what every limit of the engine is a part of.
#include <algorithm>
#include <cmath>

#include "system/blocks.hpp"
#include "system/compiler.hpp"

namespace bramah::compiling {
namespace {

/// The power of two next to a size: scaling by it rounds nothing.
double rounded(double size) { return std::exp2(std::round(std::log2(size))); }

/// Entries of one block with their rows and columns: places in State's vectors, or local rows of constraints.
template <class Function>
void for_entries(const System& system, const Blocks& blocks, int block, Function&& function) {
  for (std::size_t g = 0; g < system.groups.size(); ++g) {
    const Group& group = system.groups[g];
    const BlockPattern& pattern = group.patterns[static_cast<std::size_t>(block)];
    const std::span<const double> values = blocks.block(g, block);
    if (values.empty()) continue;
    std::size_t entry = 0;
    for (Index i = 0; i < group.count; ++i) {
      for (Index j = 0; j < pattern.columns; ++j) {
        for (auto e = pattern.start[static_cast<std::size_t>(j)]; e < pattern.start[static_cast<std::size_t>(j) + 1];
             ++e)
          function(group, i, pattern.row[static_cast<std::size_t>(e)], j, std::abs(values[entry++]));
      }
    }
  }
}

/// The largest of what the rows say at the start values.
struct Sizes {
  double mass = 0.0, inertia = 0.0;                   // kg, kg m^2
  double lever = 0.0;                                 // m
  double force = 0.0, moment = 0.0;                   // N, N m: what nothing but constraints balances
  double stiffness = 0.0, torsional_stiffness = 0.0;  // N/m, N m
};

class Reader {
 public:
  explicit Reader(const System& system) : system_(system), blocks_(system), state_(initial_state(system)) {
    std::fill(state_.v.begin(), state_.v.end(), 0.0);
    state_.lambda.assign(state_.lambda.size(), 0.0);
  }
  /// False where the rows cannot be evaluated there.
  bool read(Sizes& sizes) {
    const Request request = Request{}.rows("fc").blocks({BRAMAH_F_A, BRAMAH_F_X, BRAMAH_C_X});
    if (!blocks_.evaluate(system_, state_, request).ok()) return false;
    for (std::size_t i = 0; i < system_.x.size(); ++i) {
      if (is(i, "m")) raise(sizes.force, std::abs(blocks_.f[i]));
      if (is(i, "rad")) raise(sizes.moment, std::abs(blocks_.f[i]));
    }
    diagonal(BRAMAH_F_A, sizes.mass, sizes.inertia);
    diagonal(BRAMAH_F_X, sizes.stiffness, sizes.torsional_stiffness);
    for_entries(system_, blocks_, BRAMAH_C_X, [&](const Group& group, Index i, Index row, Index column, double value) {
      const Row& c = system_.holonomic[at(group.first_holonomic[at(i)] + row)];
      if (c.unit == "m" && is(place(group, i, column), "rad")) raise(sizes.lever, value);
    });
    return true;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static void raise(double& largest, double value) { largest = std::max(largest, value); }
  static std::size_t place(const Group& group, Index i, Index column) {
    return at(group.x[at(i * group.type->nx + column)]);
  }
  [[nodiscard]] bool is(std::size_t place, const char* unit) const {
    return place < system_.x.size() && system_.x[place].unit == unit;
  }
  void diagonal(int block, double& translation, double& rotation) const {
    for_entries(system_, blocks_, block, [&](const Group& group, Index i, Index row, Index column, double value) {
      if (row != column) return;
      if (is(place(group, i, column), "m")) raise(translation, value);
      if (is(place(group, i, column), "rad")) raise(rotation, value);
    });
  }

  const System& system_;
  Blocks blocks_;
  State state_;
};

}  // namespace

Scales scales_of(const System& system) {
  // Where nothing is loaded, forces are those of springs bent by this part of the length.
  constexpr double slack = 1e-3;
  Scales scales;
  Sizes sizes;
  if (!Reader(system).read(sizes)) return scales;
  double length = sizes.lever;
  if (sizes.mass > 0.0) length = std::max(length, std::sqrt(sizes.inertia / sizes.mass));
  if (length > 0.0) scales.length = rounded(length);
  const double L = scales.length;
  const double mass = std::max(sizes.mass, sizes.inertia / (L * L));
  if (mass > 0.0) scales.mass = rounded(mass);
  const double stiffness = std::max(sizes.stiffness * L, sizes.torsional_stiffness / L);
  const double force = std::max({sizes.force, sizes.moment / L, slack * stiffness});
  if (force > 0.0) scales.time = rounded(std::sqrt(scales.mass * L / force));
  return scales;
}

}  // namespace bramah::compiling
