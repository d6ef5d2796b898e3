// A force along a length or a torque about an angle, given by a signal: adds to Q of Eq. (9); Eq. (92) is one.
//
//   Q   force   N or N.m
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct CoordinateForce {
  Coordinate on;
  Input force;

  void describe(Description& is) {
    is.called("mechanics/coordinate_force", "a generalized force on one coordinate");
    is.port("on", on, "the length or angle it drives");
    is.port("force", force, "N on a length, N.m on an angle");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(on, at(force));
  }
};

}  // namespace bramah::mechanics
