// A number that a scene gives, and its derivative along the direction that an analysis moves parameters in.
//
//   Parameter k(100.0, 1.0);        // N/m; dk/deps = 1
//   Parameter w = sqrt(k / 4.0);    // w = 5, dw/deps = 1 / (2 * 4 * 5)
//   T F = k * at(s);                // on an Epsilon F carries dk/deps along, on every other scalar k is a number
//
// There is no way to a double but value(), so that a tangent cannot be lost unseen. A member that is a plain double
// works in every law; analyses then name it as not differentiable.
#pragma once

#include <cmath>
#include <compare>

namespace bramah {

#define BRAMAH_INLINE inline __attribute__((always_inline))

/// The scalars that laws are evaluated on say whether they have room for the tangent of a parameter.
template <class T>
concept LawScalar = requires {
  T::keeps_tangent;
};
template <class T>
concept KeepsTangent = LawScalar<T> && T::keeps_tangent;

class Parameter {
 public:
  constexpr Parameter(double value = 0.0) : v_(value) {}
  constexpr Parameter(double value, double tangent) : v_(value), d_(tangent) {}
  [[nodiscard]] constexpr double value() const { return v_; }
  [[nodiscard]] constexpr double tangent() const { return d_; }

  friend constexpr Parameter operator+(const Parameter& a, const Parameter& b) { return {a.v_ + b.v_, a.d_ + b.d_}; }
  friend constexpr Parameter operator-(const Parameter& a, const Parameter& b) { return {a.v_ - b.v_, a.d_ - b.d_}; }
  friend constexpr Parameter operator-(const Parameter& a) { return {-a.v_, -a.d_}; }
  friend constexpr Parameter operator*(const Parameter& a, const Parameter& b) {
    return {a.v_ * b.v_, a.d_ * b.v_ + a.v_ * b.d_};
  }
  friend constexpr Parameter operator/(const Parameter& a, const Parameter& b) {
    const double ratio = a.v_ / b.v_;
    return {ratio, (a.d_ - ratio * b.d_) / b.v_};
  }
  constexpr Parameter& operator+=(const Parameter& b) { return *this = *this + b; }
  constexpr Parameter& operator-=(const Parameter& b) { return *this = *this - b; }
  constexpr Parameter& operator*=(const Parameter& b) { return *this = *this * b; }
  constexpr Parameter& operator/=(const Parameter& b) { return *this = *this / b; }
  friend constexpr bool operator==(const Parameter& a, const Parameter& b) { return a.v_ == b.v_; }
  friend constexpr std::partial_ordering operator<=>(const Parameter& a, const Parameter& b) { return a.v_ <=> b.v_; }

 private:
  double v_, d_ = 0.0;
};

/// The number that comparisons are made on. Declared before every scalar that is built on double.
inline double value(double a) { return a; }
inline double value(const Parameter& a) { return a.value(); }

// Where a scalar has no room for the tangent, a parameter costs what a plain number costs.
template <LawScalar T>
BRAMAH_INLINE T operator+(const T& a, const Parameter& p) {
  if constexpr (KeepsTangent<T>) return a + T(p);
  return a + p.value();
}
template <LawScalar T>
BRAMAH_INLINE T operator-(const T& a, const Parameter& p) {
  if constexpr (KeepsTangent<T>) return a - T(p);
  return a - p.value();
}
template <LawScalar T>
BRAMAH_INLINE T operator*(const T& a, const Parameter& p) {
  if constexpr (KeepsTangent<T>) return a * T(p);
  return a * p.value();
}
template <LawScalar T>
BRAMAH_INLINE T operator/(const T& a, const Parameter& p) {
  if constexpr (KeepsTangent<T>) return a / T(p);
  return a / p.value();
}
template <LawScalar T>
BRAMAH_INLINE T operator+(const Parameter& p, const T& a) {
  return a + p;
}
template <LawScalar T>
BRAMAH_INLINE T operator-(const Parameter& p, const T& a) {
  if constexpr (KeepsTangent<T>) return T(p) - a;
  return p.value() - a;
}
template <LawScalar T>
BRAMAH_INLINE T operator*(const Parameter& p, const T& a) {
  return a * p;
}
template <LawScalar T>
BRAMAH_INLINE T operator/(const Parameter& p, const T& a) {
  if constexpr (KeepsTangent<T>) return T(p) / a;
  return p.value() / a;
}

}  // namespace bramah
