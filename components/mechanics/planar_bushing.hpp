// A bushing between two planar bodies: springs and dampers along x and y of body a. With one stiffness 0, a spring
// between a point and a line:
//
//   d = A_a^T (r_b + A_b point_b - r_a) - point_a     m   the point of b as a sees it, from the point of a
//   F_k = stiffness_k d_k + damping_k d_k'            N   pulls b along -k of a's axes, and a back at the same place
//
//   point_a, point_b   m       body axes of a and of b
//   stiffness          N/m     along x and y of a
//   damping            N.s/m   along x and y of a
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct PlanarBushing {
  PlanarFrame a, b;
  Output force_x, force_y;
  Vec2<Parameter> point_a = {}, point_b = {}, stiffness = {}, damping = {};

  void describe(Description& is) {
    is.called("mechanics/planar_bushing", "springs and dampers between points of two planar bodies");
    is.port("a", a, "the body along whose axes the springs act");
    is.port("b", b, "the other body");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("where the springs are slack, in body axes of a");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the point that they hold, in body axes of b");
    is.parameter("stiffness", stiffness, "N/m").by_default(0.0).doc("along x and y of a");
    is.parameter("damping", damping, "N.s/m").by_default(0.0).doc("along x and y of a");
    is.output("force_x", force_x, "N", "pull along x of a");
    is.output("force_y", force_y, "N", "pull along y of a");
  }
  /// The pull in a's axes.
  template <class T>
  Vec2<T> pull(const At<T>& at) const {
    const Vec2<T> arm = at.point(b, point_b) - at.position(a), speed = at.velocity(b, point_b) - at.velocity(a);
    const T& w = at.rate_of_angle(a);
    const Vec2<T> drift = {speed[0] + w * arm[1], speed[1] - w * arm[0]};
    Vec2<T> force;
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec2<T> axis = at.direction(a, k == 0 ? Vec2<double>{1.0, 0.0} : Vec2<double>{0.0, 1.0});
      force[k] = (dot(axis, arm) - point_a[k]) * stiffness[k] + dot(axis, drift) * damping[k];
    }
    return force;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const Vec2<T> F = pull(at), x = at.direction(a, {1.0, 0.0}), y = at.direction(a, {0.0, 1.0});
    const Vec2<T> on_a = {F[0] * x[0] + F[1] * y[0], F[0] * x[1] + F[1] * y[1]};  // ground axes
    rows.apply(b, point_b, Vec2<T>{-on_a[0], -on_a[1]});
    const Vec2<T> arm = at.point(b, point_b) - at.position(a);
    rows.apply(a, on_a);
    rows.apply_torque(a, arm[0] * on_a[1] - arm[1] * on_a[0]);
  }
  template <class T>
  T energy(const At<T>& at) const {
    const Vec2<T> arm = at.point(b, point_b) - at.position(a);
    const T d_x = dot(at.direction(a, {1.0, 0.0}), arm) - point_a[0],
            d_y = dot(at.direction(a, {0.0, 1.0}), arm) - point_a[1];
    return square(d_x) * (0.5 * stiffness[0]) + square(d_y) * (0.5 * stiffness[1]);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    const Vec2<T> F = pull(at);
    y(force_x) = F[0];
    y(force_y) = F[1];
  }
};

}  // namespace bramah::mechanics
