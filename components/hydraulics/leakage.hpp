// Leakage past a piston or a spool, laminar at any drop:
//
//   Q = C_L (p_a - p_b)   m^3/s, from a to b
//
//   C_L   m^3/(s.Pa)   coefficient
#pragma once

#include <bramah/component.hpp>

#include "resistor.hpp"

namespace bramah::hydraulics {

struct Leakage : Resistor<Leakage> {
  Parameter C_L = 1e-13;

  void describe(Description& is) {
    is.called("hydraulics/leakage", "laminar leakage between two volumes");
    is.port("a", a, "volume upstream", "Pa");
    is.port("b", b, "volume downstream", "Pa");
    is.parameter("C_L", C_L, "m^3/(s.Pa)").at_least(0.0).doc("flow per drop");
    is.output("flow", flow_out, "m^3/s", "flow from a to b");
  }
  template <class T>
  T flow(const At<T>& at) const {
    return (at(a) - at(b)) * C_L;
  }
};

}  // namespace bramah::hydraulics
