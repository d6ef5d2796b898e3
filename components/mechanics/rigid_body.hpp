// A rigid body in space; its frame sits at its centre of mass. Its share of Eq. (9), after Newton and Euler:
//
//   m rddot - m g                         N
//   2 L(e)^T (I alpha + w x I w)          N.m   w = 2 L(e) edot, alpha = 2 L(e) eddot
//   (e.e - 1) / 2 = 0                     1     the Euler parameters stay of unit length
//
//   r   x, y, z                               m        centre of mass, ground axes
//   e   e0, e1, e2, e3                        1        Euler parameters: body axes against ground axes
//   w                                         rad/s    angular velocity, body axes
//   m   mass                                  kg
//   I   inertia xx, yy, zz; products xy, xz, yz  kg.m^2  about the centre of mass, body axes
//   g   gravity                               m/s^2
#pragma once

#include <algorithm>
#include <bramah/component.hpp>

#include "axes.hpp"

namespace bramah::mechanics {

struct RigidBody {
  Gravity gravity;
  Frame frame;
  HolonomicRow norm;
  Parameter mass = 1.0;
  Vec3<Parameter> inertia = {}, products = {};
  Vec3<Parameter> position = {}, rotation = {}, velocity = {}, angular_velocity = {};

  void describe(Description& is) {
    is.called("mechanics/rigid_body", "a rigid body in space");
    is.port("gravity", gravity, "the field it falls in; without it there is none").optional({0.0, 0.0, 0.0});
    is.parameter("mass", mass, "kg").above(0.0).doc("mass");
    is.parameter("inertia", inertia, "kg.m^2")
        .at_least(0.0)
        .doc("xx, yy, zz of the inertia matrix at the centre of mass");
    is.parameter("products", products, "kg.m^2")
        .by_default(0.0)
        .doc("xy, xz, yz of the inertia matrix: elements, so that xy = -integral of x y dm");
    is.parameter("position", position, "m").by_default(0.0).doc("start: centre of mass in ground axes");
    is.parameter("rotation", rotation, "rad").by_default(0.0).doc("start: rotation vector, axis times angle");
    is.parameter("velocity", velocity, "m/s").by_default(0.0).doc("start: velocity of the centre of mass, ground axes");
    is.parameter("angular_velocity", angular_velocity, "rad/s").by_default(0.0).doc("start: in body axes");
    is.own("frame", frame, "centre of mass and body axes");
    is.holonomic("norm", norm, "1", "unit length of the Euler parameters");
  }

  void check(Faults& faults) const {
    // The matrix of second moments, tr(I)/2 1 - I = integral of r r^T dm, is positive semidefinite for every body; this
    // implies the same of I. Slender rods sit on the edge, so rounded numbers get a margin.
    const Parameter trace = inertia[0] + inertia[1] + inertia[2], margin = 1e-9 * trace;
    const Vec3<Parameter> moment = {0.5 * trace - inertia[0], 0.5 * trace - inertia[1], 0.5 * trace - inertia[2]};
    const std::string found = written(inertia) + " with products " + written(products);
    if (!semidefinite(inertia, products, margin)) {
      faults.add("inertia", found, "a positive semidefinite inertia matrix");
    } else if (!semidefinite(moment, -1.0 * products, margin)) {
      faults.add("inertia", found, "no principal moment greater than the sum of the other two");
    }
  }

  void start(Start& start) const {
    const Quaternion<Parameter> e = quaternion_of(rotation);
    const Quaternion<Parameter> edot = body_rate_transposed(e, 0.5 * angular_velocity);  // inverts w = 2 L edot
    Parameter *x = start.frame(frame), *v = start.frame_rate(frame);
    std::copy(position.begin(), position.end(), x);
    std::copy(e.begin(), e.end(), x + 3);
    std::copy(velocity.begin(), velocity.end(), v);
    std::copy(edot.begin(), edot.end(), v + 3);
  }

  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.inertia(frame, mass, inertia_matrix());
    rows.apply(frame, mass * at(gravity));
  }
  template <class T>
  T energy(const At<T>& at) const {
    return kinetic_energy(at, frame, mass, inertia_matrix()) + weight_energy(mass, at(gravity), at.position(frame));
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Quaternion<T> e = at.orientation(frame);
    rows(norm) = 0.5 * (dot(e, e) - 1.0);
  }

 private:
  [[nodiscard]] Inertia inertia_matrix() const {
    return {inertia[0], inertia[1], inertia[2], products[0], products[1], products[2]};
  }
  /// Whether the symmetric matrix (diagonal xx, yy, zz; off xy, xz, yz) has no eigenvalue below about -margin: by all
  /// its principal minors.
  static bool semidefinite(const Vec3<Parameter>& d, const Vec3<Parameter>& o, const Parameter& margin) {
    const Parameter a = d[0] + margin, b = d[1] + margin, c = d[2] + margin;
    const Parameter determinant =
        a * (b * c - o[2] * o[2]) - o[0] * (o[0] * c - o[2] * o[1]) + o[1] * (o[0] * o[2] - b * o[1]);
    return a >= 0.0 && b >= 0.0 && c >= 0.0 && a * b >= o[0] * o[0] && a * c >= o[1] * o[1] && b * c >= o[2] * o[2] &&
           determinant >= -1e-15 * (a + b + c) * (a + b + c) * (a + b + c);
  }
};

}  // namespace bramah::mechanics
