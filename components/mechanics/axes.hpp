// Unit vectors from vectors of any length: how a scene gives directions.
#pragma once

#include <bramah/component.hpp>
#include <cstdio>
#include <string>

namespace bramah::mechanics {

template <class T, std::size_t N>
T length(const std::array<T, N>& a) {
  return sqrt(dot(a, a));
}

/// a / |a|; a zero vector stays as it is, for `check` to report.
template <class T, std::size_t N>
std::array<T, N> unit(const std::array<T, N>& a) {
  const T size = length(a);
  return size > 0.0 ? (1.0 / size) * a : a;
}

/// Two unit vectors that complete the unit vector `axis` to a right-handed triad (t1, t2, axis). The first is normal to
/// a coordinate axis that `axis` is little aligned with: well conditioned, and the same on every machine. The choice prefers
/// the first of nearly equals, so that it does not change, and the triad does not jump, where an axis moves off a
/// coordinate axis or a diagonal.
template <class T>
std::array<Vec3<T>, 2> normals(const Vec3<T>& axis) {
  std::size_t least = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (abs(axis[k]) + 0.1 < abs(axis[least])) least = k;
  }
  Vec3<T> other = {};
  other[least] = 1.0;
  const Vec3<T> t1 = unit(cross(axis, other));
  return {t1, cross(axis, t1)};
}

/// Numbers as a message shows them: "(0, 0, 1)".
template <std::size_t N>
std::string written(const std::array<Parameter, N>& a) {
  std::string text = "(";
  for (std::size_t k = 0; k < N; ++k) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.6g", k == 0 ? "" : ", ", a[k].value());
    text += number;
  }
  return text + ")";
}

template <std::size_t N>
void require_direction(Faults& faults, const char* parameter, const std::array<Parameter, N>& a) {
  if (!(length(a) > 0.0)) faults.add(parameter, written(a), "a direction: at least one number other than zero");
}

}  // namespace bramah::mechanics
