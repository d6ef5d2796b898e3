#include "system/diagnostic.hpp"

#include <algorithm>
#include <utility>

namespace bramah {

std::string one_line(const Diagnostic& diagnostic) {
  std::string line = diagnostic.severity == Diagnostic::Severity::warning ? "warning: " : "";
  if (!diagnostic.pointer.empty()) line += diagnostic.pointer + ": ";
  line += diagnostic.found;
  if (!diagnostic.expected.empty()) line += "; expected " + diagnostic.expected;
  if (!diagnostic.remedy.empty()) line += "; " + diagnostic.remedy;
  return line;
}

namespace {

std::string joined(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!text.empty()) text += '\n';
    text += one_line(diagnostic);
  }
  return text;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Two costs in one number: wrong letters count 1000, letters in the wrong case 1. So "d_2" finds "D_2", and a
// candidate in the right case wins.
constexpr std::size_t kWrong = 1000;

std::size_t substitution(char a, char b) {
  if (a == b) return 0;
  return lower(a) == lower(b) ? 1 : kWrong;
}

// Damerau-Levenshtein in the variant that edits no substring twice.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j * kWrong;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, last);
    std::swap(last, row);
    row[0] = i * kWrong;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + kWrong, row[j - 1] + kWrong, last[j - 1] + substitution(a[i - 1], b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + kWrong);
    }
  }
  return row[b.size()];
}

}  // namespace

SceneError::SceneError(std::vector<Diagnostic> diagnostics)
    : diagnostics_(std::move(diagnostics)), what_(joined(diagnostics_)) {}

SceneError::SceneError(Diagnostic diagnostic) : SceneError(std::vector<Diagnostic>{std::move(diagnostic)}) {}

std::string closest(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr std::size_t longest_word = 200;  // a hostile name is not worth a long search
  if (word.empty() || word.size() > longest_word) return {};
  const std::string* best = nullptr;
  std::size_t least = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(word.size(), candidate.size());
    const std::size_t allowed = longer / 3;
    if (longer - std::min(word.size(), candidate.size()) > allowed) continue;
    const std::size_t cost = distance(word, candidate);
    if (cost / kWrong <= allowed && (best == nullptr || cost < least)) {
      best = &candidate;
      least = cost;
    }
  }
  return best == nullptr ? std::string{} : *best;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& candidates, std::string_view fallback) {
  const std::string candidate = closest(word, candidates);
  return candidate.empty() ? std::string(fallback) : "did you mean \"" + candidate + "\"?";
}

std::string quoted_list(const std::vector<std::string>& items, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < std::min(most, items.size()); ++i) {
    if (i > 0) text += ", ";
    text += '"' + items[i] + '"';
  }
  if (items.size() <= most) return text;
  return text + (most > 0 ? ", " : "") + "... (" + std::to_string(items.size()) + " in all)";
}

}  // namespace bramah
