// What is wrong with a scene, told so that the user can mend it: where, what was found, what was expected, what to do.
#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace bramah {

/// One fault of a scene. `pointer` is a JSON pointer into the scene, empty for the document as a whole.
struct Diagnostic {
  enum class Severity { error, warning };
  std::string code;      // stable, for tests and scripts: "unknown-key", "wrong-unit", ...
  std::string pointer;   // "/components/V2/volume"
  std::string found;     // "unknown key \"volum\" of hydraulics/hose"
  std::string expected;  // "one of: volume, V_h, B_h, B_oil"
  std::string remedy;    // "did you mean \"volume\"?"
  Severity severity = Severity::error;
  bool at_key = false;  // the place is the key itself, not its value
  long long byte = -1;  // set instead of `pointer` where the text could not be parsed (0-based)
};

/// "warning: /components/V2/volume: FOUND; expected EXPECTED; REMEDY", without a file position.
std::string one_line(const Diagnostic& diagnostic);

/// Every fault of a scene at once. `what()` joins the diagnostics without file positions.
class SceneError : public std::exception {
 public:
  explicit SceneError(std::vector<Diagnostic> diagnostics);
  explicit SceneError(Diagnostic diagnostic);
  [[nodiscard]] const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }
  [[nodiscard]] const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::vector<Diagnostic> diagnostics_;
  std::string what_;
};

/// The candidate most like `word` (Damerau-Levenshtein, at most a third of its length wrong), or "".
std::string closest(std::string_view word, const std::vector<std::string>& candidates);

/// `did you mean "x"?` for the closest candidate, or `fallback` where none is close.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates, std::string_view fallback);

/// `"a", "b", "c"` for messages; more than `most` items end in `... (12 in all)`.
std::string quoted_list(const std::vector<std::string>& items, std::size_t most = 12);

}  // namespace bramah
