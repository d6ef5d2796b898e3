// The oil in a pipe as a mass that moves: inertia and laminar friction. What the pipe stores is a hose at its ends.
//
//   L Qdot = p_a - p_b - R Q                                         Pa
//   L = rho_oil l / A,  R = 128 mu l / (pi d^4),  A = pi d^2 / 4     kg/m^4, Pa.s/m^3, m^2
//
//   Q         m^3/s    flow from a to b
//   d, l      m        inner diameter, length
//   rho_oil   kg/m^3   density of the oil
//   mu        Pa.s     its viscosity
#pragma once

#include <bramah/component.hpp>
#include <numbers>

namespace bramah::hydraulics {

/// Flow through a pipe.
struct Flow : FirstOrder {
  static constexpr const char* kind = "flow";
};

struct Pipe {
  Pressure a, b;
  Flow Q;
  Parameter d = 0.02, l = 1.0, rho_oil = 850.0, mu = 0.04;

  void describe(Description& is) {
    is.called("hydraulics/pipe", "oil that moves through a pipe, with inertia and laminar friction");
    is.port("a", a, "volume upstream", "Pa");
    is.port("b", b, "volume downstream", "Pa");
    is.parameter("d", d, "m").above(0.0).doc("inner diameter");
    is.parameter("l", l, "m").above(0.0).doc("length");
    is.parameter("rho_oil", rho_oil, "kg/m^3").above(0.0).doc("density of the oil");
    is.parameter("mu", mu, "Pa.s").by_default(0.04).at_least(0.0).doc("viscosity of the oil");
    is.own("Q", Q, "m^3/s", "flow from a to b").nominal(1e-3).start(0.0);
  }
  [[nodiscard]] Parameter inertance() const { return 4.0 * rho_oil * l / (std::numbers::pi * d * d); }
  [[nodiscard]] Parameter resistance() const { return 128.0 * mu * l / (std::numbers::pi * d * d * d * d); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.inflow(a, -at(Q));
    rows.inflow(b, at(Q));
    rows.store(Q, inertance());
    rows.inflow(Q, at(a) - at(b) - at(Q) * resistance());
  }
  template <class T>
  T energy(const At<T>& at) const {
    return storage_energy(at, Q, inertance());  // kinetic energy of the oil
  }
};

}  // namespace bramah::hydraulics
