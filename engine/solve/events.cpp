#include "solve/events.hpp"

#include <algorithm>
#include <cmath>

namespace bramah {
namespace {

// A function counts as zero within this part of its nominal: it must leave this band before it can have a zero again.
constexpr double band = 1e-9;
// Zeros are located to this part of the step.
constexpr double resolution = 1e-13;

}  // namespace

Events::Events(const System& system, const SimulateOptions& options, Kkt& kkt)
    : system_(system), kkt_(kkt), switches_(system), conditions_(options.events), blocks_(system) {
  if (options.meet_switches) {
    for (const Switches::Info& info : switches_.info()) nominal_.push_back(info.nominal);
  }
  switching_ = nominal_.size();
  std::vector<Measured> watched;
  for (const EventOptions& condition : conditions_) {
    watched.push_back(condition.of);
    nominal_.push_back(condition.level == 0.0 ? 1.0 : std::abs(condition.level));
    using Kind = Measured::Kind;
    const Kind kind = condition.of.kind;
    needs_forces_ |=
        kind == Kind::a || kind == Kind::zdot || kind == Kind::lambda || kind == Kind::y || kind == Kind::power;
  }
  meter_.emplace(system, std::move(watched));
  signs_.assign(nominal_.size(), 0);
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
  for (std::size_t k = 0; k < conditions_.size(); ++k) values_.push_back(watched[k] - conditions_[k].level);
  return values_;
}

int Events::sign(std::size_t event, double value) const {
  if (std::isnan(value) || std::abs(value) <= band * nominal_[event]) return 0;
  return value > 0.0 ? 1 : -1;
}

/// Whether a change of sign to `to` is an event: conditions count in their direction only.
bool Events::counts(std::size_t event, int to) const {
  if (signs_[event] == 0 || to == 0 || to == signs_[event]) return false;
  const EventOptions* watched = condition(event);
  return watched == nullptr || watched->rises == (to > 0);
}

void Events::arm(State& state) {
  if (none()) return;
  const Vector& values = evaluate(state);
  for (std::size_t k = 0; k < signs_.size(); ++k) {
    if (const int now = sign(k, values[k]); now != 0) signs_[k] = now;
  }
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
      for (const std::size_t k : first->what) signs_[k] = -signs_[k];
      return first;
    }
    for (std::size_t k = 0; k < signs_.size(); ++k) {
      if (const int now = sign(k, before_[k]); now != 0) signs_[k] = now;
    }
    low = high;
  }
  return std::nullopt;
}

}  // namespace bramah
