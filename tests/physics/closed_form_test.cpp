// Spectra that are known in closed form: tops, lattices, trapped oil.
#include <cmath>
#include <numbers>

#include "moving.hpp"

namespace bramah::testing {
namespace {

constexpr std::complex<double> i(0.0, 1.0);

TEST(SleepingTop, PrecessesFastAndSlowly) {
  // About the tip; the stem's own spin is no motion to first order.
  constexpr double g = 9.81, C = 5e-4;
  constexpr double A = 2e-4 + 0.1 * 0.06 * 0.06 + 3e-4 + 0.5 * 0.08 * 0.08, mgh = g * (0.1 * 0.06 + 0.5 * 0.08);
  const double critical = 2.0 * std::sqrt(A * mgh) / C;
  for (const double rate : {0.0, 0.3, 0.9, 1.1, 2.0, 50.0}) {
    const double spin = rate * critical;
    char setting[64];
    std::snprintf(setting, sizeof setting, "rotor.rate=%.17g", spin);
    const Moving top("scenes/linear/sleeping_top.json", {setting});
    const double H = C * spin;
    const std::complex<double> root = std::sqrt(std::complex<double>(H * H - 4.0 * A * mgh));
    Eigenvalues expected;
    for (const double sign : {1.0, -1.0}) {
      expected.push_back(i * sign * (H + root) / (2.0 * A));
      expected.push_back(i * sign * (H - root) / (2.0 * A));
    }
    expect_spectrum(top.model(), expected, 2, rate == 50.0 ? 1e-9 : 1e-12);  // slow precession: H - root cancels
  }
}

TEST(Lattice, HasTheFrequenciesOfItsLength) {
  // w_k = 2 sqrt(k / m) sin(k pi / (2 N + 2)) between walls.
  const Moving lattice("scenes/linear/lattice.json");
  Eigenvalues expected;
  for (int k = 1; k <= 8; ++k) {
    const double w = 2.0 * std::sqrt(2000.0 / 0.5) * std::sin(k * std::numbers::pi / 18.0);
    expected.push_back(i * w);
    expected.push_back(-i * w);
  }
  expect_spectrum(lattice.model(), expected, 0, 1e-13);
}

/// N masses in a row, joined by springs, free at both ends.
Scene free_lattice(int N) {
  Scene scene;
  Value::Object components;
  for (int k = 1; k <= N; ++k) {
    const std::string number = std::to_string(k), before = std::to_string(k - 1);
    components.push_back({"m" + number, Value::Object{{"type", "mechanics/mass"}, {"mass", 0.5}}});
    if (k == 1) continue;
    components.push_back({"k" + number, Value::Object{{"type", "mechanics/spring_damper"},
                                                      {"from", "m" + before},
                                                      {"to", "m" + number},
                                                      {"stiffness", 2000.0}}});
  }
  Value::List libraries;
  libraries.emplace_back("mechanics");
  scene.root = Value::Object{{"bramah", 1}, {"libraries", std::move(libraries)}, {"components", std::move(components)}};
  return scene;
}

TEST(Lattice, FloatsFree) {
  // w_k = 2 sqrt(k / m) sin(k pi / (2 N)), and a rigid-body motion: two zeros.
  for (const int N : {2, 5, 40}) {
    const Compiled compiled = compile(free_lattice(N), registry());
    const State state = consistent_start(compiled.system, compiled.options, 0.0);
    Linearizer linearizer(compiled.system, choose_partition(compiled.system, state));
    LinearModel model;
    linearizer.linearize(state, model);
    Eigenvalues expected;
    for (int k = 1; k < N; ++k) {
      const double w = 2.0 * std::sqrt(2000.0 / 0.5) * std::sin(k * std::numbers::pi / (2.0 * N));
      expected.push_back(i * w);
      expected.push_back(-i * w);
    }
    expect_spectrum(model, expected, 2, 1e-11);
  }
}

TEST(TrappedVolumes, KeepTheirOil) {
  // K pdot = -C_L (Laplacian) p: 0, 1 and 3 times C_L / K for three in a row; a pair against its series capacity.
  const Moving volumes("scenes/linear/trapped_volumes.json");
  const double wall = 1.0 / 1.5e9 + 1.0 / 5.5e8, K = 1e-4 * wall;
  const double seal = 2e-11 / K, throttle = 0.8 * 1e-6 * std::sqrt(2.0 / 850.0) / std::sqrt(2e5);
  const Eigenvalues expected = {-seal, -3.0 * seal, -throttle * (1.0 / (2.0 * K) + 1.0 / (3.0 * K))};
  expect_spectrum(volumes.model(), expected, 2, 1e-14);
}

}  // namespace
}  // namespace bramah::testing
