// A force of fixed direction at a point of a body, its magnitude given by a signal: adds (dr/dx)^T F d to Q of Eq. (9).
//
//   r   point       m   body axes
//   d   direction   1   ground axes, of any length, made a unit vector
//   F   magnitude   N
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct Force {
  Frame on;
  Input magnitude;
  Vec3<Parameter> point = {}, direction = {};

  void describe(Description& is) {
    is.called("mechanics/force", "a force of fixed direction at a point of a body");
    is.port("on", on, "the body it acts on");
    is.port("magnitude", magnitude, "the force along the direction", "N");
    is.parameter("point", point, "m").by_default(0.0).doc("where it acts, in body axes");
    is.parameter("direction", direction, "1").doc("where it pulls, in ground axes, of any length");
    direction = unit(direction);
  }
  void check(Faults& faults) const { require_direction(faults, "direction", direction); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    Vec3<T> force;
    for (std::size_t k = 0; k < force.size(); ++k) force[k] = at(magnitude) * direction[k];
    rows.apply(on, point, force);
  }
};

}  // namespace bramah::mechanics
