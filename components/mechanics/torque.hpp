// A torque about an axis fixed in a body, its magnitude given by a signal: adds 2 L(e)^T d M to Q of Eq. (9).
//
//   d   axis        1     body axes, of any length, made a unit vector
//   M   magnitude   N.m
#pragma once

#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct Torque {
  Frame on;
  Input magnitude;
  Vec3<Parameter> axis = {};

  void describe(Description& is) {
    is.called("mechanics/torque", "a torque about an axis fixed in a body");
    is.port("on", on, "the body it acts on");
    is.port("magnitude", magnitude, "the torque about the axis", "N.m");
    is.parameter("axis", axis, "1").by_default({0.0, 0.0, 1.0}).doc("in body axes, of any length");
    axis = unit(axis);
  }
  void check(Faults& faults) const { require_direction(faults, "axis", axis); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const T& M = at(magnitude);
    rows.apply_torque(on, Vec3<T>{M * axis[0], M * axis[1], M * axis[2]});
  }
};

}  // namespace bramah::mechanics
