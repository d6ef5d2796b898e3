// A simulation with its outputs by name: what `simulate` and `study` share.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/context.hpp"
#include "io/tables.hpp"
#include "solve/simulate.hpp"

namespace bramah {

/// Called with every output state and the values of the scene's outputs there.
using Sink = std::function<void(const State& state, const Vector& values)>;

struct Transient {
  Simulation simulation;
  Vector final_values;     // of the scene's outputs, at the last output
  double last_time = 0.0;  // of the last output
  bool interrupted = false;
};

/// What a simulation begins with, and who hears of it on the way.
struct TransientSetup {
  const State* start = nullptr;        // instead of what the scene's "simulate" says
  const Checkpoint* resume = nullptr;  // to go on from
  bool show_progress = true;
  std::function<void(const Checkpoint&)> save;  // called every `save_every` seconds of work
  double save_every = 0.0;                      // 0: never
};

/// Simulates. Ctrl-C stops after the current step.
Transient run_transient(const Context& context, const SimulateOptions& options, const TransientSetup& setup,
                        const Sink& sink);

/// `time,NAME,...` and rows below it.
std::string csv_header(const std::vector<Measured>& outputs);
std::string csv_row(double time, std::span<const double> values);

Table statistics_table(const Transient& transient);
/// "from t = 0.2 s on P was beyond where its law holds: ...", one line for each limit.
std::vector<std::string> limit_warnings(const std::vector<LimitPassed>& limits);
/// Why not to trust a run that came to its end: more than 2 % of the energy that was turned over unaccounted for, or
/// accelerations without digits.
std::vector<AnalysisError> doubts_of(const Simulation& simulation);
/// Members of an open object.
void write_statistics(class JsonWriter& json, const Transient& transient);

}  // namespace bramah
