// Truncated Taylor series in time: c[0] + c[1] t + ... + c[K] t^K over any scalar T.
//
// With x = x0 + v t + a t^2/2 one evaluation of a constraint c(x) yields c, cdot = c[1], cddot = 2 c[2]; with T a dual,
// their partials as well: Eqs. (34), (39), (40), (46) of Agundez et al. (2023) from one line of physics.
#pragma once

#include "bramah/dual.hpp"

namespace bramah {

template <class T, int K>
struct Taylor {
  static_assert(K == 1 || K == 2);
  static constexpr bool keeps_tangent = KeepsTangent<T>;
  T c[K + 1];

  Taylor() = default;
  Taylor(double constant) {
    c[0] = T(constant);
    for (int k = 1; k <= K; ++k) c[k] = T(0.0);
  }
  Taylor(const Parameter& p) {
    c[0] = T(p);
    for (int k = 1; k <= K; ++k) c[k] = T(0.0);
  }

  BRAMAH_INLINE friend Taylor operator+(const Taylor& a, const Taylor& b) {
    Taylor r;
    for (int k = 0; k <= K; ++k) r.c[k] = a.c[k] + b.c[k];
    return r;
  }
  BRAMAH_INLINE friend Taylor operator-(const Taylor& a, const Taylor& b) {
    Taylor r;
    for (int k = 0; k <= K; ++k) r.c[k] = a.c[k] - b.c[k];
    return r;
  }
  BRAMAH_INLINE friend Taylor operator-(const Taylor& a) {
    Taylor r;
    for (int k = 0; k <= K; ++k) r.c[k] = -a.c[k];
    return r;
  }
  BRAMAH_INLINE friend Taylor operator*(const Taylor& a, const Taylor& b) {
    Taylor r;
    r.c[0] = a.c[0] * b.c[0];
    r.c[1] = a.c[0] * b.c[1] + a.c[1] * b.c[0];
    if constexpr (K == 2) r.c[2] = a.c[0] * b.c[2] + a.c[1] * b.c[1] + a.c[2] * b.c[0];
    return r;
  }
  BRAMAH_INLINE friend Taylor operator/(const Taylor& a, const Taylor& b) {
    Taylor r;
    r.c[0] = a.c[0] / b.c[0];
    r.c[1] = (a.c[1] - r.c[0] * b.c[1]) / b.c[0];
    if constexpr (K == 2) r.c[2] = (a.c[2] - r.c[0] * b.c[2] - r.c[1] * b.c[1]) / b.c[0];
    return r;
  }
  BRAMAH_INLINE friend Taylor operator+(const Taylor& a, double b) {
    Taylor r = a;
    r.c[0] = a.c[0] + b;
    return r;
  }
  BRAMAH_INLINE friend Taylor operator+(double a, const Taylor& b) { return b + a; }
  BRAMAH_INLINE friend Taylor operator-(const Taylor& a, double b) { return a + (-b); }
  BRAMAH_INLINE friend Taylor operator-(double a, const Taylor& b) { return (-b) + a; }
  BRAMAH_INLINE friend Taylor operator*(const Taylor& a, double b) {
    Taylor r;
    for (int k = 0; k <= K; ++k) r.c[k] = a.c[k] * b;
    return r;
  }
  BRAMAH_INLINE friend Taylor operator*(double a, const Taylor& b) { return b * a; }
  BRAMAH_INLINE friend Taylor operator/(const Taylor& a, double b) { return a * (1.0 / b); }
  BRAMAH_INLINE friend Taylor operator/(double a, const Taylor& b) { return Taylor(a) / b; }
  BRAMAH_INLINE Taylor& operator+=(const Taylor& b) { return *this = *this + b; }
  BRAMAH_INLINE Taylor& operator-=(const Taylor& b) { return *this = *this - b; }
  BRAMAH_INLINE Taylor& operator*=(const Taylor& b) { return *this = *this * b; }
};

template <class T, int K>
BRAMAH_INLINE double value(const Taylor<T, K>& a) {
  return value(a.c[0]);
}

}  // namespace bramah
