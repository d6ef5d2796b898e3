// The count of zeros foretold from unreduced, sparse coefficients against the one found in the reduced Jacobian.
#include "linear/census.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "linear/augmented.hpp"
#include "linear/staircase.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/random_machine.hpp"
#include "support/shipped.hpp"
#include "system/analysis_error.hpp"

namespace bramah::testing {
namespace {

using Eigen::MatrixXd;

std::vector<int> block_sizes(const Spectrum& spectrum) {
  std::vector<int> sizes;
  for (const ZeroBlock& block : spectrum.zeros) sizes.push_back(block.size);
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

TEST(Census, ForetellsTheZerosOfEveryScene) {
  int compared = 0;
  for (const std::string& file : shipped_scenes()) {
    SCOPED_TRACE(file);
    const Machine machine = load(file);
    const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
    const State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
    Descriptor descriptor(machine.system(), choose_partition(machine.system(), state).rows);
    descriptor.evaluate(state);
    if (!descriptor.changing().empty()) continue;
    const ZeroPrediction predicted = predict_zeros(descriptor);
    EXPECT_EQ(predicted.block_sizes, block_sizes(find_spectrum(linear_model(machine, state))));
    // A gap of ten orders between what counts as a pivot and what does not.
    EXPECT_GT(predicted.accepted, 1e-5);
    EXPECT_LT(predicted.refused, 1e-14);
    ++compared;
  }
  EXPECT_GE(compared, 14);
}

// The pole starts to fall from rest: its constraint's coefficients stand still at first, and their second derivatives
// couple fall and cart. J has a block of 4 for that, P(s) two of 2; so P(s) is not to be asked.
TEST(Census, IsNotAskedWhereAMachineStartsToFall) {
  const Machine machine = load("scenes/benchmarks/light_cart_pole.json");
  const State state = reference_state(machine.system(), machine.options(), false, 0.0);
  EXPECT_EQ(block_sizes(find_spectrum(linear_model(machine, state))), (std::vector<int>{4, 2}));
  Descriptor descriptor(machine.system(), choose_partition(machine.system(), state).rows);
  descriptor.evaluate(state);
  EXPECT_EQ(predict_zeros(descriptor).block_sizes, (std::vector<int>{2, 2, 2}));
  EXPECT_EQ(descriptor.changing(),
            "a coefficient of the constraint hinge.x changes along the reference motion, by 9.81 per second squared");
  EXPECT_THROW(descriptor.require_constant(), AnalysisError);
}

// What a reader of the unreduced spectrum would call unstable: a real part above a part of the fastest eigenvalue that is
// 10^7 times the rounding of a double. Smaller real parts may be taken for none.
constexpr double visible = 1e-9;
constexpr double difference_step = 1e-5;  // where Fig. 14 has its minimum
constexpr Index most_coordinates_differences = 40;

bool looks_unstable(const std::vector<std::complex<double>>& eigenvalues) {
  double fastest = 0.0, growth = 0.0;
  for (const std::complex<double> s : eigenvalues) {
    fastest = std::max(fastest, std::abs(s));
    growth = std::max(growth, s.real());
  }
  return growth > visible * fastest;
}

TEST(Census, IsRightOnRandomMachines) {
  constexpr int machines = 300;
  int compared = 0, called_unstable = 0, exact_called_unstable = 0;
  Index zeros = 0, settled = 0;
  double accepted = 1.0, refused = 0.0;
  for (int seed = 1; seed <= machines; ++seed) {
    const support::RandomMachine random = support::random_machine(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + support::scene_text(random.scene));
    const Compiled machine = support::compiled(random.scene);
    const System& system = machine.system;
    const bool equilibrium = machine.options.linearize.at == LinearizeOptions::At::equilibrium;
    const State state = reference_state(system, machine.options, equilibrium, 0.0);
    const Partition partition = choose_partition(system, state);
    Linearizer linearizer(system, partition);
    LinearModel model, augmented;
    linearizer.linearize(state, model);
    linearizer.estimate_rounding(model);
    Spectrum spectrum = find_spectrum(model);
    Descriptor descriptor(system, partition.rows);
    descriptor.evaluate(state);
    EXPECT_EQ(descriptor.changing(), "");
    const ZeroPrediction predicted = predict_zeros(descriptor);

    EXPECT_EQ(predicted.block_sizes, random.zero_blocks);
    EXPECT_EQ(spectrum.unstable_count(), 0);
    // Seed 258: multipliers known to 4e-10 leave more in the row of a motion that nothing restores than the estimate of
    // its rounding. The reduced Jacobian alone is in doubt there; together with the foretold count it is not.
    settled += std::count_if(spectrum.modes.begin(), spectrum.modes.end(), [](const Mode& m) { return m.doubtful; });
    settle_doubtful(model, predicted, spectrum);
    EXPECT_EQ(block_sizes(spectrum), random.zero_blocks);
    EXPECT_EQ(spectrum.zero_count(), predicted.count());
    EXPECT_EQ(spectrum.left.cols() + spectrum.zero_count(), spectrum.right.cols());
    EXPECT_TRUE(std::none_of(spectrum.modes.begin(), spectrum.modes.end(), [](const Mode& m) { return m.doubtful; }));
    zeros += predicted.count();
    accepted = std::min(accepted, predicted.accepted);
    refused = std::max(refused, predicted.refused);

    if (system.n() > most_coordinates_differences) continue;
    ++compared;
    const MatrixXd differences = AugmentedByDifferences(system, partition, AugmentedByDifferences::Inverse::dense)
                                     .jacobian(state, difference_step);
    if (looks_unstable(plain_eigenvalues(differences))) ++called_unstable;
    linearizer.linearize_augmented(state, augmented);
    if (looks_unstable(plain_eigenvalues(augmented))) ++exact_called_unstable;
  }
  EXPECT_LE(settled, 2);  // one pair in all
  // A gap of six orders between what counts as a pivot and what does not.
  EXPECT_GT(accepted, 1e-6);
  EXPECT_LT(refused, 1e-12);
  EXPECT_GE(compared, 200);
  std::printf(
      "%d stable machines, %d zeros, none called unstable; %d of them unreduced: %d called unstable with "
      "differences (%.0f %%), %d with exact derivatives (%.0f %%)\n",
      machines, static_cast<int>(zeros), compared, called_unstable, 100.0 * called_unstable / compared,
      exact_called_unstable, 100.0 * exact_called_unstable / compared);
  RecordProperty("zeros", static_cast<int>(zeros));
  RecordProperty("unreduced", compared);
  RecordProperty("called_unstable_with_differences", called_unstable);
  RecordProperty("called_unstable_with_exact_derivatives", exact_called_unstable);
}

}  // namespace
}  // namespace bramah::testing
