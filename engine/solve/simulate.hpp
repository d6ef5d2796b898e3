// Simulation: segments between breakpoints and events, each marched by an integrator, with outputs on the way.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solve/energy_book.hpp"
#include "solve/event_memory.hpp"
#include "solve/integrator.hpp"
#include "solve/partition.hpp"
#include "system/options.hpp"
#include "system/system.hpp"

namespace bramah {

struct EventTaken {
  double time = 0.0;
  std::string name;  // "relief.crack", or as the scene calls it
};

/// A limit of a law that was passed, where the law goes on meaningfully.
struct LimitPassed {
  std::string component, quantity;  // "P", "p"
  std::string text;                 // of the farthest beyond: "the pressure, P.p, is -12000 Pa, below 0 Pa"
  double first_time = 0.0, farthest_time = 0.0, value = 0.0;
};

struct SimulationStatistics : IntegratorWork {
  std::string integrator;                             // which one, and why where it was chosen
  long restarts = 0;                                  // at breakpoints of the inputs and at events
  double worst_position = 0.0, worst_velocity = 0.0;  // constraint rows, over all accepted steps
  std::string worst_position_row, worst_velocity_row;
  double smallest_step = 0.0, largest_step = 0.0;
  std::string limiting;       // the variable that limited most steps
  double limiting_share = 0;  // of the steps
  EnergyBalance energy;
  double worst_shown = 0.0, worst_shown_time = 0.0;  // Kkt::uncertainty of what was shown
  double seconds = 0.0;
  double seconds_integrating = 0.0, seconds_events = 0.0, seconds_outputs = 0.0;  // where they went
};

/// All that a run needs to go on from where it was.
struct Checkpoint {
  State state;             // complete
  State chosen_at;         // t, side, x, v, z: where the independent rows were chosen
  std::string integrator;  // Integrator::name
  Vector memory;           // Integrator::memory; empty where integration starts anew
  std::vector<EventMemory> events;
  long outputs = 0;  // how many the run has made so far, those before it was continued included
};

struct Observer {
  /// Called with every output state in order; a, lambda and zdot are those of the solution.
  std::function<void(const State&)> output;
  /// Called after every step with time and step size; false stops the run after the last output.
  std::function<bool(double time, double step)> progress;
  /// Asked after every step; where it is true, `checkpoint` gets the state reached.
  std::function<bool()> checkpoint_due;
  std::function<void(const Checkpoint&)> checkpoint;
};

struct Simulation {
  SimulationStatistics statistics;
  State last;              // the last state reached
  Checkpoint checkpoint;   // to go on from there
  bool stopped = false;    // by the observer
  std::string stopped_by;  // the scene's event that ended the run
  std::vector<EventTaken> events;
  std::vector<LimitPassed> limits_passed;
};

/// A run that could not go on: the same message, and the last good state.
class SimulationError : public AnalysisError {
 public:
  SimulationError(const AnalysisError& error, Checkpoint last, std::vector<LimitPassed> passed)
      : AnalysisError(error), last_(std::move(last)), limits_passed_(std::move(passed)) {}
  [[nodiscard]] const Checkpoint& last() const { return last_; }
  [[nodiscard]] const std::vector<LimitPassed>& limits_passed() const { return limits_passed_; }

 private:
  Checkpoint last_;
  std::vector<LimitPassed> limits_passed_;
};

/// Runs from `start` (consistent in positions and velocities; its time is where the run begins) to options.to_time.
/// Output at the start, every output_step from from_time on, at output_times (every step where neither is given), at both
/// sides of input breakpoints and of the scene's events, and at the end. Throws SimulationError where the integrator gives
/// up; the message names the row and the component that limited the step.
Simulation simulate(const System& system, const SimulateOptions& options, const State& start, const Observer& observer);

/// Goes on from a checkpoint, with no output there. The generalized-alpha method goes on with the same bits as if it had
/// never stopped; the others start anew. Throws AnalysisError where the integrator is not the one of the checkpoint.
Simulation resume(const System& system, const SimulateOptions& options, const Checkpoint& from,
                  const Observer& observer);

}  // namespace bramah
