// The families with a size parameter against what is known of them in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "linear/spectrum.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pendulum.hpp"

namespace bramah::testing {
namespace {

using Eigenvalues = std::vector<std::complex<double>>;

struct Model {
  explicit Model(const Scene& scene) : machine(support::compiled(scene)) {
    const Options& options = machine.options;
    const bool equilibrium = options.linearize.at == LinearizeOptions::At::equilibrium;
    const State state = reference_state(machine.system, options, equilibrium, 0.0);
    Linearizer linearizer(machine.system, choose_partition(machine.system, state));
    linearizer.linearize(state, linear);
    linearizer.estimate_rounding(linear);
    const Spectrum spectrum = find_spectrum(linear);
    for (const Mode& mode : spectrum.modes) mode.zero ? (void)++zeros : nonzero.push_back(mode.eigenvalue);
  }
  [[nodiscard]] const System& system() const { return machine.system; }
  Compiled machine;
  LinearModel linear;
  Eigenvalues nonzero;
  int zeros = 0;
};

/// `found` holds `expected` and nothing else.
void expect_all(Eigenvalues found, const Eigenvalues& expected, double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (const std::complex<double>& value : expected) EXPECT_TRUE(take_nearest(found, value, tolerance));
}

TEST(Lattice, HasTheFrequenciesOfTheSquareGrid) {
  constexpr int side = 5;
  Eigenvalues expected;
  for (int i = 1; i <= side; ++i) {
    for (int j = 1; j <= side; ++j) {
      const double p = std::numbers::pi / (2.0 * side + 2.0), a = std::sin(i * p), b = std::sin(j * p);
      const double w = std::sqrt(4.0 * support::lattice_stiffness / support::lattice_mass * (a * a + b * b));
      expected.insert(expected.end(), {{0.0, w}, {0.0, -w}});
    }
  }
  const Model lattice(support::spring_lattice(side));
  EXPECT_EQ(lattice.zeros, 0);
  expect_all(lattice.nonzero, expected, 1e-13);
}

TEST(Trailers, FollowWithTheRateOfTheirDrawbars) {
  for (const int count : {1, 4, 30, 100}) {
    const Model train(support::trailers(count));
    EXPECT_EQ(train.system().n(), 3 * count + 3);
    EXPECT_EQ(train.system().m(), 2 * count);
    EXPECT_EQ(train.system().l(), count + 1);
    Eigenvalues expected;
    for (int i = 1; i <= count; ++i) expected.emplace_back(-support::trailer_speed / support::drawbar(i, count));
    EXPECT_EQ(train.zeros, 5);  // x with its rate; y, heading and yaw rate
    expect_all(train.nonzero, expected, 1e-11);
  }
}

TEST(Ladder, FallsAsOneInvertedPendulum) {
  // All uprights turn by one angle: T = ((N + 1) / 3 + N) m L^2 w^2 / 2, V = ((N + 1) / 2 + N) m g L cos.
  for (const int loops : {1, 6}) {
    const double rate =
        std::sqrt(support::gravity / support::rod_length * ((loops + 1) / 2.0 + loops) / ((loops + 1) / 3.0 + loops));
    Scene scene = support::four_bar_ladder(loops);
    expect_all(Model(scene).nonzero, {rate, -rate}, 1e-12);
  }
}

TEST(Manifold, RepeatsWhatItsCylindersDoAgainstEachOther) {
  const Model one(support::cylinder_manifold(1)), two(support::cylinder_manifold(2)),
      five(support::cylinder_manifold(5));
  ASSERT_EQ(one.nonzero.size(), 4U);
  Eigenvalues opposed = two.nonzero;
  for (const std::complex<double>& together : one.nonzero) EXPECT_TRUE(take_nearest(opposed, together, 1e-11));
  ASSERT_EQ(opposed.size(), 3U);
  Eigenvalues expected = one.nonzero;
  for (int k = 1; k < 5; ++k) expected.insert(expected.end(), opposed.begin(), opposed.end());
  EXPECT_EQ(five.zeros, 0);
  expect_all(five.nonzero, expected, 1e-10);
  for (const std::complex<double>& value : expected) EXPECT_LT(value.real(), 0.0);
}

TEST(HydraulicChain, HasAZeroForEveryCylinderShutIn) {
  // A throttle joins both sides of a piston: their oil stays, whatever the pressures.
  const Model chain(support::hydraulic_chain(5, 2));
  EXPECT_EQ(chain.linear.A.rows(), 2 * 5 + 2 * 3);
  EXPECT_EQ(chain.zeros, 3);
}

TEST(Pendulum, SturmsCountFindsTheFrequenciesOfTheEngine) {
  // The engine's are tested against dense matrices in absolute angles (chain_test.cpp): a third formulation.
  constexpr int links = 9;
  const auto expected = [](const std::vector<double>& pieces) {
    Eigenvalues list;
    for (const double w : support::lowest_frequencies(pieces, static_cast<int>(pieces.size())))
      list.insert(list.end(), {{0.0, w}, {0.0, -w}});
    return list;
  };
  expect_all(Model(support::planar_chain(links)).nonzero, expected(support::planar_pieces(links)), 1e-11);
  Eigenvalues both = expected(support::spatial_pieces_about_y(links));
  const Eigenvalues others = expected(support::spatial_pieces_about_x(links));
  both.insert(both.end(), others.begin(), others.end());
  expect_all(Model(support::spatial_chain(links)).nonzero, both, 1e-11);
}

TEST(Pendulum, LadderFallsInTheTimeThatItsEnergyTells) {
  // w^2 = 1 + 2 rate (1 - cos phi): the time to an angle by Simpson's rule.
  for (const int loops : {1, 40}) {
    const double rate = support::gravity * ((loops + 1) / 2.0 + loops) / ((loops + 1) / 3.0 + loops);
    const double angle = support::ladder_angle(loops, 10.0);
    constexpr int intervals = 200000;
    double sum = 0.0;
    for (int k = 0; k <= intervals; ++k) {
      const double weight = k == 0 || k == intervals ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
      sum += weight / std::sqrt(1.0 + 2.0 * rate * (1.0 - std::cos(angle * k / intervals)));
    }
    EXPECT_TRUE(close(sum * angle / (3.0 * intervals), 10.0, 1e-11)) << loops << " loops";
  }
}

TEST(Families, CompileAtEverySize) {
  for (const support::Family& family : support::families()) {
    for (const int size : {1, 2, 30}) {
      const Compiled machine = support::compiled(family.make(size));
      EXPECT_GT(machine.system.n(), 0) << family.name << ' ' << size;
      EXPECT_NO_THROW(consistent_start(machine.system, machine.options, 0.0)) << family.name << ' ' << size;
    }
  }
}

}  // namespace
}  // namespace bramah::testing
