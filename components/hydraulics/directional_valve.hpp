// A 4/3 directional valve whose spool lags its reference. Eqs. (3), (4), (6):
//
//   U > 0:   pump -> A  C_v U f(p_P - p_A),     B -> tank  C_v U f(p_B - p_T)       m^3/s
//   U < 0:   A -> tank  C_v |U| f(p_A - p_T),   pump -> B  C_v |U| f(p_P - p_B)     f: see orifice.hpp
//   tau Udot = U_ref - U
//
//   U        spool displacement over its full travel   1
//   U_ref    reference                                 1
//   C_v      m^3/(s.Pa^0.5)   flow coefficient, fully open
//   dp_lim   Pa               drop between laminar and turbulent
//   tau      s                time constant of the spool
// The slope in U jumps at U = 0, where the paths change: derivatives there are those of the side that is asked for.
#pragma once

#include <bramah/component.hpp>

#include "orifice.hpp"

namespace bramah::hydraulics {

struct DirectionalValve {
  Pressure pump, tank, A, B;
  Input reference;
  Spool U;
  Output flow_A, flow_B;
  Limit travel;
  Switch spool_centre, laminar_limit_A, laminar_limit_B;
  Parameter C_v = 1e-8, dp_lim = 2e5, tau = 0.01;

  void describe(Description& is) {
    is.called("hydraulics/directional_valve", "a 4/3 directional valve with spool lag, Eqs. (3), (4), (6)");
    is.port("pump", pump, "supply", "Pa");
    is.port("tank", tank, "return", "Pa");
    is.port("A", A, "volume that U > 0 feeds", "Pa");
    is.port("B", B, "volume that U < 0 feeds", "Pa");
    is.port("reference", reference, "where the spool is sent: -1 to 1", "1");
    is.parameter("C_v", C_v, "m^3/(s.Pa^0.5)").above(0.0).doc("flow coefficient, fully open");
    is.parameter("dp_lim", dp_lim, "Pa").by_default(2e5).above(0.0).doc("drop at which the flow turns turbulent");
    is.parameter("tau", tau, "s").above(0.0).doc("time constant of the spool");
    is.own("U", U, "1", "spool displacement over its full travel").nominal(1.0).start(0.0);
    is.valid("U", travel, "1", 1.0, "spool displacement").at_least(-1.0, -HUGE_VAL).at_most(1.0, HUGE_VAL);
    is.output("flow_A", flow_A, "m^3/s", "flow into A");
    is.output("flow_B", flow_B, "m^3/s", "flow into B");
    is.switching("spool_centre", spool_centre, "1", 1.0, "the spool: the paths change");
    is.switching("laminar_limit_A", laminar_limit_A, "Pa", 1e5, "the drop of A's open path less dp_lim");
    is.switching("laminar_limit_B", laminar_limit_B, "Pa", 1e5, "the drop of B's open path less dp_lim");
  }

  /// Drops (Pa) that drive oil into A and into B through the paths that the spool opens.
  template <class T>
  std::array<T, 2> drops(const At<T>& at) const {
    if (at.above_zero(at(U))) return {at(pump) - at(A), at(tank) - at(B)};
    return {at(tank) - at(A), at(pump) - at(B)};
  }
  /// Flows (m^3/s) into A and into B.
  template <class T>
  std::array<T, 2> flows(const At<T>& at) const {
    const std::array<T, 2> dp = drops(at);
    const T opening = at.above_zero(at(U)) ? at(U) * C_v : at(U) * -C_v;
    return {opening * orifice(at, dp[0], dp_lim), opening * orifice(at, dp[1], dp_lim)};
  }

  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const auto [Q_A, Q_B] = flows(at);
    const bool ahead = at.above_zero(at(U));
    rows.inflow(A, Q_A);
    rows.inflow(B, Q_B);
    rows.inflow(ahead ? pump : tank, -Q_A);
    rows.inflow(ahead ? tank : pump, -Q_B);
    rows.store(U, tau);
    rows.inflow(U, at(reference) - at(U));  // Eq. (4)
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    const auto [Q_A, Q_B] = flows(at);
    y(flow_A) = Q_A;
    y(flow_B) = Q_B;
  }
  template <class T>
  void validity(const At<T>& at, Values<T>& q) const {
    q(travel) = at(U);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    const std::array<T, 2> dp = drops(at);
    s(spool_centre) = at(U);
    s(laminar_limit_A) = laminar_margin(dp[0], dp_lim);
    s(laminar_limit_B) = laminar_margin(dp[1], dp_lim);
  }
};

}  // namespace bramah::hydraulics
