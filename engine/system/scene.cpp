#include "system/scene.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "system/diagnostic.hpp"
#include "system/units.hpp"

namespace bramah {

const Value* Value::find(std::string_view key) const {
  const Object* members = object();
  if (members == nullptr) return nullptr;
  const auto found = std::find_if(members->begin(), members->end(), [&](const Member& m) { return m.key == key; });
  return found == members->end() ? nullptr : &found->value;
}

Value* Value::find(std::string_view key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

void Value::set(std::string_view key, Value value) {
  if (Value* present = find(key)) {
    *present = std::move(value);
    return;
  }
  if (object() == nullptr) data = Object{};
  object()->push_back({std::string(key), std::move(value)});
}

namespace {

std::string shortened(std::string_view text) {
  constexpr std::size_t longest = 60;
  if (text.size() <= longest) return std::string(text);
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // not inside a character
  return std::string(text.substr(0, end)) + "...";
}

std::string shortest(double number) {
  std::array<char, 32> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  return {digits.data(), written.ptr};
}

struct Describe {
  std::string operator()(std::monostate) const { return "null"; }
  std::string operator()(bool b) const { return b ? "true" : "false"; }
  std::string operator()(double d) const { return "number " + shortest(d); }
  std::string operator()(const std::string& s) const { return "text \"" + shortened(s) + '"'; }
  std::string operator()(const Value::List& l) const { return "list of " + std::to_string(l.size()); }
  std::string operator()(const Value::Object&) const { return "object"; }
};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

Value scalar_from(std::string_view text) {
  if (text == "true") return true;
  if (text == "false") return false;
  const std::optional<Quantity> quantity = parse_quantity(text);
  if (quantity && quantity->unit.empty()) return quantity->value;
  return std::string(text);
}

/// [a, b, ...] is a list of numbers and texts, "80 mm" among them, with or without quotation marks.
Value value_from(std::string_view text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return scalar_from(text);
  Value::List list;
  const std::string_view inside = trimmed(text.substr(1, text.size() - 2));
  if (inside.empty()) return list;
  for (std::string_view item : split(inside, ',')) {
    if (item.size() >= 2 && item.front() == '"' && item.back() == '"') item = item.substr(1, item.size() - 2);
    list.push_back(scalar_from(item));
  }
  return list;
}

constexpr auto kSections =
    std::to_array<std::string_view>({"constants", "start", "assembly", "simulate", "linearize", "equilibrium", "study",
                                     "sweep", "vary", "modes", "compare"});

bool is_section(const Scene& scene, std::string_view word) {
  return std::find(kSections.begin(), kSections.end(), word) != kSections.end() || scene.root.find(word) != nullptr;
}

[[noreturn]] void refuse(std::string code, std::string found, std::string expected, std::string remedy) {
  Diagnostic diagnostic;
  diagnostic.code = std::move(code);
  diagnostic.found = std::move(found);
  diagnostic.expected = std::move(expected);
  diagnostic.remedy = std::move(remedy);
  throw SceneError(std::move(diagnostic));
}

[[noreturn]] void refuse_word(const Scene& scene, const std::string& quoted, std::string_view word) {
  std::vector<std::string> known(kSections.begin(), kSections.end());
  std::vector<std::string> names;
  const Value* components = scene.root.find("components");
  if (components != nullptr && components->object() != nullptr) {
    for (const Member& member : *components->object()) names.push_back(member.key);
  }
  std::string expected = "a section (" + quoted_list(known) + ")";
  if (!names.empty()) expected = "a component (" + quoted_list(names) + ") or " + expected;
  known.insert(known.begin(), names.begin(), names.end());
  refuse("unknown-setting", quoted + ": the scene has no component or section \"" + std::string(word) + '"',
         std::move(expected), suggestion(word, known, "name one of these before the first dot"));
}

// The object that the first word of a setting names. References stay valid until the scene changes.
Value& target_of(Scene& scene, const std::string& quoted, std::string_view word, std::string_view rest) {
  Value* components = scene.root.find("components");
  Value* component = components == nullptr ? nullptr : components->find(word);
  const std::string name(word);
  if (component != nullptr && is_section(scene, word)) {
    refuse("ambiguous-setting", quoted + ": \"" + name + "\" is a component and a section",
           "a word with one meaning before the first dot", "rename the component");
  }
  if (component == nullptr && word == "components") {
    refuse("unknown-setting", quoted + " begins with \"components\"", "component.parameter=value",
           "write \"" + std::string(rest) + "=...\"");
  }
  if (component == nullptr && !is_section(scene, word)) refuse_word(scene, quoted, word);
  Value* target = component != nullptr ? component : scene.root.find(word);
  if (target == nullptr) {
    scene.root.set(word, Value::Object{});
    target = scene.root.find(word);
  }
  if (target->object() == nullptr) {
    refuse("wrong-kind", quoted + ": \"" + name + "\" is " + description(*target),
           "an object, whose members can be set", "change \"" + name + "\" in the scene itself");
  }
  return *target;
}

}  // namespace

std::string description(const Value& value) { return std::visit(Describe{}, value.data); }

std::string pointer(std::string_view parent, std::string_view key) {
  std::string path;
  path.reserve(parent.size() + key.size() + 1);
  path += parent;
  path += '/';
  for (const char c : key) {
    if (c == '~')
      path += "~0";
    else if (c == '/')
      path += "~1";
    else
      path += c;
  }
  return path;
}

std::string pointer(std::string_view parent, std::size_t index) { return pointer(parent, std::to_string(index)); }

void apply_setting(Scene& scene, std::string_view setting) {
  const std::string quoted = "setting \"" + shortened(setting) + '"';
  const std::string form = "component.parameter=value or section.key=value";
  const std::size_t equals = setting.find('=');
  if (equals == std::string_view::npos) {
    refuse("bad-setting", quoted + " has no equals sign", form, "write the value after \"=\"");
  }
  const std::string_view path = trimmed(setting.substr(0, equals));
  const std::size_t dot = path.find('.');
  if (dot == std::string_view::npos) {
    refuse("bad-setting", quoted + " has no dot before its equals sign", form, "name what is to be set after a dot");
  }
  const std::string_view word = path.substr(0, dot);
  const std::string_view rest = path.substr(dot + 1);
  if (word.empty() || rest.empty()) {
    refuse("bad-setting", quoted + " has nothing " + (word.empty() ? "before" : "after") + " its dot", form,
           "complete the path");
  }
  Value& target = target_of(scene, quoted, word, rest);
  target.set(rest, value_from(trimmed(setting.substr(equals + 1))));
}

namespace {

Value swept_from(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view range = equals == std::string_view::npos ? "" : trimmed(text.substr(equals + 1));
  if (range.empty() || equals == 0) {
    refuse("bad-sweep", "--over \"" + shortened(text) + "\" names no parameter with its values",
           "PARAMETER=FROM:TO, PARAMETER=FROM:TO:COUNT or PARAMETER=A,B,C",
           "write for instance --over \"constants.v=1:9:41\"");
  }
  Value over{Value::Object{}};
  over.set("parameter", std::string(trimmed(text.substr(0, equals))));
  const std::vector<std::string_view> ends = split(range, ':');
  if (ends.size() == 1) {
    Value::List values;
    for (const std::string_view value : split(range, ',')) values.push_back(value_from(value));
    over.set("values", std::move(values));
    return over;
  }
  if (ends.size() > 3) {
    refuse("bad-sweep", "--over \"" + shortened(text) + "\" has more than FROM:TO:COUNT", "at most two colons",
           "give a count, not a step, after the second colon");
  }
  over.set("from", value_from(ends[0]));
  over.set("to", value_from(ends[1]));
  if (ends.size() == 3) over.set("count", value_from(ends[2]));
  return over;
}

}  // namespace

void apply_sweep(Scene& scene, const std::vector<std::string>& over) {
  if (over.empty()) return;
  if (over.size() > 2) {
    refuse("bad-sweep", "--over is given " + std::to_string(over.size()) + " times", "one parameter, or two for a grid",
           "sweep the others in runs of their own");
  }
  Value sweep = swept_from(over.front());
  if (over.size() == 2) sweep.set("second", swept_from(over.back()));
  scene.root.set("sweep", std::move(sweep));
}

}  // namespace bramah
