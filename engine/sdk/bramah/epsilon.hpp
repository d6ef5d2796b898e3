// First order in eps: v + eps d over any scalar T, exactly.
//
// eps moves the state and the parameters together along a given direction. On duals, v carries the partials of a law and
// d their derivatives along that direction: second derivatives from the same line of physics, and no differences.
#pragma once

#include "bramah/parameter.hpp"

namespace bramah {

template <class T>
struct Epsilon {
  static constexpr bool keeps_tangent = true;
  T v, d;  // value, derivative by eps

  Epsilon() = default;
  Epsilon(double constant) : v(constant), d(0.0) {}
  Epsilon(const Parameter& p) : v(p.value()), d(p.tangent()) {}
  Epsilon(const T& value, const T& tangent) : v(value), d(tangent) {}

  friend Epsilon operator+(const Epsilon& a, const Epsilon& b) { return {a.v + b.v, a.d + b.d}; }
  friend Epsilon operator-(const Epsilon& a, const Epsilon& b) { return {a.v - b.v, a.d - b.d}; }
  friend Epsilon operator-(const Epsilon& a) { return {-a.v, -a.d}; }
  friend Epsilon operator*(const Epsilon& a, const Epsilon& b) { return {a.v * b.v, a.v * b.d + a.d * b.v}; }
  friend Epsilon operator/(const Epsilon& a, const Epsilon& b) {
    const T ratio = a.v / b.v;
    return {ratio, (a.d - ratio * b.d) / b.v};
  }
  friend Epsilon operator+(const Epsilon& a, double b) { return {a.v + b, a.d}; }
  friend Epsilon operator+(double a, const Epsilon& b) { return b + a; }
  friend Epsilon operator-(const Epsilon& a, double b) { return {a.v - b, a.d}; }
  friend Epsilon operator-(double a, const Epsilon& b) { return {a - b.v, -b.d}; }
  friend Epsilon operator*(const Epsilon& a, double b) { return {a.v * b, a.d * b}; }
  friend Epsilon operator*(double a, const Epsilon& b) { return b * a; }
  friend Epsilon operator/(const Epsilon& a, double b) { return a * (1.0 / b); }
  friend Epsilon operator/(double a, const Epsilon& b) { return Epsilon(a) / b; }
  Epsilon& operator+=(const Epsilon& b) { return *this = *this + b; }
  Epsilon& operator-=(const Epsilon& b) { return *this = *this - b; }
  Epsilon& operator*=(const Epsilon& b) { return *this = *this * b; }
};

template <class T>
double value(const Epsilon<T>& a) {
  return value(a.v);
}

}  // namespace bramah
