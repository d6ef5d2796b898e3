// A plain number as a scalar of laws: what rows are evaluated on when nobody asks for partials.
//
// A law on bare doubles could not tell `2 * k`, which keeps the tangent of a parameter, from `k * at(s)`, which is a
// force. This type is that difference; it costs nothing.
#pragma once

#include "bramah/parameter.hpp"

namespace bramah {

class Real {
 public:
  static constexpr bool keeps_tangent = false;
  Real() = default;
  BRAMAH_INLINE Real(double value) : v_(value) {}
  BRAMAH_INLINE Real(const Parameter& p) : v_(p.value()) {}
  [[nodiscard]] BRAMAH_INLINE double value() const { return v_; }

  BRAMAH_INLINE friend Real operator+(const Real& a, const Real& b) { return a.v_ + b.v_; }
  BRAMAH_INLINE friend Real operator-(const Real& a, const Real& b) { return a.v_ - b.v_; }
  BRAMAH_INLINE friend Real operator-(const Real& a) { return -a.v_; }
  BRAMAH_INLINE friend Real operator*(const Real& a, const Real& b) { return a.v_ * b.v_; }
  BRAMAH_INLINE friend Real operator/(const Real& a, const Real& b) { return a.v_ / b.v_; }
  BRAMAH_INLINE Real& operator+=(const Real& b) { return *this = *this + b; }
  BRAMAH_INLINE Real& operator-=(const Real& b) { return *this = *this - b; }
  BRAMAH_INLINE Real& operator*=(const Real& b) { return *this = *this * b; }

 private:
  double v_;
};

inline double value(const Real& a) { return a.value(); }

}  // namespace bramah
