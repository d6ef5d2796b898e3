// How the program ends when it cannot do what was asked, and how it says so.
#pragma once

#include <exception>
#include <string>
#include <vector>

#include "io/output_file.hpp"
#include "system/analysis_error.hpp"
#include "system/diagnostic.hpp"
#include "system/scene.hpp"

namespace bramah {

enum ExitCode : int {
  exit_ok = 0,
  exit_analysis = 1,      // the scene is sound, but this analysis has no answer
  exit_scene = 2,         // the scene is wrong
  exit_usage = 3,         // the command line is wrong
  exit_write = 4,         // results cannot be written
  exit_interrupted = 130  // Ctrl-C; results so far are kept
};

class Failure : public std::exception {
 public:
  /// One fault and its place; line 0: none.
  struct Entry {
    std::string file;
    std::size_t line = 0, column = 0;
    Diagnostic diagnostic;
  };
  Failure(ExitCode code, const char* kind) : code_(code), kind_(kind) {}

  /// Faults of a scene; those in values that came from --set are reported there.
  static Failure scene(const Source& source, const SceneError& error, const std::vector<std::string>& settings);
  /// With the place of the component to look at, where the scene has a text.
  static Failure analysis(const Source& source, const AnalysisError& error);
  static Failure usage(std::string found, std::string expected, std::string remedy);
  static Failure write(const WriteError& error);
  static Failure unexpected(const std::string& what);

  [[nodiscard]] ExitCode code() const { return code_; }
  [[nodiscard]] const char* what() const noexcept override { return text_.c_str(); }
  /// Blocks as of `render`.
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// {"error": {...}}
  [[nodiscard]] std::string document() const;

 private:
  void add(const Source& source, const std::vector<Diagnostic>& diagnostics);
  ExitCode code_;
  std::string kind_, text_;
  std::vector<Entry> entries_;
};

}  // namespace bramah
