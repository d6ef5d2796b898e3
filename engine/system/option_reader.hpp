// Reads the members of a scene's sections into options, and tells every fault with its place.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "system/compile_parts.hpp"

namespace bramah::compiling {

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
      if (const auto found = measurement(*item.text(), where)) result.push_back(*found);
    }
  }

 private:
  /// The measurement of this name; a fault at `where` where there is none.
  [[nodiscard]] std::optional<Measured> measurement(const std::string& name, const std::string& where);
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

}  // namespace bramah::compiling
