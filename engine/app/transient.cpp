#include "app/transient.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "app/progress.hpp"
#include "app/results.hpp"
#include "io/tables.hpp"
#include "solve/kkt.hpp"
#include "solve/start.hpp"
#include "system/measure.hpp"

namespace bramah {

Transient run_transient(const Context& context, const SimulateOptions& options, const TransientSetup& setup,
                        const Sink& sink) {
  using Clock = std::chrono::steady_clock;
  const System& system = context.system();
  Transient result;
  Meter meter(system, context.options().outputs);
  Progress progress("simulate", setup.show_progress && !context.arguments.quiet);
  const InterruptGuard guard;
  Observer observer;
  observer.output = [&](const State& state) {
    result.final_values = meter.read(state);
    result.last_time = state.t;
    sink(state, result.final_values);
  };
  const double length = options.to_time - options.from_time;
  observer.progress = [&](double time, double step) {
    progress.show((time - options.from_time) / length, "t = " + short_number(time, 4) + " s, step " + duration(step));
    return !InterruptGuard::interrupted();
  };
  std::optional<Clock::time_point> saved;  // once at least
  observer.checkpoint_due = [&] {
    if (setup.save_every == 0.0) return false;
    if (saved && std::chrono::duration<double>(Clock::now() - *saved).count() < setup.save_every) return false;
    saved = Clock::now();
    return true;
  };
  observer.checkpoint = setup.save;
  if (setup.resume != nullptr) {
    result.simulation = resume(system, options, *setup.resume, observer);
  } else if (setup.start != nullptr) {
    result.simulation = simulate(system, options, *setup.start, observer);
  } else {
    const State start = reference_state(system, context.options(), options.from == SimulateOptions::From::equilibrium,
                                        options.from_time);
    result.simulation = simulate(system, options, start, observer);
  }
  result.interrupted = result.simulation.stopped;
  return result;
}

std::string csv_header(const std::vector<Measured>& outputs) {
  std::string line = "time";
  for (const Measured& output : outputs) line += ',' + csv_field(output.name);
  return line + '\n';
}

std::string csv_row(double time, std::span<const double> values) {
  std::string line = exact_number(time);
  for (const double value : values) line += ',' + exact_number(value);
  return line + '\n';
}

namespace {

/// "relief.opening (12), stop (1)", the most frequent first.
std::string events_text(const std::vector<EventTaken>& events) {
  std::map<std::string, int> counts;
  for (const EventTaken& event : events) ++counts[event.name];
  std::vector<std::pair<std::string, int>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t k = 0; k < sorted.size() && k < 5; ++k)
    text += (k == 0 ? "" : ", ") + sorted[k].first + " (" + std::to_string(sorted[k].second) + ")";
  return text + (sorted.size() > 5 ? ", ... " + std::to_string(events.size()) + " in all" : "");
}

/// "3.2 J at the start, 1.1 J at the end; 2 J taken out, most of it by damper; 4e-09 J unaccounted for".
std::string energy_text(const EnergyBalance& energy) {
  if (!energy.unknown.empty()) return "not balanced: " + energy.unknown;
  const auto joule = [](double value) { return short_number(value, 4) + " J"; };
  std::string text = joule(energy.at_start) + " at the start, " + joule(energy.at_end) + " at the end";
  const auto share = [&](double work, const char* what, const std::string& most) {
    if (work > 1e-10 * energy.activity) text += "; " + joule(work) + what + ", most of it by " + most;
  };
  share(energy.brought_in, " brought in", energy.most_brought_in);
  share(energy.taken_out, " taken out", energy.most_taken_out);
  return text + "; " + short_number(energy.unaccounted, 2) + " J unaccounted for";
}

}  // namespace

Table statistics_table(const Transient& transient) {
  const SimulationStatistics& s = transient.simulation.statistics;
  Table table{{}, {}, "ll"};
  const auto row = [&](const char* name, std::string value) { table.rows.push_back({name, std::move(value)}); };
  row("simulated to",
      short_number(transient.simulation.last.t, 10) + " s" + (transient.interrupted ? ", interrupted" : "") +
          (transient.simulation.stopped_by.empty() ? "" : ", stopped by " + transient.simulation.stopped_by));
  row("steps", std::to_string(s.steps) + " (" + counted(static_cast<std::size_t>(s.restarts), "restart") + ", " +
                   counted(static_cast<std::size_t>(s.error_test_failures), "failed error test") + ", " +
                   counted(static_cast<std::size_t>(s.convergence_failures), "failed Newton iteration") + ")");
  row("integrator", s.integrator);
  row("step size",
      duration(s.smallest_step) + " ... " + duration(s.largest_step) +
          (s.limiting.empty() ? ""
                              : ", limited by " + s.limiting + " in " +
                                    short_number(std::round(100.0 * s.limiting_share), 3) + " % of the steps"));
  row("evaluations", std::to_string(s.evaluations) + " of rows, " + std::to_string(s.jacobians) + " of partials");
  row("factorizations", std::to_string(s.factorizations));
  if (s.newton_iterations > 0) row("Newton iterations", std::to_string(s.newton_iterations));
  const auto violation = [](double value, const std::string& name) {
    return short_number(value, 2) + (name.empty() ? "" : " in " + name);
  };
  if (!transient.simulation.events.empty()) row("events", events_text(transient.simulation.events));
  row("energy", energy_text(s.energy));
  row("worst constraint violation", violation(s.worst_position, s.worst_position_row));
  row("worst violation of rates", violation(s.worst_velocity, s.worst_velocity_row));
  const double rest = s.seconds - s.seconds_integrating - s.seconds_events - s.seconds_outputs;
  row("time", duration(s.seconds) + ": integrating " + duration(s.seconds_integrating + std::max(rest, 0.0)) +
                  ", events " + duration(s.seconds_events) + ", outputs " + duration(s.seconds_outputs));
  return table;
}

std::vector<std::string> limit_warnings(const std::vector<LimitPassed>& limits) {
  std::vector<std::string> list;
  for (const LimitPassed& passed : limits)
    list.push_back("from t = " + short_number(passed.first_time, 6) + " s on " + passed.component +
                   " was beyond where its law holds: at t = " + short_number(passed.farthest_time, 6) + " s " +
                   passed.text);
  return list;
}

std::vector<AnalysisError> doubts_of(const Simulation& simulation) {
  constexpr double tolerable = 0.02;
  std::vector<AnalysisError> doubts;
  const SimulationStatistics& s = simulation.statistics;
  if (s.energy.unknown.empty() && s.energy.relative() > tolerable) {
    doubts.emplace_back("simulate",
                        short_number(s.energy.unaccounted, 2) + " J, " + short_number(100.0 * s.energy.relative(), 2) +
                            " % of the energy that was turned over, came from nowhere or got lost",
                        "at most " + short_number(100.0 * tolerable) + " %",
                        "do not trust this run; lower rel_tol, or try another integrator", "/simulate");
  }
  // Few are those of singular positions that the machine passes; steps around them bridge these.
  const auto imprecise = static_cast<double>(s.imprecise), all = static_cast<double>(s.evaluations);
  if (imprecise > tolerable * all) {
    doubts.emplace_back("simulate",
                        short_number(std::ceil(100.0 * std::min(1.0, imprecise / all)), 3) +
                            " % of the accelerations that were integrated have fewer than 6 digits: constraints nearly "
                            "depend on each other",
                        "at most " + short_number(100.0 * tolerable) + " %",
                        "set \"integrator\": \"ida\", which solves for them without softness", "/simulate");
  }
  if (s.worst_shown > Kkt::few_digits) {
    doubts.emplace_back("simulate",
                        "accelerations and multipliers shown at t = " + short_number(s.worst_shown_time, 6) +
                            " s are certain to " + short_number(s.worst_shown, 1) + " of the largest only",
                        short_number(Kkt::few_digits), "look for constraints that nearly depend on each other there",
                        "/simulate");
  }
  return doubts;
}

void write_statistics(JsonWriter& json, const Transient& transient) {
  const SimulationStatistics& s = transient.simulation.statistics;
  json.member("reached_time", transient.simulation.last.t).member("interrupted", transient.interrupted);
  json.member("stopped_by", transient.simulation.stopped_by).member("integrator", s.integrator);
  json.member("steps", s.steps).member("restarts", s.restarts).member("newton_iterations", s.newton_iterations);
  json.member("evaluations", s.evaluations).member("jacobians", s.jacobians);
  json.member("factorizations", s.factorizations);
  json.member("error_test_failures", s.error_test_failures).member("convergence_failures", s.convergence_failures);
  json.member("imprecise_accelerations", s.imprecise).member("worst_shown_uncertainty", s.worst_shown);
  json.member("worst_position_violation", s.worst_position).member("worst_position_row", s.worst_position_row);
  json.member("worst_velocity_violation", s.worst_velocity).member("worst_velocity_row", s.worst_velocity_row);
  json.key("energy").begin_object();
  if (s.energy.unknown.empty()) {
    json.member("at_start", s.energy.at_start).member("at_end", s.energy.at_end);
    json.member("brought_in", s.energy.brought_in).member("most_brought_in", s.energy.most_brought_in);
    json.member("taken_out", s.energy.taken_out).member("most_taken_out", s.energy.most_taken_out);
    json.member("unaccounted", s.energy.unaccounted).member("unaccounted_share", s.energy.relative());
  } else {
    json.member("unknown", s.energy.unknown);
  }
  json.end_object();
  json.member("smallest_step", s.smallest_step).member("largest_step", s.largest_step);
  json.member("limiting", s.limiting).member("limiting_share", s.limiting_share);
  json.key("events").begin_list();
  for (const EventTaken& event : transient.simulation.events)
    json.begin_flat_object().member("time", event.time).member("name", event.name).end_object();
  json.end_list();
  json.key("limits_passed").begin_list();
  for (const LimitPassed& passed : transient.simulation.limits_passed) {
    json.begin_flat_object().member("component", passed.component).member("quantity", passed.quantity);
    json.member("first_time", passed.first_time).member("farthest_time", passed.farthest_time);
    json.member("farthest", passed.value).end_object();
  }
  json.end_list();
  json.member("time_s", s.seconds).member("integrating_s", s.seconds_integrating);
  json.member("events_s", s.seconds_events).member("outputs_s", s.seconds_outputs);
}

}  // namespace bramah
