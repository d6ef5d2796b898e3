// Rungs (a) to (d) beside the reduced spectrum: where they agree, and by how much they do not.
#include "linear/rungs.hpp"

#include "linear/augmented.hpp"
#include "linear/eigenpairs.hpp"
#include "solve/equilibrium.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "system/analysis_error.hpp"

namespace bramah::testing {
namespace {

using Inverse = AugmentedByDifferences::Inverse;

/// A machine at a reference state with the spectrum of its reduced model.
struct Reference {
  explicit Reference(Compiled compiled)
      : model(std::move(compiled)),
        state(model.options.linearize.at == LinearizeOptions::At::start
                  ? consistent_start(system(), model.options, 0.0)
                  : find_equilibrium(system(), model.options.equilibrium).state),
        partition(choose_partition(system(), state, model.options.linearize.prescribed)) {
    LinearModel linear;
    Linearizer linearizer(system(), partition);
    linearizer.linearize(state, linear);
    linearizer.estimate_rounding(linear);
    const Spectrum spectrum = find_spectrum(linear);
    zeros = static_cast<std::size_t>(spectrum.zero_count());
    double logarithms = 0.0;
    for (const Mode& mode : spectrum.modes) {
      if (mode.zero) continue;
      nonzero.push_back(mode.eigenvalue);
      logarithms += std::log(std::abs(mode.eigenvalue));
    }
    how.budget = 0.0;
    how.shift = std::exp(logarithms / static_cast<double>(nonzero.size()));
  }
  [[nodiscard]] const System& system() const { return model.system; }
  [[nodiscard]] Contender on(Rung rung) const {
    Contender contender = measure(rung, system(), partition, state, how);
    hold_against(nonzero, zeros, contender);
    return contender;
  }
  Compiled model;
  State state;
  Partition partition;
  Eigenvalues nonzero;
  std::size_t zeros = 0;
  Measuring how;
};

Reference of(const std::string& scene) { return Reference(load(scene).compiled); }

struct Case {
  std::string name, scene;
  double pencil, differences;  // worst errors allowed: rounding times condition; truncation of h = 1e-5
  // NOLINTNEXTLINE(readability-identifier-naming): the name that GoogleTest looks for
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

class Rungs : public ::testing::TestWithParam<Case> {};

TEST_P(Rungs, AgreeWithTheReducedSpectrum) {
  const Case& c = GetParam();
  const Reference machine = of(c.scene);
  // One for every row of positions, one for that of velocities that follows from it, one for every nonholonomic row.
  const auto rows = static_cast<long>(machine.partition.rows.size());
  const long false_zeros = rows + static_cast<long>(machine.partition.holonomic);
  const Contender reduced = machine.on(Rung::reduced), augmented = machine.on(Rung::augmented),
                  pencil = machine.on(Rung::pencil), dense = machine.on(Rung::differences),
                  sparse = machine.on(Rung::sparse_differences);
  EXPECT_LT(reduced.worst_error(), 1e-12);
  EXPECT_EQ(reduced.false_zeros, 0);
  EXPECT_LT(augmented.worst_error(), 1e-10);
  EXPECT_EQ(augmented.false_zeros, false_zeros);
  EXPECT_LT(pencil.worst_error(), c.pencil);
  EXPECT_EQ(pencil.false_zeros, 0);
  EXPECT_LT(dense.worst_error(), c.differences);
  EXPECT_LT(sparse.worst_error(), c.differences);
  EXPECT_GT(dense.worst_error(), 1e-12);  // differences never are exact
  EXPECT_EQ(dense.false_zeros, false_zeros);
  EXPECT_EQ(sparse.false_zeros, false_zeros);
}

INSTANTIATE_TEST_SUITE_P(Machines, Rungs,
                         ::testing::Values(Case{"four_bar", "scenes/four_bar/overdamped.json", 1e-12, 1e-4},
                                           Case{"four_bar_in_space", "scenes/four_bar/spatial.json", 1e-10, 1e-3},
                                           Case{"chain_in_space", "scenes/linear/hanging_chain_spatial.json", 1e-10,
                                                1e-8},
                                           Case{"skate", "scenes/rolling/skate.json", 1e-11, 1e-8}),
                         [](const auto& p) { return p.param.name; });

TEST(Rungs, OnlyFalseZerosMakeAStableMachineLookUnstable) {
  const Reference machine = of("scenes/four_bar/overdamped.json");
  EXPECT_FALSE(machine.on(Rung::reduced).looks_unstable);
  EXPECT_FALSE(machine.on(Rung::pencil).looks_unstable);
  EXPECT_TRUE(machine.on(Rung::augmented).looks_unstable);
  EXPECT_TRUE(machine.on(Rung::differences).looks_unstable);
  EXPECT_TRUE(machine.on(Rung::sparse_differences).looks_unstable);
}

TEST(Rungs, ReportSizesAndTimes) {
  const Reference machine = of("scenes/four_bar/overdamped.json");
  constexpr Index n = 10, m = 9, nz = 4;
  EXPECT_EQ(machine.on(Rung::reduced).size, 2 * n - 2 * m + nz);
  EXPECT_EQ(machine.on(Rung::augmented).size, 2 * n + nz);
  EXPECT_EQ(machine.on(Rung::differences).size, 2 * n + nz);
  EXPECT_EQ(machine.on(Rung::sparse_differences).size, 2 * n + nz);
  EXPECT_EQ(machine.on(Rung::pencil).size, 2 * n + m + nz);
  for (const Rung rung : all_rungs) {
    const Contender contender = machine.on(rung);
    // Measured, that is: not NaN. On a busy machine a difference of two times may be zero.
    EXPECT_GE(contender.cost.assembly, 0.0) << name_of(rung);
    EXPECT_GE(contender.cost.reduction, 0.0) << name_of(rung);
    EXPECT_GE(contender.cost.eigenvalues, 0.0) << name_of(rung);
  }
}

TEST(Differences, AreTheSameByDenseInversesAndSparseFactors) {
  // One formula, two ways to A^-1: they differ by rounding over the step, relative to the terms of a column.
  constexpr double h = 1e-3;
  const Reference machine = of("scenes/four_bar/overdamped.json");
  const auto by = [&](Inverse inverse) {
    return AugmentedByDifferences(machine.system(), machine.partition, inverse).jacobian(machine.state, h);
  };
  const Eigen::MatrixXd dense = by(Inverse::dense), sparse = by(Inverse::sparse);
  for (Eigen::Index j = 0; j < dense.cols(); ++j) {
    const double size = std::max(1.0, dense.col(j).norm());
    EXPECT_LT((sparse.col(j) - dense.col(j)).norm() / size, 1e-6) << "column " << j;
  }
  AugmentedByDifferences columns(machine.system(), machine.partition, Inverse::sparse);
  columns.start(machine.state);
  for (const Eigen::Index j : {20, 12, 3, 13})  // factors are taken anew where the ones at hand are of another point
    EXPECT_EQ(columns.column(j, h), sparse.col(j)) << "column " << j;
}

TEST(Pencil, FindsTheNearestEigenvaluesOfAChain) {
  const Reference machine(support::compiled(support::planar_chain(40)));
  Descriptor descriptor(machine.system(), machine.partition.rows);
  descriptor.evaluate(machine.state);
  AugmentedPencil pencil(descriptor);
  pencil.factor(0.5);
  EXPECT_EQ(pencil.size(), 2 * 120 + 80);
  Eigenvalues found = pencil.nearest(20);
  ASSERT_EQ(found.size(), 20U);
  const Eigenpairs expected = find_nearest(descriptor, 10, 0.5, 0, Proof::wanted);
  for (const Eigenpair& pair : expected.pairs) EXPECT_TRUE(take_nearest(found, pair.eigenvalue, 1e-11));
}

TEST(Pencil, SaysThatItsShiftIsAnEigenvalue) {
  const Reference machine = of("scenes/four_bar/overdamped.json");  // the oil is shut in: 0 is an eigenvalue
  Descriptor descriptor(machine.system(), machine.partition.rows);
  descriptor.evaluate(machine.state);
  AugmentedPencil pencil(descriptor);
  try {
    pencil.factor(0.0);
    FAIL() << "no error";
  } catch (const AnalysisError& error) {
    EXPECT_STREQ(
        error.what(),
        "compare: a singular matrix at the shift 0 1/s; expected a shift that is no eigenvalue; move the shift");
  }
}

TEST(HoldAgainst, EachEigenvalueIsClaimedOnceNearestPairsFirst) {
  Contender contender;
  contender.eigenvalues = {{-1.001, 0.0}, {-0.9, 0.0}, {1e-7, 2e-7}, {-3e-7, 0.0}};
  hold_against({{-1.0, 0.0}, {-1.002, 0.0}}, 1, contender);
  ASSERT_EQ(contender.errors.size(), 2U);
  EXPECT_TRUE(close(contender.errors[1], 0.001 / 1.002, 1e-12));  // nearer to -1.001 than -1 is, relatively
  EXPECT_TRUE(close(contender.errors[0], 0.1, 1e-12));
  EXPECT_TRUE(close(contender.worst_error(), 0.1, 1e-12));
  EXPECT_EQ(contender.false_zeros, 1);
  EXPECT_TRUE(close(contender.largest_false_zero, 3e-7, 1e-12));
  EXPECT_TRUE(close(contender.largest_real_part, 1e-7, 1e-12));
  EXPECT_TRUE(contender.looks_unstable);
}

}  // namespace
}  // namespace bramah::testing
