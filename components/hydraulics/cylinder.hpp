// A double-acting cylinder on a length s. Eqs. (7), (72)-(75), friction apart:
//
//   F = A_2 p_2 - A_3 p_3                        N         extends s
//   l_2 = s - c_1 - c_2,  l_3 = l - l_2          m
//   K_2 = A_2 l_2 (kappa(p_2) + 1 / B_c),  V_2dot = A_2 sdot    m^3/Pa, m^3/s   kappa: 1 / B_oil, see oil.hpp
//   K_3 = A_3 l_3 (kappa(p_3) + 1 / B_c),  V_3dot = -A_3 sdot
//   A_2 = pi D_2^2 / 4,  A_3 = pi (D_2^2 - D_3^2) / 4           m^2
//
//   s            stroke                m    length from end to end
//   p_2, p_3     piston_side, rod_side Pa
//   D_2, D_3     m    diameters of piston and rod
//   l            m    length of the chamber; both l_2 and l_3 are positive inside it
//   c_1, c_2     m    from the end to the base of the chamber; length of the piston
//   B_oil, B_c   Pa   bulk moduli of oil and barrel
//   air          1    share of free air in the oil
// The law ends where a chamber has no length left.
#pragma once

#include <bramah/component.hpp>
#include <cstdio>
#include <numbers>
#include <string>

#include "oil.hpp"

namespace bramah::hydraulics {

struct Cylinder {
  Coordinate stroke;
  Pressure piston_side, rod_side;
  Output force, length_2, length_3;
  Parameter D_2 = 0.1, D_3 = 0.05, l = 1.0, c_1 = 0.0, c_2 = 0.0, B_oil = 1e9, B_c = 1e10, air = 0.0;
  Limit least_2, least_3;

  void describe(Description& is) {
    is.called("hydraulics/cylinder", "a double-acting cylinder, Eqs. (7), (72)-(75)");
    is.port("stroke", stroke, "its length from end to end", "m");
    is.port("piston_side", piston_side, "volume that extends it", "Pa");
    is.port("rod_side", rod_side, "volume that retracts it", "Pa");
    is.parameter("D_2", D_2, "m").above(0.0).typical(2e-3, 2.0).doc("diameter of the piston");
    is.parameter("D_3", D_3, "m").at_least(0.0).typical(1e-3, 2.0).doc("diameter of the rod");
    is.parameter("l", l, "m").above(0.0).typical(1e-3, 50.0).doc("length of the chamber");
    is.parameter("c_1", c_1, "m").by_default(0.0).doc("from the end of the cylinder to the base of its chamber");
    is.parameter("c_2", c_2, "m").by_default(0.0).doc("length of the piston");
    is.parameter("B_oil", B_oil, "Pa").above(0.0).typical(1e8, 1e10).doc("bulk modulus of the oil");
    is.parameter("B_c", B_c, "Pa").above(0.0).typical(1e8, 1e13).doc("bulk modulus of the barrel");
    describe_air(is, air);
    is.valid("l_2", least_2, "m", 1.0, "length of the piston-side chamber").at_least(0.0);
    is.valid("l_3", least_3, "m", 1.0, "length of the rod-side chamber").at_least(0.0);
    is.output("force", force, "N", "force of the oil, positive where it extends");
    is.output("l_2", length_2, "m", "length of the piston-side chamber");
    is.output("l_3", length_3, "m", "length of the rod-side chamber");
  }
  void check(Faults& faults) const {
    if (D_3 < D_2) return;
    char found[64], expected[64];
    std::snprintf(found, sizeof found, "%g m", D_3.value());
    std::snprintf(expected, sizeof expected, "less than the piston's D_2 = %g m", D_2.value());
    faults.add("D_3", found, expected);
  }

  [[nodiscard]] Parameter A_2() const { return 0.25 * std::numbers::pi * D_2 * D_2; }                // m^2
  [[nodiscard]] Parameter A_3() const { return 0.25 * std::numbers::pi * (D_2 * D_2 - D_3 * D_3); }  // m^2
  template <class T>
  T l_2(const At<T>& at) const {
    return at(stroke) - (c_1 + c_2);  // Eq. (73)
  }
  template <class T>
  T l_3(const At<T>& at) const {
    return l - l_2(at);
  }
  template <class T>
  T oil_force(const At<T>& at) const {
    return at(piston_side) * A_2() - at(rod_side) * A_3();  // Eq. (7)
  }

  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const Parameter compliance = 1.0 / B_oil + 1.0 / B_c;  // 1/Pa, Eq. (75)
    const T V_2 = l_2(at) * A_2(), V_3 = l_3(at) * A_3();
    rows.apply(stroke, oil_force(at));
    rows.store(piston_side, T(l_2(at) * (A_2() * compliance) + V_2 * gas_compliance(at(piston_side), air)),
               T(at.rate(stroke) * A_2()));
    rows.store(rod_side, T(l_3(at) * (A_3() * compliance) + V_3 * gas_compliance(at(rod_side), air)),
               T(at.rate(stroke) * -A_3()));
  }
  template <class T>
  T energy(const At<T>& at) const {
    const Parameter compliance = 1.0 / B_oil + 1.0 / B_c;
    const T V_2 = l_2(at) * A_2(), V_3 = l_3(at) * A_3();
    return storage_energy(at, piston_side, T(V_2 * compliance)) + V_2 * gas_energy(at(piston_side), air) +
           storage_energy(at, rod_side, T(V_3 * compliance)) + V_3 * gas_energy(at(rod_side), air);
  }
  template <class T>
  void validity(const At<T>& at, Values<T>& q) const {
    q(least_2) = l_2(at);
    q(least_3) = l_3(at);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(force) = oil_force(at);
    y(length_2) = l_2(at);
    y(length_3) = l_3(at);
  }
};

}  // namespace bramah::hydraulics
