// Measures: functions of the coordinates that forces act along.
//
// A law acts on a few scalars, a measure takes them from the mechanism. Virtual work then gives the generalized force,
// Q = (ds/dx)^T F, and no term can be forgotten: the gradient is exact, on whatever scalar the balance is evaluated on.
#pragma once

#include "bramah/rows.hpp"

namespace bramah {

/// A mass point (kg) whose position is a function of own or connected coordinates, in free fall under `gravity` (m/s^2):
/// adds (dr/dx)^T m (rddot - gravity). `position` is a generic callable on Positions<S> returning Vec3<S>; `nx` is the
/// number of local coordinates, all of which it may use.
template <std::size_t nx, class T, class Position>
void add_particle(const At<T>& at, Rows<T>& rows, const Parameter& mass, const Vec3<T>& gravity,
                  const Position& position) {
  Taylor<T, 2> path[nx];
  for (std::size_t j = 0; j < nx; ++j) {
    path[j].c[0] = at.x()[j];
    path[j].c[1] = at.v()[j];
    path[j].c[2] = 0.5 * at.a()[j];
  }
  Taylor<T, 2> clock(0.0);
  clock.c[0] = at.time();
  clock.c[1] = T(1.0);
  const Vec3<Taylor<T, 2>> r = position(Positions<Taylor<T, 2>>(path, clock, 1));
  Vec3<T> force;
  for (std::size_t k = 0; k < 3; ++k) force[k] = (gravity[k] - 2.0 * r[k].c[2]) * mass;

  Taylor<T, 1> now(0.0);
  now.c[0] = at.time();
  Taylor<T, 1> x[nx];
  for (std::size_t j = 0; j < nx; ++j) {
    x[j].c[0] = at.x()[j];
    x[j].c[1] = T(0.0);
  }
  for (std::size_t j = 0; j < nx; ++j) {
    x[j].c[1] = T(1.0);
    const Vec3<Taylor<T, 1>> moved = position(Positions<Taylor<T, 1>>(x, now, 1));
    Coordinate q;
    q.slot = static_cast<int>(j);
    rows.apply(q, moved[0].c[1] * force[0] + moved[1].c[1] * force[1] + moved[2].c[1] * force[2]);
    x[j].c[1] = T(0.0);
  }
}

/// Kinetic and potential energy (J) of that mass point.
template <std::size_t nx, class T, class Position>
T particle_energy(const At<T>& at, const Parameter& mass, const Vec3<T>& gravity, const Position& position) {
  Taylor<T, 1> path[nx];
  for (std::size_t j = 0; j < nx; ++j) {
    path[j].c[0] = at.x()[j];
    path[j].c[1] = at.v()[j];
  }
  Taylor<T, 1> clock(0.0);
  clock.c[0] = at.time();
  clock.c[1] = T(1.0);
  const Vec3<Taylor<T, 1>> r = position(Positions<Taylor<T, 1>>(path, clock, 1));
  T energy = T(0.0);
  for (std::size_t k = 0; k < 3; ++k) energy += (square(r[k].c[1]) * 0.5 - gravity[k] * r[k].c[0]) * mass;
  return energy;
}

}  // namespace bramah
