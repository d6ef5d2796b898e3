// Stick-slip: static friction up to a break-away speed, falling to Coulomb friction beyond it (Stribeck).
//
//   F = F_s sdot / v_b                                                |sdot| < v_b     N, against sdot; creeps, "sticks"
//   F = sgn(sdot) (F_c + (F_s - F_c) exp(-(|sdot| - v_b) / v_s))      |sdot| > v_b     slips
//   and sigma_2 sdot besides
//
//   s         along    m       the length that slides
//   F_c, F_s           N       Coulomb friction, static friction
//   v_b                m/s     break-away speed: below it the creep that stands for sticking
//   v_s                m/s     Stribeck velocity, the decay beyond break-away
//   sigma_2            N.s/m   viscous coefficient
#pragma once

#include <bramah/component.hpp>

#include "static_friction.hpp"

namespace bramah::friction {

struct StickSlip {
  Coordinate along;
  Output force_out;
  Switch break_away;
  Parameter F_c = 0.0, F_s = 0.0, v_b = 1e-4, v_s = 0.01, sigma_2 = 0.0;

  void describe(Description& is) {
    is.called("friction/stick_slip", "static friction up to a break-away speed, Coulomb friction beyond");
    is.port("along", along, "the length that slides", "m");
    is.parameter("F_c", F_c, "N").at_least(0.0).doc("Coulomb friction");
    is.parameter("F_s", F_s, "N").at_least(0.0).doc("static friction, reached at break-away");
    is.parameter("v_b", v_b, "m/s").above(0.0).doc("break-away speed: slower is the creep that stands for sticking");
    is.parameter("v_s", v_s, "m/s").above(0.0).doc("Stribeck velocity: how fast friction falls beyond break-away");
    is.parameter("sigma_2", sigma_2, "N.s/m").by_default(0.0).at_least(0.0).doc("viscous coefficient");
    is.output("force", force_out, "N", "friction, positive against positive speed");
    is.switching("break_away", break_away, "m/s", 1e-3, "the speed's magnitude less v_b: it slips");
  }
  void check(Faults& faults) const { check_static_friction(faults, F_c, F_s); }
  template <class T>
  T force(const At<T>& at) const {
    const T& sdot = at.rate(along);
    const T beyond = abs(sdot) - v_b;  // m/s
    if (!at.above_zero(beyond)) return sdot * (F_s / v_b + sigma_2);
    const T dry = F_c + (F_s - F_c) * exp(-beyond / v_s);
    return (value(sdot) < 0.0 ? T(-dry) : dry) + sdot * sigma_2;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(along, -force(at));
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(force_out) = force(at);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(break_away) = abs(at.rate(along)) - v_b;
  }
};

}  // namespace bramah::friction
