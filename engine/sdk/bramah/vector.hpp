// Small vectors and rotations over any scalar: what measures of a mechanism are written with.
#pragma once

#include <array>

#include "bramah/math.hpp"

namespace bramah {

template <class T>
using Vec2 = std::array<T, 2>;
template <class T>
using Vec3 = std::array<T, 3>;
template <class T>
using Quaternion = std::array<T, 4>;  // Euler parameters e0, e1, e2, e3

template <class T, class S, std::size_t N>
std::array<decltype(T{} + S{}), N> operator+(const std::array<T, N>& a, const std::array<S, N>& b) {
  std::array<decltype(T{} + S{}), N> sum;
  for (std::size_t i = 0; i < N; ++i) sum[i] = a[i] + b[i];
  return sum;
}
template <class T, class S, std::size_t N>
std::array<decltype(T{} - S{}), N> operator-(const std::array<T, N>& a, const std::array<S, N>& b) {
  std::array<decltype(T{} - S{}), N> difference;
  for (std::size_t i = 0; i < N; ++i) difference[i] = a[i] - b[i];
  return difference;
}
template <class T, class S, std::size_t N>
std::array<decltype(T{} * S{}), N> operator*(const S& scale, const std::array<T, N>& a) {
  std::array<decltype(T{} * S{}), N> product;
  for (std::size_t i = 0; i < N; ++i) product[i] = a[i] * scale;
  return product;
}
template <class T, class S, std::size_t N>
auto dot(const std::array<T, N>& a, const std::array<S, N>& b) {
  auto sum = a[0] * b[0];
  for (std::size_t i = 1; i < N; ++i) sum = sum + a[i] * b[i];
  return sum;
}
template <class T, class S>
Vec3<decltype(T{} * S{})> cross(const Vec3<T>& a, const Vec3<S>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// A(e) u: the vector u of the body, in the frame that e is measured in. A homogeneous quadratic form in e, so that it
/// equals the rotated vector where |e| = 1 and stays polynomial elsewhere.
template <class T, class S>
Vec3<T> rotate(const Quaternion<T>& e, const Vec3<S>& u) {
  const T e00 = e[0] * e[0], e11 = e[1] * e[1], e22 = e[2] * e[2], e33 = e[3] * e[3];
  const T e01 = e[0] * e[1], e02 = e[0] * e[2], e03 = e[0] * e[3];
  const T e12 = e[1] * e[2], e13 = e[1] * e[3], e23 = e[2] * e[3];
  return {(e00 + e11 - e22 - e33) * u[0] + (e12 - e03) * (2.0 * u[1]) + (e13 + e02) * (2.0 * u[2]),
          (e12 + e03) * (2.0 * u[0]) + (e00 - e11 + e22 - e33) * u[1] + (e23 - e01) * (2.0 * u[2]),
          (e13 - e02) * (2.0 * u[0]) + (e23 + e01) * (2.0 * u[1]) + (e00 - e11 - e22 + e33) * u[2]};
}

/// A(e)^T w: a vector of the outer frame, in the body.
template <class T, class S>
Vec3<T> rotate_back(const Quaternion<T>& e, const Vec3<S>& w) {
  return rotate(Quaternion<T>{e[0], -e[1], -e[2], -e[3]}, w);
}

/// L(e) q with L = [-eps, e0 I - eps~] (3 x 4): the angular velocity in the body frame is 2 L(e) edot.
template <class T>
Vec3<T> body_rate(const Quaternion<T>& e, const Quaternion<T>& q) {
  return {e[0] * q[1] - e[1] * q[0] + e[3] * q[2] - e[2] * q[3], e[0] * q[2] - e[2] * q[0] + e[1] * q[3] - e[3] * q[1],
          e[0] * q[3] - e[3] * q[0] + e[2] * q[1] - e[1] * q[2]};
}

/// L(e)^T w (4): the generalized force of a torque w in the body frame is 2 L^T w.
template <class T>
Quaternion<T> body_rate_transposed(const Quaternion<T>& e, const Vec3<T>& w) {
  return {-(e[1] * w[0] + e[2] * w[1] + e[3] * w[2]), e[0] * w[0] - e[3] * w[1] + e[2] * w[2],
          e[3] * w[0] + e[0] * w[1] - e[1] * w[2], e[1] * w[1] - e[2] * w[0] + e[0] * w[2]};
}

/// (d(A(e) u)/de)^T w (4): the generalized force on e of a force w at the body's point u.
template <class T, class S>
Quaternion<T> point_force(const Quaternion<T>& e, const Vec3<S>& u, const Vec3<T>& w) {
  const T ew = e[1] * w[0] + e[2] * w[1] + e[3] * w[2];
  const T eu = e[1] * u[0] + e[2] * u[1] + e[3] * u[2];
  const T uw = u[0] * w[0] + u[1] * w[1] + u[2] * w[2];
  const Vec3<T> uxw = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
  Quaternion<T> q;
  q[0] = 2.0 * (e[0] * uw + e[1] * uxw[0] + e[2] * uxw[1] + e[3] * uxw[2]);
  for (std::size_t k = 0; k < 3; ++k) q[k + 1] = 2.0 * (eu * w[k] + ew * u[k] - uw * e[k + 1] + e[0] * uxw[k]);
  return q;
}

/// Unit Euler parameters of the rotation vector (axis times angle, rad).
template <class T = double>
Quaternion<T> quaternion_of(const Vec3<T>& rotation) {
  const T angle = sqrt(dot(rotation, rotation));
  const T scale = value(angle) > 0.0 ? T(sin(0.5 * angle) / angle) : T(0.5);
  return {cos(0.5 * angle), scale * rotation[0], scale * rotation[1], scale * rotation[2]};
}

}  // namespace bramah
