#include "docs/markdown.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace bramah::docs {
namespace {

namespace fs = std::filesystem;

const fs::path root = BRAMAH_SOURCE_DIR;

std::vector<std::string> all_matches(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace

bool Block::is(const std::string& language, const std::string& use) const {
  return words.size() >= 2 && words[0] == language && words[1] == use;
}

int Block::number(const std::string& name, int fallback) const {
  for (const std::string& word : words) {
    if (word.starts_with(name + "=")) return std::stoi(word.substr(name.size() + 1));
  }
  return fallback;
}

Document::Document(const fs::path& file) : file_(file) {
  std::istringstream in(contents(file));
  bool inside = false;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (!inside) continue;
      Block block;
      block.place = file.string() + ":" + std::to_string(number);
      std::istringstream words(line.substr(3));
      for (std::string word; words >> word;) block.words.push_back(word);
      blocks_.push_back(std::move(block));
    } else if (inside) {
      blocks_.back().text += line + '\n';
    } else {
      prose_.push_back({number, line});
    }
  }
  if (inside) throw std::runtime_error(file.string() + ": a block is not closed");
}

std::vector<std::string> Document::anchors() const {
  std::vector<std::string> found;
  for (const Line& line : prose_) {
    if (!line.text.starts_with("#")) continue;
    std::string anchor;
    for (const char c : trimmed(line.text.substr(line.text.find_first_not_of('#')))) {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') {
        anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      } else if (c == ' ') {
        anchor += '-';
      }
    }
    found.push_back(anchor);
  }
  return found;
}

std::vector<Document> documents() {
  std::vector<fs::path> files = {"README.md", "CHANGELOG.md", "CONTRIBUTING.md"};
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs"))
    files.push_back(entry.path().lexically_relative(root));
  for (const char* folder : {"plugins", "components"}) {
    for (const auto& entry : fs::directory_iterator(root / folder)) {
      files.push_back(entry.path().lexically_relative(root) / "README.md");
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<Document> result;
  for (const fs::path& file : files) {
    if (file.extension() == ".md" && fs::exists(root / file)) result.emplace_back(file);
  }
  return result;
}

std::vector<std::string> code_words(const std::string& line) {
  static const std::regex code("`([^`]+)`");
  return all_matches(line, code);
}

std::vector<std::string> links(const std::string& line) {
  static const std::regex code("`[^`]*`"), link(R"(\]\(([^) ]+)\))");
  return all_matches(std::regex_replace(line, code, ""), link);
}

std::vector<std::string> cells(const std::string& line) {
  if (!line.starts_with("|")) return {};
  std::vector<std::string> found;
  std::istringstream in(line.substr(1));
  for (std::string cell; std::getline(in, cell, '|');) found.push_back(trimmed(cell));
  return found;
}

std::string contents(const fs::path& file) {
  std::ifstream in(root / file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace bramah::docs
