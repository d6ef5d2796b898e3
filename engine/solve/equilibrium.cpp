#include "solve/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "solve/assemble.hpp"
#include "solve/settling.hpp"
#include "system/limits.hpp"
#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

constexpr double kept = 1e-6;     // nominals: a start that balances may round so far
constexpr double notable = 1e-9;  // nominals: what counts as moved

std::string name_held(const System& system, const EquilibriumOptions& options) {
  std::string held;
  for (const Index i : options.hold_x) held += (held.empty() ? "" : ", ") + system.x[static_cast<std::size_t>(i)].name;
  for (const Index i : options.hold_z) held += (held.empty() ? "" : ", ") + system.z[static_cast<std::size_t>(i)].name;
  return held;
}

/// Constraints that move by themselves: no state at rest satisfies their rates and accelerations.
void refuse_drives(const System& system, const State& state) {
  constexpr double at_rest = 1e-12;  // of the row's size in the machine's time
  Blocks blocks(system);
  if (system.m() + system.l() == 0 || !blocks.evaluate(system, state, Request{}.rows("rs")).ok()) return;
  const double time = system.scales.time;
  for (Index i = 0; i < system.m() + system.l(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    const Row& constraint = system.constraint(i);
    // Nonholonomic rows are rates already: r is the row itself and s its derivative.
    const double per_time = i < system.m() ? time : 1.0;
    const bool moves = std::abs(blocks.r[row]) * per_time > at_rest * constraint.nominal;
    const bool starts = std::abs(blocks.s[row]) * per_time * time > at_rest * constraint.nominal;
    if (!moves && !starts) continue;
    const std::string per = i < system.m() ? (moves ? "/s" : "/s^2") : (moves ? "" : "/s");
    const std::string& name = system.component_name(constraint.component);
    throw AnalysisError(
        "equilibrium",
        "the constraint " + constraint.name + " moves by itself: at t = " + digits(state.t) + " s it asks for " +
            (moves ? "a velocity of " : "an acceleration of ") +
            digits(std::abs(moves ? blocks.r[row] : blocks.s[row])) + " " + constraint.unit + per +
            ", so the machine cannot rest",
        "constraints that stand still",
        "stop what " + name +
            " drives for this analysis, or begin at the start state: \"linearize\": {\"at\": \"start\"}, \"simulate\": "
            "{\"from\": \"start\"}",
        pointer("/components", name));
  }
}

/// The search, from assembled start values.
class Search {
 public:
  Search(const System& system, const EquilibriumOptions& options, State start)
      : system_(system), options_(options), start_(std::move(start)) {}

  Equilibrium run() {
    const bool nearest = options_.stability == EquilibriumOptions::Stability::nearest;
    if (newton(start_, kept) && is_kept()) return finish();
    if (!Settling(system_, options_, start_).find_multipliers(start_)) refuse_start();
    if (newton(start_) && (nearest || is_kept() || is_minimum())) return finish();
    const std::optional<State> first = found_ ? std::optional(state_) : std::nullopt;
    settle();
    if (!found_ && (!options_.hold_x.empty() || !options_.hold_z.empty())) settle_then_hold();
    if (found_) {
      result_.passed_unstable = first.has_value();
      return finish();
    }
    if (first && newton(*first)) return finish();
    refuse();
  }

  /// Newton's method alone.
  Equilibrium run_nearby() {
    if (newton(start_)) return finish();
    refuse();
  }

 private:
  /// To an equilibrium found_, at state_.
  bool newton(const State& from, double largest_step = HUGE_VAL) {
    state_ = from;
    if (!balance_) balance_.emplace(system_, options_, state_);
    found_ = balance_->run(largest_step);
    result_.iterations += balance_->iterations();
    return found_;
  }
  [[nodiscard]] bool is_kept() const {
    for (std::size_t i = 0; i < system_.x.size(); ++i) {
      if (std::abs(state_.x[i] - start_.x[i]) > kept * system_.x[i].nominal) return false;
    }
    return true;
  }
  [[nodiscard]] bool is_minimum() const {
    Curvature curvature(system_, options_);
    return !curvature.evaluate(state_) || curvature.minimum();
  }

  void settle() {
    found_ = false;
    Settling settling(system_, options_, start_);
    State state = start_;
    way_ = settling.run(state);
    result_.steps += way_.steps;
    if (way_.end == Settling::End::rest && !newton(state)) settled_ = std::move(state);
  }

  /// What is held may be for the others to balance, and no way leads there: the machine settles without, then what is held
  /// goes to its value step by step.
  void settle_then_hold() {
    EquilibriumOptions all_free = options_;
    all_free.hold_x.clear();
    all_free.hold_z.clear();
    State here = start_;
    const Settling::Result way = Settling(system_, all_free, start_).run(here);
    result_.steps += way.steps;
    if (way.end != Settling::End::rest) return;
    const State from = here;
    constexpr double shortest = 1e-3;
    double done = 0.0, share = 1.0;
    while (done < 1.0 && share > shortest) {
      const double next = std::min(1.0, done + share);
      State guess = here;
      const auto between = [&](double a, double b) { return next == 1.0 ? b : a + next * (b - a); };
      for (const Index i : options_.hold_x) {
        const auto k = static_cast<std::size_t>(i);
        guess.x[k] = between(from.x[k], start_.x[k]);
      }
      for (const Index i : options_.hold_z) {
        const auto k = static_cast<std::size_t>(i);
        guess.z[k] = between(from.z[k], start_.z[k]);
      }
      if (newton(guess)) {
        here = state_;
        done = next;
        share *= 2.0;
      } else {
        share *= 0.25;
      }
    }
    found_ = found_ && done == 1.0;
  }

  /// At state_, where the last Newton iteration ended.
  Equilibrium finish() {
    State& state = state_;
    result_.residual = balance_->size();
    result_.free_directions = balance_->free_directions();
    if (balance_->multipliers_undetermined()) {
      const Partition partition = choose_partition(system_, state);
      take_minimum_norm(system_, partition, state.lambda);
      result_.redundancy = describe_redundancy(system_, state, partition);
    }
    std::fill(state.a.begin(), state.a.end(), 0.0);
    std::fill(state.zdot.begin(), state.zdot.end(), 0.0);
    Limits limits(system_);
    limits.require("equilibrium", state);
    for (auto& [k, text] : limits.passed(state)) result_.beyond_limits.push_back(std::move(text));
    note_moves(state);
    result_.state = std::move(state);
    return std::move(result_);
  }

  void note_moves(const State& state) {
    const auto add = [&](const Variable& variable, double from, double to, bool coordinate) {
      const double far = std::abs(to - from) / variable.size;
      if (far <= notable) return;
      result_.moved.push_back({variable.name, variable.unit, from, to, far, coordinate, variable.start_given});
    };
    for (std::size_t i = 0; i < system_.x.size(); ++i) add(system_.x[i], start_.x[i], state.x[i], true);
    for (std::size_t i = 0; i < system_.z.size(); ++i) add(system_.z[i], start_.z[i], state.z[i], false);
    std::stable_sort(result_.moved.begin(), result_.moved.end(),
                     [](const Moved& a, const Moved& b) { return a.nominals > b.nominals; });
  }

  [[noreturn]] void refuse_start() {
    State state = start_;
    Balance balance(system_, options_, state);
    balance.evaluate(true);
    throw AnalysisError("equilibrium", balance.failure(), "start values at which every component can be evaluated",
                        "move the start values", balance.place_of_failure());
  }

  [[noreturn]] void refuse() {
    // What is held keeps the machine at rest with its balances open: the worst of these is the one to name.
    State state = settled_ ? *settled_ : start_;
    Balance balance(system_, options_, state);
    const bool runs_away = way_.end == Settling::End::runs_away;
    if (!runs_away && !settled_) balance.run();
    if (!balance.evaluate(true)) refuse_start();
    if (runs_away) refuse_to_run_away(balance, way_.away);
    balance.solve();
    Index row = 0;
    static_cast<void>(balance.balanced(row));
    const std::string held = name_held(system_, options_);
    throw AnalysisError(
        "equilibrium",
        balance.equation_name(row) + " stays at " + balance.equation_residual(row) + " after " +
            std::to_string(result_.iterations) + " iterations" +
            (result_.steps > 0 ? " of Newton's method and " + std::to_string(result_.steps) + " steps of settling"
                               : ""),
        held.empty() ? std::string("start values near an equilibrium")
                     : "an equilibrium at the start values of what is held: " + held,
        std::string(held.empty() ? "" : "hold fewer variables, ") +
            "move the start values, or check that something balances this row",
        pointer("/components", balance.equation_component(row)));
  }

  [[noreturn]] void refuse_to_run_away(const Balance& balance, Index row) const {
    const bool coordinate = row < system_.n();
    const Variable& away =
        coordinate ? system_.x[static_cast<std::size_t>(row)] : system_.z[static_cast<std::size_t>(row - system_.n())];
    throw AnalysisError(
        "equilibrium",
        balance.equation_name(row) + " stays at " + balance.equation_residual(row) + ", and nothing resists a " +
            (coordinate ? "motion" : "change") + " of " + away.name,
        coordinate ? "something that balances this force" : "something that balances this flow",
        coordinate ? "connect a joint, a spring or a support; holding " + away.name + " would not balance the force"
                   : "connect a way out, or a source; holding " + away.name + " would not balance the flow",
        pointer("/components", balance.equation_component(row)));
  }

  const System& system_;
  const EquilibriumOptions& options_;
  State start_;
  State state_;
  std::optional<Balance> balance_;  // at state_
  bool found_ = false;
  std::optional<State> settled_;  // at rest as long as something is held that does not balance
  Settling::Result way_;
  Equilibrium result_;
};

State at_rest(const System& system, const EquilibriumOptions& options, State state) {
  std::fill(state.v.begin(), state.v.end(), 0.0);
  std::fill(state.a.begin(), state.a.end(), 0.0);
  std::fill(state.zdot.begin(), state.zdot.end(), 0.0);
  assemble_start_positions(system, state, options.hold_x);
  refuse_drives(system, state);
  return state;
}

}  // namespace

Equilibrium find_equilibrium(const System& system, const EquilibriumOptions& options, double t) {
  return Search(system, options, at_rest(system, options, initial_state(system, t))).run();
}

Equilibrium continue_equilibrium(const System& system, const EquilibriumOptions& options, const State& guess) {
  State state = initial_state(system, guess.t);
  std::copy_n(guess.x.begin(), system.n(), state.x.begin());
  std::copy_n(guess.z.begin(), system.nz(), state.z.begin());
  state.lambda = guess.lambda;
  for (const Index i : options.hold_x)
    state.x[static_cast<std::size_t>(i)] = system.x[static_cast<std::size_t>(i)].start;
  for (const Index i : options.hold_z)
    state.z[static_cast<std::size_t>(i)] = system.z[static_cast<std::size_t>(i)].start;
  return Search(system, options, at_rest(system, options, std::move(state))).run_nearby();
}

void move_equilibrium(const System& system, const EquilibriumOptions& options, const State& state, Direction& along) {
  State at = state;
  Balance balance(system, options, at);
  // Of the start values only those of held variables matter.
  const State before = along.state;
  along.add_start(system);
  const State starts = std::exchange(along.state, before);
  for (const Index i : options.hold_x)
    along.state.x[static_cast<std::size_t>(i)] = starts.x[static_cast<std::size_t>(i)];
  for (const Index i : options.hold_z)
    along.state.z[static_cast<std::size_t>(i)] = starts.z[static_cast<std::size_t>(i)];
  if (balance.evaluate(true) && balance.follow(along)) return;
  throw AnalysisError("sensitivity", balance.failure().empty() ? "no equilibrium beside this one" : balance.failure(),
                      "an equilibrium that moves with the number",
                      "hold other variables: what is held may not balance");
}

}  // namespace bramah
