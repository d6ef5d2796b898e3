// JSON text to Value, with the errors of syntax told as faults of a scene. For io, and for what reads its results.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "system/diagnostic.hpp"
#include "system/scene.hpp"

namespace bramah {

using Faults = std::vector<Diagnostic>;

inline Diagnostic fault(std::string code, std::string found, std::string expected, std::string remedy) {
  Diagnostic diagnostic;
  diagnostic.code = std::move(code);
  diagnostic.found = std::move(found);
  diagnostic.expected = std::move(expected);
  diagnostic.remedy = std::move(remedy);
  return diagnostic;
}

inline std::string in_quotes(std::string_view text) { return '"' + std::string(text) + '"'; }

/// Reads `text` into `root` as far as its syntax allows and appends what is wrong with it: syntax, repeated keys, numbers
/// out of range, nesting deeper than 64. True where all of it was read.
bool parse_json(std::string_view text, Value& root, Faults& faults);

/// Appends the numbers of a list; false where it is none, or holds anything else.
bool read_numbers(const Value& list, std::vector<double>& numbers);

}  // namespace bramah
