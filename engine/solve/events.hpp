// Events: zeros of the components' switching functions and conditions of the scene, located within a step.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "solve/kkt.hpp"
#include "system/blocks.hpp"
#include "system/measure.hpp"
#include "system/options.hpp"
#include "system/switches.hpp"

namespace bramah {

class Events {
 public:
  /// Sets a state at a time within the last step.
  using Interpolate = std::function<void(double, State&)>;
  struct Hit {
    double time = 0.0;              // just beyond the zero, where the new side holds
    std::vector<std::size_t> what;  // in the order of `name`
  };

  Events(const System& system, const SimulateOptions& options, Kkt& kkt);

  [[nodiscard]] bool none() const { return signs_.empty(); }
  /// "relief.crack" of a component, or the name that the scene gives.
  [[nodiscard]] std::string name(std::size_t event) const;
  /// The scene's condition, null for a switching function.
  [[nodiscard]] const EventOptions* condition(std::size_t event) const;

  /// Notes on which side of every event `state` lies, where integration starts; with the conditions that a jump at this
  /// time has made true, an input's or that of another event. Not at the first start: what is true there has not come true.
  std::optional<Hit> arm(State& state);
  /// The first event after `before` and not after `reached`, both within the last step; `state` is workspace. Zeros are
  /// looked for between `before`, the middle of the step and its end.
  std::optional<Hit> find(double before, double reached, const Interpolate& interpolate, State& state);

 private:
  const Vector& evaluate(State& state);
  [[nodiscard]] int sign(std::size_t event, double value) const;
  [[nodiscard]] bool counts(std::size_t event, int to) const;
  void note(std::size_t event, int now);
  double locate(std::size_t event, double low, double high, const Interpolate& interpolate, State& state);

  const System& system_;
  Kkt& kkt_;
  Switches switches_;
  std::size_t switching_;  // how many of the events are switching functions
  std::vector<EventOptions> conditions_;
  bool needs_forces_ = false;   // a condition watches what only the KKT solve gives
  std::optional<Meter> meter_;  // of what conditions watch
  Blocks blocks_;
  Vector values_, before_;
  Vector least_, size_;      // of each event: what is rounding; its level, or the largest magnitude that it had
  std::vector<int> signs_;   // side of each event; 0: on its zero since the start
  std::vector<bool> fresh_;  // has just happened: until the new side is reached, the old one does not count
  bool armed_ = false;
};

}  // namespace bramah
