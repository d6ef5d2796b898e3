// The ends of a travel: springs that push only, with the damping of Hunt and Crossley, whose force begins at zero.
//
//   F = k d max(0, 1 + chi ddot)                       N, away from the end
//   d = lower - s,  ddot = -sdot   where s < lower     m, m/s
//   d = s - upper,  ddot = sdot    where s > upper
//
//   s                along   m     the length that is bounded
//   lower, upper     m       its ends
//   k   stiffness    N/m
//   chi damping      s/m     share of the spring's force per speed of approach
#pragma once

#include <bramah/component.hpp>
#include <cstdio>

namespace bramah::mechanics {

struct EndStop {
  Coordinate along;
  Output force_out, depth_out;
  Switch lower_end, upper_end, lower_release, upper_release;
  Parameter lower = 0.0, upper = 1.0, stiffness = 0.0, damping = 0.0;

  void describe(Description& is) {
    is.called("mechanics/end_stop", "the two ends of a travel, which push only");
    is.port("along", along, "the length that is bounded", "m");
    is.parameter("lower", lower, "m").doc("its lower end");
    is.parameter("upper", upper, "m").doc("its upper end");
    is.parameter("stiffness", stiffness, "N/m").above(0.0).doc("force per depth");
    is.parameter("damping", damping, "s/m").by_default(0.0).at_least(0.0).doc("share of force per speed of approach");
    is.output("force", force_out, "N", "force of the ends, positive where it lengthens");
    is.output("depth", depth_out, "m", "how deep the end is pressed in, 0 where none is touched");
    is.switching("lower_end", lower_end, "m", 1e-3, "the length less its lower end");
    is.switching("upper_end", upper_end, "m", 1e-3, "the upper end less the length");
    is.switching("lower_release", lower_release, "1", 1.0, "1 less damping times speed: the lower end would pull");
    is.switching("upper_release", upper_release, "1", 1.0, "1 plus damping times speed: the upper end would pull");
  }
  void check(Faults& faults) const {
    if (lower < upper) return;
    char found[64], expected[64];
    std::snprintf(found, sizeof found, "%g m", lower.value());
    std::snprintf(expected, sizeof expected, "less than upper = %g m", upper.value());
    faults.add("lower", found, expected);
  }

  /// Depth (m) in the end that is touched, negative or zero where none is; and the speed (m/s) into it.
  template <class T>
  struct Contact {
    T depth, approach;
    double away;  // 1 where pushing lengthens, else -1
  };
  template <class T>
  Contact<T> contact(const At<T>& at) const {
    const T &s = at(along), &speed = at.rate(along);
    if (value(s) < 0.5 * (lower.value() + upper.value())) return {lower - s, -speed, 1.0};
    return {s - upper, speed, -1.0};
  }
  template <class T>
  bool touches(const At<T>& at, const Contact<T>& c) const {
    // The switching functions are gaps, so that side + is where there is none.
    return !at.above_zero(-c.depth);
  }
  /// Push (N) of the end, away from it.
  template <class T>
  T push(const At<T>& at, const Contact<T>& c) const {
    const T factor = 1.0 + c.approach * damping;
    return touches(at, c) && at.above_zero(factor) ? T(c.depth * factor * stiffness) : T(0.0);
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const Contact<T> c = contact(at);
    rows.apply(along, push(at, c) * c.away);
  }
  template <class T>
  T energy(const At<T>& at) const {
    const Contact<T> c = contact(at);
    return touches(at, c) ? T(square(c.depth) * (0.5 * stiffness)) : T(0.0);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    const Contact<T> c = contact(at);
    y(force_out) = push(at, c) * c.away;
    y(depth_out) = touches(at, c) ? c.depth : T(0.0);
  }
  template <class T>
  void switches(const At<T>& at, Values<T>& s) const {
    s(lower_end) = at(along) - lower;
    s(upper_end) = upper - at(along);
    s(lower_release) = 1.0 - at.rate(along) * damping;
    s(upper_release) = 1.0 + at.rate(along) * damping;
  }
};

}  // namespace bramah::mechanics
