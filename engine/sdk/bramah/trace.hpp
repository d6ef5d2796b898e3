// A scalar that records which seeds a result depends on, and on which of them nonlinearly.
//
// One evaluation of a law on Trace gives the structure of its partials, valid for every state as long as the law does
// not branch on the state. Comparisons are noted; whoever reads the structure then takes everything as dependent.
#pragma once

#include <bitset>

#include "bramah/dual.hpp"

namespace bramah {

class Trace {
 public:
  static constexpr bool keeps_tangent = false;
  static constexpr std::size_t most_seeds = 512;
  using Set = std::bitset<most_seeds>;

  Trace() = default;
  Trace(double value) : v_(value) {}
  Trace(const Parameter& p) : v_(p.value()) {}
  static Trace seed(double value, std::size_t index) {
    Trace t(value);
    t.depends_.set(index);
    return t;
  }
  [[nodiscard]] const Set& depends() const { return depends_; }
  [[nodiscard]] const Set& nonlinear() const { return nonlinear_; }

  /// Set by every comparison of traced numbers in this thread.
  static bool& compared() {
    thread_local bool flag = false;
    return flag;
  }
  [[nodiscard]] double number() const { return v_; }

  friend Trace operator+(const Trace& a, const Trace& b) { return linear(a.v_ + b.v_, a, b); }
  friend Trace operator-(const Trace& a, const Trace& b) { return linear(a.v_ - b.v_, a, b); }
  friend Trace operator-(const Trace& a) { return linear(-a.v_, a, a); }
  friend Trace operator*(const Trace& a, const Trace& b) {
    if (b.depends_.none()) return linear(a.v_ * b.v_, a, a);
    if (a.depends_.none()) return linear(a.v_ * b.v_, b, b);
    return curved(a.v_ * b.v_, a, b);
  }
  friend Trace operator/(const Trace& a, const Trace& b) {
    return b.depends_.none() ? linear(a.v_ / b.v_, a, a) : curved(a.v_ / b.v_, a, b);
  }
  friend Trace operator+(const Trace& a, double b) { return linear(a.v_ + b, a, a); }
  friend Trace operator+(double a, const Trace& b) { return linear(a + b.v_, b, b); }
  friend Trace operator-(const Trace& a, double b) { return linear(a.v_ - b, a, a); }
  friend Trace operator-(double a, const Trace& b) { return linear(a - b.v_, b, b); }
  friend Trace operator*(const Trace& a, double b) { return linear(a.v_ * b, a, a); }
  friend Trace operator*(double a, const Trace& b) { return linear(a * b.v_, b, b); }
  friend Trace operator/(const Trace& a, double b) { return linear(a.v_ / b, a, a); }
  friend Trace operator/(double a, const Trace& b) { return curved(a / b.v_, b, b); }
  Trace& operator+=(const Trace& b) { return *this = *this + b; }
  Trace& operator-=(const Trace& b) { return *this = *this - b; }
  Trace& operator*=(const Trace& b) { return *this = *this * b; }

  static Trace curved(double value, const Trace& a, const Trace& b) {
    Trace r(value);
    r.depends_ = a.depends_ | b.depends_;
    r.nonlinear_ = r.depends_;
    return r;
  }

 private:
  static Trace linear(double value, const Trace& a, const Trace& b) {
    Trace r(value);
    r.depends_ = a.depends_ | b.depends_;
    r.nonlinear_ = a.nonlinear_ | b.nonlinear_;
    return r;
  }
  double v_ = 0.0;
  Set depends_, nonlinear_;
};

inline double value(const Trace& a) {
  Trace::compared() = true;
  return a.number();
}

}  // namespace bramah
