// Consistent positions and velocities from rough ones.
#pragma once

#include <span>

#include "system/blocks.hpp"
#include "system/system.hpp"

namespace bramah {

/// Moves x to the nearest positions with c(t, x) = 0; distances in units of the variables' nominals, `fixed` coordinates
/// stay. Redundant rows are no obstacle; contradictory ones are named. Throws AnalysisError.
void assemble_positions(const System& system, State& state, std::span<const Index> fixed = {});

/// Newton's method from state.x for the `rows` of c with `fixed` coordinates kept, steps of least size in nominals. True
/// where they close; blocks.c then holds all rows at state.x. Throws AnalysisError where c cannot be evaluated.
bool close_positions(const System& system, State& state, std::span<const Index> rows, std::span<const Index> fixed,
                     Blocks& blocks);

/// Moves v to the nearest velocities with cdot = 0 and b = 0; rates of `fixed` coordinates stay. Where rates are `given`,
/// these stay as long as the others can follow, and are changed as little as possible where they cannot; with none, all
/// weigh alike. Throws AnalysisError.
void assemble_velocities(const System& system, State& state, std::span<const Index> fixed = {},
                         std::span<const Index> given = {});

/// The largest |c| and |r| over their rows, with the row: how far a state is from the constraints.
struct Violation {
  double position = 0.0, velocity = 0.0;
  Index position_row = -1, velocity_row = -1;
};
Violation constraint_violation(const System& system, const State& state, Blocks& blocks);

}  // namespace bramah
