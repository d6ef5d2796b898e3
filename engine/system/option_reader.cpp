#include "system/option_reader.hpp"

#include <cmath>

namespace bramah::compiling {
namespace {

constexpr int least_count = 2, most_count = 100000;
constexpr double default_count = 51.0;

}  // namespace

std::optional<Measured> OptionReader::measurement(const std::string& name, const std::string& where) {
  Measured found;
  if (find_measured(system_, name, found)) return found;
  if (faults_.is_unread(name)) return std::nullopt;
  const std::vector<std::string> names = measured_names(system_);
  faults_.add("unknown-output", where, "there is no variable, multiplier or output \"" + name + "\"",
              names.empty() ? "a name; the scene has none" : "one of: " + quoted_list(related(name, names)),
              suggestion(name, names, "`bramah check SCENE` lists all names"));
  return std::nullopt;
}

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
  const auto watched = measurement(*of->text(), pointer(place, "of"));
  if (!watched) return false;
  event.of = *watched;
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

double grid_size(const std::vector<SweptParameter>& over, std::size_t count) {
  auto size = static_cast<double>(count);
  for (const SweptParameter& one : over) size *= static_cast<double>(one.values.size());
  return size;
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
  const double runs = grid_size(vary.over, vary.count);
  if (runs > most_runs) {
    faults_.add("out-of-range", "/vary", "\"vary\" asks for " + number_text(runs) + " runs",
                "at most " + number_text(most_runs), "take fewer values or draws", true);
  }
}

}  // namespace bramah::compiling
