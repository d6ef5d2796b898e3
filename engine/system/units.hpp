// Units of measurement: text to SI, with the dimension checked. One conversion at the border, SI everywhere inside.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace bramah {

/// A unit as a fraction that leads to SI and the exponents of its base dimensions, doubled so that sqrt(Pa) is exact.
/// A fraction rather than a factor: 80 mm is 80 * 1 / 1000, one rounding, hence the double nearest to 0.08.
struct Unit {
  double numerator = 1.0;
  double denominator = 1.0;
  double offset = 0.0;                 // only degC: K above the zero of SI
  std::array<signed char, 6> twice{};  // 2 x exponents of m, kg, s, A, K, rad
  [[nodiscard]] double to_si(double value) const { return value * numerator / denominator + offset; }
  [[nodiscard]] bool same_dimension(const Unit& other) const { return twice == other.twice; }
};

/// Reads "m^3/(s.Pa^0.5)", "N.m/rad", "kg*m^2", "rpm", "1", "" (dimensionless). Operators . * / ^ and parentheses,
/// from left to right (a/b.c is a.c/b); exponents are multiples of one half: 2, -1, 0.5, (1/2). No spaces inside.
/// SI prefixes p n u µ m c d k M G T on m g s N Pa J W Hz A K V L rad; further bar, mbar, psi, in, t, min, h, deg, rev,
/// rpm, degC, %, percent. degC stands alone only. Empty where it is no unit.
std::optional<Unit> parse_unit(std::string_view text);

/// A number followed by a unit: "80 mm", "-1.5e3 N", "60deg". `unit` is empty where none was written; nothing says yet
/// that it is a unit.
struct Quantity {
  double value = 0.0;
  std::string unit;
};
/// Empty where the text does not begin with a finite number.
std::optional<Quantity> parse_quantity(std::string_view text);

/// Units with the dimension of `unit` that a user might have meant: "m, mm, cm, km". For messages, and never empty:
/// an unusual dimension is spelled in base units.
std::string alternatives(const Unit& unit);

}  // namespace bramah
