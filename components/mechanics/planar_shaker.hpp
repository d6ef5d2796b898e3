// A shaker: moves a point of a planar body along a line of the ground, as a sine of time:
//
//   d . (r + A point) - offset - amplitude sin(omega t + phase) = 0   m   row drive
//
//   point           m       body axes
//   d   direction   1       of the motion, ground axes, of any length, made a unit vector
//   omega           rad/s   angular frequency
// Multiplier: the force (N) of the body on the shaker along d.
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct PlanarShaker {
  PlanarFrame body;
  HolonomicRow drive;
  Vec2<Parameter> point = {}, direction = {};
  Parameter amplitude = 0.0, omega = 0.0, phase = 0.0, offset = 0.0;

  void describe(Description& is) {
    is.called("mechanics/planar_shaker", "moves a point of a planar body along a line, as a sine of time");
    is.port("body", body, "the body that it moves");
    is.parameter("point", point, "m").by_default(0.0).doc("where it holds the body, in body axes");
    is.parameter("direction", direction, "1").doc("along which it moves, in ground axes, of any length");
    is.parameter("amplitude", amplitude, "m").doc("amplitude");
    is.parameter("omega", omega, "rad/s").doc("angular frequency");
    is.parameter("phase", phase, "rad").by_default(0.0).doc("phase at t = 0");
    is.parameter("offset", offset, "m").by_default(0.0).doc("middle of the motion, from the origin");
    is.holonomic("drive", drive, "m", "the point along the direction less the motion");
    direction = unit(direction);
  }
  void check(Faults& faults) const { require_direction(faults, "direction", direction); }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    rows(drive) = dot(at.point(body, point), direction) - offset - amplitude * sin(omega * at.time() + phase);
  }
};

}  // namespace bramah::mechanics
