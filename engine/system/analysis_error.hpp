// An analysis that cannot give an answer: where, what was found, what was expected, what to do. Names, never indices.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "system/diagnostic.hpp"

namespace bramah {

class AnalysisError : public std::runtime_error {
 public:
  /// `pointer`: the component or key of the scene to look at, as a JSON pointer; empty where there is no single one.
  AnalysisError(std::string analysis, std::string found, std::string expected, std::string remedy,
                std::string pointer = {})
      : std::runtime_error(analysis + ": " + found + "; expected " + expected + "; " + remedy),
        analysis_(std::move(analysis)),
        found_(std::move(found)),
        expected_(std::move(expected)),
        remedy_(std::move(remedy)),
        pointer_(std::move(pointer)) {}
  [[nodiscard]] const std::string& analysis() const { return analysis_; }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] const std::string& expected() const { return expected_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }
  [[nodiscard]] const std::string& pointer() const { return pointer_; }

  /// The same as a fault of a scene, for io's `render`.
  [[nodiscard]] Diagnostic diagnostic() const {
    Diagnostic d;
    d.code = "analysis-failed";
    d.pointer = pointer_;
    d.found = analysis_ + ": " + found_;
    d.expected = expected_;
    d.remedy = remedy_;
    d.at_key = true;
    return d;
  }

 private:
  std::string analysis_, found_, expected_, remedy_, pointer_;
};

}  // namespace bramah
