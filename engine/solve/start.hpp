// The state that an analysis begins with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solve/equilibrium.hpp"
#include "solve/partition.hpp"
#include "system/options.hpp"

namespace bramah {

/// The scene's start values made consistent: positions nearest to them, velocities nearest to those that are given, then
/// accelerations, multipliers and rates. Variables of "hold" keep their start values, and coordinates their start rates.
/// Throws AnalysisError.
State consistent_start(const System& system, const Options& options, double t);

/// Completes a, lambda and zdot from t, x, v, z; multipliers of redundant rows are those of least norm.
void complete(const System& system, State& state);

/// What "from" and "at" of the scene ask for: the equilibrium or the consistent start.
State reference_state(const System& system, const Options& options, bool equilibrium, double t);

/// A start that is sound, and perhaps not the one that is meant.
struct StartNote {
  /// "near assembly", "rounded data", "singular position", "nearly singular", "rate changed", "beyond a limit", "moved far"
  std::string kind;
  std::vector<std::string> names;  // of the coordinates concerned
  std::string found, remedy;
};

/// Where `state` is a singular position, at which the rank of the constraints drops for this position only, or nearly one.
std::optional<StartNote> singular_note(const System& system, const State& state);

/// What is to be said about the state that reference_state makes of the start values: another assembly nearby, rates that
/// were given and could not be kept (by 1e-6 of themselves or of the nominal). An equilibrium has no rates.
std::vector<StartNote> start_notes(const System& system, const Options& options, bool equilibrium, double t);

}  // namespace bramah
