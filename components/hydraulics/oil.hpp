// Compliance of oil that holds free air and turns into vapour: what 1 / B_oil of Eqs. (2) and (75) becomes where oil is
// pulled. Pressures are absolute.
//
//   kappa(p) = 1 / B_oil + alpha p_0 / q^2 + w^2 / p_w^3   1/Pa    per volume of oil
//   q = (p + sqrt(p^2 + 4 p_w^2)) / 2                      Pa      p where it is large, and above zero everywhere
//   w = max(0, -p)                                         Pa
//
//   alpha  air   1    share of the volume that is free air at p_0 (isothermal: its volume goes as 1 / p); default 0
//   p_0          Pa   1.01325e5, the atmosphere
//   p_w          Pa   1e4: within a few of it below zero the oil tears
// Oil does not pull: below zero vapour takes up the volume that is missing, w^3 / (3 p_w^3) of that of the oil. The vapour
// pressure of hydraulic oil, some 10 Pa, is taken as zero. Above zero and without air kappa is 1 / B_oil to the last bit.
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

inline constexpr double atmosphere = 101325.0;  // Pa
inline constexpr double tearing = 1e4;          // Pa, p_w

/// kappa(p) less 1 / B_oil, 1/Pa.
template <class T>
T gas_compliance(const T& p, const Parameter& air) {
  const T q = 0.5 * (p + sqrt(square(p) + 4.0 * tearing * tearing)), w = positive_part(T(-p));
  return air * atmosphere / square(q) + square(w) / (tearing * tearing * tearing);
}

/// int (kappa - 1 / B_oil) p dp from the atmosphere on, J/m^3.
template <class T>
T gas_energy(const T& p, const Parameter& air) {
  constexpr double s4 = tearing * tearing * tearing * tearing;
  const T q = 0.5 * (p + sqrt(square(p) + 4.0 * tearing * tearing)), w = positive_part(T(-p));
  return air * atmosphere * (log(q / atmosphere) + s4 / (4.0 * square(square(q)))) +
         square(square(w)) / (4.0 * tearing * tearing * tearing);
}

inline void describe_air(Description& is, Parameter& air) {
  is.parameter("air", air, "1")
      .by_default(0.0)
      .at_least(0.0)
      .below(1.0)
      .doc("share of the volume that is free air at the atmosphere's pressure");
}

}  // namespace bramah::hydraulics
