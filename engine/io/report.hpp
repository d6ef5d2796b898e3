// A page of results that stands alone: text, tables and figures in one HTML file, nothing loaded from elsewhere.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "io/tables.hpp"

namespace bramah {

class Report {
 public:
  Report(std::string title, std::string description) : title_(std::move(title)), description_(std::move(description)) {}

  /// Label and value in large type, in a row.
  void facts(const std::vector<std::pair<std::string, std::string>>& list);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  void table(const Table& table, const std::string& caption = "");
  /// One <svg> element, as of plot::svg.
  void figure(const std::string& svg, const std::string& caption = "");
  /// The same side by side where the window is wide enough.
  void figures(const std::vector<std::string>& svgs);

  /// `footer`: the last line of the page.
  [[nodiscard]] std::string html(const std::string& footer) const;

 private:
  std::string title_, description_, body_;
};

}  // namespace bramah
