// A torque on a planar body, given by a signal: adds M to Q of Eq. (9).
//
//   M   magnitude   N.m   positive from x to y
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct PlanarTorque {
  PlanarFrame on;
  Input magnitude;

  void describe(Description& is) {
    is.called("mechanics/planar_torque", "a torque on a planar body");
    is.port("on", on, "the body it acts on");
    is.port("magnitude", magnitude, "the torque, positive from x to y", "N.m");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply_torque(on, at(magnitude));
  }
};

}  // namespace bramah::mechanics
