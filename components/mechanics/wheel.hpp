// An axisymmetric wheel, rotor or flywheel on an axle of a carrier, which it turns with in every way but one: the spin.
// Nothing depends on the spin angle: on a carrier that does not turn, coefficients stay constant at any speed:
//
//   m rddot_c - m g                                     N      at the centre, on the carrier
//   hdot + w x h,  h = A (w - (w.d) d) + C n d          N.m    on the carrier, body axes;  n = w.d + spin rate
//   C ndot                                              N.m    on the spin
//
//   spin         rad      angle of the wheel against the carrier, about d
//   w            rad/s    angular velocity of the carrier
//   r_c  point   m        centre of mass of the wheel, carrier axes
//   d    axle    1        carrier axes, of any length, made a unit vector
//   m    mass    kg
//   A, C         kg.m^2   inertia about a diameter and about the axle, at the centre; C <= 2 A
//   g    gravity m/s^2
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

/// A plate has C = 2 A; no body has more. Rounded numbers get a margin.
inline void require_axial_inertia(Faults& faults, const Parameter& A, const Parameter& C) {
  if (C <= 2.0 * A * (1.0 + 1e-9)) return;
  char found[64], expected[64];
  std::snprintf(found, sizeof found, "%g kg.m^2", C.value());
  std::snprintf(expected, sizeof expected, "at most 2 A = %g kg.m^2, that of a plate", 2.0 * A.value());
  faults.add("C", found, expected);
}

struct Wheel {
  Gravity gravity;
  Frame carrier;
  Coordinate spin;
  Parameter mass = 1.0, A = 1.0, C = 1.0, angle = 0.0, rate = 0.0;
  Vec3<Parameter> point = {}, axle = {};

  void describe(Description& is) {
    is.called("mechanics/wheel", "an axisymmetric wheel or rotor on an axle of a body");
    is.port("gravity", gravity, "the field it falls in; without it there is none").optional({0.0, 0.0, 0.0});
    is.port("carrier", carrier, "the body that holds the axle");
    is.parameter("mass", mass, "kg").above(0.0).doc("mass");
    is.parameter("A", A, "kg.m^2").above(0.0).doc("moment of inertia about a diameter, at the centre");
    is.parameter("C", C, "kg.m^2").above(0.0).doc("moment of inertia about the axle");
    is.parameter("point", point, "m").by_default(0.0).doc("its centre in carrier axes");
    is.parameter("axle", axle, "1").by_default({0.0, 1.0, 0.0}).doc("its axle in carrier axes, of any length");
    is.parameter("angle", angle, "rad").by_default(0.0).doc("start: spin angle");
    is.parameter("rate", rate, "rad/s").by_default(0.0).doc("start: rate of the spin, against the carrier");
    is.own("spin", spin, "rad", "angle of the wheel against the carrier");
    axle = unit(axle);
  }
  void check(Faults& faults) const {
    require_direction(faults, "axle", axle);
    require_axial_inertia(faults, A, C);
  }
  void start(Start& start) const {
    start(spin) = angle;
    start.rate(spin) = rate;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const Quaternion<T> e = at.orientation(carrier), edot = at.orientation_rate(carrier),
                        eddot = at.orientation_acceleration(carrier);
    // A(e) r is quadratic in e: second rate 2 A(edot) r + d(A(e) r)/de eddot, the latter as a difference of the form.
    const Vec3<T> swing = 2.0 * rotate(edot, point) + 0.5 * (rotate(e + eddot, point) - rotate(e - eddot, point));
    rows.apply(carrier, point, mass * (at(gravity) - at.acceleration(carrier) - swing));

    const Vec3<T> w = at.angular_velocity(carrier), alpha = 2.0 * body_rate(e, eddot);
    const T about = dot(w, axle), n = about + at.rate(spin);
    const T about_dot = dot(alpha, axle), ndot = about_dot + at.acceleration(spin);
    const Vec3<T> h = A * w + (C * n - A * about) * axle;
    const Vec3<T> hdot = A * alpha + (C * ndot - A * about_dot) * axle;
    rows.apply_torque(carrier, -1.0 * (hdot + cross(w, h)));
    rows.apply(spin, -(C * ndot));
  }
  template <class T>
  T energy(const At<T>& at) const {
    const Vec3<T> v = at.velocity(carrier, point), w = at.angular_velocity(carrier);
    const T about = dot(w, axle), n = about + at.rate(spin);
    const T kinetic = 0.5 * (mass * dot(v, v) + A * (dot(w, w) - square(about)) + C * square(n));
    return kinetic + weight_energy(mass, at(gravity), at.point(carrier, point));
  }
};

}  // namespace bramah::mechanics
