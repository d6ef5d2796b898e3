// The flow through an opening per unit of its coefficient: Eq. (6) with gamma_2 = 1, as a function of the drop.
//
//   f(dp) = dp / sqrt(dp_lim)       |dp| < dp_lim     laminar, Pa^0.5
//   f(dp) = sqrt(|dp|) dp / |dp|    |dp| > dp_lim     turbulent, Pa^0.5
//
// Odd and continuous. The slope falls to half at |dp| = dp_lim: whoever uses this declares laminar_margin as a
// switching function. The paper prints dp where |dp| must be tested.
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

/// |dp| - dp_lim, Pa: negative where the flow is laminar.
template <class T>
T laminar_margin(const T& dp, const Parameter& dp_lim) {
  return abs(dp) - dp_lim;
}

template <class T>
T orifice(const At<T>& at, const T& dp, const Parameter& dp_lim) {
  if (!at.above_zero(laminar_margin(dp, dp_lim))) return dp * (1.0 / sqrt(dp_lim));
  return value(dp) > 0.0 ? sqrt(dp) : -sqrt(-dp);
}

}  // namespace bramah::hydraulics
