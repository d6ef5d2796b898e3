// As much Markdown as the documentation's tests need: fenced blocks, links, headings, tables.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace bramah::docs {

/// A fenced block: "```json scene" has the words {"json", "scene"}.
struct Block {
  std::string place;  // "docs/scenes.md:12"
  std::vector<std::string> words;
  std::string text;
  [[nodiscard]] bool is(const std::string& language, const std::string& use) const;
  /// The number in a word "NAME=3"; `fallback` where there is none.
  [[nodiscard]] int number(const std::string& name, int fallback) const;
};

struct Line {
  std::size_t number;
  std::string text;
};

class Document {
 public:
  /// `file` relative to the repository.
  explicit Document(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  /// Lines outside fenced blocks.
  [[nodiscard]] const std::vector<Line>& prose() const { return prose_; }
  [[nodiscard]] std::string place(const Line& line) const { return file_.string() + ":" + std::to_string(line.number); }
  /// What links to a heading end in: "Error weights" is "error-weights".
  [[nodiscard]] std::vector<std::string> anchors() const;

 private:
  std::filesystem::path file_;
  std::vector<Block> blocks_;
  std::vector<Line> prose_;
};

/// README.md, CHANGELOG.md, CONTRIBUTING.md, docs/ and the README of each plugin and library.
std::vector<Document> documents();

/// All `code` of a line.
std::vector<std::string> code_words(const std::string& line);
/// Targets of [text](target), those within `code` left out.
std::vector<std::string> links(const std::string& line);
/// Cells of "| a | b |", trimmed; empty where the line is no row of a table.
std::vector<std::string> cells(const std::string& line);

/// The whole text of a file, relative to the repository.
std::string contents(const std::filesystem::path& file);

}  // namespace bramah::docs
