// An analysis that cannot give an answer: where, what was found, what was expected, what to do. Names, never indices.
#pragma once

#include <stdexcept>
#include <string>

namespace bramah {

class AnalysisError : public std::runtime_error {
 public:
  AnalysisError(std::string analysis, std::string found, std::string expected, std::string remedy)
      : std::runtime_error(analysis + ": " + found + "; expected " + expected + "; " + remedy),
        analysis_(std::move(analysis)),
        found_(std::move(found)),
        expected_(std::move(expected)),
        remedy_(std::move(remedy)) {}
  [[nodiscard]] const std::string& analysis() const { return analysis_; }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] const std::string& expected() const { return expected_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }

 private:
  std::string analysis_, found_, expected_, remedy_;
};

}  // namespace bramah
