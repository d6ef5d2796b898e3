// Equilibria: f = 0, g = 0, c = 0 at v = a = zdot = 0, with some variables held.
//
// Equilibria come in families: a closed oil volume keeps any pressure, a free body any place. The scene says what to
// hold; the rank of the Newton matrix decides the rest, and directions that stay free are reported by name.
//
// Newton's method is tried first, from multipliers that belong to the start. Start values that balance are kept, whether
// they are stable or not. A search from elsewhere, where Newton's method fails or ends at a point of rest that is no minimum
// of the potential, follows the way that the machine would creep along (solve/settling.hpp).
#pragma once

#include <string>
#include <vector>

#include "solve/balance.hpp"
#include "solve/redundancy.hpp"
#include "system/options.hpp"

namespace bramah {

/// A variable that the search has moved.
struct Moved {
  std::string name, unit;
  double from = 0.0, to = 0.0;  // SI; from: the assembled start value
  double nominals = 0.0;        // how far
  bool coordinate = true;
  bool given = false;  // by the scene's "start"
};

struct Equilibrium {
  State state;
  int iterations = 0;     // of Newton's method
  int steps = 0;          // along the way of settling; 0 where Newton's method was enough
  double residual = 0.0;  // largest, relative to the terms of its row
  /// The point of rest that Newton's method ended at first is no minimum of the potential; this one is.
  bool passed_unstable = false;
  std::vector<FreeDirection> free_directions;
  std::vector<RedundantSet> redundancy;    // where not empty, multipliers are not unique: those of least norm are given
  std::vector<std::string> beyond_limits;  // of laws that go on there: "the pressure, P.p, is -10 Pa, below 0 Pa"
  std::vector<Moved> moved;                // all that left their assembled start values, the farthest first
};

/// Finds the equilibrium near the start values; throws AnalysisError where there is none.
Equilibrium find_equilibrium(const System& system, const EquilibriumOptions& options, double t = 0.0);

/// The equilibrium that Newton's method reaches from `guess`, whatever its stability; variables that are held take their
/// start values. AnalysisError where there is none.
Equilibrium continue_equilibrium(const System& system, const EquilibriumOptions& options, const State& guess);

/// How the equilibrium at `state` moves: completes `along`, whose parameters and inputs move, with dx, dz and dlambda.
/// Held variables follow their start values; free directions are left where they are. AnalysisError where no equilibrium
/// is beside it.
void move_equilibrium(const System& system, const EquilibriumOptions& options, const State& state, Direction& along);

}  // namespace bramah
