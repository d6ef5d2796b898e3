// A hinge: a point and an axis of one body stay on a point and an axis of another. The first five rows of Eq. (67):
//
//   r_a + A_a point_a - r_b - A_b point_b = 0          m   rows x, y, z, ground axes
//   (A_a t_k) . (A_b axis_b) = 0, k = 1, 2             1   rows tilt_1, tilt_2
//
//   point_a, point_b   m   the hinge, body axes of a and of b
//   axis_a, axis_b     1   its axis, body axes of a and of b
//   t_1, t_2           1   fixed in a and normal to axis_a; functions of axis_a alone
// Multipliers: the force (N) of the hinge on b, negative on a; the moments (N.m) that keep the axes aligned.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct Revolute {
  Frame a, b;
  HolonomicRow x, y, z, tilt_1, tilt_2;
  Vec3<Parameter> point_a = {}, point_b = {}, axis_a = {}, axis_b = {};
  std::array<Vec3<Parameter>, 2> t = {};  // 1

  void describe(Description& is) {
    is.called("mechanics/revolute", "a hinge between two bodies, Eq. (67)");
    is.port("a", a, "one body");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("the hinge in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the hinge in body axes of b");
    is.parameter("axis_a", axis_a, "1").by_default({0.0, 0.0, 1.0}).doc("its axis in body axes of a, of any length");
    is.parameter("axis_b", axis_b, "1").by_default({0.0, 0.0, 1.0}).doc("its axis in body axes of b, of any length");
    is.holonomic("x", x, "m", "point of a less point of b, along x");
    is.holonomic("y", y, "m", "point of a less point of b, along y");
    is.holonomic("z", z, "m", "point of a less point of b, along z");
    is.holonomic("tilt_1", tilt_1, "1", "axis of b against the first normal of the axis of a");
    is.holonomic("tilt_2", tilt_2, "1", "axis of b against the second normal of the axis of a");
    axis_a = unit(axis_a);
    axis_b = unit(axis_b);
    t = normals(axis_a);
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
    const Vec3<T> axis = at.direction(b, axis_b);
    rows(tilt_1) = dot(at.direction(a, t[0]), axis);
    rows(tilt_2) = dot(at.direction(a, t[1]), axis);
  }
};

}  // namespace bramah::mechanics
