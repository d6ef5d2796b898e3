// A signal through given points: linear between them, constant outside; a time given twice is a jump. Eq. (92) is one.
//
//   times    s       t_0 <= t_1 <= ...
//   values   @unit   one per time
// At a jump the value is the limit from the side that is asked for.
#pragma once

#include <algorithm>
#include <bramah/component.hpp>
#include <cstdio>
#include <string>
#include <vector>

namespace bramah::signals {

struct Table {
  std::string unit;
  std::vector<double> times;  // moving a kink in time is no derivative of a signal
  std::vector<Parameter> values;

  void describe(Description& is) {
    is.called("signals/table", "a signal through given points, linear between them");
    is.parameter("unit", unit).by_default("1").doc("unit of the signal");
    is.parameter("times", times, "s").doc("times of the points, in order; a time given twice is a jump");
    is.parameter("values", values, "@unit").doc("values at these times");
    is.provide_signal<Input>("value", "@unit", "the value");
  }
  void check(Faults& faults) const {
    if (times.empty()) faults.add("times", "none", "at least one time");
    if (values.size() != times.size()) {
      faults.add("values", std::to_string(values.size()) + " values", std::to_string(times.size()) + ", one per time");
    }
    for (std::size_t k = 1; k < times.size(); ++k) {
      if (!(times[k] >= times[k - 1])) {
        faults.add("times", written(times[k]) + " after " + written(times[k - 1]), "times in order");
      } else if (k >= 2 && times[k] == times[k - 2]) {
        faults.add("times", written(times[k]) + " more than twice", "at most two points at one time");
      }
    }
  }
  [[nodiscard]] Parameter signal(double t, int side) const {
    // The first point behind t; from before, a point at t itself is still ahead.
    const auto after =
        side > 0 ? std::upper_bound(times.begin(), times.end(), t) : std::lower_bound(times.begin(), times.end(), t);
    if (after == times.begin()) return values.front();
    if (after == times.end()) return values.back();
    const auto k = static_cast<std::size_t>(after - times.begin());
    const double share = (t - times[k - 1]) / (times[k] - times[k - 1]);
    return (1.0 - share) * values[k - 1] + share * values[k];  // exact at both ends
  }
  [[nodiscard]] double next_breakpoint(double t) const {
    const auto next = std::upper_bound(times.begin(), times.end(), t);
    return next == times.end() ? HUGE_VAL : *next;
  }

 private:
  static std::string written(double t) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g s", t);
    return text;
  }
};

}  // namespace bramah::signals
