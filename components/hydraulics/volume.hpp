// A volume of oil at one pressure: one balance, Eq. (1) times K = V / B_e,
//
//   K pdot + Vdot - sum Q = 0   m^3/s
//
// to which hoses and chambers add K and Vdot, orifices Q; the volume by itself stores nothing.
//
//   p   Pa   pressure, absolute
// Below zero the oil tears: hoses and chambers follow (oil.hpp), and a warning says so. 1 bar below zero nothing is left
// that could be meant.
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

struct Volume {
  Pressure p;
  Limit absolute;

  void describe(Description& is) {
    is.called("hydraulics/volume", "a volume of oil at one pressure, Eq. (1)");
    is.own("p", p, "Pa", "pressure").nominal(1e6).start(1e5);
    is.valid("p", absolute, "Pa", 1e5, "absolute pressure, below zero of which oil cavitates").at_least(0.0, -1e5);
  }
  template <class T>
  void validity(const At<T>& at, Values<T>& q) const {
    q(absolute) = at(p);
  }
};

}  // namespace bramah::hydraulics
