// Elementary functions on every scalar that physics is evaluated on, Real, Dual, Epsilon, Taylor and Trace, and on
// parameters.
//
// Comparisons are made on value(x). A law that branches on the state must be continuous across the branch; its kinks are
// declared with Description::switching so that analyses can tell which side they take.
#pragma once

#include <cmath>

#include "bramah/dual.hpp"
#include "bramah/epsilon.hpp"
#include "bramah/real.hpp"
#include "bramah/taylor.hpp"
#include "bramah/trace.hpp"

namespace bramah {

// On double they are those of the standard library.
using std::abs;
using std::acos;
using std::asin;
using std::atan;
using std::atan2;
using std::cos;
using std::cosh;
using std::exp;
using std::log;
using std::pow;
using std::sin;
using std::sinh;
using std::sqrt;
using std::tan;
using std::tanh;

// f(u) for a series u from f, f' and f'' at u0: f(u)[1] = f' u1, f(u)[2] = f' u2 + f'' u1^2 / 2.
template <class T, int K>
BRAMAH_INLINE Taylor<T, K> series(const Taylor<T, K>& u, const T& f, const T& df, const T& ddf) {
  Taylor<T, K> r;
  r.c[0] = f;
  r.c[1] = df * u.c[1];
  if constexpr (K == 2) r.c[2] = df * u.c[2] + 0.5 * (ddf * (u.c[1] * u.c[1]));
  return r;
}

/// The tangent of f(p), df its slope; a parameter that stands still has none, whatever the slope.
inline Parameter moved(const Parameter& p, double f, double df) {
  return {f, p.tangent() == 0.0 ? 0.0 : df * p.tangent()};
}

// Each function in one place: its slope and curvature as expressions of the argument `a` and of the value `f`.
#define BRAMAH_FUNCTION(name, slope, curvature)                                       \
  template <std::size_t N>                                                            \
  BRAMAH_INLINE Dual<N> name(const Dual<N>& d) {                                      \
    const double a = d.value();                                                       \
    [[maybe_unused]] const double f = name(a);                                        \
    return chain(d, f, slope);                                                        \
  }                                                                                   \
  inline Real name(const Real& x) { return name(x.value()); }                         \
  inline Parameter name(const Parameter& p) {                                         \
    const double a = p.value();                                                       \
    [[maybe_unused]] const double f = name(a);                                        \
    return moved(p, f, slope);                                                        \
  }                                                                                   \
  inline Trace name(const Trace& t) { return Trace::curved(name(t.number()), t, t); } \
  template <class T>                                                                  \
  Epsilon<T> name(const Epsilon<T>& e) {                                              \
    const T& a = e.v;                                                                 \
    [[maybe_unused]] const T f = name(a);                                             \
    return {f, T(slope) * e.d};                                                       \
  }                                                                                   \
  template <class T, int K>                                                           \
  BRAMAH_INLINE Taylor<T, K> name(const Taylor<T, K>& u) {                            \
    const T& a = u.c[0];                                                              \
    [[maybe_unused]] const T f = name(a);                                             \
    return series(u, f, T(slope), T(curvature));                                      \
  }

BRAMAH_FUNCTION(sqrt, 0.5 / f, -0.25 / (f * a))
BRAMAH_FUNCTION(exp, f, f)
BRAMAH_FUNCTION(log, 1.0 / a, -1.0 / (a * a))
BRAMAH_FUNCTION(sin, cos(a), -1.0 * f)
BRAMAH_FUNCTION(cos, -1.0 * sin(a), -1.0 * f)
BRAMAH_FUNCTION(tan, 1.0 + f * f, 2.0 * f * (1.0 + f * f))
BRAMAH_FUNCTION(asin, 1.0 / sqrt(1.0 - a * a), a / ((1.0 - a * a) * sqrt(1.0 - a * a)))
BRAMAH_FUNCTION(acos, -1.0 / sqrt(1.0 - a * a), -1.0 * a / ((1.0 - a * a) * sqrt(1.0 - a * a)))
BRAMAH_FUNCTION(atan, 1.0 / (1.0 + a * a), -2.0 * a / ((1.0 + a * a) * (1.0 + a * a)))
BRAMAH_FUNCTION(sinh, cosh(a), f)
BRAMAH_FUNCTION(cosh, sinh(a), f)
BRAMAH_FUNCTION(tanh, 1.0 - f * f, -2.0 * f * (1.0 - f * f))
#undef BRAMAH_FUNCTION

template <class T>
BRAMAH_INLINE T square(const T& a) {
  return a * a;
}

/// a^exponent for a > 0 and an exponent that does not depend on the state.
template <LawScalar T>
T pow(const T& a, double exponent) {
  return exp(exponent * log(a));
}
template <LawScalar T>
T pow(const T& a, const Parameter& exponent) {
  return exp(exponent * log(a));
}
inline Parameter pow(const Parameter& a, const Parameter& exponent) {
  const double n = exponent.value(), f = pow(a.value(), n);
  const Parameter by_base = moved(a, f, n * pow(a.value(), n - 1.0));
  return {f, by_base.tangent() + (exponent.tangent() == 0.0 ? 0.0 : f * log(a.value()) * exponent.tangent())};
}

/// The angle of the vector (x, y), any quadrant.
template <class T>
T atan2(const T& y, const T& x) {
  // The branch only picks a representation; either is smooth where it is used.
  const double vy = value(y), vx = value(x);
  const double at = std::atan2(vy, vx);
  if (std::fabs(vx) >= std::fabs(vy)) {
    const T ratio = atan(y / x);
    return ratio + (at - std::atan(vy / vx));
  }
  const T ratio = atan(x / y);
  return (at + std::atan(vx / vy)) - ratio;
}

/// |a|; the slope at 0 is +1. Smooth laws rather use sqrt(a^2 + small^2).
template <class T>
T abs(const T& a) {
  return value(a) < 0.0 ? T(-a) : a;
}
/// max(a, 0): smooth where it is squared or raised to more, and no branch then.
template <class T>
T positive_part(const T& a) {
  return value(a) > 0.0 ? a : T(0.0);
}
inline Trace positive_part(const Trace& t) { return Trace::curved(t.number() > 0.0 ? t.number() : 0.0, t, t); }
template <class T>
T max(const T& a, const T& b) {
  return value(a) < value(b) ? b : a;
}
template <class T>
T min(const T& a, const T& b) {
  return value(b) < value(a) ? b : a;
}
inline Parameter max(const Parameter& a, const Parameter& b) { return a < b ? b : a; }
inline Parameter min(const Parameter& a, const Parameter& b) { return b < a ? b : a; }

}  // namespace bramah
