// A disc, hoop or torus that rolls without slip on the plane z = 0, in angles of which yaw and spin are cyclic, so that
// straight rolling and steady turning have constant coefficients: R = R_z(yaw) R_x(lean) R_y(spin).
//
//   m (xddot, yddot, zddot) - m g                                               N
//   (A yaw' cos^2 lean + C n sin lean)'                                         N.m   on yaw; n = spin' + yaw' sin lean
//   A lean'' + (A yaw' sin lean - C n) yaw' cos lean                            N.m   on lean
//   C n'                                                                        N.m   on spin
//   z - a cos lean - rho = 0                                                    m     row contact
//   x' - v_f cos yaw - v_n sin yaw = 0,  y' - v_f sin yaw + v_n cos yaw = 0     m/s   rows rolling_x, rolling_y
//   v_f = a n + rho spin' cos lean,  v_n = (a cos lean + rho) lean'
//
//   x, y, z           m        centre of mass
//   yaw, lean, spin   rad      about z; about the horizontal diameter, positive to the right; about the axle
//   m    mass         kg
//   A, C              kg.m^2   inertia about a diameter and about the axle; C <= 2 A
//   a, rho            m        radius of the circle of the rim's centres; of the rim's section, 0 for a knife edge
//   g    gravity      m/s^2
// Multipliers: the force (N) of the wheel on the plane, negative on the wheel. The law ends at lean = +-pi/2,
// where the disc lies flat on the plane.
#pragma once

#include <bramah/component.hpp>
#include <numbers>

#include "wheel.hpp"

namespace bramah::mechanics {

struct RollingDisc {
  Gravity gravity;
  Coordinate x, y, z, yaw, lean, spin;
  HolonomicRow contact;
  Limit upright;
  NonholonomicRow rolling_x, rolling_y;
  Parameter mass = 1.0, A = 1.0, C = 1.0, a = 1.0, rho = 0.0;
  Vec2<Parameter> position = {};
  Parameter yaw_0 = 0.0, lean_0 = 0.0, spin_0 = 0.0, yaw_rate = 0.0, lean_rate = 0.0, spin_rate = 0.0;

  void describe(Description& is) {
    is.called("mechanics/rolling_disc", "a disc, hoop or torus that rolls without slip on the plane z = 0");
    is.port("gravity", gravity, "the field it falls in; without it there is none").optional({0.0, 0.0, 0.0});
    is.parameter("mass", mass, "kg").above(0.0).doc("mass");
    is.parameter("A", A, "kg.m^2").above(0.0).doc("moment of inertia about a diameter");
    is.parameter("C", C, "kg.m^2").above(0.0).doc("moment of inertia about the axle");
    is.parameter("a", a, "m").above(0.0).doc("radius of the circle of the rim's centres");
    is.parameter("rho", rho, "m").by_default(0.0).at_least(0.0).doc("radius of the rim's section; 0 for a knife edge");
    is.parameter("position", position, "m").by_default(0.0).doc("start: x and y of the centre");
    is.parameter("yaw", yaw_0, "rad").by_default(0.0).doc("start: heading, from x to y");
    is.parameter("lean", lean_0, "rad")
        .by_default(0.0)
        .above(-0.5 * std::numbers::pi)
        .below(0.5 * std::numbers::pi)
        .doc("start: lean to the right");
    is.parameter("spin", spin_0, "rad").by_default(0.0).doc("start: spin angle");
    is.parameter("yaw_rate", yaw_rate, "rad/s").by_default(0.0).doc("start: rate of the heading");
    is.parameter("lean_rate", lean_rate, "rad/s").by_default(0.0).doc("start: rate of the lean");
    is.parameter("spin_rate", spin_rate, "rad/s").by_default(0.0).doc("start: rate of the spin");
    is.own("x", x, "m", "centre");
    is.own("y", y, "m", "centre");
    is.own("z", z, "m", "centre");
    is.own("yaw", yaw, "rad", "heading, from x to y");
    is.own("lean", lean, "rad", "lean to the right");
    is.own("spin", spin, "rad", "spin about the axle");
    is.valid("lean", upright, "rad", 1.0, "lean of the disc, which lies flat on the plane beyond")
        .at_least(-0.5 * std::numbers::pi)
        .at_most(0.5 * std::numbers::pi);
    is.holonomic("contact", contact, "m", "height of the lowest point of the rim");
    is.nonholonomic("rolling_x", rolling_x, "m/s", "velocity of the rim where it touches, along x");
    is.nonholonomic("rolling_y", rolling_y, "m/s", "velocity of the rim where it touches, along y");
  }
  void check(Faults& faults) const { require_axial_inertia(faults, A, C); }

  /// Speeds of the centre that go with rolling: ahead and to the right.
  template <class T>
  std::array<T, 2> speeds(const T& tilt, const T& turning, const T& tilting, const T& spinning) const {
    const T c = cos(tilt);
    return {a * (spinning + turning * sin(tilt)) + rho * spinning * c, (a * c + rho) * tilting};
  }
  void start(Start& start) const {
    const Parameter angles[] = {yaw_0, lean_0, spin_0}, rates[] = {yaw_rate, lean_rate, spin_rate};
    const Coordinate coordinates[] = {yaw, lean, spin};
    for (int k = 0; k < 3; ++k) {
      start(coordinates[k]) = angles[k];
      start.rate(coordinates[k]) = rates[k];
    }
    const auto [ahead, right] = speeds(lean_0, yaw_rate, lean_rate, spin_rate);
    start(x) = position[0];
    start(y) = position[1];
    start(z) = a * cos(lean_0) + rho;
    start.rate(x) = ahead * cos(yaw_0) + right * sin(yaw_0);
    start.rate(y) = ahead * sin(yaw_0) - right * cos(yaw_0);
    start.rate(z) = -a * sin(lean_0) * lean_rate;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const Vec3<T> g = at(gravity);
    rows.inertia(x, mass);
    rows.inertia(y, mass);
    rows.inertia(z, mass);
    rows.apply(x, g[0] * mass);
    rows.apply(y, g[1] * mass);
    rows.apply(z, g[2] * mass);
    const T s = sin(at(lean)), c = cos(at(lean));
    const T &turning = at.rate(yaw), &tilting = at.rate(lean);
    const T n = at.rate(spin) + turning * s;
    const T ndot = at.acceleration(spin) + at.acceleration(yaw) * s + turning * tilting * c;
    rows.apply(yaw,
               -(A * c * (at.acceleration(yaw) * c - 2.0 * turning * tilting * s) + C * (ndot * s + n * tilting * c)));
    rows.apply(lean, -(A * at.acceleration(lean) + (A * turning * s - C * n) * turning * c));
    rows.apply(spin, -(C * ndot));
  }
  template <class T>
  T energy(const At<T>& at) const {
    const T &turning = at.rate(yaw), &tilting = at.rate(lean);
    const T n = at.rate(spin) + turning * sin(at(lean));
    const T speed = square(at.rate(x)) + square(at.rate(y)) + square(at.rate(z));
    const T kinetic = 0.5 * (mass * speed + A * (square(turning * cos(at(lean))) + square(tilting)) + C * square(n));
    return kinetic + weight_energy(mass, at(gravity), Vec3<T>{at(x), at(y), at(z)});
  }
  template <class T>
  void validity(const At<T>& at, Values<T>& q) const {
    q(upright) = at(lean);
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    rows(contact) = at(z) - a * cos(at(lean)) - rho;
  }
  template <class T>
  void nonholonomic(const Motion<T>& at, Values<T>& rows) const {
    const auto [ahead, right] = speeds(at(lean), at.rate(yaw), at.rate(lean), at.rate(spin));
    const T c = cos(at(yaw)), s = sin(at(yaw));
    rows(rolling_x) = at.rate(x) - ahead * c - right * s;
    rows(rolling_y) = at.rate(y) - ahead * s + right * c;
  }
};

}  // namespace bramah::mechanics
