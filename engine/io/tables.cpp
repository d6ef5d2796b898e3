#include "io/tables.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace bramah {

std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string as_text(const Table& table, std::string_view indent) {
  std::vector<std::size_t> widths;
  const auto measure = [&](const std::vector<std::string>& row) {
    if (widths.size() < row.size()) widths.resize(row.size(), 0);
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], width(row[k]));
  };
  measure(table.header);
  for (const auto& row : table.rows) measure(row);

  std::string out;
  const auto put = [&](const std::vector<std::string>& row) {
    std::string line(indent);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string padding(widths[k] - width(row[k]), ' ');
      const bool right = k < table.right.size() && table.right[k] == 'r';
      if (k > 0) line += "  ";
      line += right ? padding + row[k] : row[k] + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  };
  if (!table.header.empty()) {
    put(table.header);
    std::vector<std::string> rule;
    rule.reserve(widths.size());
    for (const std::size_t w : widths) rule.emplace_back(w, '-');
    put(rule);
  }
  for (const auto& row : table.rows) put(row);
  return out;
}

std::string short_number(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (value == 0.0) value = 0.0;  // no minus sign before a zero
  std::array<char, 40> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), written.ptr};
}

std::string with_unit(std::string_view number, std::string_view unit) {
  std::string text(number);
  if (!unit.empty() && unit != "1") text.append(" ").append(unit);
  return text;
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string duration(double seconds) {
  if (std::isnan(seconds)) return "-";
  if (seconds >= 100.0) return short_number(std::round(seconds), 9) + " s";
  if (seconds >= 1.0) return short_number(seconds, 3) + " s";
  if (seconds >= 1e-3) return short_number(1e3 * seconds, 3) + " ms";
  return short_number(1e6 * seconds, 3) + " us";
}

}  // namespace bramah
