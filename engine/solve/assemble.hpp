// Consistent positions and velocities from rough ones.
#pragma once

#include <span>

#include "solve/partition.hpp"
#include "system/blocks.hpp"
#include "system/system.hpp"

namespace bramah {

/// Moves x to the nearest positions with c(t, x) = 0; distances in units of the variables' nominals, `fixed` coordinates
/// stay. Redundant rows are no obstacle; contradictory ones are named. Throws AnalysisError.
void assemble_positions(const System& system, State& state, std::span<const Index> fixed = {});

/// As assemble_positions, from start values. Coordinates without mass that nobody gave a position, such as a length that
/// is only measured, have no say in it: where they alone can close all rows nothing else moves.
void assemble_start_positions(const System& system, State& state, std::span<const Index> fixed = {});

/// Newton's method from state.x for the `rows` of c with `fixed` coordinates kept, steps of least size in nominals. Where
/// `given` names coordinates, all others follow these. True where the rows close; blocks.c then holds all rows at state.x.
/// Throws AnalysisError where c cannot be evaluated.
bool close_positions(const System& system, State& state, std::span<const Index> rows, std::span<const Index> fixed,
                     Blocks& blocks, std::span<const Index> given = {});

/// Moves v to the nearest velocities with cdot = 0 and b = 0; rates of `fixed` coordinates stay. Throws AnalysisError.
void assemble_velocities(const System& system, State& state, std::span<const Index> fixed = {});

/// As assemble_velocities, from start values. Rates that are `given` stay as long as the others can follow, and are changed
/// as little as possible where they cannot; of the others those with mass move as little as possible, and coordinates
/// without mass have no say. Throws AnalysisError.
void assemble_start_velocities(const System& system, State& state, std::span<const Index> fixed,
                               std::span<const Index> given);

/// Whether rows c at an assembled state are open by more than their own rounding: joints that repeat each other but for the
/// rounding of their data, and System::assembly_tolerance has let pass.
bool leaves_rounding(const System& system, const State& state, const Vector& c);

/// Moves x, then v, to the nearest where the independent rows of `partition` close, the others as far as these imply them.
/// Throws AnalysisError.
void close_independent_rows(const System& system, State& state, const Partition& partition, Blocks& blocks);

/// The largest |c| and |r| over their rows, with the row: how far a state is from the constraints.
struct Violation {
  double position = 0.0, velocity = 0.0;
  Index position_row = -1, velocity_row = -1;
};
Violation constraint_violation(const System& system, const State& state, Blocks& blocks);

}  // namespace bramah
