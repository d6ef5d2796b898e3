// Numbers of a scene: plain, with a unit, or a constant by name.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "system/compile_parts.hpp"

namespace bramah::compiling {

namespace {

bool begins_a_number(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" +-.");
  return first != std::string_view::npos && text[first] >= '0' && text[first] <= '9';
}

bool is_infinite_or_nan(std::string_view text) {
  const std::size_t first = std::min(text.find_first_not_of(" +-"), text.size());
  std::string word;
  for (const char c : text.substr(first, 3)) word += static_cast<char>(c | 0x20);
  return word == "inf" || word == "nan";
}

}  // namespace

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(", ", begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 2;
  }
  return words;
}

void Numbers::read_constants(const Value* section) {
  if (section == nullptr || section->object() == nullptr) return;
  for (const Member& member : *section->object()) {
    const std::string where = pointer("/constants", member.key);
    Known& constant = constants_[member.key];
    constant.name = member.key;
    constant.written = description(member.value);
    if (const double* number = member.value.number()) {
      constant.value = *number;
    } else if (const std::string* text = member.value.text()) {
      const std::optional<Quantity> quantity = quantity_of(*text, where, "Pa");
      if (!quantity) continue;
      const std::optional<Unit> unit = unit_of(*quantity, *text, where, nullptr, "");
      if (!unit) continue;
      constant.value = unit->to_si(quantity->value);
      constant.unit = *unit;
      constant.plain = quantity->unit.empty();
    } else {
      faults_.add("wrong-kind", where, named(where) + " is " + description(member.value),
                  "a number, or a number with a unit such as \"1500 MPa\"", "write one number");
      continue;
    }
    constant.sound = is_finite(constant.value, where);
  }
}

bool Numbers::is_finite(double value, const std::string& where) {
  if (std::isfinite(value)) return true;
  faults_.add("number-out-of-range", where, named(where) + " is not a finite number",
              "a number between -1.79e308 and 1.79e308 in SI units", "check the exponent");
  return false;
}

/// Number and unit of a text; a fault where it has no number.
std::optional<Quantity> Numbers::quantity_of(const std::string& text, const std::string& where, std::string_view unit) {
  std::optional<Quantity> quantity = parse_quantity(text);
  if (quantity) return quantity;
  const std::string found = named(where) + " is " + description(text), example = "\"1 " + std::string(unit) + "\"";
  if (begins_a_number(text)) {
    faults_.add("number-out-of-range", where, found, "a number between -1.79e308 and 1.79e308", "check the exponent");
  } else if (is_infinite_or_nan(text)) {
    faults_.add("number-out-of-range", where, found, "a finite number", "write a number that the physics allows");
  } else {
    const bool is_constant = constants_.find(text) != constants_.end();
    if (is_constant) used_.insert(text);
    faults_.add(
        "bad-number", where, found, "a number, or a number with a unit such as " + example,
        is_constant ? "did you mean \"=" + text + "\"?" : "write the number first; constants are written \"=name\"");
  }
  return std::nullopt;
}

/// The unit of a quantity; a fault where it is none. `wanted` may be null: any dimension.
std::optional<Unit> Numbers::unit_of(const Quantity& quantity, const std::string& text, const std::string& where,
                                     const Unit* wanted, const std::string& shown) {
  const std::optional<Unit> unit = parse_unit(quantity.unit);
  if (unit) return unit;
  static const std::map<std::string, std::string> others = {{"\u00b0", "write deg"},
                                                            {"lb", "1 lb = 0.45359237 kg"},
                                                            {"lbs", "1 lb = 0.45359237 kg"},
                                                            {"lbf", "1 lbf = 4.4482216152605 N"},
                                                            {"kgf", "1 kgf = 9.80665 N"},
                                                            {"ft", "1 ft = 0.3048 m"},
                                                            {"gal", "1 US gal = 3.785411784 L"},
                                                            {"hp", "1 hp = 745.69987158227 W"},
                                                            {"cal", "1 cal = 4.184 J"},
                                                            {"at", "1 at = 98066.5 Pa"},
                                                            {"atm", "1 atm = 101325 Pa"},
                                                            {"l", "write L"},
                                                            {"C", "write degC"},
                                                            {"sec", "write s"}};
  const bool word = std::all_of(quantity.unit.begin(), quantity.unit.end(),
                                [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
  std::string remedy = word ? "use one of these units" : "write products with a dot: N.m, kg.m^2, m^3/(s.Pa^0.5)";
  const auto known = others.find(quantity.unit);
  if (known != others.end()) {
    remedy = known->second;
  } else if (quantity.unit.front() == ',') {
    remedy = "write a decimal point, not a comma";
  } else if (wanted != nullptr) {
    remedy = suggestion(quantity.unit, split(alternatives(*wanted)), remedy);
  }
  faults_.add(
      "unknown-unit", where, named(where) + " is " + description(text) + ", and \"" + quantity.unit + "\" is no unit",
      wanted == nullptr ? "a unit such as MPa, mm or kg/m^3" : "a unit for " + shown + ": " + alternatives(*wanted),
      remedy);
  return std::nullopt;
}

std::optional<double> Numbers::read(const Value& value, const std::string& where, std::string_view unit_text,
                                    const Drives& drives) {
  const std::optional<Unit> wanted = parse_unit(unit_text);
  const std::string shown(unit_text.empty() ? "1" : unit_text);
  if (const double* number = value.number()) return is_finite(*number, where) ? std::optional(*number) : std::nullopt;
  const std::string* text = value.text();
  if (text == nullptr) {
    faults_.add(
        "wrong-kind", where, named(where) + " is " + description(value),
        shown == "1" ? std::string("a number") : "a number in " + shown + ", or text such as \"1 " + shown + "\"",
        "write one number");
    return std::nullopt;
  }
  if (!text->empty() && text->front() == '=') {
    Known* constant = find_constant(text->substr(1), where, wanted, shown);
    if (constant == nullptr) return std::nullopt;
    if (drives) drives(*constant);
    return constant->value;
  }
  const std::optional<Quantity> quantity = quantity_of(*text, where, shown);
  if (!quantity) return std::nullopt;
  if (quantity->unit.empty()) return quantity->value;  // "0.3" as text: SI, like a plain number
  const std::optional<Unit> unit = unit_of(*quantity, *text, where, wanted ? &*wanted : nullptr, shown);
  if (!unit) return std::nullopt;
  if (wanted && !unit->same_dimension(*wanted)) {
    faults_.add("wrong-unit", where, named(where) + " is " + description(value),
                shown == "1" ? std::string("a number without unit") : "a quantity in " + shown,
                shown == "1" ? std::string("write the number alone")
                             : "use one of " + alternatives(*wanted) + ", or a plain number, which is in " + shown);
    return std::nullopt;
  }
  const double number = unit->to_si(quantity->value);
  return is_finite(number, where) ? std::optional(number) : std::nullopt;
}

/// What "=name" stands for; null after a fault.
Numbers::Known* Numbers::find_constant(const std::string& name, const std::string& where,
                                       const std::optional<Unit>& wanted, const std::string& shown) {
  const auto constant = constants_.find(name);
  if (constant == constants_.end()) {
    std::vector<std::string> names;
    for (const auto& [key, unused] : constants_) names.push_back(key);
    const bool expression = name.find_first_of("+-*/^() ") != std::string::npos;
    const std::string meant = expression ? "" : closest(name, names);
    used_.insert(meant);
    for (const std::string& key : names) {
      if (expression && name.find(key) != std::string::npos) used_.insert(key);
    }
    faults_.add(
        "unknown-constant", where, named(where) + " is \"=" + name + "\", and there is no constant \"" + name + '"',
        names.empty() ? "a name from the section \"constants\", which is empty" : "one of: " + quoted_list(names),
        expression      ? "expressions are not read: add a constant with the number"
        : meant.empty() ? "add it to \"constants\""
                        : "did you mean \"=" + meant + "\"?");
    return nullptr;
  }
  used_.insert(name);
  if (!constant->second.sound) return nullptr;  // reported already
  if (!constant->second.plain && wanted && !constant->second.unit.same_dimension(*wanted)) {
    faults_.add("wrong-unit", where,
                named(where) + " is \"=" + name + "\", and that constant is " + constant->second.written,
                "a quantity in " + shown, "use a constant in one of " + alternatives(*wanted));
    return nullptr;
  }
  return &constant->second;
}

std::vector<Constant> Numbers::constants() const {
  std::vector<Constant> list;
  for (const auto& [name, constant] : constants_) list.push_back(constant);
  return list;
}

namespace {

bool refers(const Value& value, const std::string& reference) {
  if (value.text() != nullptr) return *value.text() == reference;
  if (value.list() != nullptr) {
    return std::any_of(value.list()->begin(), value.list()->end(),
                       [&](const Value& item) { return refers(item, reference); });
  }
  if (value.object() == nullptr) return false;
  return std::any_of(value.object()->begin(), value.object()->end(),
                     [&](const Member& m) { return refers(m.value, reference); });
}

}  // namespace

void Numbers::report_unused(const Value& root) {
  const Value* section = root.find("constants");
  if (section == nullptr || section->object() == nullptr) return;
  const bool all_read = faults_.list.empty();  // else it may be used where nothing could be read
  for (const Member& member : *section->object()) {
    if (used_.contains(member.key) || (!all_read && refers(root, "=" + member.key))) continue;
    faults_.add("unused", pointer("/constants", member.key), "constant \"" + member.key + "\" is used nowhere",
                "every constant to be used", "remove it, or refer to it as \"=" + member.key + "\"", true);
  }
}

}  // namespace bramah::compiling
