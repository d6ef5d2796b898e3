#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/json_scanner.hpp"
#include "io/read_scene.hpp"

namespace bramah {

namespace {

constexpr std::size_t most_printed = 100;

struct Found {
  bool is_there = false;
  std::size_t value = 0;  // its first byte; that of the key as long as no value follows
  std::size_t key = 0;
};
using Wanted = std::unordered_map<std::string, Found>;

// The pointer itself and everything around it, up to the document.
void want(Wanted& wanted, std::string path) {
  while (wanted.try_emplace(path).second && !path.empty()) {
    const std::size_t slash = path.rfind('/');
    path.resize(slash == std::string::npos ? 0 : slash);
  }
}

// False for the second of two equal keys: the first counts.
bool note(Found& found, const JsonScanner& scanner) {
  if (found.is_there && found.key != scanner.key_begin()) return false;
  found = {true, scanner.begin(), scanner.key_begin()};
  return true;
}

// One walk for all pointers; containers in which nothing is wanted are passed over.
void find_all(std::string_view text, Wanted& wanted) {
  JsonScanner scanner(text);
  std::string path;                  // of the innermost container that holds something wanted
  std::vector<std::size_t> lengths;  // of the paths around it, one for each open container on the way there
  for (;;) {
    const bool on_the_way = scanner.depth() == lengths.size();
    const JsonScanner::Event event = scanner.next();
    if (event == JsonScanner::Event::end) return;
    if (event == JsonScanner::Event::close) {
      if (on_the_way && !lengths.empty()) {
        path.resize(lengths.back());
        lengths.pop_back();
      }
      continue;
    }
    if (!on_the_way) continue;
    std::string child = lengths.empty() ? std::string{} : pointer(path, scanner.name());
    const auto entry = wanted.find(child);
    if (entry == wanted.end() || !note(entry->second, scanner)) continue;
    if (event != JsonScanner::Event::open) continue;
    lengths.push_back(path.size());
    path = std::move(child);
  }
}

std::size_t byte_of(const Wanted& wanted, const Diagnostic& diagnostic) {
  if (diagnostic.byte >= 0) return static_cast<std::size_t>(diagnostic.byte);
  std::string path = diagnostic.pointer;
  for (;;) {
    const auto entry = wanted.find(path);
    if (entry != wanted.end() && entry->second.is_there) {
      const bool exact = path.size() == diagnostic.pointer.size();
      return exact && diagnostic.at_key ? entry->second.key : entry->second.value;
    }
    const std::size_t slash = path.rfind('/');
    if (slash == std::string::npos) return 0;
    path.resize(slash);
  }
}

std::vector<Place> locate_all(std::string_view text, const std::vector<Diagnostic>& diagnostics) {
  Wanted wanted;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.byte < 0) want(wanted, diagnostic.pointer);
  }
  if (!wanted.empty()) find_all(text, wanted);
  std::vector<std::size_t> bytes;
  bytes.reserve(diagnostics.size());
  for (const Diagnostic& diagnostic : diagnostics) bytes.push_back(byte_of(wanted, diagnostic));
  return places(text, bytes);
}

// Scenes may come from strangers: a control character must neither break the line nor reach the terminal.
std::string printable(std::string_view text) {
  std::string shown;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F) {
      shown += c;
    } else if (c == '\n') {
      shown += "\\n";
    } else {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(byte));
      shown += escape.data();
    }
  }
  return shown;
}

std::string block(const Source& source, const Diagnostic& diagnostic, const Place& place) {
  std::string text = source.name.empty() ? "scene" : printable(source.name);
  const bool is_somewhere = diagnostic.byte >= 0 || !diagnostic.pointer.empty();
  if (is_somewhere && !source.text.empty()) {
    text += ':' + std::to_string(place.line) + ':' + std::to_string(place.column);
  }
  text += diagnostic.severity == Diagnostic::Severity::warning ? ": warning: " : ": error: ";
  text += printable(diagnostic.found);
  if (!diagnostic.code.empty()) text += "   [" + diagnostic.code + ']';
  text += '\n';
  const auto line = [&](std::string_view label, const std::string& content) {
    if (!content.empty()) text.append("  ").append(label).append(printable(content)) += '\n';
  };
  line("at        ", diagnostic.pointer);
  line("expected  ", diagnostic.expected);
  line("to do     ", diagnostic.remedy);
  return text;
}

}  // namespace

std::vector<Place> locate_all(const Source& source, const std::vector<Diagnostic>& diagnostics) {
  return locate_all(source.text, diagnostics);
}

Place locate(const Source& source, const Diagnostic& diagnostic) {
  return locate_all(source.text, {diagnostic}).front();
}

std::string render(const Source& source, const SceneError& error) {
  const std::vector<Diagnostic>& diagnostics = error.diagnostics();
  const std::vector<Place> where = locate_all(source.text, diagnostics);
  std::vector<std::size_t> order(diagnostics.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(where[a].line, where[a].column) < std::pair(where[b].line, where[b].column);
  });
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), most_printed); ++k)
    text += block(source, diagnostics[order[k]], where[order[k]]);
  if (order.size() > most_printed)
    text += "... and " + std::to_string(order.size() - most_printed) + " faults more (" + std::to_string(order.size()) +
            " in all)\n";
  return text;
}

std::string render(const Source& source, const AnalysisError& error) {
  return render(source, SceneError(error.diagnostic()));
}

}  // namespace bramah
