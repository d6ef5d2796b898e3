// The length of a cylinder, a spring or a driver between points of two bodies, as a coordinate of its own:
// pressures, friction and springs then act on s alone. What rows 8 and 9 of Eq. (67) do for s and alpha:
//
//   |r_b + A_b point_b - r_a - A_a point_a| - s = 0   m   row length
//
//   s                  m   distance of the two points
//   point_a, point_b   m   body axes of a and of b
// Multiplier: the pull (N) that holds the points together, which balances all forces that act along s. The direction is
// lost where the points meet: s > 0.
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct Stroke {
  Frame a, b;
  Coordinate s;
  HolonomicRow length_row;
  Vec3<Parameter> point_a = {}, point_b = {};
  Parameter length = 1.0;

  void describe(Description& is) {
    is.called("mechanics/stroke", "the distance of points of two bodies");
    is.port("a", a, "one body");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("one end in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the other end in body axes of b");
    is.parameter("length", length, "m").by_default(1.0).above(0.0).doc("start: the distance");
    is.own("s", s, "m", "distance of the two points").nominal(1.0).start(1.0);
    is.holonomic("length", length_row, "m", "the distance less s");
  }
  void start(Start& start) const { start(s) = length; }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec3<T> d = at.point(b, point_b) - at.point(a, point_a);
    rows(length_row) = sqrt(dot(d, d)) - at(s);
  }
};

}  // namespace bramah::mechanics
