// A knife edge, a skate or an axle of wheels under a planar body: no speed across it where it touches.
//
//   n . (rdot + angle' e_z x A point) = 0,  n = e_z x A d   m/s   row edge
//
//   point           m   where it touches, body axes
//   d   direction   1   along the edge, body axes, of any length, made a unit vector
// Multiplier: the force (N) of the edge on the ground, to its left; negative on the body.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct KnifeEdge {
  PlanarFrame body;
  NonholonomicRow edge;
  Vec2<Parameter> point = {}, direction = {};

  void describe(Description& is) {
    is.called("mechanics/knife_edge", "a knife edge, skate or axle of wheels: no speed across it");
    is.port("body", body, "the body that it carries");
    is.parameter("point", point, "m").by_default(0.0).doc("where it touches, in body axes");
    is.parameter("direction", direction, "1").by_default({1.0, 0.0}).doc("along the edge, in body axes, of any length");
    is.nonholonomic("edge", edge, "m/s", "speed across the edge, to its left");
    direction = unit(direction);
  }
  void check(Faults& faults) const { require_direction(faults, "direction", direction); }
  template <class T>
  void nonholonomic(const Motion<T>& at, Values<T>& rows) const {
    rows(edge) = dot(at.direction(body, Vec2<Parameter>{-direction[1], direction[0]}), at.velocity(body, point));
  }
};

}  // namespace bramah::mechanics
