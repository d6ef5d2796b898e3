// A universal joint (Hooke's, Cardan's): a point in common, and two axes that stay normal to each other:
//
//   r_a + A_a point_a - r_b - A_b point_b = 0   m   rows x, y, z, ground axes
//   (A_a axis_a) . (A_b axis_b) = 0             1   row cross
//
//   point_a, point_b   m   the joint, body axes of a and of b
//   axis_a, axis_b     1   the arms of the cross, body axes of a and of b
// Multipliers: the force (N) of the joint on b, negative on a; the moment (N.m) that keeps the arms normal.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct Universal {
  Frame a, b;
  HolonomicRow x, y, z, across;
  Vec3<Parameter> point_a = {}, point_b = {}, axis_a = {}, axis_b = {};

  void describe(Description& is) {
    is.called("mechanics/universal", "a universal joint between two bodies");
    is.port("a", a, "one body");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("the joint in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the joint in body axes of b");
    is.parameter("axis_a", axis_a, "1").by_default({1.0, 0.0, 0.0}).doc("arm held by a, of any length");
    is.parameter("axis_b", axis_b, "1").by_default({0.0, 1.0, 0.0}).doc("arm held by b, of any length");
    is.holonomic("x", x, "m", "point of a less point of b, along x");
    is.holonomic("y", y, "m", "point of a less point of b, along y");
    is.holonomic("z", z, "m", "point of a less point of b, along z");
    is.holonomic("cross", across, "1", "arm of a against arm of b");
    axis_a = unit(axis_a);
    axis_b = unit(axis_b);
  }
  void check(Faults& faults) const {
    require_direction(faults, "axis_a", axis_a);
    require_direction(faults, "axis_b", axis_b);
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec3<T> gap = at.point(a, point_a) - at.point(b, point_b);
    rows(x) = gap[0];
    rows(y) = gap[1];
    rows(z) = gap[2];
    rows(across) = dot(at.direction(a, axis_a), at.direction(b, axis_b));
  }
};

}  // namespace bramah::mechanics
