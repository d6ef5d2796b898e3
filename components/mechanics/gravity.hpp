// Gravity: the acceleration of free fall, the same everywhere.
//
//   g   acceleration   m/s^2, ground axes
#pragma once

#include <algorithm>
#include <bramah/component.hpp>

namespace bramah::mechanics {

struct UniformGravity {
  Vec3<Parameter> acceleration = {};

  void describe(Description& is) {
    is.called("mechanics/gravity", "a uniform field of gravity");
    is.parameter("acceleration", acceleration, "m/s^2")
        .by_default({0.0, 0.0, -9.81})
        .doc("acceleration of free fall in ground axes; planar bodies use its x and y");
    is.provide_constants<Gravity>("field", "the field that bodies fall in");
  }
  void constants(Parameter* values) const { std::copy(acceleration.begin(), acceleration.end(), values); }
};

}  // namespace bramah::mechanics
