// Static friction is the peak: what every law with F_c and F_s asks of its parameters.
#pragma once

#include <bramah/component.hpp>
#include <cstdio>

namespace bramah::friction {

/// A fault where static friction F_s is below Coulomb friction F_c, both N.
inline void check_static_friction(Faults& faults, const Parameter& F_c, const Parameter& F_s) {
  if (F_s >= F_c) return;
  char found[64], expected[64];
  std::snprintf(found, sizeof found, "%g N", F_s.value());
  std::snprintf(expected, sizeof expected, "at least F_c = %g N", F_c.value());
  faults.add("F_s", found, expected);
}

}  // namespace bramah::friction
