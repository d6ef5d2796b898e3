// Where a machine comes to rest: the way of steepest descent in the metric of its masses, in steps that grow.
//
//   (M + mass) v / T + f(t, x, 0, 0, z, lambda, u) = 0      v = dx/ds, without inertia: all that moves creeps
//   g(t, x, v, z, dz/ds, u) = 0                              storage as it is, oil that a piston displaces included
//   c(t, x) = 0,  b(t, x, v) = 0
//
// by implicit Euler steps. Where the forces have a potential each step lowers it, and a step is no longer than lets the
// potential with the metric be convex: a point of rest that is no minimum repels. T: the machine's scale of time.
#pragma once

#include <vector>

#include "solve/curvature.hpp"
#include "solve/scaled_matrix.hpp"

namespace bramah {

class Settling {
 public:
  /// Coordinates and first-order variables that `options` holds stand still; their balances may stay open.
  Settling(const System& system, const EquilibriumOptions& options, const State& start);

  /// Gives `state` the multipliers that leave the least force, in the metric of the masses. False where the rows cannot be
  /// evaluated.
  bool find_multipliers(State& state);

  enum class End { rest, runs_away, gives_up };
  struct Result {
    End end = End::gives_up;
    int steps = 0;
    Index away = -1;  // runs_away: a coordinate, or n and a first-order variable
  };
  /// Follows the way from `state`, whose constraints are closed, to a point of rest.
  Result run(State& state);

 private:
  void choose_masses(const State& start);
  /// Residual and partials of a step of length h that ends at `state`; sets its velocities and rates.
  bool evaluate(const State& from, State& state, double h);
  void scale_matrix(const State& state, double statics, double h);
  /// Solves for the end of a step, from a guess. False where Newton's method does not get there.
  bool close_step(const State& from, State& state, double h);
  [[nodiscard]] State predicted(const State& from, double h);
  [[nodiscard]] double distance(const State& a, const State& b) const;
  [[nodiscard]] Index far_away(const State& start, const State& state) const;
  /// Whether all rows balance close to `state`, which is then moved there.
  bool polish(State& state, double within) const;
  bool is_minimum(const State& state);
  bool disturb(State& state, int time) const;

  const System& system_;
  const EquilibriumOptions& options_;
  Unknowns unknowns_;
  Blocks blocks_;
  Curvature curvature_;
  ScaledMatrix matrix_;
  SparsePlan inertia_;
  Vector mass_;  // (n) added to the diagonal of M, so that massless coordinates creep as well
  Vector residual_, scale_, step_, nominal_, terms_;
  Vector creep_x_, creep_z_;  // (n), (nz) velocities at the last point of the way
};

}  // namespace bramah
