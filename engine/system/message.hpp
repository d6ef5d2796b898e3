// Numbers and lists in messages of analyses.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace bramah {

/// `value` with so many significant digits: for people only, results carry 17.
inline std::string digits(double value, int count = 3) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", count, value);
  return text;
}

/// "0.12 m", "0.12" without a unit.
inline std::string with_unit(double value, const std::string& unit, int count = 3) {
  return digits(value, count) + (unit == "1" ? "" : " " + unit);
}

/// "a, b, c", with what exceeds five of them counted.
inline std::string list_of(const std::vector<std::string>& parts) {
  constexpr std::size_t most = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(parts.size(), most); ++k) text += (k == 0 ? "" : ", ") + parts[k];
  return text + (parts.size() > most ? ", ... (" + std::to_string(parts.size()) + " in all)" : "");
}

}  // namespace bramah
