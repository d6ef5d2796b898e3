// Reference numbers of tests/reference.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace bramah::testing {

nlohmann::json reference(const std::string& file);

inline double number(const nlohmann::json& text) { return std::stod(text.get<std::string>()); }

inline std::vector<double> numbers(const nlohmann::json& list) {
  std::vector<double> result;
  for (const auto& item : list) result.push_back(number(item));
  return result;
}

}  // namespace bramah::testing
