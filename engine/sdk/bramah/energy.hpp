// What the storages of Rows<T> hold, J: the terms that a component's `energy` adds up.
#pragma once

#include "bramah/rows.hpp"

namespace bramah {

/// Kinetic energy that belongs to rows.inertia(q, mass).
template <class T, class S>
T kinetic_energy(const At<T>& at, Coordinate q, const S& mass) {
  return square(at.rate(q)) * (0.5 * mass);
}
/// That of a rigid body in space, rows.inertia(frame, mass, inertia).
template <class T>
T kinetic_energy(const At<T>& at, Frame frame, const Parameter& mass, const Inertia& inertia) {
  const Vec3<T> v = at.velocity(frame), w = at.angular_velocity(frame);
  return 0.5 * (dot(v, v) * mass + dot(w, times(inertia, w)));
}
/// That of a rigid body in a plane, rows.inertia(frame, mass, inertia).
template <class T>
T kinetic_energy(const At<T>& at, PlanarFrame frame, const Parameter& mass, const Parameter& inertia) {
  const Vec2<T> v = at.velocity(frame);
  return 0.5 * (dot(v, v) * mass + square(at.rate_of_angle(frame)) * inertia);
}

/// Potential energy of a mass (kg) at the position r (ground axes, m) in a field: -m g.r, zero at the origin.
template <class T, std::size_t N>
T weight_energy(const Parameter& mass, const Vec3<T>& gravity, const std::array<T, N>& r) {
  T sum = gravity[0] * r[0] + gravity[1] * r[1];
  if constexpr (N == 3) sum += gravity[2] * r[2];
  return sum * -mass;
}

/// Energy of K zdot in a balance that is a flow: rows.store(p, K).
template <class T, class S>
T storage_energy(const At<T>& at, FirstOrder p, const S& K) {
  return square(at(p)) * (0.5 * K);
}

}  // namespace bramah
