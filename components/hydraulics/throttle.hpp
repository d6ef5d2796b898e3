// A throttle valve: laminar below dp_lim, turbulent above. Eqs. (5), (6):
//
//   Q = C_vt f(p_a - p_b),  C_vt = C_d A_t sqrt(2 / rho_oil)   m^3/s, from a to b; f: see orifice.hpp
//
//   C_d       1        discharge coefficient
//   A_t       m^2      area
//   rho_oil   kg/m^3   density of the oil
//   dp_lim    Pa       drop between laminar and turbulent
#pragma once

#include <bramah/component.hpp>

#include "orifice.hpp"
#include "resistor.hpp"

namespace bramah::hydraulics {

struct Throttle : Resistor<Throttle> {
  Switch laminar_limit;
  Parameter C_d = 0.8, A_t = 1e-5, rho_oil = 850.0, dp_lim = 2e5;

  void describe(Description& is) {
    is.called("hydraulics/throttle", "a throttle valve, Eqs. (5), (6)");
    is.port("a", a, "volume upstream", "Pa");
    is.port("b", b, "volume downstream", "Pa");
    is.parameter("C_d", C_d, "1").above(0.0).typical(0.1, 1.5).doc("discharge coefficient");
    is.parameter("A_t", A_t, "m^2").at_least(0.0).typical(1e-9, 1e-2).doc("area of the opening");
    is.parameter("rho_oil", rho_oil, "kg/m^3").above(0.0).typical(500.0, 2000.0).doc("density of the oil");
    is.parameter("dp_lim", dp_lim, "Pa").by_default(2e5).above(0.0).doc("drop at which the flow turns turbulent");
    is.output("flow", flow_out, "m^3/s", "flow from a to b");
    is.switching("laminar_limit", laminar_limit, "Pa", 1e5, "the drop less dp_lim: the flow turns turbulent");
  }
  template <class T>
  T flow(const At<T>& at) const {
    const Parameter C_vt = C_d * A_t * sqrt(2.0 / rho_oil);  // m^3/(s.Pa^0.5), Eq. (5)
    return orifice(at, T(at(a) - at(b)), dp_lim) * C_vt;
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(laminar_limit) = laminar_margin(T(at(a) - at(b)), dp_lim);
  }
};

}  // namespace bramah::hydraulics
