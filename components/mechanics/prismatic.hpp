// A prismatic joint: one body slides along an axis of another and does not turn against it. With the gap
// d = r_b + A_b point_b - r_a - A_a point_a:
//
//   (A_a t_k) . d = 0, k = 1, 2                m   rows across_1, across_2
//   (A_a t_k) . (A_b axis_b) = 0, k = 1, 2     1   rows tilt_1, tilt_2
//   (A_a n_a) . (A_b q_b) = 0                  1   row twist
//
//   point_a, point_b     m   points of the axis, body axes of a and of b
//   axis_a, axis_b       1   its direction, body axes of a and of b
//   normal_a, normal_b   1   directions that stay in one plane with the axis, body axes of a and of b
//   t_1, t_2             1   fixed in a and normal to axis_a; functions of axis_a alone
//   n_a                  1   normal_a without its part along axis_a
//   q_b                  1   axis_b x normal_b, of unit length
// Multipliers: the force (N) along t_k on b at point_b; the moments (N.m) that keep the axes and normals aligned.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct Prismatic {
  Frame a, b;
  HolonomicRow across_1, across_2, tilt_1, tilt_2, twist;
  Vec3<Parameter> point_a = {}, point_b = {}, axis_a = {}, axis_b = {}, normal_a = {}, normal_b = {};
  std::array<Vec3<Parameter>, 2> t = {};  // 1
  Vec3<Parameter> n_a = {}, q_b = {};     // 1

  void describe(Description& is) {
    is.called("mechanics/prismatic", "a straight guide between two bodies, which do not turn against each other");
    is.port("a", a, "one body");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("a point of the axis in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("a point of the axis in body axes of b");
    is.parameter("axis_a", axis_a, "1").by_default({0.0, 0.0, 1.0}).doc("the axis in body axes of a, of any length");
    is.parameter("axis_b", axis_b, "1").by_default({0.0, 0.0, 1.0}).doc("the axis in body axes of b, of any length");
    is.parameter("normal_a", normal_a, "1").by_default({1.0, 0.0, 0.0}).doc("across the axis, in body axes of a");
    is.parameter("normal_b", normal_b, "1")
        .by_default({1.0, 0.0, 0.0})
        .doc("the same direction in body axes of b; only the part across the axis counts");
    is.holonomic("across_1", across_1, "m", "point of b less point of a, along the first normal of the axis of a");
    is.holonomic("across_2", across_2, "m", "point of b less point of a, along the second normal of the axis of a");
    is.holonomic("tilt_1", tilt_1, "1", "axis of b against the first normal of the axis of a");
    is.holonomic("tilt_2", tilt_2, "1", "axis of b against the second normal of the axis of a");
    is.holonomic("twist", twist, "1", "turn of a against b about the axis, its sine");
    axis_a = unit(axis_a);
    axis_b = unit(axis_b);
    t = normals(axis_a);
    n_a = unit(cross(cross(axis_a, normal_a), axis_a));
    q_b = unit(cross(axis_b, normal_b));
  }
  void check(Faults& faults) const {
    require_direction(faults, "axis_a", axis_a);
    require_direction(faults, "axis_b", axis_b);
    require_across(faults, "normal_a", normal_a, axis_a);
    require_across(faults, "normal_b", normal_b, axis_b);
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec3<T> gap = at.point(b, point_b) - at.point(a, point_a), axis = at.direction(b, axis_b);
    const Vec3<T> t1 = at.direction(a, t[0]), t2 = at.direction(a, t[1]);
    rows(across_1) = dot(t1, gap);
    rows(across_2) = dot(t2, gap);
    rows(tilt_1) = dot(t1, axis);
    rows(tilt_2) = dot(t2, axis);
    rows(twist) = dot(at.direction(a, n_a), at.direction(b, q_b));
  }

 private:
  static void require_across(Faults& faults, const char* parameter, const Vec3<Parameter>& a,
                             const Vec3<Parameter>& axis) {
    if (!(length(cross(axis, a)) > 1e-9 * length(a)))
      faults.add(parameter, written(a), "a direction that is not along the axis " + written(axis));
  }
};

}  // namespace bramah::mechanics
