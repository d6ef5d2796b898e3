// A rigid body that moves in the x-y plane; its frame sits at its centre of mass. Its share of Eq. (9):
//
//   m rddot - m g     N
//   I thetaddot       N.m
//
//   r      x, y      m        centre of mass
//   theta  angle     rad      rotation, from x to y
//   m      mass      kg
//   I      inertia   kg.m^2   about the centre of mass
//   g      gravity   m/s^2    its x and y components
#pragma once

#include <bramah/component.hpp>

namespace bramah::mechanics {

struct PlanarBody {
  Gravity gravity;
  PlanarFrame frame;
  Parameter mass = 1.0, inertia = 0.0;
  Vec2<Parameter> position = {}, velocity = {};
  Parameter angle = 0.0, angular_velocity = 0.0;

  void describe(Description& is) {
    is.called("mechanics/planar_body", "a rigid body in a plane");
    is.port("gravity", gravity, "the field it falls in; without it there is none").optional({0.0, 0.0, 0.0});
    is.parameter("mass", mass, "kg").above(0.0).doc("mass");
    is.parameter("inertia", inertia, "kg.m^2").at_least(0.0).doc("moment of inertia about the centre of mass");
    is.parameter("position", position, "m").by_default(0.0).doc("start: centre of mass");
    is.parameter("angle", angle, "rad").by_default(0.0).typical(-6.3, 6.3).doc("start: rotation, from x to y");
    is.parameter("velocity", velocity, "m/s").by_default(0.0).doc("start: velocity of the centre of mass");
    is.parameter("angular_velocity", angular_velocity, "rad/s").by_default(0.0).doc("start: rate of the rotation");
    is.own("frame", frame, "centre of mass and body axes");
  }
  void start(Start& start) const {
    Parameter *x = start.frame(frame), *v = start.frame_rate(frame);
    x[0] = position[0], x[1] = position[1], x[2] = angle;
    v[0] = velocity[0], v[1] = velocity[1], v[2] = angular_velocity;
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.inertia(frame, mass, inertia);
    const Vec3<T> g = at(gravity);
    rows.apply(frame, Vec2<T>{g[0] * mass, g[1] * mass});
  }
  template <class T>
  T energy(const At<T>& at) const {
    return kinetic_energy(at, frame, mass, inertia) + weight_energy(mass, at(gravity), at.position(frame));
  }
};

}  // namespace bramah::mechanics
