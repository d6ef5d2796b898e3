// Simulation by IDA: the stabilized index-2 form of Gear, Gupta and Leimkuhler with the exact sparse Jacobian.
//
//   xdot - v + C_x^T mu = 0      f(t, x, v, vdot, z, lambda, u) = 0      g(t, x, v, z, zdot, u) = 0
//   r(t, x, v) = 0               c(t, x) = 0
//
// Positions and velocities both satisfy their constraints at every step; mu is zero on the exact solution.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solve/partition.hpp"
#include "system/options.hpp"
#include "system/system.hpp"

namespace bramah {

struct SimulationStatistics {
  long steps = 0, residuals = 0, jacobians = 0, newton_iterations = 0, error_test_failures = 0,
       convergence_failures = 0;
  long restarts = 0;                                  // at breakpoints of the inputs
  double worst_position = 0.0, worst_velocity = 0.0;  // constraint rows, over all accepted steps
  std::string worst_position_row, worst_velocity_row;
  double seconds = 0.0;
};

struct Observer {
  /// Called with every output state in order; a, lambda and zdot are those of the solution.
  std::function<void(const State&)> output;
  /// Called after every step with time and step size; false stops the run after the last output.
  std::function<bool(double time, double step)> progress;
};

struct Simulation {
  SimulationStatistics statistics;
  State last;            // the last state reached
  bool stopped = false;  // by the observer
};

/// Runs from `start` (consistent in positions and velocities) to options.to_time. Output at from_time, every output_step,
/// at output_times (every step where neither is given), at both sides of input breakpoints, and at the end. Throws
/// AnalysisError where the integrator gives up; the message names the row and the component that limited the step.
Simulation simulate(const System& system, const SimulateOptions& options, const State& start, const Observer& observer);

}  // namespace bramah
