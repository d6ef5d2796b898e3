// Numbers in messages of analyses.
#pragma once

#include <cstdio>
#include <string>

namespace bramah {

/// `value` with so many significant digits: for people only, results carry 17.
inline std::string digits(double value, int count = 3) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", count, value);
  return text;
}

}  // namespace bramah
