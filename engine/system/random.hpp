// Random numbers that are the same everywhere: each is a function of its place, by arithmetic that IEEE 754 fixes.
#pragma once

#include <array>
#include <cstdint>

namespace bramah {

/// Philox4x32-10 of Salmon et al., "Parallel random numbers: as easy as 1, 2, 3" (2011): four random words for each counter
/// and key, with no state between them.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// Evenly spread over 0 < share < 1: the odd multiples of 2^-53. Depends on these three numbers alone.
double random_share(std::uint64_t seed, std::uint64_t sample, std::uint32_t parameter);

/// How a number is spread, in its own unit.
struct Distribution {
  enum class Kind { normal, uniform, log_uniform };
  Kind kind = Kind::uniform;
  double first = 0.0, second = 1.0;  // normal: mean, standard deviation; else: lower, upper end

  /// The value that lies above `share` of all, 0 < share < 1.
  [[nodiscard]] double quantile(double share) const;
};

/// The quantile of the standard normal distribution: AS 241 of Wichura (1988), right to a few roundings.
double normal_quantile(double share);

}  // namespace bramah
