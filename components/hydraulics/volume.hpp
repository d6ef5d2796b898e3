// A volume of oil at one pressure: one balance, Eq. (1) times K = V / B_e,
//
//   K pdot + Vdot - sum Q = 0   m^3/s
//
// to which hoses and chambers add K and Vdot, orifices Q; the volume by itself stores nothing.
//
//   p   Pa   pressure
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

struct Volume {
  Pressure p;

  void describe(Description& is) {
    is.called("hydraulics/volume", "a volume of oil at one pressure, Eq. (1)");
    is.own("p", p, "Pa", "pressure").nominal(1e6).start(1e5);
  }
};

}  // namespace bramah::hydraulics
