#include "solve/events.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace bramah {
namespace {

// A function counts as zero within its band, and must leave the band before it can have a zero again. The band of a
// switching function is this part of its nominal, that of a condition this part of the range that its quantity had so far,
constexpr double band_of_range = 1e-9;
// and no less than what the values are rounded to, in the machine at hand: projections and KKT solves lose some digits.
constexpr double rounding = 1e-12;
// What a quantity of the machine shows by rounding where it and its level are zero, as part of its size.
constexpr double least = 1e-15;
// Zeros are located to this part of the step.
constexpr double resolution = 1e-13;

/// Size that a quantity has in this machine, in its unit; 0 where it is not computed from others, or nobody knows.
double size_of(const System& system, const Measured& of) {
  const Scales& scales = system.scales;
  const double time = scales.time;
  const auto i = static_cast<std::size_t>(of.index);
  switch (of.kind) {
    case Measured::Kind::x: return system.x[i].nominal;
    case Measured::Kind::v: return system.x[i].nominal / time;
    case Measured::Kind::a: return system.x[i].nominal / (time * time);
    case Measured::Kind::z: return system.z[i].nominal;
    case Measured::Kind::zdot: return system.z[i].nominal / time;
    case Measured::Kind::lambda: return system.multiplier_nominal(of.index);
    case Measured::Kind::y: return system.outputs[i].nominal;
    case Measured::Kind::input: return 0.0;
    case Measured::Kind::energy: return scales.energy();
    case Measured::Kind::power: return scales.energy() / time;
  }
  return 0.0;
}

/// Whether `other` can happen again once `event` has: the quantity is then beyond its level on the side that it waits on.
bool rearms(const EventOptions& event, const EventOptions& other) {
  if (event.of.kind != other.of.kind || event.of.index != other.of.index || event.rises == other.rises) return false;
  return event.rises ? other.level <= event.level : other.level >= event.level;
}

}  // namespace

Events::Events(const System& system, const SimulateOptions& options, Kkt& kkt)
    : system_(system), kkt_(kkt), switches_(system), limits_(system), conditions_(options.events), blocks_(system) {
  if (options.meet_switches) {
    for (const Switches::Info& info : switches_.info()) watches_.emplace_back().size = info.nominal;
  }
  switching_ = watches_.size();
  for (std::size_t k = 0; k < limits_.info().size(); ++k) {
    if (!limits_.info()[k].ends) continue;
    watches_.emplace_back().size = limits_.info()[k].nominal;
    ending_.push_back(k);
  }
  conditional_ = watches_.size();
  std::vector<Measured> watched;
  for (const EventOptions& condition : conditions_) {
    watched.push_back(condition.of);
    Watch& watch = watches_.emplace_back();
    watch.size = size_of(system, condition.of);
    for (std::size_t k = 0; k < conditions_.size(); ++k) {
      if (rearms(condition, conditions_[k])) watch.rearms.push_back(conditional_ + k);
    }
    using Kind = Measured::Kind;
    const Kind kind = condition.of.kind;
    needs_forces_ |=
        kind == Kind::a || kind == Kind::zdot || kind == Kind::lambda || kind == Kind::y || kind == Kind::power;
  }
  meter_.emplace(system, std::move(watched));
}

std::string Events::name(std::size_t event) const {
  if (event >= conditional_) return conditions_[event - conditional_].name;
  if (const auto k = limit(event))
    return system_.component_name(limits_.info()[*k].component) + "." + limits_.info()[*k].name;
  const Switches::Info& info = switches_.info()[event];
  return system_.component_name(info.component) + "." + info.name;
}

const EventOptions* Events::condition(std::size_t event) const {
  return event < conditional_ ? nullptr : &conditions_[event - conditional_];
}

std::optional<std::size_t> Events::limit(std::size_t event) const {
  if (event < switching_ || event >= conditional_) return std::nullopt;
  return ending_[event - switching_];
}

const Vector& Events::evaluate(State& state) {
  values_.clear();
  if (switching_ > 0) values_ = switches_.evaluate(state);
  if (!ending_.empty()) {
    const Vector& inside = limits_.evaluate(state);
    for (const std::size_t k : ending_) values_.push_back(inside[k]);
  }
  if (conditions_.empty()) return values_;
  if (needs_forces_) {
    kkt_.forget_pivots();  // the time of an event is the same in a continued run
    kkt_.complete(state, blocks_);
  }
  const Vector& watched = meter_->read(state);
  for (std::size_t k = 0; k < conditions_.size(); ++k) values_.push_back(watched[k] - conditions_[k].level);
  return values_;
}

double Events::band(std::size_t event, double value) const {
  const Watch& watch = watches_[event];
  if (event < conditional_) return band_of_range * watch.size;
  const double level = conditions_[event - conditional_].level;
  const double rounded = rounding * std::max(std::abs(level), std::abs(value + level));
  return std::max({rounded, band_of_range * (watch.high - watch.low), least * watch.size});
}

/// Of the zero; 0 within its band.
int Events::side(std::size_t event, double value) const {
  if (std::isnan(value) || std::abs(value) <= band(event, value)) return 0;
  const Watch& watch = watches_[event];
  const int now = value > 0.0 ? 1 : -1;
  return watch.fresh && now == -watch.side && std::abs(value) <= watch.slack ? 0 : now;
}

/// Whether a change to the side `to` is an event: conditions count in their direction only, and also where they leave the
/// level on which they started; so do limits, where they are passed.
bool Events::counts(std::size_t event, int to) const {
  if (limit(event)) return to < 0 && watches_[event].side >= 0;
  const EventOptions* watched = condition(event);
  const int from = watches_[event].side;
  if (to == 0 || to == from || (from == 0 && watched == nullptr)) return false;
  return watched == nullptr || watched->rises == (to > 0);
}

void Events::note(std::size_t event, double value, int now) {
  Watch& watch = watches_[event];
  if (std::isfinite(value)) {
    watch.low = std::min(watch.low, value);
    watch.high = std::max(watch.high, value);
  }
  watch.armed = true;
  if (now == 0) return;
  watch.side = now;
  watch.fresh = false;
}

/// The event has been located just beyond its zero. Conditions on the same quantity that wait on that side can happen
/// again, however near their levels are.
void Events::happen(std::size_t event, int to) {
  const auto reach = [](Watch& watch, int now) {
    watch.side = now;
    watch.fresh = true;
    watch.slack = 0.0;
  };
  reach(watches_[event], to);
  for (const std::size_t other : watches_[event].rearms) {
    if (watches_[other].side != to) reach(watches_[other], to);
  }
}

std::optional<Events::Hit> Events::arm(State& state) {
  if (none()) return std::nullopt;
  const Vector& values = evaluate(state);
  Hit hit{state.t, {}};
  for (std::size_t k = 0; k < watches_.size(); ++k) {
    const int now = side(k, values[k]);
    if (watches_[k].armed && condition(k) != nullptr && counts(k, now)) hit.what.push_back(k);
    note(k, values[k], now);
  }
  if (hit.what.empty()) return std::nullopt;
  return hit;
}

void Events::settled(State& state) {
  const Vector& values = evaluate(state);
  for (std::size_t k = 0; k < watches_.size(); ++k) {
    Watch& watch = watches_[k];
    if (watch.fresh && values[k] * watch.side < 0.0) watch.slack = 2.0 * std::abs(values[k]);
  }
}

std::vector<EventMemory> Events::memory() const {
  std::vector<EventMemory> memory;
  for (std::size_t k = 0; k < watches_.size(); ++k) {
    const Watch& watch = watches_[k];
    if (!watch.armed) continue;
    const EventOptions* watched = condition(k);
    memory.push_back({name(k), watched == nullptr ? "" : watched->of.name, watched == nullptr ? 0.0 : watched->level,
                      watch.side, watch.fresh, watch.slack, watch.low, watch.high});
  }
  return memory;
}

void Events::recall(std::span<const EventMemory> memory) {
  std::unordered_map<std::string, const EventMemory*> known;
  for (const EventMemory& one : memory) known.emplace(one.name, &one);
  for (std::size_t k = 0; k < watches_.size(); ++k) {
    const auto found = known.find(name(k));
    if (found == known.end()) continue;
    const EventMemory& one = *found->second;
    const EventOptions* watched = condition(k);
    if (watched != nullptr && (one.of != watched->of.name || one.level != watched->level)) continue;
    Watch& watch = watches_[k];
    watch.low = one.low;
    watch.high = one.high;
    watch.side = one.side;
    watch.fresh = one.fresh;
    watch.slack = one.slack;
    watch.armed = true;
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
    ends_ = evaluate(state);
    std::optional<Hit> first;
    for (std::size_t k = 0; k < watches_.size(); ++k) {
      if (!counts(k, side(k, ends_[k]))) continue;
      const double time = locate(k, low, high, interpolate, state);
      if (!first || time < first->time) first = Hit{time, {}};
      if (time == first->time) first->what.push_back(k);
    }
    if (first) {
      for (const std::size_t k : first->what) happen(k, ends_[k] > 0.0 ? 1 : -1);
      return first;
    }
    for (std::size_t k = 0; k < watches_.size(); ++k) note(k, ends_[k], side(k, ends_[k]));
    low = high;
  }
  return std::nullopt;
}

}  // namespace bramah
