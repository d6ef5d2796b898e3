// The state that an analysis begins with.
#pragma once

#include "solve/equilibrium.hpp"
#include "solve/partition.hpp"
#include "system/options.hpp"

namespace bramah {

/// The scene's start values made consistent: positions and velocities nearest to them, then accelerations, multipliers
/// and rates. Variables of "hold" keep their start values, and coordinates their start rates. Throws AnalysisError.
State consistent_start(const System& system, const Options& options, double t);

/// Completes a, lambda and zdot from t, x, v, z; multipliers of redundant rows are those of least norm.
void complete(const System& system, State& state);

/// What "from" and "at" of the scene ask for: the equilibrium or the consistent start.
State reference_state(const System& system, const Options& options, bool equilibrium, double t);

}  // namespace bramah
