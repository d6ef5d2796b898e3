// A check valve: a spring holds it shut up to p_crack, the rest of the drop drives the flow.
//
//   Q = 0                              p_a - p_b < p_crack     m^3/s, from a to b
//   Q = C_v f(p_a - p_b - p_crack)     p_a - p_b > p_crack     f: see orifice.hpp
//
//   p_crack   Pa                drop at which it opens
//   C_v       m^3/(s.Pa^0.5)    flow coefficient
//   dp_lim    Pa                drop beyond p_crack at which the flow turns turbulent
#pragma once

#include <bramah/component.hpp>

#include "orifice.hpp"
#include "resistor.hpp"

namespace bramah::hydraulics {

struct CheckValve : Resistor<CheckValve> {
  Switch edge, laminar_limit;
  Parameter p_crack = 0.0, C_v = 1e-6, dp_lim = 2e5;

  void describe(Description& is) {
    is.called("hydraulics/check_valve", "lets oil pass one way");
    is.port("a", a, "volume upstream", "Pa");
    is.port("b", b, "volume downstream", "Pa");
    is.parameter("p_crack", p_crack, "Pa").by_default(0.0).at_least(0.0).doc("drop at which it opens");
    is.parameter("C_v", C_v, "m^3/(s.Pa^0.5)").above(0.0).doc("flow coefficient");
    is.parameter("dp_lim", dp_lim, "Pa")
        .by_default(2e5)
        .above(0.0)
        .doc("drop beyond p_crack at which the flow turns turbulent");
    is.output("flow", flow_out, "m^3/s", "flow from a to b");
    is.switching("edge", edge, "Pa", 1e5, "the drop less p_crack: the valve opens");
    is.switching("laminar_limit", laminar_limit, "Pa", 1e5,
                 "the drop less p_crack and dp_lim: the flow turns turbulent");
  }
  /// The drop (Pa) that drives the flow; shut where it is negative.
  template <class T>
  T drive(const At<T>& at) const {
    return at(a) - at(b) - p_crack;
  }
  template <class T>
  T flow(const At<T>& at) const {
    const T dp = drive(at);
    return at.above_zero(dp) ? T(orifice(at, dp, dp_lim) * C_v) : T(0.0);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(edge) = drive(at);
    s(laminar_limit) = drive(at) - dp_lim;
  }
};

}  // namespace bramah::hydraulics
