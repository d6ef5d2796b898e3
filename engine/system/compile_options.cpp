#include <algorithm>
#include <cmath>
#include <functional>

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
    if (value == nullptr || value->object() == nullptr) return;
    for (const Member& member : *value->object()) {
      const std::string where = pointer("/" + std::string(name), member.key);
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
    if (list == nullptr || list->list() == nullptr) {
      const auto all = [&](Measured::Kind kind, const auto& named) {
        for (const auto& one : named) result.push_back({kind, &one - named.data(), one.name, one.unit});
      };
      all(Measured::Kind::x, system_.x);
      all(Measured::Kind::z, system_.z);
      all(Measured::Kind::y, system_.outputs);
      return;
    }
    std::size_t k = 0;
    for (const Value& item : *list->list()) {
      const std::string where = pointer("/outputs", k++);
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
  const System& system_;
  Numbers& numbers_;
  Faults& faults_;
};

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
                 {"from", "from_time", "to_time", "output_step", "output_times", "rel_tol", "max_step"},
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
                   } else if (key == "rel_tol") {
                     reader.number(value, where, "1", 0.0, simulate.rel_tol, true);
                   } else {
                     reader.number(value, where, "s", 0.0, simulate.max_step, true);
                   }
                 });
  if (simulate.asked && !(simulate.to_time > simulate.from_time)) {
    faults.add("out-of-range", "/simulate/to_time",
               "the simulation ends at to_time = " + with_unit(simulate.to_time, "s"),
               "a time after from_time = " + with_unit(simulate.from_time, "s"), "set \"to_time\"");
  }
  if (!std::is_sorted(simulate.output_times.begin(), simulate.output_times.end())) {
    faults.add("out-of-range", "/simulate/output_times", "\"output_times\" go back", "ascending times", "sort them");
  }

  LinearizeOptions& linearize = options.linearize;
  linearize.asked = root.find("linearize") != nullptr;
  reader.section(root, "linearize", {"at", "independent", "admissible_dependent", "side", "times"},
                 [&](const std::string& key, const Value& value, const std::string& where) {
                   if (key == "at") {
                     reader.word<LinearizeOptions::At>(
                         value, where,
                         {{"equilibrium", LinearizeOptions::At::equilibrium}, {"start", LinearizeOptions::At::start}},
                         linearize.at);
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
  if (const Value* title = root.find("title"); title != nullptr && title->text() != nullptr)
    options.study.title = *title->text();
  if (const Value* text = root.find("description"); text != nullptr && text->text() != nullptr)
    options.study.description = *text->text();
}

}  // namespace compiling
}  // namespace bramah
