// Tables for the terminal: columns aligned, numbers to the right.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bramah {

struct Table {
  std::vector<std::string> header;  // may be empty
  std::vector<std::vector<std::string>> rows;
  std::string right;  // one letter a column: 'r' right, anything else left; missing letters: left
};

/// Two blanks between columns; the last column is not padded.
std::string as_text(const Table& table, std::string_view indent = "  ");

/// For people: `digits` significant ones, whatever the locale; "-" for NaN.
std::string short_number(double value, int digits = 6);
/// "80 mm": the unit left out where it is "1" or empty.
std::string with_unit(std::string_view number, std::string_view unit);
/// "1.23e-05 s" as "12.3 us".
std::string duration(double seconds);
/// A field of a CSV file: quoted where a comma, a quote or a line break asks for it (RFC 4180).
std::string csv_field(const std::string& text);
/// Columns of a terminal that a UTF-8 text takes, one each character.
std::size_t width(std::string_view text);

}  // namespace bramah
