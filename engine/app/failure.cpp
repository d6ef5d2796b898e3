#include "app/failure.hpp"

#include <utility>

#include "io/json_writer.hpp"
#include "io/read_scene.hpp"

namespace bramah {
namespace {

Diagnostic diagnostic(std::string code, std::string found, std::string expected, std::string remedy) {
  Diagnostic d;
  d.code = std::move(code);
  d.found = std::move(found);
  d.expected = std::move(expected);
  d.remedy = std::move(remedy);
  return d;
}

/// Whether the fault lies in the value that `setting` put into the scene.
bool came_from(const std::string& setting, const std::string& fault_pointer) {
  const std::size_t dot = setting.find('.'), equals = setting.find('=');
  if (dot == std::string::npos || equals == std::string::npos || dot > equals) return false;
  const std::string word = setting.substr(0, dot), key = setting.substr(dot + 1, equals - dot - 1);
  return fault_pointer == pointer(pointer("/components", word), key) ||
         fault_pointer == pointer(pointer("", word), key);
}

}  // namespace

void Failure::add(const Source& source, const std::vector<Diagnostic>& diagnostics) {
  const std::vector<Place> places = locate_all(source, diagnostics);
  for (std::size_t k = 0; k < diagnostics.size(); ++k) {
    const Diagnostic& d = diagnostics[k];
    Entry entry{source.name, 0, 0, d};
    if (!source.text.empty() && (d.byte >= 0 || !d.pointer.empty())) {
      entry.line = places[k].line;
      entry.column = places[k].column;
    }
    entries_.push_back(std::move(entry));
  }
}

Failure Failure::scene(const Source& source, const SceneError& error, const std::vector<std::string>& settings) {
  Failure failure(exit_scene, "scene");
  std::vector<Diagnostic> of_file;
  std::string of_settings;
  for (const Diagnostic& d : error.diagnostics()) {
    const std::string* origin = nullptr;
    for (const std::string& setting : settings) {
      if (came_from(setting, d.pointer)) origin = &setting;
    }
    if (origin == nullptr) {
      of_file.push_back(d);
      continue;
    }
    const Source command_line{"--set " + *origin, ""};
    failure.add(command_line, {d});
    of_settings += render(command_line, SceneError(d));
  }
  failure.add(source, of_file);
  if (!of_file.empty()) failure.text_ = render(source, SceneError(of_file));
  failure.text_ += of_settings;
  return failure;
}

Failure Failure::analysis(const Source& source, const AnalysisError& error) {
  Failure failure(exit_analysis, "analysis");
  failure.add(source, {error.diagnostic()});
  failure.text_ = render(source, error);
  return failure;
}

Failure Failure::usage(std::string found, std::string expected, std::string remedy) {
  Failure failure(exit_usage, "usage");
  const Diagnostic d = diagnostic("usage", std::move(found), std::move(expected), std::move(remedy));
  failure.add({"bramah", ""}, {d});
  failure.text_ = render({"bramah", ""}, SceneError(d));
  return failure;
}

Failure Failure::write(const WriteError& error) {
  Failure failure(exit_write, "write");
  const Diagnostic d = diagnostic("cannot-write", error.found(), "room and permission to write it", error.remedy());
  failure.add({error.file().string(), ""}, {d});
  failure.text_ = render({error.file().string(), ""}, SceneError(d));
  return failure;
}

Failure Failure::unexpected(const std::string& what) {
  Failure failure(exit_analysis, "unexpected");
  const Diagnostic d = diagnostic("unexpected", what, "",
                                  "if the scene is not extraordinarily large, please report this with the scene");
  failure.add({"bramah", ""}, {d});
  failure.text_ = render({"bramah", ""}, SceneError(d));
  return failure;
}

std::string Failure::document() const {
  JsonWriter json;
  json.begin_object().key("error").begin_object();
  json.member("kind", kind_.c_str()).member("exit_code", static_cast<int>(code_));
  json.key("diagnostics").begin_list();
  for (const Entry& entry : entries_) {
    const Diagnostic& d = entry.diagnostic;
    json.begin_object();
    json.member("severity", d.severity == Diagnostic::Severity::warning ? "warning" : "error").member("code", d.code);
    json.member("file", entry.file);
    entry.line > 0 ? json.member("line", entry.line) : json.key("line").null();
    entry.line > 0 ? json.member("column", entry.column) : json.key("column").null();
    json.member("pointer", d.pointer).member("found", d.found);
    json.member("expected", d.expected).member("remedy", d.remedy).end_object();
  }
  json.end_list().end_object().end_object();
  return json.take();
}

}  // namespace bramah
