#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "system/compile_parts.hpp"

namespace bramah {
namespace {

using namespace compiling;

/// Names and finders of one kind of measurement, visited in a fixed order.
void visit_measured(const System& s, const std::function<bool(const Measured&)>& visit) {
  const auto each = [&](Measured::Kind kind, Index count, auto&& name, auto&& unit) {
    for (Index i = 0; i < count; ++i) {
      if (!visit({kind, i, name(static_cast<std::size_t>(i)), unit(static_cast<std::size_t>(i))})) return false;
    }
    return true;
  };
  using K = Measured::Kind;
  using std::size_t;
  each(
      K::x, s.n(), [&](size_t i) { return s.x[i].name; }, [&](size_t i) { return s.x[i].unit; }) &&
      each(
          K::v, s.n(), [&](size_t i) { return s.x[i].name + ".rate"; },
          [&](size_t i) { return rate_unit(s.x[i].unit); }) &&
      each(
          K::a, s.n(), [&](size_t i) { return s.x[i].name + ".acceleration"; },
          [&](size_t i) { return s.x[i].unit == "1" ? std::string("1/s^2") : s.x[i].unit + "/s^2"; }) &&
      each(
          K::z, s.nz(), [&](size_t i) { return s.z[i].name; }, [&](size_t i) { return s.z[i].unit; }) &&
      each(
          K::zdot, s.nz(), [&](size_t i) { return s.z[i].name + ".rate"; },
          [&](size_t i) { return rate_unit(s.z[i].unit); }) &&
      each(
          K::lambda, s.m() + s.l(), [&](size_t i) { return s.multiplier_name(static_cast<Index>(i)); },
          [&](size_t i) { return s.multiplier_unit(static_cast<Index>(i)); }) &&
      each(
          K::y, s.ny(), [&](size_t i) { return s.outputs[i].name; }, [&](size_t i) { return s.outputs[i].unit; }) &&
      each(
          K::input, s.nu(), [&](size_t i) { return s.inputs[i].name; }, [&](size_t i) { return s.inputs[i].unit; });
}

}  // namespace

bool find_measured(const System& system, std::string_view name, Measured& found) {
  bool success = false;
  visit_measured(system, [&](const Measured& candidate) {
    if (candidate.name != name) return true;
    found = candidate;
    success = true;
    return false;
  });
  return success;
}

std::vector<std::string> measured_names(const System& system) {
  std::vector<std::string> names;
  visit_measured(system, [&](const Measured& candidate) {
    names.push_back(candidate.name);
    return true;
  });
  return names;
}

namespace compiling {
namespace {

class OptionReader {
 public:
  OptionReader(const System& system, Numbers& numbers, Faults& faults)
      : system_(system), numbers_(numbers), faults_(faults) {}

  /// Calls `key(member, where)` for each member of the section; keys it does not take are faults.
  void section(const Value& root, std::string_view name, const std::vector<std::string>& keys,
               const std::function<void(const std::string&, const Value&, const std::string&)>& take) {
    const Value* value = root.find(name);
    if (value != nullptr) members(*value, "/" + std::string(name), name, keys, take);
  }

  /// The same for the members of one object at `place`.
  void members(const Value& object, const std::string& place, std::string_view name,
               const std::vector<std::string>& keys,
               const std::function<void(const std::string&, const Value&, const std::string&)>& take) {
    if (object.object() == nullptr) return;
    for (const Member& member : *object.object()) {
      const std::string where = pointer(place, member.key);
      if (std::find(keys.begin(), keys.end(), member.key) == keys.end()) {
        faults_.add("unknown-key", where, "unknown key \"" + member.key + "\" of section \"" + std::string(name) + "\"",
                    "one of: " + quoted_list(keys), suggestion(member.key, keys, "remove it"), true);
        continue;
      }
      take(member.key, member.value, where);
    }
  }

  void number(const Value& value, const std::string& where, std::string_view unit, double least, double& result,
              bool strictly) {
    const auto read = numbers_.read(value, where, unit);
    if (!read) return;
    if (*read < least || (strictly && *read == least)) {
      faults_.add("out-of-range", where, named(where) + " is " + with_unit(*read, unit),
                  (strictly ? "above " : "at least ") + with_unit(least, unit), "correct the number, or its unit");
      return;
    }
    result = *read;
  }

  void flag(const Value& value, const std::string& where, bool& result) {
    if (value.boolean() != nullptr) {
      result = *value.boolean();
    } else {
      faults_.add("wrong-kind", where, named(where) + " is " + description(value), "true or false",
                  "write one of them");
    }
  }

  void numbers(const Value& value, const std::string& where, std::string_view unit, std::vector<double>& result) {
    if (value.list() == nullptr) {
      faults_.add("wrong-kind", where, named(where) + " is " + description(value),
                  "a list of numbers" + (unit == "1" ? std::string() : " in " + std::string(unit)),
                  "write [a, b, ...]");
      return;
    }
    std::size_t k = 0;
    for (const Value& item : *value.list()) {
      if (const auto read = numbers_.read(item, pointer(where, k++), unit)) result.push_back(*read);
    }
  }

  template <class Enum>
  void word(const Value& value, const std::string& where, const std::vector<std::pair<std::string, Enum>>& words,
            Enum& result) {
    std::vector<std::string> known;
    for (const auto& [text, meaning] : words) {
      known.push_back(text);
      if (value.text() != nullptr && *value.text() == text) {
        result = meaning;
        return;
      }
    }
    faults_.add("wrong-choice", where, named(where) + " is " + description(value), "one of: " + quoted_list(known),
                value.text() == nullptr ? "write one of these words"
                                        : suggestion(*value.text(), known, "write one of these words"));
  }

  /// Conditions: {NAME: {"of": MEASUREMENT, "rises_above" | "falls_below": LEVEL, "stop": true, "hold": {INPUT: VALUE}}}.
  void events(const Value& list, const std::string& place, std::vector<EventOptions>& events);

  /// The section "sweep", or its member "second".
  void swept(const Value& root, const Value& section, const std::string& place, std::vector<SweptParameter>& over);

  /// The section "vary".
  void vary(const Value& root, const std::vector<Measured>& outputs, VaryOptions& vary);

  /// Names of x or z variables.
  void variables(const Value& list, const std::string& where, std::vector<Index>& x, std::vector<Index>* z) {
    if (list.list() == nullptr) {
      faults_.add("wrong-kind", where, named(where) + " is " + description(list), "a list of names of variables",
                  list.text() == nullptr ? "write [\"component.variable\"]" : "put it in brackets: [ ... ]");
      return;
    }
    std::size_t k = 0;
    for (const Value& item : *list.list()) {
      const std::string here = pointer(where, k++);
      if (item.text() == nullptr) {
        faults_.add("wrong-kind", here, named(here) + " is " + description(item), "the name of a variable",
                    "put it in double quotes");
        continue;
      }
      std::vector<Index>* target = &x;
      Index index = system_.find_x(*item.text());
      if (index < 0 && z != nullptr) {
        index = system_.find_z(*item.text());
        target = z;
      }
      if (index < 0) {
        if (faults_.is_unread(*item.text())) continue;
        std::vector<std::string> names;
        for (const Variable& v : system_.x) names.push_back(v.name);
        for (const Variable& v : system_.z) {
          if (z != nullptr) names.push_back(v.name);
        }
        const std::string kind = z == nullptr ? "coordinate" : "variable";
        faults_.add("unknown-variable", here, "there is no " + kind + " \"" + *item.text() + "\"",
                    "a " + kind +
                        (names.empty() ? "; the scene has none"
                                       : " of the scene: " + quoted_list(related(*item.text(), names))),
                    suggestion(*item.text(), names, "`bramah check SCENE` lists all variables"));
        continue;
      }
      if (std::find(target->begin(), target->end(), index) != target->end()) {
        faults_.add("repeated", here, "\"" + *item.text() + "\" a second time", "each variable once", "remove one");
        continue;
      }
      target->push_back(index);
    }
  }

  void outputs(const Value& root, std::vector<Measured>& result) {
    const Value* list = root.find("outputs");
    if (list != nullptr && list->list() != nullptr) return measurements(*list, "/outputs", result);
    const auto all = [&](Measured::Kind kind, const auto& named) {
      for (const auto& one : named) result.push_back({kind, &one - named.data(), one.name, one.unit});
    };
    all(Measured::Kind::x, system_.x);
    all(Measured::Kind::z, system_.z);
    all(Measured::Kind::y, system_.outputs);
  }

  /// Names of variables, multipliers and outputs.
  void measurements(const Value& list, const std::string& place, std::vector<Measured>& result) {
    if (list.list() == nullptr) {
      faults_.add("wrong-kind", place, named(place) + " is " + description(list), "a list of names",
                  list.text() == nullptr ? "write [\"component.variable\"]" : "put it in brackets: [ ... ]");
      return;
    }
    std::size_t k = 0;
    for (const Value& item : *list.list()) {
      const std::string where = pointer(place, k++);
      if (item.text() == nullptr) {
        faults_.add("wrong-kind", where, named(where) + " is " + description(item),
                    "the name of a variable or an output", "put it in double quotes");
        continue;
      }
      Measured found;
      if (find_measured(system_, *item.text(), found)) {
        result.push_back(found);
        continue;
      }
      if (faults_.is_unread(*item.text())) continue;
      const std::vector<std::string> names = measured_names(system_);
      faults_.add("unknown-output", where, "there is no variable, multiplier or output \"" + *item.text() + "\"",
                  names.empty() ? "a name; the scene has none" : "one of: " + quoted_list(related(*item.text(), names)),
                  suggestion(*item.text(), names, "`bramah check SCENE` lists all names"));
    }
  }

 private:
  bool event_condition(const Value& object, const std::string& place, EventOptions& event);
  bool event_consequence(const Value& object, const std::string& place, EventOptions& event);
  [[nodiscard]] std::optional<std::string> unit_of_swept(const Value& root, const std::string& name,
                                                         const std::string& where, bool at_key);
  [[nodiscard]] std::optional<std::string> unit_of_parameter(const Value& root, const Component& component,
                                                             const std::string& key, const std::string& where,
                                                             bool at_key);
  [[nodiscard]] std::optional<double> whole(const Value& value, const std::string& where, double least, double most);
  [[nodiscard]] std::optional<std::vector<double>> range(const Value& section, const std::string& place,
                                                         const std::string& unit, double count);
  using TakeParameter =
      std::function<void(std::string name, std::string unit, const Value& value, const std::string& where)>;
  void parameters(const Value& root, const Value& list, const std::string& place, const TakeParameter& take);
  [[nodiscard]] std::optional<std::vector<double>> grid_values(const Value& value, const std::string& where,
                                                               const std::string& unit);
  [[nodiscard]] std::optional<Distribution> distribution(const Value& value, const std::string& where,
                                                         const std::string& unit);
  void figures(const Value& list, const std::string& place, std::vector<VaryOptions::Figure>& figures);
  void check_vary(const Value& section, const VaryOptions& vary);
  const System& system_;
  Numbers& numbers_;
  Faults& faults_;
};

constexpr int least_count = 2, most_count = 100000;
constexpr double default_count = 51.0;

/// The unit of a component's parameter; a fault where it has none of this name, or one that is no number.
std::optional<std::string> OptionReader::unit_of_parameter(const Value& root, const Component& component,
                                                           const std::string& key, const std::string& where,
                                                           bool at_key) {
  std::vector<std::string> known;
  const bramah_type& type = *component.type;
  for (std::int32_t i = 0; i < type.parameter_count; ++i) {
    const bramah_parameter_info& info = type.parameters[i];
    const bool is_number = info.kind == BRAMAH_NUMBER;
    if (is_number) known.push_back(component.name + "." + info.name);
    if (key != info.name) continue;
    if (!is_number) {
      faults_.add("wrong-kind", where, "\"" + key + "\" of " + component.name + " is not a single number",
                  "a parameter that is one number",
                  "write \"=NAME\" where a number of it stands, and name constants.NAME here", at_key);
      return std::nullopt;
    }
    const std::string unit = info.unit;
    if (!unit.starts_with('@')) return unit;
    const Value* text = root.find("components")->find(component.name)->find(unit.substr(1));
    return text != nullptr && text->text() != nullptr ? *text->text() : "1";
  }
  const std::string name = component.name + "." + key;
  faults_.add("unknown-parameter", where, std::string(type.name) + " has no parameter \"" + key + "\"",
              known.empty() ? "a parameter; it has none that is a number" : "one of: " + quoted_list(known),
              suggestion(name, known, "`bramah describe " + std::string(type.name) + "` explains them"), at_key);
  return std::nullopt;
}

/// The unit of the number called `name`; a fault where there is none.
std::optional<std::string> OptionReader::unit_of_swept(const Value& root, const std::string& name,
                                                       const std::string& where, bool at_key) {
  const std::size_t dot = name.find('.');
  const std::string word = name.substr(0, dot), key = dot == std::string::npos ? "" : name.substr(dot + 1);
  if (word == "constants" || word == "start") {
    std::vector<std::string> known;
    if (word == "start") {
      Measured found;
      if (find_measured(system_, key, found) &&
          (found.kind == Measured::Kind::x || found.kind == Measured::Kind::v || found.kind == Measured::Kind::z))
        return found.unit;
      for (const Variable& v : system_.x) known.insert(known.end(), {"start." + v.name, "start." + v.name + ".rate"});
      for (const Variable& v : system_.z) known.push_back("start." + v.name);
    } else if (const Value* constants = root.find("constants");
               constants != nullptr && constants->object() != nullptr) {
      for (const Member& constant : *constants->object()) {
        known.push_back("constants." + constant.key);
        if (constant.key != key) continue;
        const auto quantity = constant.value.text() ? parse_quantity(*constant.value.text()) : std::nullopt;
        const auto si = quantity ? parse_unit(quantity->unit) : std::nullopt;
        if (!si || quantity->unit.empty()) return "1";
        const std::string units = alternatives(*si);  // the SI unit first
        return units.substr(0, units.find(','));
      }
    }
    if (!faults_.is_unread(key)) {
      faults_.add("unknown-parameter", where, "the scene has no \"" + name + "\"",
                  known.empty() ? "a name; the section is empty" : "one of: " + quoted_list(known),
                  suggestion(name, known, "`bramah check SCENE` lists all variables"), at_key);
    }
    return std::nullopt;
  }
  if (faults_.is_unread(name)) return std::nullopt;
  std::vector<std::string> names = {"constants", "start"};
  for (const Component& component : system_.components) {
    if (component.name == word) return unit_of_parameter(root, component, key, where, at_key);
    names.push_back(component.name);
  }
  const Value* components = root.find("components");
  if (components != nullptr && components->find(word) != nullptr) return std::nullopt;  // with faults of its own
  faults_.add("unknown-parameter", where, "the scene has no \"" + name + "\"",
              "COMPONENT.PARAMETER, constants.NAME or start.VARIABLE",
              suggestion(word, names, "name one of these before the first dot"), at_key);
  return std::nullopt;
}

void OptionReader::events(const Value& list, const std::string& place, std::vector<EventOptions>& events) {
  if (list.object() == nullptr) {
    faults_.add("wrong-kind", place, named(place) + " is " + description(list), "{NAME: {\"of\": ..., ...}, ...}",
                "give every event a name");
    return;
  }
  for (const Member& member : *list.object()) {
    const std::string where = pointer(place, member.key);
    if (member.value.object() == nullptr) {
      faults_.add("wrong-kind", where, named(where) + " is " + description(member.value), "{\"of\": ..., ...}",
                  "write what it watches, a level, and what follows");
      continue;
    }
    EventOptions event;
    event.name = member.key;
    if (event_condition(member.value, where, event) && event_consequence(member.value, where, event))
      events.push_back(std::move(event));
  }
}

/// What the event watches and from which side; false after a fault.
bool OptionReader::event_condition(const Value& object, const std::string& place, EventOptions& event) {
  members(object, place, event.name, {"of", "rises_above", "falls_below", "stop", "hold"},
          [](const std::string&, const Value&, const std::string&) {});
  const Value* of = object.find("of");
  if (of == nullptr || of->text() == nullptr) {
    faults_.add("wrong-kind", of == nullptr ? place : pointer(place, "of"),
                of == nullptr ? named(place) + " without \"of\"" : "\"of\" is " + description(*of),
                "\"of\": the name of a variable or an output", "name what the event watches", of == nullptr);
    return false;
  }
  if (!find_measured(system_, *of->text(), event.of)) {
    if (faults_.is_unread(*of->text())) return false;
    const std::vector<std::string> names = measured_names(system_);
    faults_.add("unknown-output", pointer(place, "of"),
                "there is no variable, multiplier or output \"" + *of->text() + "\"",
                names.empty() ? "a name; the scene has none" : "one of: " + quoted_list(related(*of->text(), names)),
                suggestion(*of->text(), names, "`bramah check SCENE` lists all names"));
    return false;
  }
  const Value *rises = object.find("rises_above"), *falls = object.find("falls_below");
  if ((rises == nullptr) == (falls == nullptr)) {
    faults_.add("conflict", place, named(place) + (rises == nullptr ? " without a level" : " with two levels"),
                "either \"rises_above\" or \"falls_below\"", "give one of them, in " + event.of.unit, true);
    return false;
  }
  event.rises = rises != nullptr;
  const auto level = numbers_.read(event.rises ? *rises : *falls,
                                   pointer(place, event.rises ? "rises_above" : "falls_below"), event.of.unit);
  if (level) event.level = *level;
  return level.has_value();
}

/// What follows from the event; false after a fault.
bool OptionReader::event_consequence(const Value& object, const std::string& place, EventOptions& event) {
  if (const Value* stop = object.find("stop")) flag(*stop, pointer(place, "stop"), event.stop);
  const Value* hold = object.find("hold");
  if (hold != nullptr && hold->object() == nullptr) {
    faults_.add("wrong-kind", pointer(place, "hold"), "\"hold\" is " + description(*hold), "{INPUT: VALUE, ...}",
                "name inputs and the values that they keep");
    return false;
  }
  bool sound = true;
  for (std::size_t k = 0; hold != nullptr && k < hold->object()->size(); ++k) {
    const Member& held = (*hold->object())[k];
    const std::string where = pointer(pointer(place, "hold"), held.key);
    const auto input = std::find_if(system_.inputs.begin(), system_.inputs.end(),
                                    [&](const InputSignal& one) { return one.name == held.key; });
    if (input == system_.inputs.end()) {
      sound = false;
      if (faults_.is_unread(held.key)) continue;
      std::vector<std::string> names;
      for (const InputSignal& one : system_.inputs) names.push_back(one.name);
      faults_.add("unknown-variable", where, "there is no input \"" + held.key + "\"",
                  names.empty() ? "an input; the scene has none" : "one of: " + quoted_list(names),
                  suggestion(held.key, names, "`bramah check SCENE` lists them"), true);
      continue;
    }
    const auto value = numbers_.read(held.value, where, input->unit);
    sound = sound && value.has_value();
    if (value) event.holds.emplace_back(input - system_.inputs.begin(), *value);
  }
  if (sound && !event.stop && event.holds.empty()) {
    faults_.add("conflict", place, named(place) + " has no consequence", "\"stop\": true, or \"hold\": {INPUT: VALUE}",
                "say what shall follow", true);
    return false;
  }
  return sound;
}

std::optional<double> OptionReader::whole(const Value& value, const std::string& where, double least, double most) {
  const auto read = numbers_.read(value, where, "1");
  if (!read || (*read >= least && *read <= most && *read == std::floor(*read))) return read;
  faults_.add("out-of-range", where, named(where) + " is " + description(value),
              "a whole number from " + number_text(least) + " to " + number_text(most), "correct the number");
  return std::nullopt;
}

/// From "from" to "to" of the section, which has both, in even steps; nothing after a fault.
std::optional<std::vector<double>> OptionReader::range(const Value& section, const std::string& place,
                                                       const std::string& unit, double count) {
  const auto first = numbers_.read(*section.find("from"), pointer(place, "from"), unit);
  const auto last = numbers_.read(*section.find("to"), pointer(place, "to"), unit);
  if (const Value* own = section.find("count")) {
    const auto read = whole(*own, pointer(place, "count"), least_count, most_count);
    if (!read) return std::nullopt;
    count = *read;
  }
  if (!first || !last) return std::nullopt;
  // Both ends exactly; the others as near to even as rounding allows.
  std::vector<double> values;
  const int last_step = static_cast<int>(count) - 1;
  for (int k = 0; k <= last_step; ++k) {
    const double share = static_cast<double>(k) / last_step;
    values.push_back(k == last_step ? *last : (1.0 - share) * *first + share * *last);
  }
  return values;
}

void OptionReader::swept(const Value& root, const Value& section, const std::string& place,
                         std::vector<SweptParameter>& over) {
  const bool is_first = place == "/sweep";
  std::vector<std::string> keys = {"parameter", "from", "to", "count", "values"};
  if (is_first) keys.emplace_back("second");
  members(section, place, is_first ? "sweep" : "second", keys,
          [](const std::string&, const Value&, const std::string&) {});
  const Value* name = section.find("parameter");
  if (name == nullptr || name->text() == nullptr) {
    faults_.add("wrong-kind", name == nullptr ? place : pointer(place, "parameter"),
                name == nullptr ? "a sweep without \"parameter\"" : "\"parameter\" is " + description(*name),
                "\"parameter\": \"COMPONENT.PARAMETER\", \"constants.NAME\" or \"start.VARIABLE\"",
                "name the number that is to change", name == nullptr);
    return;
  }
  SweptParameter swept{*name->text(), "1", {}};
  const auto unit = unit_of_swept(root, swept.name, pointer(place, "parameter"), false);
  const Value *from = section.find("from"), *to = section.find("to"), *count = section.find("count"),
              *values = section.find("values");
  if ((values != nullptr) == (from != nullptr || to != nullptr || count != nullptr) ||
      (values == nullptr && (from == nullptr || to == nullptr))) {
    faults_.add("wrong-choice", place,
                values != nullptr ? "a sweep with \"values\" and a range" : "a sweep without values",
                "either \"from\" and \"to\", with \"count\" if it is not 51, or \"values\"",
                values != nullptr ? "keep one of them" : "add \"from\" and \"to\"", true);
    return;
  }
  if (!unit) return;
  swept.unit = *unit;
  if (values != nullptr) {
    numbers(*values, pointer(place, "values"), swept.unit, swept.values);
    if (values->list() == nullptr || swept.values.size() != values->list()->size()) return;  // told already
  } else {
    auto even = range(section, place, swept.unit, default_count);
    if (!even) return;
    swept.values = std::move(*even);
  }
  const auto out_of_order = [&](auto&& before) {
    return std::adjacent_find(swept.values.begin(), swept.values.end(),
                              [&](double a, double b) { return !before(a, b); }) != swept.values.end();
  };
  if (swept.values.size() < 2 || (out_of_order(std::less<>()) && out_of_order(std::greater<>()))) {
    faults_.add("out-of-range", values != nullptr ? pointer(place, "values") : pointer(place, "to"),
                swept.values.size() < 2 ? "a sweep over a single value" : "values that do not go one way",
                "two values or more, all ascending or all descending",
                values != nullptr ? "sort them and remove repeated ones" : "let \"to\" differ from \"from\"");
    return;
  }
  if (!over.empty() && over.front().name == swept.name) {
    faults_.add("repeated", pointer(place, "parameter"), "\"" + swept.name + "\" a second time",
                "another parameter than the first one", "remove \"second\", or name another");
    return;
  }
  over.push_back(std::move(swept));
}

/// {NAME: VALUE, ...}: the numbers that a grid goes through, or that are drawn.
void OptionReader::parameters(const Value& root, const Value& list, const std::string& place,
                              const TakeParameter& take) {
  if (list.object() == nullptr) {
    faults_.add("wrong-kind", place, named(place) + " is " + description(list), "{\"COMPONENT.PARAMETER\": ..., ...}",
                "name the numbers that are to change");
    return;
  }
  for (const Member& member : *list.object()) {
    const std::string where = pointer(place, member.key);
    auto unit = unit_of_swept(root, member.key, where, true);
    if (unit) take(member.key, std::move(*unit), member.value, where);
  }
}

std::optional<std::vector<double>> OptionReader::grid_values(const Value& value, const std::string& where,
                                                             const std::string& unit) {
  if (value.list() != nullptr && !value.list()->empty()) {
    std::vector<double> values;
    numbers(value, where, unit, values);
    if (values.size() != value.list()->size()) return std::nullopt;  // told already
    return values;
  }
  members(value, where, "over", {"from", "to", "count"}, [](const std::string&, const Value&, const std::string&) {});
  if (value.find("from") == nullptr || value.find("to") == nullptr || value.find("count") == nullptr) {
    faults_.add("wrong-kind", where,
                value.object() != nullptr ? "a range that is not complete" : named(where) + " is " + description(value),
                "[VALUE, ...] or {\"from\": ..., \"to\": ..., \"count\": ...}", "list its values, or give a range");
    return std::nullopt;
  }
  return range(value, where, unit, default_count);
}

std::optional<Distribution> OptionReader::distribution(const Value& value, const std::string& where,
                                                       const std::string& unit) {
  using Kind = Distribution::Kind;
  static const std::vector<std::pair<std::string, Kind>> kinds = {
      {"normal", Kind::normal}, {"uniform", Kind::uniform}, {"log_uniform", Kind::log_uniform}};
  static const std::string expected =
      "{\"normal\": [MEAN, DEVIATION]}, {\"uniform\": [LOW, HIGH]} or {\"log_uniform\": [LOW, HIGH]}";
  if (value.object() == nullptr || value.object()->size() != 1) {
    faults_.add("wrong-kind", where, named(where) + " is " + description(value), expected, "write one of these");
    return std::nullopt;
  }
  const Member& member = value.object()->front();
  const std::string place = pointer(where, member.key);
  std::vector<std::string> known;
  for (const auto& [word, kind] : kinds) {
    known.push_back(word);
    if (word != member.key) continue;
    std::vector<double> two;
    const std::size_t faults_before = faults_.list.size();
    numbers(member.value, place, unit, two);
    if (faults_.list.size() != faults_before) return std::nullopt;
    const bool ordered = two.size() == 2 && (kind == Kind::normal ? two[1] >= 0.0 : two[0] < two[1]);
    if (ordered && (kind != Kind::log_uniform || two[0] > 0.0)) return Distribution{kind, two[0], two[1]};
    faults_.add("out-of-range", place,
                two.size() == 2
                    ? named(place) + " is [" + with_unit(two[0], unit) + ", " + with_unit(two[1], unit) + "]"
                    : named(place) + " is " + description(member.value),
                kind == Kind::normal    ? "the mean and a standard deviation that is not negative"
                : kind == Kind::uniform ? "two ends, the lower first"
                                        : "two ends above 0, the lower first",
                "correct the numbers, or their units");
    return std::nullopt;
  }
  faults_.add("wrong-choice", place, "no distribution \"" + member.key + "\"", expected,
              suggestion(member.key, known, "write one of these"), true);
  return std::nullopt;
}

void OptionReader::figures(const Value& list, const std::string& place, std::vector<VaryOptions::Figure>& figures) {
  using Figure = VaryOptions::Figure;
  if (list.list() == nullptr || list.list()->empty()) {
    faults_.add("wrong-kind", place, named(place) + " is " + description(list), "a list of figures",
                "write for instance [\"final\", \"max\"]");
    return;
  }
  figures.clear();
  std::size_t k = 0;
  for (const Value& item : *list.list()) {
    Figure figure = Figure::final_value;
    word<Figure>(item, pointer(place, k++),
                 {{"final", Figure::final_value},
                  {"min", Figure::min},
                  {"max", Figure::max},
                  {"mean", Figure::mean},
                  {"rms", Figure::rms}},
                 figure);
    figures.push_back(figure);
  }
}

void OptionReader::vary(const Value& root, const std::vector<Measured>& outputs, VaryOptions& vary) {
  const Value* section = root.find("vary");
  if (section == nullptr || section->object() == nullptr) return;
  constexpr double most_draws = 1e6, largest_seed = 1e15;
  vary.asked = true;
  members(*section, "/vary", "vary", {"over", "random", "count", "seed", "of", "figures"},
          [&](const std::string& key, const Value& value, const std::string& where) {
            if (key == "over") {
              parameters(root, value, where, [&](auto name, auto unit, const Value& values, const std::string& place) {
                if (auto read = grid_values(values, place, unit))
                  vary.over.push_back({std::move(name), std::move(unit), std::move(*read)});
              });
            } else if (key == "random") {
              parameters(root, value, where, [&](auto name, auto unit, const Value& spread, const std::string& place) {
                if (const auto read = distribution(spread, place, unit))
                  vary.random.push_back({std::move(name), std::move(unit), *read});
              });
            } else if (key == "count") {
              if (const auto count = whole(value, where, 1.0, most_draws))
                vary.count = static_cast<std::size_t>(*count);
            } else if (key == "seed") {
              if (const auto seed = whole(value, where, 0.0, largest_seed))
                vary.seed = static_cast<std::uint64_t>(*seed);
            } else if (key == "of") {
              measurements(value, where, vary.of);
            } else {
              figures(value, where, vary.figures);
            }
          });
  if (section->find("of") == nullptr) vary.of = outputs;
  check_vary(*section, vary);
}

/// What no key of "vary" can tell alone.
void OptionReader::check_vary(const Value& section, const VaryOptions& vary) {
  constexpr double most_runs = 1e6;
  const Value *over = section.find("over"), *random = section.find("random");
  const auto is_empty = [](const Value* list) {
    return list == nullptr || (list->object() && list->object()->empty());
  };
  if (is_empty(over) && is_empty(random)) {
    faults_.add("wrong-kind", "/vary", "\"vary\" without a number that changes",
                "\"over\": {NAME: VALUES} for a grid, \"random\": {NAME: DISTRIBUTION} for draws, or both", "add one",
                true);
    return;
  }
  if (is_empty(random) == (section.find("count") != nullptr)) {
    faults_.add("conflict", "/vary", is_empty(random) ? "\"count\" without \"random\"" : "\"random\" without \"count\"",
                "\"count\": how many draws there are, at each point of the grid",
                is_empty(random) ? "remove it" : "add for instance \"count\": 200", true);
  }
  if (is_empty(random) && section.find("seed") != nullptr) {
    faults_.add("conflict", "/vary/seed", "\"seed\" without \"random\"", "a seed for random numbers only", "remove it",
                true);
  }
  for (const RandomParameter& one : vary.random) {
    if (over == nullptr || over->find(one.name) == nullptr) continue;
    faults_.add("repeated", pointer("/vary/random", one.name), "\"" + one.name + "\" in \"over\" and in \"random\"",
                "each number in one of them", "remove it from the other", true);
  }
  auto runs = static_cast<double>(vary.count);
  for (const SweptParameter& one : vary.over) runs *= static_cast<double>(one.values.size());
  if (runs > most_runs) {
    faults_.add("out-of-range", "/vary", "\"vary\" asks for " + number_text(runs) + " runs",
                "at most " + number_text(most_runs), "take fewer values or draws", true);
  }
}

void read_modes(const Value& root, OptionReader& reader, Faults& faults, ModesOptions& modes) {
  std::vector<std::string> selections;
  const auto selects = [&](const std::string& key, ModesOptions::Select select) {
    selections.push_back(key);
    modes.select = select;
  };
  reader.section(root, "modes", {"count", "shift", "band", "within", "prove"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "count") {
                     selects(key, ModesOptions::Select::nearest);
                     double count = 0.0;
                     reader.number(value, where, "1", 1.0, count, false);
                     modes.count = static_cast<Index>(std::min(count, 1e6));
                   } else if (key == "shift") {
                     reader.number(value, where, "1/s", 0.0, modes.shift, true);
                   } else if (key == "within") {
                     selects(key, ModesOptions::Select::within);
                     reader.number(value, where, "1/s", 0.0, modes.within, true);
                   } else if (key == "band") {
                     selects(key, ModesOptions::Select::band);
                     std::vector<double> ends;
                     reader.numbers(value, where, "Hz", ends);
                     if (ends.size() == 2 && ends[0] >= 0.0 && ends[1] > ends[0]) {
                       modes.band_from = ends[0];
                       modes.band_to = ends[1];
                     } else {
                       faults.add("out-of-range", where, "\"band\" is " + description(value),
                                  "two frequencies, the lower first", "write [\"1 Hz\", \"5 Hz\"]");
                     }
                   } else {
                     reader.flag(value, where, modes.prove);
                   }
                 });
  if (root.find("modes") != nullptr && selections.size() != 1) {
    faults.add("wrong-choice", "/modes",
               selections.empty() ? "\"modes\" without a selection"
                                  : "\"modes\" with several selections: " + quoted_list(selections),
               "one of: \"count\", \"band\", \"within\"",
               selections.empty() ? "add one, or remove \"modes\" to have all modes" : "keep one of them");
  }
  if (modes.shift > 0.0 && modes.select != ModesOptions::Select::nearest)
    faults.add("wrong-choice", "/modes/shift", "\"shift\" without \"count\"", "a shift for the nearest modes only",
               "remove it");
}

}  // namespace

void read_options(const Value& root, const System& system, Numbers& numbers, Faults& faults, Options& options) {
  OptionReader reader(system, numbers, faults);
  if (const Value* hold = root.find("hold")) {
    reader.variables(*hold, "/hold", options.equilibrium.hold_x, &options.equilibrium.hold_z);
  }
  reader.outputs(root, options.outputs);

  EquilibriumOptions& equilibrium = options.equilibrium;
  reader.section(root, "equilibrium", {"tolerance", "max_iterations"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "tolerance") {
                     reader.number(value, where, "1", 0.0, equilibrium.tolerance, true);
                   } else {
                     double count = equilibrium.max_iterations;
                     reader.number(value, where, "1", 1.0, count, false);
                     equilibrium.max_iterations = static_cast<int>(std::min(count, 1e6));
                   }
                 });

  SimulateOptions& simulate = options.simulate;
  simulate.asked = root.find("simulate") != nullptr;
  reader.section(root, "simulate",
                 {"from", "from_time", "to_time", "output_step", "output_times", "integrator", "rel_tol", "max_step",
                  "step", "rho_infinity", "switches", "events"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "from") {
                     reader.word<SimulateOptions::From>(
                         value, where,
                         {{"start", SimulateOptions::From::start}, {"equilibrium", SimulateOptions::From::equilibrium}},
                         simulate.from);
                   } else if (key == "from_time") {
                     reader.number(value, where, "s", -1e300, simulate.from_time, false);
                   } else if (key == "to_time") {
                     reader.number(value, where, "s", -1e300, simulate.to_time, false);
                   } else if (key == "output_step") {
                     reader.number(value, where, "s", 0.0, simulate.output_step, true);
                   } else if (key == "output_times") {
                     reader.numbers(value, where, "s", simulate.output_times);
                   } else if (key == "integrator") {
                     using Integrator = SimulateOptions::Integrator;
                     reader.word<Integrator>(value, where,
                                             {{"auto", Integrator::automatic},
                                              {"ida", Integrator::ida},
                                              {"explicit", Integrator::explicit_one_step},
                                              {"implicit", Integrator::implicit_one_step},
                                              {"generalized_alpha", Integrator::generalized_alpha}},
                                             simulate.integrator);
                   } else if (key == "rel_tol") {
                     reader.number(value, where, "1", 0.0, simulate.rel_tol, true);
                   } else if (key == "max_step") {
                     reader.number(value, where, "s", 0.0, simulate.max_step, true);
                   } else if (key == "step") {
                     reader.number(value, where, "s", 0.0, simulate.step, true);
                   } else if (key == "switches") {
                     reader.word<bool>(value, where, {{"meet", true}, {"pass", false}}, simulate.meet_switches);
                   } else if (key == "events") {
                     reader.events(value, where, simulate.events);
                   } else {
                     reader.number(value, where, "1", 0.0, simulate.rho_infinity, false);
                   }
                 });
  if (simulate.asked && !(simulate.to_time > simulate.from_time)) {
    faults.add("out-of-range", "/simulate/to_time",
               "the simulation ends at to_time = " + with_unit(simulate.to_time, "s"),
               "a time after from_time = " + with_unit(simulate.from_time, "s"), "set \"to_time\"");
  }
  const bool fixed = simulate.integrator == SimulateOptions::Integrator::generalized_alpha;
  if (fixed != (simulate.step > 0.0)) {
    faults.add("conflict", "/simulate",
               fixed ? "generalized_alpha without \"step\"" : "\"step\" without generalized_alpha",
               "a fixed \"step\" with \"integrator\": \"generalized_alpha\", and with no other",
               fixed ? "give \"step\", for example \"1 ms\"" : "limit the steps of other integrators by \"max_step\"");
  }
  if (simulate.rho_infinity > 1.0) {
    faults.add("out-of-range", "/simulate/rho_infinity", "rho_infinity = " + with_unit(simulate.rho_infinity, "1"),
               "0 ... 1: the part of the fastest motions that a step keeps", "0.8 is a good start");
  }
  if (!std::is_sorted(simulate.output_times.begin(), simulate.output_times.end())) {
    faults.add("out-of-range", "/simulate/output_times", "\"output_times\" go back", "ascending times", "sort them");
  }

  LinearizeOptions& linearize = options.linearize;
  linearize.asked = root.find("linearize") != nullptr;
  reader.section(root, "linearize", {"at", "form", "independent", "admissible_dependent", "side", "times"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "at") {
                     reader.word<LinearizeOptions::At>(
                         value, where,
                         {{"equilibrium", LinearizeOptions::At::equilibrium}, {"start", LinearizeOptions::At::start}},
                         linearize.at);
                   } else if (key == "form") {
                     reader.word<LinearizeOptions::Form>(value, where,
                                                         {{"reduced", LinearizeOptions::Form::reduced},
                                                          {"descriptor", LinearizeOptions::Form::descriptor}},
                                                         linearize.form);
                   } else if (key == "independent") {
                     reader.variables(value, where, linearize.prescribed.independent, nullptr);
                   } else if (key == "admissible_dependent") {
                     reader.variables(value, where, linearize.prescribed.admissible_dependent, nullptr);
                   } else if (key == "times") {
                     reader.numbers(value, where, "s", linearize.times);
                   } else {
                     reader.word<int>(value, where, {{"+", 1}, {"-", -1}}, linearize.side);
                   }
                 });
  for (const Index i : linearize.prescribed.admissible_dependent) {
    const std::vector<Index>& independent = linearize.prescribed.independent;
    if (std::find(independent.begin(), independent.end(), i) == independent.end()) continue;
    faults.add("repeated", "/linearize/admissible_dependent",
               "\"" + system.x[static_cast<std::size_t>(i)].name + "\" is prescribed as independent too",
               "each coordinate in one of the two lists", "remove it from one");
  }
  const auto outside = [&](double t) { return t < simulate.from_time || t > simulate.to_time; };
  if (!std::is_sorted(linearize.times.begin(), linearize.times.end()) ||
      std::any_of(linearize.times.begin(), linearize.times.end(), outside)) {
    faults.add("out-of-range", "/linearize/times", "\"times\" that go back or leave the simulation",
               "ascending times between from_time and to_time of \"simulate\"", "sort them, or simulate longer");
  }

  read_modes(root, reader, faults, options.modes);

  reader.section(root, "compare", {"steps"}, [&](const std::string&, const Value& value, const std::string& where) {
    reader.numbers(value, where, "1", options.compare.steps);
    if (std::any_of(options.compare.steps.begin(), options.compare.steps.end(), [](double h) { return !(h > 0.0); })) {
      faults.add("out-of-range", where, "\"steps\" are not all above 0", "step sizes h > 0 of Eq. (100)",
                 "remove or correct them");
    }
  });
  reader.section(root, "study", {"linear_from"}, [&](const std::string&, const Value& value, const std::string& where) {
    reader.number(value, where, "s", 0.0, options.study.linear_from, false);
  });
  if (const Value* sweep = root.find("sweep"); sweep != nullptr && sweep->object() != nullptr) {
    reader.swept(root, *sweep, "/sweep", options.sweep.over);
    if (const Value* second = sweep->find("second"); second != nullptr && second->object() != nullptr) {
      reader.swept(root, *second, "/sweep/second", options.sweep.over);
    } else if (second != nullptr) {
      faults.add("wrong-kind", "/sweep/second", "\"second\" is " + description(*second), "an object",
                 "write it as the sweep itself: { \"parameter\": ... }");
    }
  }
  reader.vary(root, options.outputs, options.vary);
  if (const Value* title = root.find("title"); title != nullptr && title->text() != nullptr)
    options.study.title = *title->text();
  if (const Value* text = root.find("description"); text != nullptr && text->text() != nullptr)
    options.study.description = *text->text();
}

}  // namespace compiling
}  // namespace bramah
