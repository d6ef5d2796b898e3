#include "solve/family.hpp"

#include <algorithm>
#include <cmath>

#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

constexpr double small_step = 0.05;  // nominals: no leap, whatever was predicted
constexpr double share = 0.5;        // of the predicted motion that a correction may have
constexpr int halvings = 14;         // of the way between two values, before the end is looked at closely
constexpr int most_approaches = 60;  // to a fold
constexpr double approach = 0.9;     // of the way to the fold that is expected, in one step
constexpr double certain = 1e-12;    // of the number: two expectations that agree

/// (1 - t) a + t b of what an equilibrium has.
State between(const State& a, const State& b, double t) {
  State state = b;
  const auto mix = [t](const Vector& from, const Vector& to, Vector& into) {
    for (std::size_t i = 0; i < into.size(); ++i) into[i] = (1.0 - t) * from[i] + t * to[i];
  };
  mix(a.x, b.x, state.x);
  mix(a.z, b.z, state.z);
  mix(a.lambda, b.lambda, state.lambda);
  return state;
}

}  // namespace

double Family::distance(const State& a, const State& b) const {
  double largest = 0.0;
  const auto look = [&](const Variable& variable, double p, double q) {
    const double size = std::max({variable.nominal, 0.1 * std::abs(p), 0.1 * std::abs(q)});
    largest = std::max(largest, std::abs(p - q) / size);
  };
  for (std::size_t i = 0; i < system_->x.size(); ++i) look(system_->x[i], a.x[i], b.x[i]);
  for (std::size_t i = 0; i < system_->z.size(); ++i) look(system_->z[i], a.z[i], b.z[i]);
  return largest;
}

State Family::predicted(double at) const {
  const Point& last = points_.back();
  if (points_.size() == 1) return last.state;
  const Point& before = points_[points_.size() - 2];
  return between(before.state, last.state, (at - before.at) / (last.at - before.at));
}

bool Family::goes_on(const State& predicted, const State& found) const {
  const double correction = distance(predicted, found);
  return correction <= small_step || correction <= share * distance(points_.back().state, predicted);
}

/// By steps that are halved where the family is not met again.
bool Family::advance(double to, double shortest, const Solve& solve) {
  double step = to - points_.back().at;
  while (points_.back().at != to) {
    const double from = points_.back().at;
    const double at = std::abs(step) >= std::abs(to - from) ? to : from + step;
    const State guess = predicted(at);
    bool met = false;
    try {
      State found = solve(at, &guess);
      met = goes_on(guess, found);
      if (met) points_.push_back({at, std::move(found)});
    } catch (const AnalysisError& error) {
      why_ = error.what();
    }
    step = met ? 2.0 * step : 0.5 * step;
    if (met) why_.clear();
    if (!met && std::abs(step) < shortest) return false;
  }
  return true;
}

/// Along a coordinate s that moves through the fold the number is p = p* - a (s - s*)^2 + O((s - s*)^3): the top of the
/// parabola through three points errs by the third power of their distance, and a point closer to it makes the next one better.
bool Family::find_fold(const Solve& solve) {
  if (points_.size() < 3) return false;
  const auto count = [&] { return points_.size(); };
  // The variable that moves most.
  const State &one = points_[count() - 2].state, &other = points_.back().state;
  const Variable* variable = nullptr;
  double largest = 0.0;
  const auto look = [&](const Variable& of, double p, double q) {
    const double moved = std::abs(p - q) / of.nominal;
    if (moved > largest) {
      largest = moved;
      variable = &of;
    }
  };
  for (std::size_t i = 0; i < system_->x.size(); ++i) look(system_->x[i], one.x[i], other.x[i]);
  for (std::size_t i = 0; i < system_->z.size(); ++i) look(system_->z[i], one.z[i], other.z[i]);
  if (variable == nullptr) return false;
  const bool coordinate = variable >= system_->x.data() && variable < system_->x.data() + system_->x.size();
  const auto place = static_cast<std::size_t>(variable - (coordinate ? system_->x.data() : system_->z.data()));
  const auto s_of = [&](const State& state) { return coordinate ? state.x[place] : state.z[place]; };

  double expected = NAN;
  for (int k = 0; k < most_approaches; ++k) {
    const Point &c = points_[count() - 1], &b = points_[count() - 2], &a = points_[count() - 3];
    const double sa = s_of(a.state), sb = s_of(b.state), sc = s_of(c.state);
    const double first = (b.at - a.at) / (sb - sa), second = (c.at - b.at) / (sc - sb);
    const double bend = (second - first) / (sc - sa);  // half the second derivative
    const double slope = second + bend * (sc - sb);    // at c
    const double top = sc - 0.5 * slope / bend, at = c.at - 0.25 * slope * slope / bend;
    const bool ahead = (at - c.at) * (c.at - b.at) >= 0.0 && (top - sc) * (sc - sb) >= 0.0;
    if (!std::isfinite(at) || !ahead) break;
    const double size = std::max(std::abs(at), std::abs(at - points_.front().at));
    if (std::abs(at - expected) <= certain * size || std::abs(at - c.at) <= certain * size) {
      fold_ = Fold{at, variable->name, top, variable->unit};
      return true;
    }
    expected = at;
    double to = c.at + approach * (at - c.at);
    const double left = std::sqrt((1.0 - approach) * (at - c.at) / (-bend)) * (top > sc ? 1.0 : -1.0);
    bool met = false;
    for (int halving = 0; !met && halving < halvings && to != c.at; ++halving) {
      // Where the parabola puts s at this value; all else follows s.
      const double s = halving == 0 ? top - left : s_of(c.state);
      const State guess = between(b.state, c.state, (s - sb) / (sc - sb));
      try {
        State found = solve(to, &guess);
        met = distance(found, c.state) <= 2.0 * std::max(distance(guess, c.state), distance(b.state, c.state));
        if (met) points_.push_back({to, std::move(found)});
      } catch (const AnalysisError& error) {
        why_ = error.what();
      }
      if (!met) to = c.at + 0.5 * (to - c.at);
    }
    if (!met) break;
  }
  return false;
}

void Family::follow(const System& system, const std::vector<double>& values, const Solve& solve, const State* guess) {
  system_ = &system;
  for (const double value : values) {
    if (points_.empty()) {
      try {
        points_.push_back({value, solve(value, guess)});
      } catch (const AnalysisError&) {
        if (value == values.back()) throw;
      }
      continue;
    }
    // Where a value has no answer, a step across it may show that the family goes on.
    const double step = std::abs(value - points_.back().at);
    if (advance(value, is_lost() ? step : std::ldexp(step, -halvings), solve)) continue;
    if (why_.empty()) why_ = "what Newton's method finds there is another one";
    if (find_fold(solve)) return;
  }
}

std::optional<State> Family::guess(double at) const {
  if (points_.empty()) return std::nullopt;
  const double way = points_.back().at >= points_.front().at ? 1.0 : -1.0;
  const double end = fold_ ? fold_->at : points_.back().at;
  if (is_lost() && way * at > way * end) {
    throw AnalysisError("equilibrium",
                        fold_ ? "the equilibria that are followed turn back at " + digits(fold_->at, 10) + ", where " +
                                    fold_->variable + " = " + digits(fold_->value, 6) + " " + fold_->unit
                              : "the equilibria that are followed end at " + digits(end, 10) + ": " + why_,
                        "values before it", "begin the sweep beyond it to see what else there is", "");
  }
  const auto next =
      std::find_if(points_.begin(), points_.end(), [&](const Point& p) { return way * p.at >= way * at; });
  if (next == points_.begin()) return next->state;
  if (next == points_.end()) return points_.back().state;
  const auto before = next - 1;
  return between(before->state, next->state, (at - before->at) / (next->at - before->at));
}

}  // namespace bramah
