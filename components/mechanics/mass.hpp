// A mass that moves along a line:
//
//   m xddot   N
//
//   x          m    place on the line
//   m   mass   kg
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct Mass {
  Coordinate x;
  Parameter mass = 1.0, position = 0.0, velocity = 0.0;

  void describe(Description& is) {
    is.called("mechanics/mass", "a mass that moves along a line");
    is.parameter("mass", mass, "kg").above(0.0).doc("mass");
    is.parameter("position", position, "m").by_default(0.0).doc("start: place on the line");
    is.parameter("velocity", velocity, "m/s").by_default(0.0).doc("start: velocity");
    is.own("x", x, "m", "place on the line");
  }
  void start(Start& start) const {
    start(x) = position;
    start.rate(x) = velocity;
  }
  template <class T>
  void balance(const At<T>&, Rows<T>& rows) const {
    rows.inertia(x, mass);
  }
  template <class T>
  T energy(const At<T>& at) const {
    return kinetic_energy(at, x, mass);
  }
};

}  // namespace bramah::mechanics
