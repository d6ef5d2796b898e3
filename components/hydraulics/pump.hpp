// A pump of variable displacement under pressure control, whose swash plate lags what its controller asks for:
//
//   Q = q alpha w                                              m^3/s, from inlet to outlet
//   tau alphadot = alpha_ref - alpha                           1
//   alpha_ref = (p_set + p_sense - p_out) / p_band             1, held between alpha_min and 1
//
//   alpha       displacement over its largest   1
//   w           speed                           rad/s
//   q           m^3/rad   largest displacement
//   p_set       Pa        outlet pressure, above p_sense, at which the pump is swung back to nothing
//   p_band      Pa        pressure below it at which it is at its largest displacement
//   alpha_min   1         least displacement; 1 makes the pump one of fixed displacement
//   tau         s         time constant of the swash plate
//   p_sense     sense     Pa
// Without `sense` the outlet pressure is bounded by p_set. With the pressure of the load as `sense` the pump is load
// sensing, and p_set is its margin.
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

/// Displacement of a pump over its largest.
struct Displacement : FirstOrder {
  static constexpr const char* kind = "displacement";
};

struct Pump {
  Pressure inlet, outlet, sense;
  Input speed;
  Displacement alpha;
  Output flow_out;
  Switch least, largest;
  Parameter q = 1e-5, p_set = 2.5e7, p_band = 1e6, alpha_min = 0.0, tau = 0.05;

  void describe(Description& is) {
    is.called("hydraulics/pump", "a pump whose displacement follows pressure, or is fixed");
    is.port("inlet", inlet, "volume that it draws from, the tank", "Pa");
    is.port("outlet", outlet, "volume that it feeds", "Pa");
    is.port("sense", sense, "pressure of the load; without it 0", "Pa").optional({0.0});
    is.port("speed", speed, "speed of its shaft", "rad/s");
    is.parameter("q", q, "m^3/rad").above(0.0).doc("largest displacement");
    is.parameter("p_set", p_set, "Pa").doc("outlet pressure above the sensed one at which nothing is delivered");
    is.parameter("p_band", p_band, "Pa").by_default(1e6).above(0.0).doc("from the largest displacement to none");
    is.parameter("alpha_min", alpha_min, "1")
        .by_default(0.0)
        .at_least(0.0)
        .at_most(1.0)
        .doc("least displacement over the largest; 1 for a fixed displacement");
    is.parameter("tau", tau, "s").by_default(0.05).above(0.0).doc("time constant of the displacement");
    is.own("alpha", alpha, "1", "displacement over its largest").nominal(1.0).start(1.0);
    is.output("flow", flow_out, "m^3/s", "flow into the outlet");
    is.switching("least", least, "Pa", 1e5, "pressure missing less that of alpha_min");
    is.switching("largest", largest, "Pa", 1e5, "pressure missing less p_band");
  }
  /// What the outlet pressure misses (Pa).
  template <class T>
  T missing(const At<T>& at) const {
    return p_set + at(sense) - at(outlet);
  }
  template <class T>
  T alpha_ref(const At<T>& at) const {
    const T p = missing(at);
    if (!at.above_zero(p - alpha_min * p_band)) return T(alpha_min);
    return at.above_zero(p - p_band) ? T(1.0) : T(p / p_band);
  }
  template <class T>
  T flow(const At<T>& at) const {
    return at(alpha) * at(speed) * q;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const T Q = flow(at);
    rows.inflow(inlet, -Q);
    rows.inflow(outlet, Q);
    rows.store(alpha, tau);
    rows.inflow(alpha, alpha_ref(at) - at(alpha));
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(flow_out) = flow(at);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(least) = missing(at) - alpha_min * p_band;
    s(largest) = missing(at) - p_band;
  }
};

}  // namespace bramah::hydraulics
