// A ball joint: a point of one body stays on a point of another, the first three rows of Eq. (67):
//
//   r_a + A_a point_a - r_b - A_b point_b = 0   m   rows x, y, z, ground axes
//
//   point_a, point_b   m   the joint, body axes of a and of b
// Multipliers: the force (N) of the joint on b, negative on a.
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct Spherical {
  Frame a, b;
  HolonomicRow x, y, z;
  Vec3<Parameter> point_a = {}, point_b = {};

  void describe(Description& is) {
    is.called("mechanics/spherical", "a ball joint between two bodies");
    is.port("a", a, "one body");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("the joint in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the joint in body axes of b");
    is.holonomic("x", x, "m", "point of a less point of b, along x");
    is.holonomic("y", y, "m", "point of a less point of b, along y");
    is.holonomic("z", z, "m", "point of a less point of b, along z");
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec3<T> gap = at.point(a, point_a) - at.point(b, point_b);
    rows(x) = gap[0];
    rows(y) = gap[1];
    rows(z) = gap[2];
  }
};

}  // namespace bramah::mechanics
