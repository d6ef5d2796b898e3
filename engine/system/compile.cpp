#include "system/compile.hpp"

#include <algorithm>
#include <cstdio>

#include "system/compiler.hpp"

namespace bramah {
namespace compiling {

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string with_unit(double value, std::string_view unit) {
  return number_text(value) + (unit.empty() || unit == "1" ? "" : " " + std::string(unit));
}

void Faults::add(std::string code, std::string where, std::string found, std::string expected, std::string remedy,
                 bool at_key) {
  list.push_back({std::move(code), std::move(where), std::move(found), std::move(expected), std::move(remedy),
                  Diagnostic::Severity::error, at_key});
}

void Faults::warn(std::string code, std::string where, std::string found, std::string expected, std::string remedy) {
  warnings.push_back({std::move(code), std::move(where), std::move(found), std::move(expected), std::move(remedy),
                      Diagnostic::Severity::warning});
}

namespace {

std::string unescaped(std::string_view key) {
  std::string text;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const bool escape = key[i] == '~' && i + 1 < key.size();
    text += escape ? (key[++i] == '1' ? '/' : '~') : key[i];
  }
  return text;
}

}  // namespace

std::string named(const std::string& where) {
  std::string rest = where;
  bool element = false;
  for (;;) {
    const std::size_t slash = rest.rfind('/');
    if (slash == std::string::npos) return "the value";
    const std::string key = rest.substr(slash + 1);
    if (key.empty() || key.find_first_not_of("0123456789") != std::string::npos) {
      return (element ? "an element of \"" : "\"") + unescaped(key) + '"';
    }
    element = true;
    rest.resize(slash);
  }
}

std::vector<std::string> related(std::string_view word, const std::vector<std::string>& names) {
  const std::string_view component = word.substr(0, word.find('.'));
  std::vector<std::string> list;
  for (const std::string& name : names) {
    if (name.size() > component.size() && name[component.size()] == '.' && name.starts_with(component))
      list.push_back(name);
  }
  return list.empty() ? names : list;
}

Compiled Compiler::run() {
  load_libraries();
  numbers_.read_constants(scene_.root.find("constants"));
  read_components();
  if (drafts_.empty()) stop_if_faulty();
  make_instances();
  number_variables();
  connect();
  read_start();
  read_options(scene_.root, compiled_.system, numbers_, faults_, compiled_.options);
  numbers_.report_unused(scene_.root);
  stop_if_faulty();
  make_patterns();
  check_structure();
  stop_if_faulty();
  take_scales(system());
  set_assembly_tolerance();
  keep_origins();
  system().registry = registry_;
  compiled_.warnings = std::move(faults_.warnings);
  return std::move(compiled_);
}

void Compiler::set_assembly_tolerance() {
  constexpr double nine_digits = 1e-8, most = 1e-3;  // of the machine's length
  const double given = compiled_.options.assembly.tolerance, length = system().scales.length;
  if (given > most * length) {
    faults_.add("out-of-range", "/assembly/tolerance", "\"tolerance\" is " + with_unit(given, "m"),
                "at most " + with_unit(most * length, "m") + ", a thousandth of the machine's length",
                "correct the points and axes of the joints instead");
    stop_if_faulty();
  }
  system().assembly_tolerance = given > 0.0 ? given : nine_digits * length;
}

void Compiler::stop_if_faulty() {
  if (faults_.list.empty() && earlier_.empty()) return;
  std::vector<Diagnostic> all = std::move(earlier_);
  const std::size_t before = all.size();
  for (Diagnostic& fault : faults_.list) {
    const auto same = [&](const Diagnostic& d) { return d.byte < 0 && d.pointer == fault.pointer; };
    if (std::none_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(before), same))
      all.push_back(std::move(fault));
  }
  throw SceneError(std::move(all));
}

void Compiler::load_libraries() {
  const Value* libraries = scene_.root.find("libraries");
  if (libraries == nullptr || libraries->list() == nullptr) {
    const bool misspelt = std::any_of(earlier_.begin(), earlier_.end(), [](const Diagnostic& d) {
      return d.code == "unknown-key" && !closest(d.pointer.substr(1), {"libraries"}).empty();
    });
    libraries_unread_ = libraries != nullptr || misspelt;
    return;
  }
  std::size_t index = 0;
  for (const Value& name : *libraries->list()) {
    const std::string where = pointer("/libraries", index++);
    if (name.text() == nullptr) {
      faults_.add("wrong-kind", where, named(where) + " is " + description(name), "the name of a library",
                  "put it in double quotes");
      continue;
    }
    if (std::find(libraries_.begin(), libraries_.end(), *name.text()) != libraries_.end()) {
      faults_.add("repeated", where, "library \"" + *name.text() + "\" a second time", "each library once",
                  "remove one");
      continue;
    }
    libraries_.push_back(*name.text());
    try {
      registry_->load(*name.text());
    } catch (const PluginError& error) {
      faults_.add(error.code(), where, error.found(), error.expected(), error.remedy());
      broken_libraries_.insert(*name.text());
    }
  }
}

void Compiler::read_components() {
  const Value* components = scene_.root.find("components");
  if (components == nullptr || components->object() == nullptr || components->object()->empty()) {
    faults_.add("no-components", components == nullptr ? "" : "/components", "no components", "at least one component",
                "describe the machine under \"components\"");
    return;
  }
  drafts_.reserve(components->object()->size());
  for (const Member& member : *components->object()) {
    Draft draft;
    draft.name = member.key;
    draft.where = pointer("/components", member.key);
    draft.value = &member.value;
    find_type(draft);
    if (draft.type != nullptr) {
      read_parameters(draft);
    } else {
      faults_.unread.insert(draft.name);
    }
    by_name_.emplace(draft.name, drafts_.size());
    drafts_.push_back(std::move(draft));
  }
}

}  // namespace compiling

Compiled compile(const Scene& scene, std::shared_ptr<Registry> registry, std::vector<Diagnostic> earlier) {
  return compiling::Compiler(scene, std::move(registry), std::move(earlier)).run();
}

}  // namespace bramah
