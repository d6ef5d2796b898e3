// Traction and resistance at a point of a planar body, along a direction fixed in it:
//
//   F = drive - X_0 - c_d u,  u = (A d) . (velocity of the point)   N   along A d, at the point
//
//   drive           N       signal; 0 where unconnected
//   X_0             N       constant resistance: of a load pushed, of rolling. For motion ahead, u > 0
//   c_d             N.s/m   resistance per speed ahead
//   point           m       where it acts, body axes
//   d   direction   1       ahead, body axes, of any length, made a unit vector
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct PlanarTraction {
  PlanarFrame on;
  Input drive;
  Output force_out;
  Parameter X_0 = 0.0, c_d = 0.0;
  Vec2<Parameter> point = {}, direction = {};

  void describe(Description& is) {
    is.called("mechanics/planar_traction", "traction and resistance along a direction of a planar body");
    is.port("on", on, "the body it acts on");
    is.port("drive", drive, "the force ahead; without it 0", "N").optional({0.0});
    is.parameter("X_0", X_0, "N").by_default(0.0).doc("constant resistance, against motion ahead");
    is.parameter("c_d", c_d, "N.s/m").by_default(0.0).at_least(0.0).doc("resistance per speed ahead");
    is.parameter("point", point, "m").by_default(0.0).doc("where it acts, in body axes");
    is.parameter("direction", direction, "1").by_default({1.0, 0.0}).doc("ahead, in body axes, of any length");
    is.output("force", force_out, "N", "the force ahead in all");
    direction = unit(direction);
  }
  void check(Faults& faults) const { require_direction(faults, "direction", direction); }
  template <class T>
  T force(const At<T>& at) const {
    return at(drive) - X_0 - c_d * dot(at.direction(on, direction), at.velocity(on, point));
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const T F = force(at);
    const Vec2<T> ahead = at.direction(on, direction);
    rows.apply(on, point, Vec2<T>{F * ahead[0], F * ahead[1]});
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(force_out) = force(at);
  }
};

}  // namespace bramah::mechanics
