// Comparing numbers so that a failure says everything: found, expected, relative error, tolerance.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <string>
#include <vector>

namespace bramah::testing {

inline ::testing::AssertionResult close(double found, double expected, double tolerance, double scale = 0.0) {
  const double size = std::max(std::abs(expected), scale);
  const double error = size > 0.0 ? std::abs(found - expected) / size : std::abs(found - expected);
  if (error <= tolerance) return ::testing::AssertionSuccess();
  char text[200];
  std::snprintf(text, sizeof text, "found %.17g, expected %.17g, relative error %.3g, tolerance %.3g", found, expected,
                error, tolerance);
  return ::testing::AssertionFailure() << text;
}

/// Takes the eigenvalue nearest to `expected` out of `found` and compares it.
inline ::testing::AssertionResult take_nearest(std::vector<std::complex<double>>& found, std::complex<double> expected,
                                               double tolerance) {
  if (found.empty()) return ::testing::AssertionFailure() << "no eigenvalue left for " << expected;
  const auto nearest = std::min_element(
      found.begin(), found.end(), [&](auto a, auto b) { return std::abs(a - expected) < std::abs(b - expected); });
  const std::complex<double> value = *nearest;
  found.erase(nearest);
  const double error = std::abs(value - expected) / std::max(std::abs(expected), 1e-300);
  if (error <= tolerance) return ::testing::AssertionSuccess();
  char text[240];
  std::snprintf(text, sizeof text, "found %.17g%+.17gi, expected %.17g%+.17gi, relative error %.3g, tolerance %.3g",
                value.real(), value.imag(), expected.real(), expected.imag(), error, tolerance);
  return ::testing::AssertionFailure() << text;
}

}  // namespace bramah::testing
