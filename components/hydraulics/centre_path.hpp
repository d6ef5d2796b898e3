// The open centre of a directional valve: a path from the pump to the tank that the spool shuts as it moves either way.
//
//   Q = C_v (1 - |U| / U_shut) f(p_a - p_b)   |U| < U_shut     m^3/s, from a to b; f: see orifice.hpp
//   Q = 0                                     |U| > U_shut
//
//   U        spool displacement over its full travel   1
//   U_shut   1                displacement at which the path is shut
//   C_v      m^3/(s.Pa^0.5)   flow coefficient at U = 0
//   dp_lim   Pa               drop between laminar and turbulent
#pragma once

#include <bramah/component.hpp>

#include "orifice.hpp"
#include "resistor.hpp"

namespace bramah::hydraulics {

struct CentrePath : Resistor<CentrePath> {
  Spool U;
  Switch spool_centre, edge, laminar_limit;
  Parameter C_v = 1e-6, U_shut = 1.0, dp_lim = 2e5;

  void describe(Description& is) {
    is.called("hydraulics/centre_path", "the open centre of a directional valve, which its spool shuts");
    is.port("a", a, "volume upstream", "Pa");
    is.port("b", b, "volume downstream", "Pa");
    is.port("U", U, "spool of the directional valve", "1");
    is.parameter("C_v", C_v, "m^3/(s.Pa^0.5)").above(0.0).doc("flow coefficient with the spool centred");
    is.parameter("U_shut", U_shut, "1").by_default(1.0).above(0.0).doc("displacement at which the path is shut");
    is.parameter("dp_lim", dp_lim, "Pa").by_default(2e5).above(0.0).doc("drop at which the flow turns turbulent");
    is.output("flow", flow_out, "m^3/s", "flow from a to b");
    is.switching("spool_centre", spool_centre, "1", 1.0, "the spool: the path begins to close");
    is.switching("edge", edge, "1", 1.0, "what is open of the path: it is shut");
    is.switching("laminar_limit", laminar_limit, "Pa", 1e5, "the drop less dp_lim: the flow turns turbulent");
  }
  /// Share of the path that is open, negative beyond the edge.
  template <class T>
  T opening(const At<T>& at) const {
    return at.above_zero(at(U)) ? T(1.0 - at(U) / U_shut) : T(1.0 + at(U) / U_shut);
  }
  template <class T>
  T flow(const At<T>& at) const {
    const T open = opening(at);
    return at.above_zero(open) ? T(open * orifice(at, T(at(a) - at(b)), dp_lim) * C_v) : T(0.0);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(spool_centre) = at(U);
    s(edge) = opening(at);
    s(laminar_limit) = laminar_margin(T(at(a) - at(b)), dp_lim);
  }
};

}  // namespace bramah::hydraulics
