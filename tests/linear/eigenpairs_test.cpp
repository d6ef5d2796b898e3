// Selected modes of the sparse form against all modes of the reduced one, closed forms, and counts that can fail.
#include "linear/eigenpairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "linear/census.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "system/analysis_error.hpp"

namespace bramah::testing {
namespace {

using Complex = std::complex<double>;

/// A system at its reference state with both forms of its linear model.
struct Both {
  Both(const System& system, const Options& options)
      : state(reference_state(system, options, options.linearize.at == LinearizeOptions::At::equilibrium, 0.0)),
        partition(choose_partition(system, state, options.linearize.prescribed)),
        descriptor(system, partition.rows) {
    descriptor.evaluate(state);
    descriptor.require_constant();
    zeros = predict_zeros(descriptor).count();
    LinearModel model;
    Linearizer(system, partition).linearize(state, model);
    for (const Mode& mode : find_spectrum(model).modes) {
      if (!mode.zero && mode.eigenvalue.imag() >= 0.0) dense.push_back(mode.eigenvalue);
    }
  }
  [[nodiscard]] std::vector<Complex> inside(const Disk& disk) const {
    std::vector<Complex> list;
    std::copy_if(dense.begin(), dense.end(), std::back_inserter(list), [&](Complex s) { return disk.contains(s); });
    return list;
  }
  State state;
  Partition partition;
  Descriptor descriptor;
  Index zeros = 0;
  std::vector<Complex> dense;  // nonzero, one of each conjugate pair
};

// Backward stable on both sides: what remains is rounding times the condition of each eigenvalue, and for the vehicle's
// slow ones beside fast ones, 0.0076 beside 1e3, what QR loses there.
constexpr double agreement = 1e-9;

void expect_same(const Eigenpairs& found, std::vector<Complex> expected) {
  EXPECT_EQ(found.pairs.size(), expected.size());
  for (const Eigenpair& pair : found.pairs) {
    EXPECT_LT(pair.residual, 1e-12) << pair.eigenvalue;
    EXPECT_TRUE(take_nearest(expected, pair.eigenvalue, agreement));
  }
}

class SelectedModes : public ::testing::TestWithParam<std::string> {};

TEST_P(SelectedModes, AreThoseOfTheReducedModel) {
  const Machine machine = load(GetParam());
  const Both both(machine.system(), machine.options());
  EXPECT_EQ(both.descriptor.states(),
            static_cast<Index>(2 * both.partition.ai.size() + both.partition.ad.size()) + machine.system().nz());
  for (const double radius : {3.0, 30.0, 300.0}) {
    const Disk disk{0.0, radius};
    const Eigenpairs found = find_inside(both.descriptor, disk, both.zeros, Proof::wanted);
    EXPECT_TRUE(found.proven);
    EXPECT_EQ(found.zeros, both.zeros);
    expect_same(found, both.inside(disk));
  }
  const Eigenpairs nearest = find_nearest(both.descriptor, 2, 0.0, both.zeros, Proof::wanted);
  expect_same(nearest, both.inside(nearest.disk));
}
INSTANTIATE_TEST_SUITE_P(Scenes, SelectedModes,
                         ::testing::Values("scenes/four_bar/overdamped.json",
                                           "scenes/four_bar/underdamped_low_friction.json",
                                           "scenes/four_bar/spatial.json", "scenes/linear/lattice.json",
                                           "scenes/linear/trapped_volumes.json", "scenes/bicycle/benchmark.json",
                                           "scenes/articulated_vehicle/straight.json", "scenes/rolling/skate.json"),
                         [](const auto& p) {
                           std::string name = p.param;
                           for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

TEST(Eigenpairs, ChainsInABandAndNearAShift) {
  for (const bool spatial : {false, true}) {
    const Compiled compiled = support::compiled(spatial ? support::spatial_chain(40) : support::planar_chain(60));
    const Both both(compiled.system, compiled.options);
    const Disk band{{0.0, 4.0}, 1.5};
    expect_same(find_inside(both.descriptor, band, 0, Proof::wanted), both.inside(band));
    const Eigenpairs nearest = find_nearest(both.descriptor, 9, 2.0, 0, Proof::wanted);
    EXPECT_EQ(nearest.pairs.size(), 9U);
    EXPECT_EQ(nearest.shift, 2.0);
    expect_same(nearest, both.inside(nearest.disk));
  }
}

TEST(Eigenpairs, LongChainNearsTheHangingRope) {
  // A rope of length L swings at j0k / 2 sqrt(g / L), j0k the zeros of the Bessel function J0; N links err by O(1/N).
  const int links = 2000;
  const Compiled compiled = support::compiled(support::planar_chain(links));
  const State state = reference_state(compiled.system, compiled.options, true, 0.0);
  Descriptor descriptor(compiled.system, choose_partition(compiled.system, state).rows);
  descriptor.evaluate(state);
  const Eigenpairs found = find_nearest(descriptor, 4, 0.0, 0, Proof::wanted);
  ASSERT_EQ(found.pairs.size(), 4U);
  const double zeros_of_bessel[] = {2.404825557695773, 5.520078110286311, 8.653727912911012, 11.79153443901428};
  for (std::size_t k = 0; k < 4; ++k) {
    const double rope = 0.5 * zeros_of_bessel[k] * std::sqrt(support::gravity / (links * support::rod_length));
    EXPECT_TRUE(close(found.pairs[k].eigenvalue.imag(), rope, 1.0 / links));
    EXPECT_LT(std::abs(found.pairs[k].eigenvalue.real()), 1e-12);
  }
}

TEST(Eigenpairs, CountTellsWhatIsMissing) {
  const Compiled compiled = support::compiled(support::planar_chain(40));
  const Both both(compiled.system, compiled.options);
  std::vector<Complex> known = both.dense;
  const Disk disk{0.3, 6.0};
  EXPECT_EQ(count_unknown(both.descriptor, disk, known), 0);
  const auto inside = static_cast<Index>(both.inside(disk).size());
  ASSERT_GE(inside, 5);
  EXPECT_EQ(count_unknown(both.descriptor, disk, {}), 2 * inside);
  const auto missed = std::find_if(known.begin(), known.end(), [&](Complex s) { return disk.contains(s); });
  known.erase(missed);
  EXPECT_EQ(count_unknown(both.descriptor, disk, known), 2);
  known.emplace_back(0.0, 1.234);  // no eigenvalue
  known.emplace_back(0.0, 2.345);
  EXPECT_EQ(count_unknown(both.descriptor, disk, known), -2);
}

TEST(Eigenpairs, VectorsSolveTheUnreducedEquations) {
  const Compiled compiled = support::compiled(support::spatial_chain(12));
  const Both both(compiled.system, compiled.options);
  for (const Eigenpair& pair : find_nearest(both.descriptor, 3, 0.0, 0, Proof::skip).pairs) {
    std::vector<Complex> values;
    both.descriptor.at(pair.eigenvalue, values);
    const auto view = both.descriptor.view(values);
    std::vector<Complex> rows(static_cast<std::size_t>(view.rows));
    std::vector<double> sizes(rows.size());
    for (Index j = 0; j < view.columns; ++j) {
      for (Index e = view.start[j]; e < view.start[j + 1]; ++e) {
        const Complex term = view.value[e] * pair.vector(j);
        rows[static_cast<std::size_t>(view.row[e])] += term;
        sizes[static_cast<std::size_t>(view.row[e])] += std::abs(term);
      }
    }
    double largest = 0.0;
    for (const double size : sizes) largest = std::max(largest, size);
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_LT(std::abs(rows[i]), 1e-11 * largest) << i;
  }
}

TEST(Descriptor, RefusesCoefficientsThatChange) {
  const Machine machine = load("scenes/four_bar/overdamped.json");
  State state = reference_state(machine.system(), machine.options(), true, 0.0);
  const Partition partition = choose_partition(machine.system(), state);
  // In motion the pin's rows turn with the crank.
  for (std::size_t i = 0; i < machine.system().x.size(); ++i) state.v[i] = 1.0;
  Descriptor descriptor(machine.system(), partition.rows);
  descriptor.evaluate(state);
  EXPECT_THROW(descriptor.require_constant(), AnalysisError);
}

TEST(Descriptor, FirstOrderFormHasTheSameEigenvalues) {
  const Machine machine = load("scenes/linear/trapped_volumes.json");
  const Both both(machine.system(), machine.options());
  const FirstOrderForm form = first_order_form(both.descriptor);
  const auto size = static_cast<Index>(form.states.size());
  Eigen::MatrixXcd E = Eigen::MatrixXcd::Zero(size, size), A = E;
  for (const Entry& e : form.E) E(e.row, e.column) += e.value;
  for (const Entry& e : form.A) A(e.row, e.column) += e.value;
  for (const Complex s : both.dense) {
    const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXcd>(A - s * E).singularValues();
    const Eigen::VectorXd beside = Eigen::JacobiSVD<Eigen::MatrixXcd>(A - 1.01 * s * E).singularValues();
    EXPECT_LT(singular.tail(1)(0), 1e-9 * beside.tail(1)(0)) << s;
  }
}

}  // namespace
}  // namespace bramah::testing
