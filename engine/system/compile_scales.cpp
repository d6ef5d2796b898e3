// The machine's own sizes, from its rows at the start values: what every limit of the engine is a part of.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <unordered_map>

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
  double damping = 0.0, torsional_damping = 0.0;      // N s/m, N m s
  double extent = 0.0, distance = 0.0;                // m: of all places from each other, of one from the origin
  double speed = 0.0, turning = 0.0;                  // m/s, rad/s
  double pressure = 0.0, flow = 0.0;                  // Pa, m^3/s: what nothing but storage balances
  double capacity = 0.0, conductance = 0.0;           // m^3/Pa, m^3/(s Pa)
};

class Reader {
 public:
  explicit Reader(const System& system) : system_(system), blocks_(system), state_(initial_state(system)) {
    std::fill(state_.v.begin(), state_.v.end(), 0.0);
    state_.lambda.assign(state_.lambda.size(), 0.0);
  }
  /// False where the rows cannot be evaluated there.
  bool read(Sizes& sizes) {
    const Request request =
        Request{}.rows("fgc").blocks({BRAMAH_F_A, BRAMAH_F_X, BRAMAH_F_V, BRAMAH_G_ZDOT, BRAMAH_G_Z, BRAMAH_C_X});
    if (!blocks_.evaluate(system_, state_, request).ok()) return false;
    for (std::size_t i = 0; i < system_.x.size(); ++i) {
      if (is(i, "m")) raise(sizes.force, std::abs(blocks_.f[i]));
      if (is(i, "rad")) raise(sizes.moment, std::abs(blocks_.f[i]));
    }
    diagonal(BRAMAH_F_A, sizes.mass, sizes.inertia);
    diagonal(BRAMAH_F_X, sizes.stiffness, sizes.torsional_stiffness);
    diagonal(BRAMAH_F_V, sizes.damping, sizes.torsional_damping);
    for_entries(system_, blocks_, BRAMAH_C_X, [&](const Group& group, Index i, Index row, Index column, double value) {
      const Row& c = system_.holonomic[at(group.first_holonomic[at(i)] + row)];
      if (c.unit == "m" && is(place(group, i, column), "rad")) raise(sizes.lever, value);
    });
    read_places(sizes);
    read_circuit(sizes);
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

  /// How far apart the start values are, and how fast: what counts where nothing else has a length or a time.
  void read_places(Sizes& sizes) const {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Variable& x : system_.x) {
      if (x.unit == "rad") raise(sizes.turning, std::abs(x.start_rate));
      if (x.unit != "m") continue;
      raise(sizes.speed, std::abs(x.start_rate));
      low = std::min(low, x.start);
      high = std::max(high, x.start);
    }
    raise(sizes.extent, high - low);
    for (const Variable& x : system_.x) {
      if (sizes.extent <= 0.0 && x.unit == "m") raise(sizes.distance, std::abs(x.start));
    }
  }
  void read_circuit(Sizes& sizes) const {
    for (std::size_t i = 0; i < system_.z.size(); ++i) {
      if (!is_pressure(i)) continue;
      raise(sizes.pressure, std::abs(state_.z[i]));
      raise(sizes.flow, std::abs(blocks_.g[i]));
    }
    for (std::size_t i = 0; i < system_.inputs.size(); ++i) {
      if (system_.inputs[i].unit == "Pa") raise(sizes.pressure, std::abs(state_.z[system_.z.size() + i]));
    }
    const auto read = [&](int block, double& size) {
      for_entries(system_, blocks_, block, [&](const Group& group, Index i, Index row, Index column, double value) {
        if (row == column && is_pressure(at(group.z[at(i * group.type->nz + column)]))) raise(size, value);
      });
    };
    read(BRAMAH_G_ZDOT, sizes.capacity);
    read(BRAMAH_G_Z, sizes.conductance);
  }
  [[nodiscard]] bool is_pressure(std::size_t place) const {
    return place < system_.z.size() && system_.z[place].unit == "Pa";
  }

  const System& system_;
  Blocks blocks_;
  State state_;
};

/// The first of several sizes that is there.
double first_of(std::initializer_list<double> sizes, double otherwise) {
  for (const double size : sizes) {
    if (size > 0.0 && std::isfinite(size)) return size;
  }
  return otherwise;
}

/// Of a machine of volumes alone: the oil that its pressure presses in gives the length, the rate of that the time.
Scales scales_of_circuit(const Sizes& sizes, Scales scales) {
  const double volume = sizes.capacity * scales.pressure;
  scales.length = first_of({std::cbrt(volume)}, scales.length);
  scales.time = first_of({volume / sizes.flow, sizes.capacity / sizes.conductance}, scales.time);
  scales.mass = scales.pressure * scales.length * scales.time * scales.time;
  return scales;
}

}  // namespace

Scales sizes_of(const System& system) {
  // Where nothing is loaded, forces are those of springs bent by this part of the length.
  constexpr double slack = 1e-3;
  Scales scales;
  Sizes sizes;
  if (!Reader(system).read(sizes)) return scales;
  scales.pressure = first_of({sizes.pressure}, scales.pressure);
  if (sizes.mass <= 0.0 && sizes.inertia <= 0.0) return scales_of_circuit(sizes, scales);
  const double gyration = sizes.mass > 0.0 ? std::sqrt(sizes.inertia / sizes.mass) : 0.0;
  const double L = scales.length = first_of({std::max(sizes.lever, gyration), sizes.extent, sizes.distance,
                                             sizes.force / sizes.stiffness, sizes.mass * sizes.speed / sizes.damping},
                                            scales.length);
  const double M = scales.mass = first_of({std::max(sizes.mass, sizes.inertia / (L * L))}, scales.mass);
  const double stiffness = std::max(sizes.stiffness * L, sizes.torsional_stiffness / L);
  const double force = std::max({sizes.force, sizes.moment / L, slack * stiffness});
  scales.time = first_of({std::sqrt(M * L / force), 1.0 / std::max(sizes.speed / L, sizes.turning),
                          M / std::max(sizes.damping, sizes.torsional_damping / (L * L))},
                         scales.time);
  return scales;
}

void take_scales(System& system) {
  const Scales& sizes = system.sizes = sizes_of(system);
  system.scales = {rounded(sizes.length), rounded(sizes.mass), rounded(sizes.time), rounded(sizes.pressure)};
  struct Factors {
    double size = 1.0, scale = 1.0;
  };
  std::unordered_map<std::string_view, Factors> known;
  const auto factors = [&](std::string_view unit) {
    const auto [place, fresh] = known.try_emplace(unit);
    if (fresh) place->second = {sizes.of(unit), system.scales.of(unit)};
    return place->second;
  };
  for (auto* variables : {&system.x, &system.z}) {
    for (Variable& variable : *variables) {
      const auto [size, scale] = factors(variable.unit);
      variable.size = variable.nominal * size;
      variable.nominal *= scale;
    }
  }
  for (auto* rows : {&system.holonomic, &system.nonholonomic, &system.outputs}) {
    for (Row& row : *rows) {
      const auto [size, scale] = factors(row.unit);
      row.size = size;
      row.nominal = scale;
    }
  }
}

}  // namespace bramah::compiling
