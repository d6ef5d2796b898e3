// Unit vectors from vectors of any length: how a scene gives directions.
#pragma once

#include <bramah/component.hpp>
#include <cstdio>
#include <string>

namespace bramah::mechanics {

template <std::size_t N>
double length(const std::array<double, N>& a) {
  return std::sqrt(dot(a, a));
}

/// a / |a|; a zero vector stays as it is, for `check` to report.
template <std::size_t N>
std::array<double, N> unit(const std::array<double, N>& a) {
  const double size = length(a);
  return size > 0.0 ? (1.0 / size) * a : a;
}

/// Two unit vectors that complete the unit vector `axis` to a right-handed triad (t1, t2, axis). The first is normal to
/// the coordinate axis that `axis` is least aligned with (the first of equals): well conditioned, and the same on every
/// machine.
inline std::array<Vec3<double>, 2> normals(const Vec3<double>& axis) {
  std::size_t least = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (std::fabs(axis[k]) < std::fabs(axis[least])) least = k;
  }
  Vec3<double> other = {};
  other[least] = 1.0;
  const Vec3<double> t1 = unit(cross(axis, other));
  return {t1, cross(axis, t1)};
}

/// Numbers as a message shows them: "(0, 0, 1)".
template <std::size_t N>
std::string written(const std::array<double, N>& a) {
  std::string text = "(";
  for (std::size_t k = 0; k < N; ++k) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.6g", k == 0 ? "" : ", ", a[k]);
    text += number;
  }
  return text + ")";
}

template <std::size_t N>
void require_direction(Faults& faults, const char* parameter, const std::array<double, N>& a) {
  if (!(length(a) > 0.0)) faults.add(parameter, written(a), "a direction: at least one number other than zero");
}

}  // namespace bramah::mechanics
