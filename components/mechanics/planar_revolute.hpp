// A pin between two planar bodies:
//
//   r_a + A_a point_a - r_b - A_b point_b = 0   m   rows x, y
//
//   point_a, point_b   m   the pin, body axes of a and of b
// Multipliers: the force (N) of the pin on b, negative on a.
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct PlanarRevolute {
  PlanarFrame a, b;
  HolonomicRow x, y;
  Vec2<Parameter> point_a = {}, point_b = {};

  void describe(Description& is) {
    is.called("mechanics/planar_revolute", "a pin between two planar bodies");
    is.port("a", a, "one body");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("the pin in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the pin in body axes of b");
    is.holonomic("x", x, "m", "point of a less point of b, along x");
    is.holonomic("y", y, "m", "point of a less point of b, along y");
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec2<T> gap = at.point(a, point_a) - at.point(b, point_b);
    rows(x) = gap[0];
    rows(y) = gap[1];
  }
};

}  // namespace bramah::mechanics
