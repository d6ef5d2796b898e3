// Events: zeros of the components' switching functions, limits of their laws and conditions of the scene, located within a
// step.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solve/event_memory.hpp"
#include "solve/kkt.hpp"
#include "system/blocks.hpp"
#include "system/limits.hpp"
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

  [[nodiscard]] bool none() const { return watches_.empty(); }
  /// "relief.crack" of a component, or the name that the scene gives.
  [[nodiscard]] std::string name(std::size_t event) const;
  /// The scene's condition, null for a switching function or a limit.
  [[nodiscard]] const EventOptions* condition(std::size_t event) const;
  /// Which of `limits` the event is; none for others.
  [[nodiscard]] std::optional<std::size_t> limit(std::size_t event) const;
  [[nodiscard]] Limits& limits() { return limits_; }

  /// Notes on which side of every event `state` lies, where integration starts; with the conditions that a jump at this
  /// time has made true, an input's or that of another event. Not at the first start: what is true there has not come true.
  std::optional<Hit> arm(State& state);
  /// `state` is that of the last hit, put back onto the constraints, before what the scene asks for there: as far as this
  /// has taken it back over the zero, it is not a return.
  void settled(State& state);
  /// The first event after `before` and not after `reached`, both within the last step; `state` is workspace. Zeros are
  /// looked for between `before`, the middle of the step and its end.
  std::optional<Hit> find(double before, double reached, const Interpolate& interpolate, State& state);

  /// What the next steps depend on beside the state; `recall` before the first `arm`. Events of other names, watched
  /// quantities or levels than those remembered start anew.
  [[nodiscard]] std::vector<EventMemory> memory() const;
  void recall(std::span<const EventMemory> memory);

 private:
  /// One event on the way.
  struct Watch {
    double size = 0.0;  // nominal of a switching function; of a condition what the machine gives the quantity
    double low = 0.0, high = 0.0;  // range of the values so far, zero included
    int side = 0;                  // 0: on its zero since the start
    bool armed = false;
    bool fresh = false;  // has just happened: until the new side is reached, the old one does not count within `slack`
    double slack = 0.0;
    std::vector<std::size_t> rearms;  // conditions on the same quantity that can happen again after this one has
  };
  const Vector& evaluate(State& state);
  [[nodiscard]] double band(std::size_t event, double value) const;
  [[nodiscard]] int side(std::size_t event, double value) const;
  [[nodiscard]] bool counts(std::size_t event, int to) const;
  void note(std::size_t event, double value, int now);
  void happen(std::size_t event, int to);
  double locate(std::size_t event, double low, double high, const Interpolate& interpolate, State& state);

  const System& system_;
  Kkt& kkt_;
  Switches switches_;
  Limits limits_;
  std::vector<std::size_t> ending_;      // of limits_, those that end a run
  std::size_t switching_, conditional_;  // the first event that is a limit, a condition
  std::vector<EventOptions> conditions_;
  bool needs_forces_ = false;   // a condition watches what only the KKT solve gives
  std::optional<Meter> meter_;  // of what conditions watch
  Blocks blocks_;
  Vector values_, ends_;
  std::vector<Watch> watches_;
};

}  // namespace bramah
