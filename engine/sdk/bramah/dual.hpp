// Forward-mode duals: a value and N first derivatives, carried exactly through every operation.
//
//   Dual<8> x = Dual<8>::seed(2.0, 0);    // x = 2, dx/dx = 1 in lane 0
//   Dual<8> y = x * sin(x);               // y.derivative(0) = sin 2 + 2 cos 2
//
// Derivatives sit in short vector blocks (4 doubles with AVX, else 2), and every operation is unrolled over them before
// the compiler decides what lives in registers: loops over plain arrays cost four times as much with GCC 12.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>

#include "bramah/parameter.hpp"

namespace bramah {

#if defined(__AVX__)
inline constexpr std::size_t lanes = 4;
#else
inline constexpr std::size_t lanes = 2;
#endif

template <std::size_t L, class E = double>
struct VectorOf {
  static constexpr std::size_t bytes = L * sizeof(E);
  using type [[gnu::vector_size(bytes)]] = E;
};

template <std::size_t K, class Function>
BRAMAH_INLINE void unrolled(Function&& function) {
  // clang-format off
  [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
    (function(std::integral_constant<std::size_t, I>{}), ...);
  }(std::make_index_sequence<K>{});
  // clang-format on
}

template <std::size_t N>
class Dual {
  static_assert(N % lanes == 0, "a dual carries whole vector blocks");
  using Block = typename VectorOf<lanes>::type;
  static constexpr std::size_t blocks = N / lanes;

 public:
  static constexpr bool keeps_tangent = false;

  Dual() = default;
  BRAMAH_INLINE Dual(double value) : v_(value) {
    unrolled<blocks>([&](auto i) __attribute__((always_inline)) { d_[i] = Block{}; });
  }
  BRAMAH_INLINE Dual(const Parameter& p) : Dual(p.value()) {}
  static Dual seed(double value, std::size_t lane) {
    Dual result(value);
    result.d_[lane / lanes][lane % lanes] = 1.0;
    return result;
  }
  [[nodiscard]] BRAMAH_INLINE double value() const { return v_; }
  [[nodiscard]] BRAMAH_INLINE double derivative(std::size_t lane) const { return d_[lane / lanes][lane % lanes]; }
  void set_derivative(std::size_t lane, double d) { d_[lane / lanes][lane % lanes] = d; }

  /// f(a) from its value and slope at a.
  BRAMAH_INLINE friend Dual chain(const Dual& a, double f, double df) {
    Dual r;
    r.v_ = f;
    unrolled<blocks>([&](auto i) __attribute__((always_inline)) { r.d_[i] = a.d_[i] * df; });
    return r;
  }
  BRAMAH_INLINE friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r;
    r.v_ = a.v_ + b.v_;
    unrolled<blocks>([&](auto i) __attribute__((always_inline)) { r.d_[i] = a.d_[i] + b.d_[i]; });
    return r;
  }
  BRAMAH_INLINE friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r;
    r.v_ = a.v_ - b.v_;
    unrolled<blocks>([&](auto i) __attribute__((always_inline)) { r.d_[i] = a.d_[i] - b.d_[i]; });
    return r;
  }
  BRAMAH_INLINE friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r;
    r.v_ = a.v_ * b.v_;
    unrolled<blocks>([&](auto i) __attribute__((always_inline)) { r.d_[i] = a.d_[i] * b.v_ + b.d_[i] * a.v_; });
    return r;
  }
  BRAMAH_INLINE friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r;
    const double inverse = 1.0 / b.v_;
    r.v_ = a.v_ * inverse;
    unrolled<blocks>([&](auto i) __attribute__((always_inline)) { r.d_[i] = (a.d_[i] - b.d_[i] * r.v_) * inverse; });
    return r;
  }
  BRAMAH_INLINE friend Dual operator-(const Dual& a) { return chain(a, -a.v_, -1.0); }
  BRAMAH_INLINE friend Dual operator+(const Dual& a, double b) {
    Dual r = a;
    r.v_ += b;
    return r;
  }
  BRAMAH_INLINE friend Dual operator+(double a, const Dual& b) { return b + a; }
  BRAMAH_INLINE friend Dual operator-(const Dual& a, double b) { return a + (-b); }
  BRAMAH_INLINE friend Dual operator-(double a, const Dual& b) { return chain(b, a - b.v_, -1.0); }
  BRAMAH_INLINE friend Dual operator*(const Dual& a, double b) { return chain(a, a.v_ * b, b); }
  BRAMAH_INLINE friend Dual operator*(double a, const Dual& b) { return chain(b, b.v_ * a, a); }
  BRAMAH_INLINE friend Dual operator/(const Dual& a, double b) { return a * (1.0 / b); }
  BRAMAH_INLINE friend Dual operator/(double a, const Dual& b) {
    const double inverse = 1.0 / b.v_;
    return chain(b, a * inverse, -a * inverse * inverse);
  }
  BRAMAH_INLINE Dual& operator+=(const Dual& b) { return *this = *this + b; }
  BRAMAH_INLINE Dual& operator-=(const Dual& b) { return *this = *this - b; }
  BRAMAH_INLINE Dual& operator*=(const Dual& b) { return *this = *this * b; }

 private:
  Block d_[blocks];
  double v_;
};

template <std::size_t N>
BRAMAH_INLINE double value(const Dual<N>& a) {
  return a.value();
}

}  // namespace bramah
