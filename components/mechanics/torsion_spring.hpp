// A torsion spring and a rotational damper on an angle, or on the difference of two:
//
//   M = k (phi_to - phi_from - free_angle) + c (phi_to' - phi_from')   N.m   turns `to` back and `from` along
//
//   phi_to, phi_from   rad         without `from` it is 0: the ground
//   k   stiffness      N.m/rad
//   c   damping        N.m.s/rad
//   free_angle         rad         where the spring is slack
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct TorsionSpring {
  Coordinate from, to;
  Output torque_out;
  Parameter stiffness = 0.0, damping = 0.0, free_angle = 0.0;

  void describe(Description& is) {
    is.called("mechanics/torsion_spring", "a torsion spring and a rotational damper on an angle");
    is.port("to", to, "the angle, or that of one end", "rad");
    is.port("from", from, "that of the other end; without it 0", "rad").optional({0.0});
    is.parameter("stiffness", stiffness, "N.m/rad").by_default(0.0).doc("torque per angle");
    is.parameter("damping", damping, "N.m.s/rad").by_default(0.0).doc("torque per rate");
    is.parameter("free_angle", free_angle, "rad").by_default(0.0).doc("angle at which the spring is slack");
    is.output("torque", torque_out, "N.m", "torque of spring and damper");
  }
  template <class T>
  T torque(const At<T>& at) const {
    return (at(to) - at(from) - free_angle) * stiffness + (at.rate(to) - at.rate(from)) * damping;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const T M = torque(at);
    rows.apply(to, -M);
    rows.apply(from, M);
  }
  template <class T>
  T energy(const At<T>& at) const {
    return square(at(to) - at(from) - free_angle) * (0.5 * stiffness);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(torque_out) = torque(at);
  }
};

}  // namespace bramah::mechanics
