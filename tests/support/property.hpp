// Property tests: few random cases in CI, as many as wanted by hand.
//
//   BRAMAH_PROPERTY_RUNS=100    a hundred times as many cases
//   BRAMAH_PROPERTY_SEED=7      other cases than those of CI
#pragma once

#include <cstdint>
#include <cstdlib>

namespace bramah::support {

/// How many cases to try where CI tries `in_ci`.
inline int property_runs(int in_ci) {
  const char* factor = std::getenv("BRAMAH_PROPERTY_RUNS");
  return in_ci * (factor != nullptr ? std::atoi(factor) : 1);
}

/// Seed of case `k`: the same on every machine, other ones for another BRAMAH_PROPERTY_SEED.
inline std::uint64_t property_seed(int k) {
  const char* seed = std::getenv("BRAMAH_PROPERTY_SEED");
  return 1'000'003 * (seed != nullptr ? std::strtoull(seed, nullptr, 10) : 0) + static_cast<std::uint64_t>(k);
}

}  // namespace bramah::support
