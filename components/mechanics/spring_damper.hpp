// A spring and a damper along a length, or along the difference of two:
//
//   F = k (s_to - s_from - free_length) + c (s_to' - s_from')   N   pulls `to` back and `from` along
//
//   s_to, s_from   m       lengths or places on a line; without `from` it is 0: the ground, or a stroke
//   k   stiffness  N/m
//   c   damping    N.s/m
//   free_length    m       where the spring is slack
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct SpringDamper {
  Coordinate from, to;
  Output force_out;
  Parameter stiffness = 0.0, damping = 0.0, free_length = 0.0;

  void describe(Description& is) {
    is.called("mechanics/spring_damper", "a spring and a damper along a length");
    is.port("to", to, "the length, or one end", "m");
    is.port("from", from, "the other end; without it 0", "m").optional({0.0});
    is.parameter("stiffness", stiffness, "N/m").by_default(0.0).doc("force per length");
    is.parameter("damping", damping, "N.s/m").by_default(0.0).doc("force per speed");
    is.parameter("free_length", free_length, "m").by_default(0.0).doc("length at which the spring is slack");
    is.output("force", force_out, "N", "pull of spring and damper");
  }
  template <class T>
  T force(const At<T>& at) const {
    return (at(to) - at(from) - free_length) * stiffness + (at.rate(to) - at.rate(from)) * damping;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const T F = force(at);
    rows.apply(to, -F);
    rows.apply(from, F);
  }
  template <class T>
  T energy(const At<T>& at) const {
    return square(at(to) - at(from) - free_length) * (0.5 * stiffness);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(force_out) = force(at);
  }
};

}  // namespace bramah::mechanics
