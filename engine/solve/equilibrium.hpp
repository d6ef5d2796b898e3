// Equilibria: f = 0, g = 0, c = 0 at v = a = zdot = 0, with some variables held.
//
// Equilibria come in families: a closed oil volume keeps any pressure, a free body any place. The scene says what to
// hold; the rank of the Newton matrix decides the rest, and directions that stay free are reported by name.
#pragma once

#include <string>
#include <vector>

#include "solve/redundancy.hpp"
#include "system/blocks.hpp"
#include "system/options.hpp"

namespace bramah {

struct FreeDirection {
  std::vector<std::pair<std::string, double>> variables;  // name and share (SI) along the direction
};

struct Equilibrium {
  State state;
  int iterations = 0;
  double residual = 0.0;  // largest, relative to the terms of its row
  std::vector<FreeDirection> free_directions;
  std::vector<RedundantSet> redundancy;  // where not empty, multipliers are not unique: those of least norm are given
};

/// Finds the equilibrium near the start values; throws AnalysisError where there is none.
Equilibrium find_equilibrium(const System& system, const EquilibriumOptions& options, double t = 0.0);

/// How the equilibrium at `state` moves: completes `along`, whose parameters and inputs move, with dx, dz and dlambda.
/// Held variables follow their start values; free directions are left where they are. AnalysisError where no equilibrium
/// is beside it.
void move_equilibrium(const System& system, const EquilibriumOptions& options, const State& state, Direction& along);

}  // namespace bramah
