// Friction of Brown and McPhee: Coulomb, stiction and viscous friction in one smooth function of the speed. Eq. (8):
//
//   F = F_c tanh(4 w) + (F_s - F_c) w / (w^2 / 4 + 3 / 4)^2 + sigma_2 k sdot,   w = sdot / v_s     N, against sdot
//
//   s         along         m         the length that slides
//   F_c       N             Coulomb friction
//   F_s       N             static friction: the peak, at w = 1 or near it
//   v_s       m/s           Stribeck velocity
//   sigma_2   N.s/m         viscous coefficient
//   k         viscous_factor   1 as Eq. (8) prints, or tanh 4 as Brown and McPhee
#pragma once

#include <bramah/component.hpp>

#include "static_friction.hpp"

namespace bramah::friction {

struct BrownMcPhee {
  Coordinate along;
  Output force_out;
  Parameter F_c = 0.0, F_s = 0.0, v_s = 1.0, sigma_2 = 0.0;
  int viscous_factor = 0;

  void describe(Description& is) {
    is.called("friction/brown_mcphee", "smooth Coulomb, static and viscous friction, Eq. (8)");
    is.port("along", along, "the length that slides", "m");
    is.parameter("F_c", F_c, "N").at_least(0.0).doc("Coulomb friction");
    is.parameter("F_s", F_s, "N").at_least(0.0).doc("static friction");
    is.parameter("v_s", v_s, "m/s").above(0.0).doc("Stribeck velocity");
    is.parameter("sigma_2", sigma_2, "N.s/m").at_least(0.0).doc("viscous coefficient");
    is.choice("viscous_factor", viscous_factor, {"one", "tanh4"})
        .by_default(0.0)
        .doc("factor of the viscous term: 1 as Eq. (8) prints, or tanh 4 as Brown and McPhee");
    is.output("force", force_out, "N", "friction, positive against positive speed");
  }
  void check(Faults& faults) const { check_static_friction(faults, F_c, F_s); }
  template <class T>
  T force(const At<T>& at) const {
    const T& sdot = at.rate(along);
    const T w = sdot / v_s;
    const Parameter viscous = viscous_factor == 0 ? sigma_2 : sigma_2 * std::tanh(4.0);
    return F_c * tanh(4.0 * w) + (F_s - F_c) * w / square(0.25 * square(w) + 0.75) + viscous * sdot;  // Eq. (8)
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(along, -force(at));
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(force_out) = force(at);
  }
};

}  // namespace bramah::friction
