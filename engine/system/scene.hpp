// A scene as data: what the user wrote, checked for syntax only and not yet for meaning.
//
// The reader (io/read_scene) makes it from JSON, tests and benches make it in code, `compile` gives it its meaning.
// A place in a scene is a JSON pointer ("/components/V2/volume"); the reader turns pointers into file:line:column when
// a message needs one, so nothing here carries positions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace bramah {

struct Member;

/// One JSON-like value. Objects keep the order in which their keys were written.
struct Value {
  using List = std::vector<Value>;
  using Object = std::vector<Member>;
  std::variant<std::monostate, bool, double, std::string, List, Object> data;

  Value() = default;
  Value(bool b);
  Value(double d);
  Value(int i);
  Value(const char* s);
  Value(std::string s);
  Value(List l);
  Value(Object o);

  [[nodiscard]] const bool* boolean() const { return std::get_if<bool>(&data); }
  [[nodiscard]] const double* number() const { return std::get_if<double>(&data); }
  [[nodiscard]] const std::string* text() const { return std::get_if<std::string>(&data); }
  [[nodiscard]] const List* list() const { return std::get_if<List>(&data); }
  [[nodiscard]] const Object* object() const { return std::get_if<Object>(&data); }
  [[nodiscard]] Object* object() { return std::get_if<Object>(&data); }

  /// The member `key` of an object; null for any other kind of value and for a missing key.
  [[nodiscard]] const Value* find(std::string_view key) const;
  [[nodiscard]] Value* find(std::string_view key);
  /// Sets or replaces the member `key`; a value that is not an object becomes one.
  void set(std::string_view key, Value value);
};

struct Member {
  std::string key;
  Value value;
};

// Here, because a list of members can be made and unmade only once Member is complete.
inline Value::Value(bool b) : data(b) {}
inline Value::Value(double d) : data(d) {}
inline Value::Value(int i) : data(static_cast<double>(i)) {}
inline Value::Value(const char* s) : data(std::string(s)) {}
inline Value::Value(std::string s) : data(std::move(s)) {}
inline Value::Value(List l) : data(std::move(l)) {}
inline Value::Value(Object o) : data(std::move(o)) {}

/// A short description for messages: `number 3.5`, `text "80 mm"`, `list of 3`, `object`, `true`, `null`.
std::string description(const Value& value);

/// The text a scene came from: only messages read it.
struct Source {
  std::string name;  // file name as given by the user; empty for scenes made in code
  std::string text;
};

struct Scene {
  Value root;  // an object: bramah, libraries, constants, components, start, hold, ...
  Source source;
};

/// `parent` + "/" + `key`, with the escapes of JSON pointers (RFC 6901).
std::string pointer(std::string_view parent, std::string_view key);
std::string pointer(std::string_view parent, std::size_t index);

/// Applies `--set path=text`: `component.parameter=value` or `section.key=value` (section: constants, start, simulate,
/// linearize, equilibrium, study, sweep, vary, or any other top-level object of the scene). The key is all that follows the
/// first dot: start.crank.angle sets "crank.angle" of start. The text is a number, true, false, a list of such in
/// brackets, "[-1.2 m, 0]", or else a string ("80 mm").
/// Unknown keys are left for `compile` to report; SceneError for a path without a dot or an equals sign, for a first word
/// that is neither a component nor a section, or is both, and for one that names no object.
void apply_setting(Scene& scene, std::string_view setting);

/// Puts what `--over PARAMETER=FROM:TO:COUNT` or `--over PARAMETER=A,B,C` say, once or twice, in the place of the section
/// "sweep". SceneError where they cannot be read; their meaning is judged by `compile`.
void apply_sweep(Scene& scene, const std::vector<std::string>& over);

}  // namespace bramah
