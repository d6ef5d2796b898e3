#include "solve/simulate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "solve/assemble.hpp"
#include "solve/choose_integrator.hpp"
#include "solve/dropped_rows.hpp"
#include "solve/events.hpp"
#include "solve/kkt.hpp"
#include "solve/near_assembly.hpp"
#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

constexpr long most_steps_in_segment = 50'000'000;
// Events that follow each other faster than this part of the run have no end: a law that jumps, or a contact that rattles.
constexpr double least_distance = 1e-10;
constexpr int most_crowded_events = 1000;
// Steps of the one-step method over a position that the chosen method does not pass.
constexpr int shortest_bridge = 20;

class Stopwatch {
 public:
  /// Adds the time since the last lap to `sum`.
  void lap(double& sum) {
    const auto now = Clock::now();
    sum += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

/// Times of output that the options ask for.
class Schedule {
 public:
  Schedule(const SimulateOptions& options, double from) : options_(options) { pass(from); }
  [[nodiscard]] bool every_step() const { return options_.output_step == 0.0 && options_.output_times.empty(); }
  /// The next time of output.
  [[nodiscard]] double next() const {
    const auto& listed = options_.output_times;
    const double named = listed_ < listed.size() ? listed[listed_] : HUGE_VAL;
    return options_.output_step > 0.0 ? std::min(named, on_grid()) : named;
  }
  /// Leaves out what is not after t.
  void pass(double t) {
    while (listed_ < options_.output_times.size() && options_.output_times[listed_] <= t) ++listed_;
    while (options_.output_step > 0.0 && on_grid() <= t) ++grid_;
  }

 private:
  [[nodiscard]] double on_grid() const {
    return options_.from_time + static_cast<double>(grid_) * options_.output_step;
  }
  const SimulateOptions& options_;
  std::size_t listed_ = 0;
  long grid_ = 0;
};

bool is_breakpoint(const System& system, double t) {
  return next_breakpoint(system, std::nextafter(t, -HUGE_VAL)) <= t;
}

class Run {
 public:
  /// Rows are chosen at `chosen_at`: where the run began that this one continues.
  Run(const System& system, const SimulateOptions& options, const State& start, const State& chosen_at,
      const Observer& observer)
      : system_(system),
        options_(options),
        observer_(observer),
        chosen_at_(chosen_at),
        chosen_(choose_integrator(system, options, chosen_at)),
        blocks_(system),
        dropped_(std::in_place, system, choose_partition(system, chosen_at), chosen_at, options.rel_tol),
        kkt_(std::in_place, system, dropped_->kept()),
        book_(system, kkt_->rows()),
        events_(system, options, *kkt_),
        schedule_(options, start.t),
        state_(start),
        shown_(start),
        limited_(static_cast<std::size_t>(2 * system.n() + system.nz()), 0),
        beyond_(events_.limits().info().size()) {
    for (const Limits::Info& limit : events_.limits().info()) has_soft_limits_ |= !limit.ends;
  }

  Simulation march();
  /// Continues what the checkpoint remembers, with no output at the start.
  void recall(const Checkpoint& from);
  [[nodiscard]] std::string integrator_name() const { return std::string(chosen_.integrator->name()); }

 private:
  [[nodiscard]] Checkpoint checkpoint() const;
  void state_at(double t, State& state);
  void complete(State& state);
  void project();
  [[nodiscard]] Integrator& integrator() const { return bridge_ ? *bridge_ : *chosen_.integrator; }
  std::optional<double> step();
  std::optional<double> step_or_bridge();
  void begin_bridge(const AnalysisError& why);
  void end_bridge();
  void check_branch(double reached);
  bool loses_digits();
  void choose_rows_anew(Partition partition, const std::optional<AnalysisError>& why);
  bool follow_without_end(double t);
  std::optional<Events::Hit> begin_segment();
  void march_segment();
  void settle(const Events::Hit& hit);
  void take(const Events::Hit& hit);
  void emit(double t);
  void give(const State& state) {
    observer_.output(state);
    ++outputs_;
  }
  void note_step(double step);
  void note_limits();
  [[nodiscard]] std::vector<LimitPassed> limits_passed();
  void conclude(double seconds);

  const System& system_;
  const SimulateOptions& options_;
  const Observer& observer_;
  State chosen_at_;
  ChosenIntegrator chosen_;
  std::unique_ptr<Integrator> bridge_;  // instead of the chosen one, over a position that it does not pass
  std::optional<AnalysisError> bridged_;
  double bridged_from_ = -HUGE_VAL, bridged_to_ = -HUGE_VAL;
  int bridge_steps_ = 0, bridge_length_ = shortest_bridge;
  Blocks blocks_;
  std::optional<DroppedRows> dropped_;
  std::optional<Kkt> kkt_;  // others refer to it: where rows are chosen anew it stays in its place
  EnergyBook book_;
  Events events_;
  Schedule schedule_;
  State state_, shown_;                         // reached; where an output is made
  double segment_end_ = 0.0, next_jump_ = 0.0;  // the first is the second or the end of the run
  bool running_ = true, started_ = false, resumed_ = false;
  bool anew_ = true;        // integration starts anew from state_: at the start, at a jump, at an event
  bool remembers_ = false;  // the integrator goes on from a checkpoint with the same bits
  Vector memory_;           // of the checkpoint to go on from
  IntegratorWork before_;   // of integrators with other rows
  long look_again_at_ = 1;  // imprecise accelerations
  std::optional<AnalysisError> choose_after_step_;  // rows are chosen anew at the end of this step, or this is thrown
  double last_event_ = -HUGE_VAL;
  int crowded_ = 0;  // events in a row that came too soon
  long outputs_ = 0;
  std::vector<long> limited_;
  /// The farthest beyond each limit of a law that goes on there.
  struct Beyond {
    double first_time = 0.0, farthest_time = 0.0, inside = 0.0;
  };
  std::vector<Beyond> beyond_;
  bool has_soft_limits_ = false;
  Stopwatch watch_;
  Simulation result_;
};

/// t, side, x, v, z and inputs at a time within the last step, both ends included. All that looks at a state on the way
/// comes here: outputs, events and the energy balance see the same.
void Run::state_at(double t, State& state) {
  if (&state != &state_) state.held = state_.held;
  integrator().interpolate(t, state);
}

/// Accelerations, multipliers and rates of what is shown.
void Run::complete(State& state) {
  if (remembers_) kkt_->forget_pivots();  // or a continued run would show other bits than one that came along
  kkt_->complete(state, blocks_);
  if (kkt_->uncertainty() > result_.statistics.worst_shown) {
    result_.statistics.worst_shown = kkt_->uncertainty();
    result_.statistics.worst_shown_time = state.t;
  }
}

/// Starts behind a jump, or at the start; with the conditions that the jump has made true.
std::optional<Events::Hit> Run::begin_segment() {
  next_jump_ = next_breakpoint(system_, state_.t);
  segment_end_ = std::min(options_.to_time, next_jump_);
  // Steps leave the constraints within their tolerance. A new start from there fails its error test at any step size.
  if (memory_.empty() && (started_ || resumed_)) project();
  state_.side = 1;
  apply_inputs(system_, state_);
  kkt_->forget_pivots();
  try {
    complete(state_);
  } catch (const AnalysisError& error) {  // the rows depend on each other just here
    Partition partition = choose_partition(system_, state_);
    if (partition.rows == dropped_->kept()) throw;
    choose_rows_anew(std::move(partition), error);
    complete(state_);
  }
  integrator().begin(state_, segment_end_);
  remembers_ = !integrator().memory().empty();
  if (!memory_.empty()) integrator().recall(std::exchange(memory_, {}));
  anew_ = false;
  events_.limits().require("simulate", state_);
  note_limits();
  auto hit = events_.arm(state_);
  book_.begin(state_);
  if (started_) ++result_.statistics.restarts;
  started_ = true;
  return hit;
}

void Run::recall(const Checkpoint& from) {
  resumed_ = true;
  memory_ = from.memory;
  events_.recall(from.events);
  outputs_ = from.outputs;
}

Checkpoint Run::checkpoint() const {
  const bool anew = anew_ || state_.t >= next_jump_;
  return {state_, chosen_at_, integrator_name(), anew ? Vector() : integrator().memory(), events_.memory(), outputs_};
}

/// Output at t within the last step: completed.
void Run::emit(double t) {
  if (!observer_.output) return;
  watch_.lap(result_.statistics.seconds_integrating);
  state_at(t, shown_);
  complete(shown_);
  give(shown_);
  watch_.lap(result_.statistics.seconds_outputs);
}

void Run::note_step(double step) {
  SimulationStatistics& s = result_.statistics;
  s.smallest_step = s.smallest_step == 0.0 ? step : std::min(s.smallest_step, step);
  s.largest_step = std::max(s.largest_step, step);
  if (const Index limiting = integrator().limiting(); limiting >= 0) ++limited_[static_cast<std::size_t>(limiting)];
  note_limits();
  const Violation violation = constraint_violation(system_, state_, blocks_);
  if (violation.position > s.worst_position) {
    s.worst_position = violation.position;
    s.worst_position_row = system_.constraint(violation.position_row).name;
  }
  if (violation.velocity > s.worst_velocity) {
    s.worst_velocity = violation.velocity;
    s.worst_velocity_row = system_.constraint(violation.velocity_row).name;
  }
}

/// Limits that are passed where the law goes on; what rounding leaves of one does not count.
void Run::note_limits() {
  if (!has_soft_limits_) return;
  constexpr double notable = 1e-9;  // of the nominal
  const std::vector<Limits::Info>& limits = events_.limits().info();
  const Vector& inside = events_.limits().evaluate(state_);
  for (std::size_t k = 0; k < limits.size(); ++k) {
    if (limits[k].ends || !(inside[k] < std::min(-notable * limits[k].nominal, beyond_[k].inside))) continue;
    if (beyond_[k].inside == 0.0) beyond_[k].first_time = state_.t;
    beyond_[k].farthest_time = state_.t;
    beyond_[k].inside = inside[k];
  }
}

void Run::project() { close_independent_rows(system_, state_, dropped_->partition(), blocks_); }

/// Puts the state of an event back onto the constraints, from which interpolation has taken it.
void Run::settle(const Events::Hit& hit) {
  anew_ = true;
  state_at(hit.time, state_);
  for (const std::size_t event : hit.what) {
    const auto limit = events_.limit(event);
    if (limit) throw events_.limits().error("simulate", state_, *limit);
  }
  project();
  if (const auto open = dropped_->look(state_, blocks_)) throw AnalysisError(*open);
  complete(state_);
  events_.settled(state_);
}

/// Counts what happens at t; true where such times follow each other too closely for too long.
bool Run::follow_without_end(double t) {
  const bool crowded = t - last_event_ < least_distance * (options_.to_time - options_.from_time);
  last_event_ = t;
  crowded_ = crowded ? crowded_ + 1 : 0;
  return crowded_ > most_crowded_events;
}

/// What the scene asks for at an event; outputs on both sides where it does.
void Run::take(const Events::Hit& hit) {
  anew_ = true;
  const double distance = hit.time - last_event_;
  if (follow_without_end(hit.time)) {
    const std::string& name = events_.name(hit.what.front());
    throw AnalysisError(
        "simulate",
        "at t = " + digits(hit.time, 6) + " s events follow each other without end, " + digits(distance) +
            " s apart, the last one is " + name,
        "events with time between them",
        "move the levels of events that switch back and forth further apart, or replace the switch by a steep law",
        events_.condition(hit.what.front()) != nullptr ? "/simulate/events" : "/components");
  }
  bool shown = false;
  for (const std::size_t event : hit.what) {
    result_.events.push_back({hit.time, events_.name(event)});
    const EventOptions* condition = events_.condition(event);
    if (condition == nullptr) continue;
    if (!shown && observer_.output) give(state_);
    shown = true;
    if (condition->stop) {
      result_.stopped_by = condition->name;
      running_ = false;
    }
    for (const auto& hold : condition->holds) {
      std::erase_if(state_.held, [&](const auto& held) { return held.first == hold.first; });
      state_.held.push_back(hold);
    }
  }
  if (!shown || !running_) return;
  state_.side = 1;
  apply_inputs(system_, state_);
  complete(state_);
  if (observer_.output) give(state_);
}

/// One step from state_, where all rows are closed, to the time that is returned; nothing where rows were chosen anew.
std::optional<double> Run::step() {
  if (!dropped_->any()) return integrator().step();
  std::optional<AnalysisError> why;
  double reached = 0.0;
  bool failed = true;
  try {
    reached = integrator().step();
    failed = false;
    state_at(reached, shown_);
    why = dropped_->look(shown_, blocks_);
    if (!why && !loses_digits()) return reached;
  } catch (const AnalysisError& error) {
    why = error;
  }
  Partition partition = choose_partition(system_, state_);
  const std::vector<Index>& kept = dropped_->kept();
  if (!why && (partition.rows.size() != kept.size() || partition.rows == kept)) return reached;
  if (!failed && partition.rows == kept && dropped_->along_branch(shown_, blocks_)) {
    // A long first step away from a singular position: the far end tells the rows.
    choose_after_step_ = *why;
    return reached;
  }
  if (partition.rows.size() > kept.size() && !dropped_->along_branch(failed ? state_ : shown_, blocks_))
    throw AnalysisError(*why);
  choose_rows_anew(std::move(partition), why);
  return std::nullopt;
}

/// IDA solves for all rows at once and does not pass exactly through a position where they depend on each other. One-step
/// methods do (their rows are softened, their steps controlled), and take a few steps in its place; the explicit one in
/// place of the implicit one. A fixed step is not controlled: beside such a position it may change the branch, and ends.
std::optional<double> Run::step_or_bridge() {
  using Kind = SimulateOptions::Integrator;
  const Kind kind = integrator_called(chosen_.integrator->name());
  try {
    const std::optional<double> reached = step();
    if (reached && !dropped_->any() && kind == Kind::generalized_alpha) check_branch(*reached);
    return reached;
  } catch (const AnalysisError& why) {
    if (bridge_) throw AnalysisError(*bridged_);
    const bool bridges = kind == Kind::ida || kind == Kind::implicit_one_step;
    if (!bridges || !is_nearly_singular(system_, state_)) throw;
    begin_bridge(why);
    return std::nullopt;
  }
}

/// Throws where a fixed step changes the velocity by much beside a singular position: it may have changed the branch.
void Run::check_branch(double reached) {
  constexpr double much = 0.1;
  state_at(reached, shown_);
  double change = 0.0, before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < system_.x.size(); ++i) {
    const double size = system_.x[i].size;
    change += std::pow((shown_.v[i] - state_.v[i]) / size, 2);
    before += std::pow(state_.v[i] / size, 2);
    after += std::pow(shown_.v[i] / size, 2);
  }
  if (change <= much * much * std::max(before, after) || !is_nearly_singular(system_, shown_)) return;
  throw AnalysisError(
      "simulate",
      "at t = " + digits(reached, 6) + " s a step of " + digits(reached - state_.t) + " s changes the velocity by " +
          digits(100.0 * std::sqrt(change / std::max(before, after)), 2) + " % beside a singular position",
      "steps that tell the branches apart", "set a shorter \"step\", or the integrator \"explicit\"", "/simulate/step");
}

void Run::begin_bridge(const AnalysisError& why) {
  anew_ = true;
  const bool again = state_.t <= bridged_to_ + (bridged_to_ - bridged_from_);
  bridge_length_ = again ? 2 * bridge_length_ : shortest_bridge;
  bridge_steps_ = 0;
  bridged_ = why;
  bridged_from_ = state_.t;
  using Kind = SimulateOptions::Integrator;
  SimulateOptions other = options_;
  const bool implicit = integrator_called(chosen_.integrator->name()) == Kind::implicit_one_step;
  other.integrator = implicit ? Kind::explicit_one_step : Kind::implicit_one_step;
  bridge_ = choose_integrator(system_, other, chosen_at_).integrator;
}

void Run::end_bridge() {
  anew_ = true;
  bridged_to_ = state_.t;
  before_ += bridge_->work();
  const std::string passed(bridge_->name());
  bridge_.reset();
  result_.events.push_back({bridged_from_, std::string(chosen_.integrator->name()) + " does not pass, bridged by " +
                                               passed + " to t = " + digits(state_.t, 6) + " s"});
}

/// Whether accelerations lost digits since this was asked and said: other rows may keep them.
bool Run::loses_digits() {
  const long imprecise = integrator().work().imprecise;
  if (imprecise < look_again_at_) return false;
  look_again_at_ = 2 * imprecise;
  return true;
}

/// Rows that others implied at the start need not follow from the same ones elsewhere. From state_, the last one with all
/// rows closed, the run goes on with those that are independent there; throws `why` where these are the same.
void Run::choose_rows_anew(Partition partition, const std::optional<AnalysisError>& why) {
  if (why && (partition.rows == dropped_->kept() || follow_without_end(state_.t))) throw AnalysisError(*why);
  anew_ = true;
  const std::string left_out = row_names(system_, left_out_by(partition));
  if (bridge_) end_bridge();
  before_ += integrator().work();
  look_again_at_ = 1;
  chosen_at_ = state_;
  dropped_.emplace(system_, std::move(partition), state_, options_.rel_tol);
  kkt_.emplace(system_, dropped_->kept());
  book_.take_rows(kkt_->rows());
  SimulateOptions same = options_;
  same.integrator = integrator_called(integrator().name());
  chosen_.integrator = choose_integrator(system_, same, chosen_at_).integrator;
  result_.events.push_back(
      {state_.t, "constraints chosen anew, " + (left_out.empty() ? "none is redundant" : "redundant are " + left_out)});
}

void Run::march_segment() {
  const auto interpolate = [this](double t, State& state) { state_at(t, state); };
  for (long steps = 0; state_.t < segment_end_ && running_; ++steps) {
    const double before = state_.t;
    const std::optional<double> stepped = step_or_bridge();
    if (!stepped) return;
    double reached = *stepped;
    const double step = reached - before;
    if (steps > most_steps_in_segment)
      throw stalled(system_, before, step, "the steps are too many", "", integrator().limiting());
    watch_.lap(result_.statistics.seconds_integrating);
    const auto hit = events_.find(before, reached, interpolate, shown_);
    if (hit) reached = hit->time;
    watch_.lap(result_.statistics.seconds_events);
    const double last = hit ? std::nextafter(reached, before) : reached;
    for (double t = schedule_.next(); t <= last && t < segment_end_; t = schedule_.next()) {
      emit(t);
      schedule_.pass(t);
    }
    if (hit) {
      settle(*hit);
    } else {
      state_at(reached, state_);
    }
    note_step(step);
    book_.step(state_, interpolate, shown_);
    if (reached >= segment_end_ || (!hit && schedule_.every_step())) {
      emit(reached);
      schedule_.pass(reached);
    }
    if (observer_.progress && !observer_.progress(reached, step)) {
      result_.stopped = true;
      running_ = false;
    }
    if (hit) take(*hit);
    if (const auto why = std::exchange(choose_after_step_, std::nullopt)) {
      choose_rows_anew(choose_partition(system_, state_), why);
      return;
    }
    const bool bridged = bridge_ && ++bridge_steps_ >= bridge_length_;
    if (bridged) end_bridge();
    if (observer_.checkpoint_due && observer_.checkpoint_due()) observer_.checkpoint(checkpoint());
    if (!hit && !bridged) continue;
    return;
  }
}

Simulation Run::march() {
  const auto clock = std::chrono::steady_clock::now();
  try {
    while (state_.t < options_.to_time && running_) {
      const bool first = !started_ && !resumed_;
      const bool jump = state_.side < 0 && is_breakpoint(system_, state_.t);
      const auto hit = begin_segment();
      // The start, and the far side of every jump of an input.
      if (observer_.output && (first || jump)) give(state_);
      if (hit) {
        take(*hit);  // may change inputs, and with them what is true
      } else {
        march_segment();
      }
    }
    complete(state_);
  } catch (const AnalysisError& error) {
    throw SimulationError(error, checkpoint(), limits_passed());
  }
  conclude(std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count());
  return result_;
}

std::vector<LimitPassed> Run::limits_passed() {
  std::vector<LimitPassed> list;
  for (std::size_t k = 0; k < beyond_.size(); ++k) {
    if (beyond_[k].inside == 0.0) continue;
    const Limits::Info& limit = events_.limits().info()[k];
    list.push_back({system_.component_name(limit.component), limit.name, events_.limits().text(k, beyond_[k].inside),
                    beyond_[k].first_time, beyond_[k].farthest_time,
                    limit.bound + (limit.lower ? beyond_[k].inside : -beyond_[k].inside)});
  }
  return list;
}

void Run::conclude(double seconds) {
  SimulationStatistics& s = result_.statistics;
  if (bridge_) end_bridge();
  static_cast<IntegratorWork&>(s) = before_;
  s += integrator().work();
  s.integrator = integrator_name() + (chosen_.reason.empty() ? "" : ", chosen: " + chosen_.reason);
  s.seconds = seconds;
  s.energy = book_.balance();
  const auto most = std::max_element(limited_.begin(), limited_.end());
  if (most != limited_.end() && *most > 0) {
    s.limiting = variable_name(system_, most - limited_.begin());
    s.limiting_share = static_cast<double>(*most) / static_cast<double>(std::max(s.steps, 1L));
  }
  result_.limits_passed = limits_passed();
  result_.last = state_;
  result_.checkpoint = checkpoint();
}

/// Refuses times that cannot be told apart: doubles near 1e16 s are 2 s apart, and no step fits between them.
void check_times(const System& system, const SimulateOptions& options, double t) {
  // Of the run, and of what the machine does in the meantime: steps, events and outputs divide by differences of times.
  constexpr double of_run = 1e-9, of_machine = 1e-3;
  const double latest = std::max(std::abs(t), std::abs(options.to_time)),
               spacing = std::nextafter(latest, HUGE_VAL) - latest;
  if (spacing <= of_run * (options.to_time - t) && spacing <= of_machine * system.scales.time) return;
  throw AnalysisError(
      "simulate",
      "the run goes from t = " + digits(t, 17) + " s to " + digits(options.to_time, 17) + " s, where times are " +
          digits(spacing) + " s apart in double precision",
      "times that resolve the run and the machine's own time of about " + digits(system.scales.time) + " s",
      "begin at an earlier time, or check the \"time\" of the checkpoint", "/simulate/to_time");
}

/// Refuses work that can be told before it begins and is too much.
void check_work(const SimulateOptions& options, double t) {
  const double length = options.to_time - t;
  const auto bound = [&](double step, const std::string& key, const std::string& what) {
    if (!(step > 0.0) || !(length / step > options.most_rows)) return;
    throw AnalysisError("simulate",
                        "\"" + key + "\" of " + digits(step) + " s asks for " + digits(length / step) + " " + what +
                            " in a run of " + digits(length) + " s",
                        "at most " + digits(options.most_rows) + " " + what,
                        "take a longer one, or allow more by \"most_rows\"", "/simulate/" + key);
  };
  bound(options.output_step, "output_step", "rows");
  bound(options.max_step, "max_step", "steps");
  bound(options.step, "step", "steps");
}

}  // namespace

Simulation simulate(const System& system, const SimulateOptions& options, const State& start,
                    const Observer& observer) {
  if (system.n() + system.nz() == 0)
    throw AnalysisError("simulate", "a scene without variables", "something that moves or stores", "add components");
  check_times(system, options, start.t);
  check_work(options, start.t);
  return Run(system, options, start, start, observer).march();
}

Simulation resume(const System& system, const SimulateOptions& options, const Checkpoint& from,
                  const Observer& observer) {
  check_times(system, options, from.state.t);
  check_work(options, from.state.t);
  SimulateOptions same = options;
  if (options.integrator == SimulateOptions::Integrator::automatic)
    same.integrator = integrator_called(from.integrator);
  Run run(system, same, from.state, from.chosen_at, observer);
  if (const std::string name = run.integrator_name(); name != from.integrator) {
    throw AnalysisError("simulate", "a checkpoint of \"" + from.integrator + "\", to be continued by \"" + name + "\"",
                        "the integrator that wrote it", "set \"integrator\": \"" + from.integrator + "\"", "/simulate");
  }
  run.recall(from);
  return run.march();
}

}  // namespace bramah
