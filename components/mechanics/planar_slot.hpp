// A pin in a straight slot of a planar body:
//
//   n . (r_b + A_b point_b - r_a - A_a point_a) = 0,  n = e_z x A_a d   m   row across
//
//   point_a         m   a point of the slot, body axes of a
//   d   direction   1   along the slot, body axes of a, of any length, made a unit vector
//   point_b         m   the pin, body axes of b
// Multiplier: the force (N) of the slot on the pin along -n, on a at the same place along n.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct PlanarSlot {
  PlanarFrame a, b;
  HolonomicRow across;
  Vec2<Parameter> point_a = {}, direction = {}, point_b = {};

  void describe(Description& is) {
    is.called("mechanics/planar_slot", "a pin of one planar body in a straight slot of another");
    is.port("a", a, "the body with the slot");
    is.port("b", b, "the body with the pin");
    is.parameter("point_a", point_a, "m").by_default(0.0).doc("a point of the slot, in body axes of a");
    is.parameter("direction", direction, "1")
        .by_default({1.0, 0.0})
        .doc("along the slot, in body axes of a, of any length");
    is.parameter("point_b", point_b, "m").by_default(0.0).doc("the pin in body axes of b");
    is.holonomic("across", across, "m", "pin from the slot, to its left");
    direction = unit(direction);
  }
  void check(Faults& faults) const { require_direction(faults, "direction", direction); }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec2<T> gap = at.point(b, point_b) - at.point(a, point_a);
    rows(across) = dot(at.direction(a, Vec2<Parameter>{-direction[1], direction[0]}), gap);
  }
};

}  // namespace bramah::mechanics
