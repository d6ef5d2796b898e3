#include "system/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bramah {
namespace {

// The C library's logarithm and exponential may differ in the last bit from one machine to another; these do not, because
// +, -, *, / and sqrt are rounded the same everywhere. The build forbids to contract them in this file.

/// ln(x) for x > 0, to about 2e-16: 2 artanh((m - 1) / (m + 1)) of the mantissa m, by its series.
double logarithm(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.5 * std::numbers::sqrt2) {
    m *= 2.0;
    --exponent;
  }
  const double s = (m - 1.0) / (m + 1.0), s2 = s * s;  // s2 < 0.0295
  double sum = 0.0;
  for (int k = 25; k >= 1; k -= 2) sum = sum * s2 + 1.0 / k;
  return exponent * std::numbers::ln2 + 2.0 * s * sum;
}

/// exp(x), to about 2e-16 (1 + |x|): the series after multiples of ln 2.
double exponential(double x) {
  const double multiple = std::floor(x / std::numbers::ln2 + 0.5), r = x - multiple * std::numbers::ln2;  // |r| < 0.35
  double sum = 1.0;
  for (int k = 16; k >= 1; --k) sum = 1.0 + sum * r / k;
  return std::ldexp(sum, static_cast<int>(multiple));
}

template <std::size_t count>
double polynomial(const std::array<double, count>& coefficients, double x) {
  double sum = 0.0;
  for (std::size_t k = count; k-- > 0;) sum = sum * x + coefficients[k];
  return sum;
}

// clang-format off
constexpr std::array
    centre_above = {3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3, 1.3731693765509461125e4,
                    4.5921953931549871457e4, 6.7265770927008700853e4, 3.3430575583588128105e4, 2.5090809287301226727e3},
    centre_below = {1.0,                     4.2313330701600911252e1, 6.8718700749205790830e2, 5.3941960214247511077e3,
                    2.1213794301586595867e4, 3.9307895800092710610e4, 2.8729085735721942674e4, 5.2264952788528545610e3},
    side_above =   {1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0, 3.64784832476320460504e0,
                    1.27045825245236838258e0, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4},
    side_below =   {1.0,                      2.05319162663775882187e0, 1.67638483018380384940e0, 6.89767334985100004550e-1,
                    1.48103976427480074590e-1, 1.51986665636164571966e-2, 5.47593808499534494600e-4, 1.05075007164441684324e-9},
    tail_above =   {6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0, 2.96560571828504891230e-1,
                    2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7},
    tail_below =   {1.0,                      5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2,
                    7.86869131145613259100e-4, 1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15};
// clang-format on

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t factor_0 = 0xD2511F53, factor_1 = 0xCD9E8D57;
  constexpr std::uint32_t step_0 = 0x9E3779B9, step_1 = 0xBB67AE85;
  constexpr int rounds = 10;
  const auto high = [](std::uint64_t product) { return static_cast<std::uint32_t>(product >> 32U); };
  const auto low = [](std::uint64_t product) { return static_cast<std::uint32_t>(product); };
  for (int round = 0; round < rounds; ++round) {
    const std::uint64_t p = factor_0 * counter[0], q = factor_1 * counter[2];
    counter = {high(q) ^ counter[1] ^ key[0], low(q), high(p) ^ counter[3] ^ key[1], low(p)};
    key[0] += step_0;
    key[1] += step_1;
  }
  return counter;
}

double random_share(std::uint64_t seed, std::uint64_t sample, std::uint32_t parameter) {
  const auto high = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32U); };
  const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
  const auto words = philox({low(sample), high(sample), parameter, 0}, {low(seed), high(seed)});
  const std::uint64_t bits = ((static_cast<std::uint64_t>(words[0]) << 32U) | words[1]) >> 12U;  // 52 of them
  return (static_cast<double>(bits) + 0.5) * 0x1p-52;                                            // exact
}

double normal_quantile(double share) {
  const double q = share - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(centre_above, r) / polynomial(centre_below, r);
  }
  const double r = std::sqrt(-logarithm(std::min(share, 1.0 - share)));
  const double size = r <= 5.0 ? polynomial(side_above, r - 1.6) / polynomial(side_below, r - 1.6)
                               : polynomial(tail_above, r - 5.0) / polynomial(tail_below, r - 5.0);
  return q < 0.0 ? -size : size;
}

double Distribution::quantile(double share) const {
  switch (kind) {
    case Kind::normal: return first + second * normal_quantile(share);
    case Kind::uniform: return (1.0 - share) * first + share * second;
    case Kind::log_uniform: break;
  }
  return std::clamp(first * exponential(share * logarithm(second / first)), first, second);
}

}  // namespace bramah
