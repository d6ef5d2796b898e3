// What a component says of itself: its type, its keys, its parameters and their limits.
#include <algorithm>
#include <cmath>

#include "system/compiler.hpp"

namespace bramah::compiling {

namespace {

std::string list_of(const bramah_parameter_info& info, const std::string& unit) {
  std::string text = "a list of ";
  if (info.kind == BRAMAH_VECTOR) text += std::to_string(info.count) + " ";
  return text + "numbers" + (unit.empty() || unit == "1" ? "" : " in " + unit) + ": " + info.doc;
}

int choice_index(const bramah_parameter_info& info, std::string_view word) {
  for (int k = 0; info.choices[k] != nullptr; ++k) {
    if (word == info.choices[k]) return k;
  }
  return -1;
}

}  // namespace

/// A unit that a type declares and nobody knows would leave all its numbers unchecked.
void Compiler::check_type_units(const Draft& draft) {
  const bramah_type& type = *draft.type;
  if (!known_units_.insert(type.name).second) return;
  const auto look = [&](const char* what, const char* name, const char* unit) {
    if (unit == nullptr || unit[0] == '@' || parse_unit(unit)) return;
    faults_.add(
        "component-broken", draft.where,
        std::string(type.name) + " declares the " + what + " \"" + name + "\" in \"" + unit + "\", which is no unit",
        "a unit such as \"N/m\" or \"1\"", "repair the component's describe, and build the library again");
  };
  for (std::int32_t k = 0; k < type.parameter_count; ++k) {
    const bramah_parameter_info& info = type.parameters[k];
    if (info.kind != BRAMAH_TEXT && info.kind != BRAMAH_CHOICE) look("parameter", info.name, info.unit);
  }
  for (std::int32_t k = 0; k < type.port_count; ++k) look("port", type.ports[k].name, type.ports[k].unit);
  for (std::int32_t k = 0; k < type.variable_count; ++k)
    look("variable", type.variables[k].name, type.variables[k].unit);
  for (std::int32_t k = 0; k < type.holonomic_count; ++k) look("row", type.holonomic[k].name, type.holonomic[k].unit);
  for (std::int32_t k = 0; k < type.nonholonomic_count; ++k)
    look("row", type.nonholonomic[k].name, type.nonholonomic[k].unit);
  for (std::int32_t k = 0; k < type.output_count; ++k) look("output", type.outputs[k].name, type.outputs[k].unit);
}

void Compiler::find_type(Draft& draft) {
  const Value* type = draft.value->find("type");
  if (type == nullptr || type->text() == nullptr) {
    faults_.add("missing-type", draft.where, "a component without a type",
                "a member \"type\" such as \"mechanics/revolute\"", "`bramah list` shows all types");
    return;
  }
  const std::string& name = *type->text();
  draft.type = registry_->find(name);
  const std::size_t slash = name.find('/');
  const std::string library = name.substr(0, slash);
  const bool listed = std::find(libraries_.begin(), libraries_.end(), library) != libraries_.end();
  // A registry may know more than this scene asks for; what the scene means must not depend on that.
  if (draft.type != nullptr && !listed) draft.type = nullptr;
  if (draft.type != nullptr) {
    check_type_units(draft);
    return;
  }
  const std::string where = pointer(draft.where, "type"), found = "unknown type \"" + name + '"';
  if (slash == std::string::npos) {
    std::vector<std::string> known = known_types("");
    std::string meant;
    for (const std::string& candidate : known) {
      if (candidate.substr(candidate.find('/') + 1) == name) meant = candidate;
    }
    faults_.add("unknown-type", where, found, "library/type, such as \"mechanics/ground\"",
                meant.empty() ? "`bramah list` shows all types" : "did you mean \"" + meant + "\"?");
    return;
  }
  // Once is enough for a library that could not be loaded, is misspelt in the list or has been forgotten there.
  if (broken_libraries_.contains(library)) return;
  if (!listed) {
    const bool meant_by_other =
        std::any_of(broken_libraries_.begin(), broken_libraries_.end(), [&](const std::string& other) {
          return other.find(library) != std::string::npos || !closest(library, {other}).empty();
        });
    if (meant_by_other || libraries_unread_ || !forgotten_libraries_.insert(library).second) return;
    const std::vector<std::string> offered = registry_->available();
    const bool exists = std::find(offered.begin(), offered.end(), library) != offered.end();
    std::vector<std::string> candidates = libraries_;
    candidates.insert(candidates.end(), offered.begin(), offered.end());
    const std::string meant = closest(library, candidates);
    faults_.add("unknown-type", where, found,
                libraries_.empty() ? std::string("a list \"libraries\" that names its library")
                                   : "a type of the scene's libraries: " + quoted_list(libraries_),
                exists          ? "add \"" + library + "\" to \"libraries\""
                : meant.empty() ? "check the library's name; `bramah list` shows all types"
                                : "did you mean \"" + meant + name.substr(slash) + "\"?");
    return;
  }
  const std::vector<std::string> known = known_types(library);
  const std::string meant = closest(name, known);
  faults_.add("unknown-type", where, found,
              meant.empty() ? "one of: " + quoted_list(known, 20) : "a type of the library \"" + library + '"',
              meant.empty() ? "`bramah list` shows all types" : "did you mean \"" + meant + "\"?");
}

std::vector<std::string> Compiler::known_types(std::string_view library) const {
  std::vector<std::string> known;
  for (const std::string& name : registry_->type_names()) {
    const std::string of = name.substr(0, name.find('/'));
    const bool listed = std::find(libraries_.begin(), libraries_.end(), of) != libraries_.end();
    if (listed && (library.empty() || of == library)) known.push_back(name);
  }
  return known;
}

void Compiler::read_parameters(Draft& draft) {
  const bramah_type& type = *draft.type;
  const std::size_t before = faults_.list.size();
  std::vector<std::string> keys;
  keys.reserve(static_cast<std::size_t>(type.port_count) + static_cast<std::size_t>(type.parameter_count));
  for (std::int32_t i = 0; i < type.port_count; ++i) keys.emplace_back(type.ports[i].name);
  for (std::int32_t i = 0; i < type.parameter_count; ++i) keys.emplace_back(type.parameters[i].name);
  for (const Member& member : *draft.value->object()) {
    if (member.key == "type" || std::find(keys.begin(), keys.end(), member.key) != keys.end()) continue;
    draft.meant.insert(closest(member.key, keys));
    faults_.add("unknown-key", pointer(draft.where, member.key), "unknown key \"" + member.key + "\" of " + type.name,
                keys.empty() ? "nothing but \"type\"" : "one of: " + quoted_list(keys, 20),
                suggestion(member.key, keys, std::string("`bramah describe ") + type.name + "` explains them"), true);
  }
  const auto count = static_cast<std::size_t>(type.parameter_count);
  draft.numbers.resize(count);
  draft.texts.resize(count);
  draft.sound = true;
  // Texts first: they may name the unit of the others.
  for (const bool texts : {true, false}) {
    for (std::size_t i = 0; i < count; ++i) {
      if ((type.parameters[i].kind == BRAMAH_TEXT) == texts) read_parameter(draft, type.parameters[i], i);
    }
  }
  draft.sound = draft.sound && faults_.list.size() == before;
}

void Compiler::read_parameter(Draft& draft, const bramah_parameter_info& info, std::size_t index) {
  const Value* value = draft.value->find(info.name);
  const std::string where = pointer(draft.where, info.name);
  std::vector<double>& numbers = draft.numbers[index];
  const auto drives = [&](Index element) {
    return [this, index, element](Constant& c) {
      c.parameters.push_back({static_cast<Index>(drafts_.size()), static_cast<std::int32_t>(index), element});
    };
  };
  const std::string unit = parameter_unit(*draft.type, info.unit, draft.texts);
  if (value == nullptr) {
    if (info.required != 0) {
      if (draft.meant.contains(info.name)) return;
      faults_.add("missing-parameter", draft.where,
                  std::string("parameter \"") + info.name + "\" of " + draft.type->name + " is missing",
                  std::string(info.doc) + (unit.empty() || unit == "1" ? "" : ", in " + unit),
                  std::string("add \"") + info.name + "\" to \"" + draft.name + '"', true);
    } else if (info.kind == BRAMAH_TEXT) {
      draft.texts[index] = info.default_text == nullptr ? "" : info.default_text;
    } else if (info.kind == BRAMAH_CHOICE && info.default_text != nullptr) {
      numbers = {static_cast<double>(choice_index(info, info.default_text))};
    } else {
      numbers.assign(info.default_numbers, info.default_numbers + info.default_count);
    }
    return;
  }
  switch (info.kind) {
    case BRAMAH_TEXT:
      if (value->text() == nullptr) {
        faults_.add("wrong-kind", where, named(where) + " is " + description(*value), "text",
                    "put it in double quotes");
        draft.texts[index] = "1";
        return;
      }
      draft.texts[index] = *value->text();
      if (std::string_view(info.name) == "unit" && !parse_unit(*value->text())) {
        faults_.add("unknown-unit", where, "\"" + *value->text() + "\" is no unit", "a unit such as \"N.m\" or \"1\"",
                    "write products with a dot: N.m, kg.m^2, m^3/(s.Pa^0.5)");
        draft.texts[index] = "1";
      }
      return;
    case BRAMAH_CHOICE: {
      const int chosen = value->text() == nullptr ? -1 : choice_index(info, *value->text());
      if (chosen < 0) {
        std::vector<std::string> words;
        for (const char* const* word = info.choices; *word != nullptr; ++word) words.emplace_back(*word);
        faults_.add("wrong-choice", where, named(where) + " is " + description(*value), "one of: " + quoted_list(words),
                    value->text() == nullptr ? "write one of these words"
                                             : suggestion(*value->text(), words, "write one of these words"));
        return;
      }
      numbers = {static_cast<double>(chosen)};
      return;
    }
    case BRAMAH_NUMBER:
      if (const auto number = numbers_.read(*value, where, unit, drives(0))) {
        numbers = {*number};
        check_limits(info, *number, unit, where);
        check_typical(draft, index, *number, unit, where);
      } else {
        draft.sound = false;
      }
      return;
    default: break;
  }
  if (value->list() == nullptr) {
    faults_.add("wrong-kind", where, named(where) + " is " + description(*value), list_of(info, unit),
                info.kind == BRAMAH_VECTOR && info.count == 2   ? "write [a, b]"
                : info.kind == BRAMAH_VECTOR && info.count == 3 ? "write [a, b, c]"
                                                                : "write [a, b, ...]");
    return;
  }
  if (info.kind == BRAMAH_VECTOR && static_cast<Index>(value->list()->size()) != info.count) {
    const bool more = static_cast<Index>(value->list()->size()) > info.count;
    faults_.add("wrong-length", where, named(where) + " is " + description(*value), list_of(info, unit),
                more ? "remove what is too much" : "add what is missing");
    return;
  }
  std::size_t k = 0;
  for (const Value& item : *value->list()) {
    const auto element = static_cast<Index>(k);
    const std::string here = pointer(where, k++);
    if (const auto number = numbers_.read(item, here, unit, drives(element))) {
      numbers.push_back(*number);
      check_limits(info, *number, unit, here);
      check_typical(draft, index, *number, unit, here);
    } else {
      draft.sound = false;
    }
  }
}

void Compiler::check_limits(const bramah_parameter_info& info, double number, std::string_view unit,
                            const std::string& where) {
  const bool low = number < info.lower || (info.lower_open != 0 && number == info.lower);
  const bool high = number > info.upper || (info.upper_open != 0 && number == info.upper);
  if (!low && !high) return;
  std::string expected;
  if (std::isfinite(info.lower))
    expected = (info.lower_open != 0 ? "above " : "at least ") + with_unit(info.lower, unit);
  if (std::isfinite(info.upper)) {
    expected += (expected.empty() ? "" : " and ") + std::string(info.upper_open != 0 ? "below " : "at most ") +
                with_unit(info.upper, unit);
  }
  faults_.add("out-of-range", where, named(where) + " is " + with_unit(number, unit), expected + ": " + info.doc,
              "correct the number, or its unit");
}

/// A number that is rarely meant, with the unit in which it would be usual. Zero is.
void Compiler::check_typical(const Draft& draft, std::size_t index, double number, std::string_view unit,
                             const std::string& where) {
  const auto* typical = extension<bramah_typical>(*draft.type, BRAMAH_EXTENSION_TYPICAL);
  if (typical == nullptr || number == 0.0) return;
  const double lower = typical->lower[index], upper = typical->upper[index];
  const auto usual = [&](double value) { return value >= lower && value <= upper; };
  if (usual(number)) return;
  std::string meant;
  const auto own = parse_unit(unit);
  for (const std::string& word : split(own ? alternatives(*own) : "")) {
    const auto other = parse_unit(word);
    if (meant.empty() && other && usual(other->to_si(number))) meant = number_text(number) + " " + word;
  }
  const bramah_parameter_info& info = draft.type->parameters[index];
  faults_.warn("unusual", where, named(where) + " is " + with_unit(number, unit) + " (" + info.doc + ")",
               "usually " + (std::isfinite(lower) ? with_unit(lower, unit) : std::string("anything")) + " to " +
                   (std::isfinite(upper) ? with_unit(upper, unit) : std::string("anything")),
               meant.empty() ? "check the number and its unit" : "did you mean \"" + meant + "\"?");
}

}  // namespace bramah::compiling
