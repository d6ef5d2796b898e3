// A wheel with a circular rim of round section rolls without slip on the plane z = 0, above it:
//
//   c_z - a s - rho = 0,  s = sqrt(d_x^2 + d_y^2)                m     row contact: the rim touches the plane
//   cdot + (w + spin' d) x (a q - rho e_z) = 0, along x and y    m/s   rows rolling_x, rolling_y: no slip
//
//   c   point   m       centre of the wheel; body axes of the carrier
//   d   axle    1       body axes of the carrier, of any length, made a unit vector; not upright: s > 0
//   w           rad/s   angular velocity of the carrier
//   spin        rad     of the wheel against the carrier; unconnected where the wheel is the body itself
//   a           m       radius of the circle of the rim's centres
//   rho         m       radius of the rim's section; 0: a knife edge. The rolling radius upright is a + rho
//   q           1       from the centre to the lowest point of that circle: (d_x d_z / s, d_y d_z / s, -s)
// Multipliers: the force (N) of the wheel on the plane, negative on the wheel. The plane can pull: watch the sign.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct RollingWheel {
  Frame carrier;
  Coordinate spin;
  HolonomicRow contact;
  NonholonomicRow rolling_x, rolling_y;
  Vec3<Parameter> point = {}, axle = {};
  Parameter a = 1.0, rho = 0.0;

  void describe(Description& is) {
    is.called("mechanics/rolling_wheel", "a wheel that rolls without slip on the plane z = 0");
    is.port("carrier", carrier, "the body that holds the axle, or the wheel itself");
    is.port("spin", spin, "spin of the wheel against the carrier; without it the wheel is the body", "rad")
        .optional({0.0});
    is.parameter("point", point, "m").by_default(0.0).doc("centre of the wheel in body axes");
    is.parameter("axle", axle, "1").by_default({0.0, 1.0, 0.0}).doc("its axle in body axes, of any length");
    is.parameter("a", a, "m").above(0.0).doc("radius of the circle of the rim's centres");
    is.parameter("rho", rho, "m").by_default(0.0).at_least(0.0).doc("radius of the rim's section; 0 for a knife edge");
    is.holonomic("contact", contact, "m", "height of the lowest point of the rim");
    is.nonholonomic("rolling_x", rolling_x, "m/s", "velocity of the rim where it touches, along x");
    is.nonholonomic("rolling_y", rolling_y, "m/s", "velocity of the rim where it touches, along y");
    axle = unit(axle);
  }
  void check(Faults& faults) const { require_direction(faults, "axle", axle); }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec3<T> d = at.direction(carrier, axle);
    rows(contact) = at.point(carrier, point)[2] - a * sqrt(d[0] * d[0] + d[1] * d[1]) - rho;
  }
  template <class T>
  void nonholonomic(const Motion<T>& at, Values<T>& rows) const {
    const Vec3<T> d = at.direction(carrier, axle);
    const T s = sqrt(d[0] * d[0] + d[1] * d[1]);
    const Vec3<T> arm = {a * d[0] * d[2] / s, a * d[1] * d[2] / s, -a * s - rho};
    const Vec3<T> w = rotate(at.orientation(carrier), at.angular_velocity(carrier)) + at.rate(spin) * d;
    const Vec3<T> slip = at.velocity(carrier, point) + cross(w, arm);
    rows(rolling_x) = slip[0];
    rows(rolling_y) = slip[1];
  }
};

}  // namespace bramah::mechanics
