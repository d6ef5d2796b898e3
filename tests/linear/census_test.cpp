// The count of zeros foretold from unreduced, sparse coefficients against the one found in the reduced Jacobian.
#include "linear/census.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "linear/staircase.hpp"
#include "solve/start.hpp"
#include "support/machine.hpp"

namespace bramah::testing {
namespace {

std::vector<int> found_blocks(const LinearModel& model) {
  std::vector<int> sizes;
  for (const ZeroBlock& block : find_spectrum(model).zeros) sizes.push_back(block.size);
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

TEST(Census, ForetellsTheZerosOfEveryScene) {
  int compared = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(BRAMAH_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".json") continue;
    const std::string file = std::filesystem::relative(entry.path(), BRAMAH_SOURCE_DIR).string();
    SCOPED_TRACE(file);
    const Machine machine = load(file);
    const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
    const State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
    Descriptor descriptor(machine.system(), choose_partition(machine.system(), state).rows);
    descriptor.evaluate(state);
    if (!descriptor.changing().empty()) continue;
    const ZeroPrediction predicted = predict_zeros(descriptor);
    EXPECT_EQ(predicted.block_sizes, found_blocks(linear_model(machine, state)));
    // A gap of ten orders between what counts as a pivot and what does not.
    EXPECT_GT(predicted.accepted, 1e-5);
    EXPECT_LT(predicted.refused, 1e-14);
    ++compared;
  }
  EXPECT_GE(compared, 14);
}

}  // namespace
}  // namespace bramah::testing
