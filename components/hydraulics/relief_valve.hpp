// A relief valve without dynamics: shut below its cracking pressure, flow in proportion to the over-pressure above.
//
//   Q = 0                              p_a - p_b < p_crack     m^3/s, from a to b
//   Q = G_v (p_a - p_b - p_crack)      p_a - p_b > p_crack
//
//   p_crack   Pa            drop at which it opens
//   G_v       m^3/(s.Pa)    flow per over-pressure
#pragma once

#include <bramah/component.hpp>

#include "resistor.hpp"

namespace bramah::hydraulics {

struct ReliefValve : Resistor<ReliefValve> {
  Switch edge;
  Parameter p_crack = 2.5e7, G_v = 1e-9;

  void describe(Description& is) {
    is.called("hydraulics/relief_valve", "opens above a pressure");
    is.port("a", a, "volume that it guards", "Pa");
    is.port("b", b, "volume downstream, the tank", "Pa");
    is.parameter("p_crack", p_crack, "Pa").at_least(0.0).doc("drop at which it opens");
    is.parameter("G_v", G_v, "m^3/(s.Pa)").above(0.0).doc("flow per over-pressure");
    is.output("flow", flow_out, "m^3/s", "flow from a to b");
    is.switching("edge", edge, "Pa", 1e5, "the drop less p_crack: the valve opens");
  }
  template <class T>
  T overpressure(const At<T>& at) const {
    return at(a) - at(b) - p_crack;
  }
  template <class T>
  T flow(const At<T>& at) const {
    const T over = overpressure(at);
    return at.above_zero(over) ? T(over * G_v) : T(0.0);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(edge) = overpressure(at);
  }
};

}  // namespace bramah::hydraulics
