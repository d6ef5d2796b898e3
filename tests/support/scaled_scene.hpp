// The same machine in other sizes: every number of a scene written out in SI, then length, mass and time scaled.
#pragma once

#include <string>

#include "support/machine.hpp"

namespace bramah::testing {

struct Factors {
  double length = 1.0, mass = 1.0, time = 1.0;
  /// Of a number in `unit`: 1 for "rad", length for "m", mass / (length time^2) for "Pa".
  [[nodiscard]] double of(const std::string& unit) const;
};

/// The scene of `machine` with all parameters written out, those that the scene leaves to their defaults included, start
/// values and sections as well, each times its factor. Sections that ask for other scenes (sweep, vary, compare, study) are
/// left out. std::logic_error for a section that this function does not know.
Scene scaled_scene(const Machine& machine, const Factors& factors);

/// scaled_scene brought to life.
Machine scaled(const Machine& machine, const Factors& factors);

}  // namespace bramah::testing
