// Random numbers against published vectors, inverse functions and moments.
#include "system/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/numbers.hpp"

namespace bramah {
namespace {

using testing::close;
using Words = std::array<std::uint32_t, 4>;

TEST(Random, PhiloxGivesThePublishedVectors) {
  // kat_vectors of Random123, philox4x32 with 10 rounds.
  constexpr std::uint32_t ones = 0xffffffff;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({ones, ones, ones, ones}, {ones, ones}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, ShareIsMadeOfTheFirst52Bits) {
  EXPECT_EQ(random_share(0, 0, 0), (static_cast<double>(0x6627e8d5e169cULL) + 0.5) / 4503599627370496.0);
  EXPECT_NE(random_share(1, 0, 0), random_share(0, 0, 0));
  EXPECT_NE(random_share(0, 1, 0), random_share(0, 0, 1));
  EXPECT_NE(random_share(std::uint64_t{1} << 32U, 0, 0), random_share(0, 0, 0));
  EXPECT_NE(random_share(0, std::uint64_t{1} << 32U, 0), random_share(0, 0, 0));
}

TEST(Random, NormalQuantileInvertsTheDistribution) {
  // A relative error of x, here of a few roundings, moves the share by x^2 times as much in the tail.
  for (double share = 0.5; share > 1e-300; share *= 0.37) {
    const double x = normal_quantile(share);
    EXPECT_TRUE(close(0.5 * std::erfc(-x / std::sqrt(2.0)), share, 1e-15 * (2.0 + x * x))) << share;
  }
  for (const double share : {0.07, 0.2, 0.4, 0.0625})
    EXPECT_EQ(normal_quantile(1.0 - share), -normal_quantile(1.0 - (1.0 - share)));
  EXPECT_EQ(normal_quantile(0.5), 0.0);
}

TEST(Random, LogUniformIsUniformInTheLogarithm) {
  const Distribution d{Distribution::Kind::log_uniform, 1e-3, 1e5};
  for (const double share : {1e-16, 0.1, 0.25, 0.5, 0.7, 0.99})
    EXPECT_TRUE(close(d.quantile(share), std::pow(10.0, -3.0 + 8.0 * share), 1e-14)) << share;
}

TEST(Random, MomentsAreThoseOfTheDistribution) {
  // Deviations of mean and variance from theory within five standard errors; the numbers are fixed by the seed.
  constexpr int count = 20000;
  const auto moments = [](const Distribution& d, std::uint32_t parameter) {
    double sum = 0.0, squares = 0.0;
    for (std::uint64_t k = 0; k < count; ++k) {
      const double value = d.quantile(random_share(7, k, parameter));
      sum += value;
      squares += value * value;
    }
    const double mean = sum / count;
    return std::pair{mean, squares / count - mean * mean};
  };
  const double error = 5.0 / std::sqrt(static_cast<double>(count));
  const auto [normal_mean, normal_variance] = moments({Distribution::Kind::normal, 3.0, 2.0}, 0);
  EXPECT_NEAR(normal_mean, 3.0, 2.0 * error);
  EXPECT_NEAR(normal_variance, 4.0, 4.0 * std::sqrt(2.0) * error);
  const auto [uniform_mean, uniform_variance] = moments({Distribution::Kind::uniform, 0.0, 1.0}, 1);
  EXPECT_NEAR(uniform_mean, 0.5, std::sqrt(1.0 / 12.0) * error);
  EXPECT_NEAR(uniform_variance, 1.0 / 12.0, std::sqrt(1.0 / 180.0) * error);
}

TEST(Random, ParametersAndSamplesDoNotGoTogether) {
  // Correlation of neighbours within five standard errors.
  constexpr int count = 20000;
  double parameters = 0.0, samples = 0.0;
  for (std::uint64_t k = 0; k < count; ++k) {
    const double share = random_share(1, k, 0) - 0.5;
    parameters += share * (random_share(1, k, 1) - 0.5);
    samples += share * (random_share(1, k + 1, 0) - 0.5);
  }
  const double most = 5.0 / std::sqrt(static_cast<double>(count));
  EXPECT_LT(std::abs(12.0 * parameters / count), most);
  EXPECT_LT(std::abs(12.0 * samples / count), most);
}

}  // namespace
}  // namespace bramah
