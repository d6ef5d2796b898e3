#include "solve/events.hpp"

#include <algorithm>
#include <cmath>

namespace bramah {
namespace {

// A function counts as zero within this part of its size: it must leave this band before it can have a zero again. The
// size of a switching function is its nominal, that of a condition its level; at level 0 the largest magnitude that the
// watched quantity had.
constexpr double band = 1e-9;
// What a machine of nominal size shows by rounding alone.
constexpr double rounding = 1e-15;
// A method that meets the state of an event anew may come back to the old side by this part of the size.
constexpr double settled = 1e-6;
// Zeros are located to this part of the step.
constexpr double resolution = 1e-13;

}  // namespace

Events::Events(const System& system, const SimulateOptions& options, Kkt& kkt)
    : system_(system), kkt_(kkt), switches_(system), conditions_(options.events), blocks_(system) {
  if (options.meet_switches) {
    for (const Switches::Info& info : switches_.info()) size_.push_back(info.nominal);
  }
  switching_ = size_.size();
  least_.assign(switching_, 0.0);
  std::vector<Measured> watched;
  for (const EventOptions& condition : conditions_) {
    watched.push_back(condition.of);
    size_.push_back(std::abs(condition.level));
    least_.push_back(rounding);
    using Kind = Measured::Kind;
    const Kind kind = condition.of.kind;
    needs_forces_ |=
        kind == Kind::a || kind == Kind::zdot || kind == Kind::lambda || kind == Kind::y || kind == Kind::power;
  }
  meter_.emplace(system, std::move(watched));
  signs_.assign(size_.size(), 0);
  fresh_.assign(size_.size(), false);
}

std::string Events::name(std::size_t event) const {
  if (event >= switching_) return conditions_[event - switching_].name;
  const Switches::Info& info = switches_.info()[event];
  return system_.component_name(info.component) + "." + info.name;
}

const EventOptions* Events::condition(std::size_t event) const {
  return event < switching_ ? nullptr : &conditions_[event - switching_];
}

const Vector& Events::evaluate(State& state) {
  values_.clear();
  if (switching_ > 0) values_ = switches_.evaluate(state);
  if (conditions_.empty()) return values_;
  if (needs_forces_) {
    kkt_.forget_pivots();  // the time of an event is the same in a continued run
    kkt_.complete(state, blocks_);
  }
  const Vector& watched = meter_->read(state);
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    values_.push_back(watched[k] - conditions_[k].level);
    if (conditions_[k].level == 0.0 && std::isfinite(watched[k]))
      size_[switching_ + k] = std::max(size_[switching_ + k], std::abs(watched[k]));
  }
  return values_;
}

int Events::sign(std::size_t event, double value) const {
  if (std::isnan(value) || std::abs(value) <= std::max(band * size_[event], least_[event])) return 0;
  const int now = value > 0.0 ? 1 : -1;
  return fresh_[event] && now == -signs_[event] && std::abs(value) <= settled * size_[event] ? 0 : now;
}

/// Whether a change of sign to `to` is an event: conditions count in their direction only, and also where they leave the
/// level on which they started.
bool Events::counts(std::size_t event, int to) const {
  const EventOptions* watched = condition(event);
  if (to == 0 || to == signs_[event] || (signs_[event] == 0 && watched == nullptr)) return false;
  return watched == nullptr || watched->rises == (to > 0);
}

void Events::note(std::size_t event, int now) {
  if (now == 0) return;
  signs_[event] = now;
  fresh_[event] = false;
}

std::optional<Events::Hit> Events::arm(State& state) {
  if (none()) return std::nullopt;
  const Vector& values = evaluate(state);
  Hit hit{state.t, {}};
  for (std::size_t k = 0; k < signs_.size(); ++k) {
    const int now = sign(k, values[k]);
    if (armed_ && condition(k) != nullptr && signs_[k] != 0 && counts(k, now)) hit.what.push_back(k);
    note(k, now);
  }
  armed_ = true;
  if (hit.what.empty()) return std::nullopt;
  return hit;
}

/// Regula falsi of Illinois on [low, high], where the sign changes; the end beyond the zero.
double Events::locate(std::size_t event, double low, double high, const Interpolate& interpolate, State& state) {
  const auto value = [&](double t) {
    interpolate(t, state);
    return evaluate(state)[event];
  };
  const double width = std::max(resolution * (high - low), 4e-16 * std::abs(high));
  double f_low = value(low), f_high = value(high);
  int last = 0;
  for (int k = 0; k < 100 && high - low > width; ++k) {
    double t = high - f_high * (high - low) / (f_high - f_low);
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    t = std::clamp(t, low + 0.5 * width, high - 0.5 * width);
    const double f = value(t);
    if ((f > 0.0) == (f_high > 0.0)) {
      high = t;
      f_high = f;
      if (last == 1) f_low *= 0.5;
      last = 1;
    } else {
      low = t;
      f_low = f;
      if (last == -1) f_high *= 0.5;
      last = -1;
    }
  }
  return high;
}

std::optional<Events::Hit> Events::find(double before, double reached, const Interpolate& interpolate, State& state) {
  if (none()) return std::nullopt;
  for (double low = before; const double high : {0.5 * (before + reached), reached}) {
    interpolate(high, state);
    before_ = evaluate(state);
    std::optional<Hit> first;
    for (std::size_t k = 0; k < signs_.size(); ++k) {
      const int now = sign(k, before_[k]);
      if (!counts(k, now)) continue;
      const double time = locate(k, low, high, interpolate, state);
      if (!first || time < first->time) first = Hit{time, {}};
      if (time == first->time) first->what.push_back(k);
    }
    if (first) {
      for (const std::size_t k : first->what) {
        signs_[k] = before_[k] > 0.0 ? 1 : -1;
        fresh_[k] = true;
      }
      return first;
    }
    for (std::size_t k = 0; k < signs_.size(); ++k) note(k, sign(k, before_[k]));
    low = high;
  }
  return std::nullopt;
}

}  // namespace bramah
