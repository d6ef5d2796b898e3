#include "system/compile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "system/compile_parts.hpp"

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
  Diagnostic d;
  d.code = std::move(code);
  d.pointer = std::move(where);
  d.found = std::move(found);
  d.expected = std::move(expected);
  d.remedy = std::move(remedy);
  d.at_key = at_key;
  list.push_back(std::move(d));
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

}  // namespace compiling

namespace {

using namespace compiling;

/// One component of the scene on its way into the system.
struct Draft {
  std::string name;
  std::string where;
  const Value* value = nullptr;
  const bramah_type* type = nullptr;
  std::vector<std::vector<double>> numbers;  // per parameter
  std::vector<std::string> texts;
  bool sound = false;           // parameters complete; only sound components become instances
  std::set<std::string> meant;  // keys that misspelt ones probably stand for: they are not missing, too
  Index group = -1, position = -1;
  Index first_x = 0, first_z = 0, first_holonomic = 0, first_nonholonomic = 0, first_output = 0;
  Index input = -1;                          // of a signal
  std::vector<double> constants;             // of the constants extension
  Index x_constants = -1, z_constants = -1;  // where they went
};

std::string parameter_unit(const bramah_type& type, const char* unit, const Draft& draft) {
  if (unit[0] != '@') return unit;
  for (std::int32_t i = 0; i < type.parameter_count; ++i) {
    if (std::string_view(type.parameters[i].name) == unit + 1) return draft.texts[static_cast<std::size_t>(i)];
  }
  return "";
}

class Compiler {
 public:
  Compiler(const Scene& scene, std::shared_ptr<Registry> registry, std::vector<Diagnostic> earlier)
      : scene_(scene), registry_(std::move(registry)), earlier_(std::move(earlier)), numbers_(faults_) {}

  /// Goes on after faults as far as sense allows, so that one run reports all of them. Components with faults have no
  /// instance, those of unknown type nothing but a name; what they would have been asked for is not judged.
  Compiled run() {
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
    system().registry = registry_;
    return std::move(compiled_);
  }

 private:
  System& system() { return compiled_.system; }

  void stop_if_faulty() {
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

  void load_libraries() {
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

  void read_components() {
    const Value* components = scene_.root.find("components");
    if (components == nullptr || components->object() == nullptr || components->object()->empty()) {
      faults_.add("no-components", components == nullptr ? "" : "/components", "no components",
                  "at least one component", "describe the machine under \"components\"");
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

  void find_type(Draft& draft) {
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
    if (draft.type != nullptr) return;
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
    if (broken_libraries_.count(library) > 0) return;
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

  /// Names of all types of one of the scene's libraries, or of all of them.
  [[nodiscard]] std::vector<std::string> known_types(std::string_view library) const {
    std::vector<std::string> known;
    for (const std::string& name : registry_->type_names()) {
      const std::string of = name.substr(0, name.find('/'));
      const bool listed = std::find(libraries_.begin(), libraries_.end(), of) != libraries_.end();
      if (listed && (library.empty() || of == library)) known.push_back(name);
    }
    return known;
  }

  void read_parameters(Draft& draft) {
    const bramah_type& type = *draft.type;
    const std::size_t before = faults_.list.size();
    std::vector<std::string> keys;
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

  void read_parameter(Draft& draft, const bramah_parameter_info& info, std::size_t index) {
    const Value* value = draft.value->find(info.name);
    const std::string where = pointer(draft.where, info.name);
    std::vector<double>& numbers = draft.numbers[index];
    const std::string unit = parameter_unit(*draft.type, info.unit, draft);
    if (value == nullptr) {
      if (info.required != 0) {
        if (draft.meant.count(info.name) > 0) return;
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
          faults_.add("wrong-choice", where, named(where) + " is " + description(*value),
                      "one of: " + quoted_list(words),
                      value->text() == nullptr ? "write one of these words"
                                               : suggestion(*value->text(), words, "write one of these words"));
          return;
        }
        numbers = {static_cast<double>(chosen)};
        return;
      }
      case BRAMAH_NUMBER:
        if (const auto number = numbers_.read(*value, where, unit)) {
          numbers = {*number};
          check_limits(info, *number, unit, where);
        } else {
          draft.sound = false;
        }
        return;
      default:
        break;
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
      const std::string here = pointer(where, k++);
      if (const auto number = numbers_.read(item, here, unit)) {
        numbers.push_back(*number);
        check_limits(info, *number, unit, here);
      } else {
        draft.sound = false;
      }
    }
  }

  static std::string list_of(const bramah_parameter_info& info, const std::string& unit) {
    std::string text = "a list of ";
    if (info.kind == BRAMAH_VECTOR) text += std::to_string(info.count) + " ";
    return text + "numbers" + (unit.empty() || unit == "1" ? "" : " in " + unit) + ": " + info.doc;
  }

  static int choice_index(const bramah_parameter_info& info, std::string_view word) {
    for (int k = 0; info.choices[k] != nullptr; ++k) {
      if (word == info.choices[k]) return k;
    }
    return -1;
  }

  void check_limits(const bramah_parameter_info& info, double number, std::string_view unit, const std::string& where) {
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

  void make_instances() {
    std::map<const bramah_type*, Index> counts;
    std::vector<const bramah_type*> order;
    for (const Draft& draft : drafts_) {
      if (draft.sound && counts[draft.type]++ == 0) order.push_back(draft.type);
    }
    std::map<const bramah_type*, Index> group_of;
    system().groups.reserve(order.size());
    for (const bramah_type* type : order) {
      group_of[type] = static_cast<Index>(system().groups.size());
      system().groups.emplace_back(*type, counts[type]);
    }
    for (std::size_t k = 0; k < drafts_.size(); ++k) {
      Draft& draft = drafts_[k];
      if (!draft.sound) {
        system().components.push_back({draft.name, draft.type, -1, -1});
        continue;
      }
      draft.group = group_of[draft.type];
      Group& group = system().groups[static_cast<std::size_t>(draft.group)];
      draft.position = static_cast<Index>(group.component.size());
      group.component.push_back(static_cast<Index>(k));
      system().components.push_back({draft.name, draft.type, draft.group, draft.position});
      std::vector<bramah_value> values;
      for (std::size_t i = 0; i < draft.numbers.size(); ++i) {
        values.push_back({sizeof(bramah_value), draft.numbers[i].data(), static_cast<Index>(draft.numbers[i].size()),
                          draft.texts[i].c_str()});
      }
      void* instance = group.instances.at(draft.position);
      if (draft.type->configure(draft.type->self, instance, values.data()) != 0) {
        faults_.add("component-broken", draft.where, std::string(draft.type->name) + " could not be configured",
                    "a working component", "this is a fault of its library");
        stop_if_faulty();
      }
      group.instances.constructed();
      struct Context {
        Faults* faults;
        const Draft* draft;
      } context{&faults_, &draft};
      if (draft.type->check == nullptr) continue;
      draft.type->check(
          draft.type->self, instance,
          [](void* c, const char* parameter, const char* found, const char* expected) {
            auto* here = static_cast<Context*>(c);
            // The parameter may rest on its default; the place is then the component.
            const bool written = parameter != nullptr && here->draft->value->find(parameter) != nullptr;
            here->faults->add("inconsistent", written ? pointer(here->draft->where, parameter) : here->draft->where,
                              (parameter == nullptr ? std::string() : "\"" + std::string(parameter) + "\": ") + found,
                              expected, "change one of them", !written);
          },
          &context);
    }
  }

  void number_variables() {
    System& s = system();
    for (std::size_t k = 0; k < drafts_.size(); ++k) {
      Draft& draft = drafts_[k];
      if (draft.type == nullptr) continue;
      const bramah_type& type = *draft.type;
      const auto component = static_cast<Index>(k);
      const void* instance =
          draft.sound ? s.groups[static_cast<std::size_t>(draft.group)].instances.at(draft.position) : nullptr;
      draft.first_x = s.n();
      draft.first_z = s.nz();
      std::vector<double> x, v, z;
      for (std::int32_t i = 0; i < type.variable_count; ++i) {
        const bramah_variable_info& info = type.variables[i];
        Variable variable;
        variable.name = draft.name + "." + info.name;
        variable.unit = info.unit;
        variable.nominal = info.nominal;
        variable.component = component;
        (info.family == BRAMAH_X ? x : z).push_back(info.start);
        (info.family == BRAMAH_X ? s.x : s.z).push_back(std::move(variable));
      }
      v.assign(x.size(), 0.0);
      if (type.start != nullptr && draft.sound) type.start(type.self, instance, x.data(), v.data(), z.data());
      for (std::size_t i = 0; i < x.size(); ++i) {
        Variable& variable = s.x[static_cast<std::size_t>(draft.first_x) + i];
        variable.start = x[i];
        variable.start_rate = v[i];
      }
      for (std::size_t i = 0; i < z.size(); ++i) s.z[static_cast<std::size_t>(draft.first_z) + i].start = z[i];
      for (std::int32_t i = 0; i < type.terminal_count; ++i) {
        const bramah_terminal_info& terminal = type.terminals[i];
        if (terminal.source != BRAMAH_OWN) continue;
        for (Index j = terminal.first; j < terminal.first + terminal.slots; ++j) {
          auto& list = terminal.family == BRAMAH_X ? s.x : s.z;
          list[static_cast<std::size_t>((terminal.family == BRAMAH_X ? draft.first_x : draft.first_z) + j)].kind =
              terminal.kind;
        }
      }
      draft.first_holonomic = s.m();
      draft.first_nonholonomic = s.l();
      draft.first_output = s.ny();
      const auto add_rows = [&](std::vector<Row>& rows, const bramah_row_info* info, std::int32_t count) {
        for (std::int32_t i = 0; i < count; ++i)
          rows.push_back({draft.name + "." + info[i].name, info[i].unit, component});
      };
      add_rows(s.holonomic, type.holonomic, type.holonomic_count);
      add_rows(s.nonholonomic, type.nonholonomic, type.nonholonomic_count);
      add_rows(s.outputs, type.outputs, type.output_count);
      if (const auto* constants = extension<bramah_constants>(type, BRAMAH_EXTENSION_CONSTANTS)) {
        draft.constants.resize(static_cast<std::size_t>(constants->count));
        if (draft.sound) constants->values(type.self, instance, draft.constants.data());
      }
      if (const auto* signal = extension<bramah_signal>(type, BRAMAH_EXTENSION_SIGNAL)) {
        draft.input = s.nu();
        std::string unit;
        for (std::int32_t i = 0; i < type.terminal_count; ++i) {
          if (type.terminals[i].source == BRAMAH_SIGNAL) unit = parameter_unit(type, type.terminals[i].unit, draft);
        }
        s.inputs.push_back({draft.name, unit, &type, signal, instance, component});
      }
    }
    if (s.n() + s.nz() == 0 && faults_.list.empty() && faults_.unread.empty()) {
      faults_.add("no-variables", "/components", "components without any variable",
                  "at least one body, volume or other owner of variables", "add what moves or stores", true);
    }
  }

  /// Position in State's vectors of constants; made on first use.
  Index constants_of(Draft& draft, int family) {
    System& s = system();
    Index& first = family == BRAMAH_X ? draft.x_constants : draft.z_constants;
    Vector& pool = family == BRAMAH_X ? s.x_constants : s.z_constants;
    if (first < 0) {
      first = static_cast<Index>(pool.size());
      pool.insert(pool.end(), draft.constants.begin(), draft.constants.end());
    }
    return first + (family == BRAMAH_X ? s.n() : s.nz() + s.nu());
  }

  void connect() {
    System& s = system();
    for (Group& group : s.groups) {
      group.x.reserve(static_cast<std::size_t>(group.count * group.type->nx));
      group.z.reserve(static_cast<std::size_t>(group.count * group.type->nz));
      group.u.reserve(static_cast<std::size_t>(group.count * group.type->nu));
    }
    std::map<const bramah_port_info*, Index> rests;
    for (Draft& draft : drafts_) {
      if (draft.type == nullptr) continue;
      const bramah_type& type = *draft.type;
      for (std::int32_t i = 0; i < type.port_count; ++i) check_connected(draft, type.ports[i]);
      if (!draft.sound) {
        for (std::int32_t i = 0; i < type.port_count; ++i) {
          if (const Value* value = draft.value->find(type.ports[i].name)) resolve(draft, type.ports[i], *value);
        }
        continue;
      }
      Group& group = s.groups[static_cast<std::size_t>(draft.group)];
      std::vector<std::int32_t>* maps[3] = {&group.x, &group.z, &group.u};
      for (std::int32_t i = 0; i < type.port_count; ++i) {
        const bramah_port_info& port = type.ports[i];
        std::vector<std::int32_t>& map = *maps[port.family];
        const Value* value = draft.value->find(port.name);
        Index first = 0;
        if (value == nullptr) {
          Vector& pool = port.family == BRAMAH_X ? s.x_constants : s.z_constants;
          const auto known = rests.find(&port);
          if (known == rests.end()) {
            first = static_cast<Index>(pool.size());
            rests.emplace(&port, first);
            if (port.rest != nullptr) pool.insert(pool.end(), port.rest, port.rest + port.slots);
          } else {
            first = known->second;
          }
          first += port.family == BRAMAH_X ? s.n() : s.nz() + s.nu();
        } else {
          first = resolve(draft, port, *value);
        }
        for (std::int32_t j = 0; j < port.slots; ++j) map.push_back(static_cast<std::int32_t>(first + j));
      }
      const auto own = [&](std::vector<std::int32_t>& map, std::int32_t slots, std::size_t before, Index first) {
        const auto ports = static_cast<std::int32_t>(map.size() - before);
        for (std::int32_t j = ports; j < slots; ++j) map.push_back(static_cast<std::int32_t>(first + j - ports));
      };
      const auto position = static_cast<std::size_t>(draft.position);
      own(group.x, type.nx, position * static_cast<std::size_t>(type.nx), draft.first_x);
      own(group.z, type.nz, position * static_cast<std::size_t>(type.nz), draft.first_z);
      group.first_holonomic.push_back(draft.first_holonomic);
      group.first_nonholonomic.push_back(draft.first_nonholonomic);
      group.first_output.push_back(draft.first_output);
    }
  }

  static bool fits(const bramah_port_info& port, const bramah_terminal_info& terminal) {
    if (std::string_view(port.kind) == terminal.kind && port.slots == terminal.slots) return true;
    if (port.slots != 1 || terminal.slots != 1 || port.family == BRAMAH_X) return false;
    // A signal may stand for any first-order variable, and any first-order variable may be read as a signal.
    return terminal.source == BRAMAH_SIGNAL || (port.family == BRAMAH_U && terminal.family == BRAMAH_Z);
  }

  /// What the scene offers to a port: names as it would write them.
  [[nodiscard]] std::vector<std::string> fitting(const bramah_port_info& port) const {
    std::vector<std::string> names;
    for (const Draft& other : drafts_) {
      if (other.type == nullptr) continue;
      bool first = true;  // the terminal that the name of the component alone stands for
      for (std::int32_t i = 0; i < other.type->terminal_count; ++i) {
        const bramah_terminal_info& terminal = other.type->terminals[i];
        if (!fits(port, terminal)) continue;
        const bool alone = first && (port.slots > 1 || other.type->terminal_count == 1);
        first = false;
        if (fits_unit(port, terminal, other)) names.push_back(alone ? other.name : other.name + "." + terminal.name);
      }
    }
    return names;
  }

  [[nodiscard]] std::string wanted(const bramah_port_info& port) const {
    const std::vector<std::string> names = fitting(port);
    const std::string unit =
        port.unit[0] == '\0' || port.unit == std::string_view("1") ? "" : std::string(" in ") + port.unit;
    return std::string("a component with a ") + spoken(port.kind) + unit + " (" + port.doc + ")" +
           (names.empty() ? "; the scene has none" : ": " + quoted_list(names));
  }

  static std::string spoken(std::string kind) {
    std::replace(kind.begin(), kind.end(), '_', ' ');
    return kind == "input" ? "signal" : kind;
  }

  void check_connected(const Draft& draft, const bramah_port_info& port) {
    if (port.required == 0 || draft.value->find(port.name) != nullptr || draft.meant.count(port.name) > 0) return;
    faults_.add("missing-port", draft.where,
                std::string("port \"") + port.name + "\" of " + draft.type->name + " is not connected", wanted(port),
                std::string("add \"") + port.name + "\" to \"" + draft.name + '"', true);
  }

  /// Position in State's vectors of what the port connects to; 0 after a fault.
  Index resolve(const Draft& draft, const bramah_port_info& port, const Value& value) {
    const std::string where = pointer(draft.where, port.name);
    if (value.text() == nullptr) {
      faults_.add("wrong-kind", where, named(where) + " is " + description(value), wanted(port),
                  "write \"component\" or \"component.terminal\"");
      return 0;
    }
    const std::string& reference = *value.text();
    const std::size_t dot = reference.find('.');
    const std::string name = reference.substr(0, dot);
    const auto found = by_name_.find(name);
    if (found == by_name_.end()) {
      std::vector<std::string> names = fitting(port);
      for (const Draft& other : drafts_) names.push_back(other.name);
      const std::string meant = closest(reference, names);
      faults_.add("unknown-component", where,
                  named(where) + " is \"" + reference + "\", and there is no component \"" + name + '"', wanted(port),
                  meant.empty() ? suggestion(name, names, "check the spelling, or add the component")
                                : "did you mean \"" + meant + "\"?");
      return 0;
    }
    Draft& other = drafts_[found->second];
    if (other.type == nullptr) return 0;  // reported already
    std::vector<std::string> terminals, names;
    const bramah_terminal_info* chosen = nullptr;
    for (std::int32_t i = 0; i < other.type->terminal_count; ++i) {
      const bramah_terminal_info& terminal = other.type->terminals[i];
      names.push_back(other.name + "." + terminal.name);
      terminals.push_back(names.back() + " (" + spoken(terminal.kind) + ")");
      const bool is_named = dot != std::string::npos && reference.substr(dot + 1) == terminal.name;
      if (chosen == nullptr && (is_named || (dot == std::string::npos && fits(port, terminal)))) chosen = &terminal;
    }
    if (chosen == nullptr || !fits(port, *chosen)) {
      std::string is = named(where) + " is \"" + reference + "\", ", remedy;
      if (chosen != nullptr) {
        is += "a " + spoken(chosen->kind);
      } else {
        const bool is_variable =
            dot != std::string::npos && (system().find_x(reference) >= 0 || system().find_z(reference) >= 0);
        is += is_variable ? "a variable that nothing can be connected to"
              : dot != std::string::npos
                  ? "and " + std::string(other.type->name) + " has no terminal \"" + reference.substr(dot + 1) + '"'
                  : "a " + std::string(other.type->name) + " without " + spoken(port.kind);
        if (dot != std::string::npos) remedy = suggestion(reference, names, "");
      }
      if (remedy.empty()) {
        remedy = terminals.empty()
                     ? "nothing can be connected to \"" + name + "\"; name another component"
                     : "\"" + name + "\" offers " + listed(terminals) + "; name another component or terminal";
      }
      faults_.add("wrong-terminal", where, is, wanted(port), remedy);
      return 0;
    }
    check_units(port, *chosen, other, where);
    switch (chosen->source) {
      case BRAMAH_CONSTANT:
        return constants_of(other, port.family) + chosen->first;
      case BRAMAH_SIGNAL:
        return system().nz() + other.input;
      default:
        return (chosen->family == BRAMAH_X ? other.first_x : other.first_z) + chosen->first;
    }
  }

  static std::string listed(const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
    return text;
  }

  static bool fits_unit(const bramah_port_info& port, const bramah_terminal_info& terminal, const Draft& other) {
    if (port.slots != 1 || port.unit[0] == '\0') return true;
    const std::string offered =
        other.texts.empty() && terminal.unit[0] == '@' ? "" : parameter_unit(*other.type, terminal.unit, other);
    if (offered.empty()) return true;
    const std::optional<Unit> a = parse_unit(port.unit), b = parse_unit(offered);
    return a && b && a->same_dimension(*b);
  }

  void check_units(const bramah_port_info& port, const bramah_terminal_info& terminal, const Draft& other,
                   const std::string& where) {
    if (fits_unit(port, terminal, other) || (!other.sound && terminal.unit[0] == '@')) return;
    const std::string offered = parameter_unit(*other.type, terminal.unit, other);
    faults_.add("wrong-unit", where,
                named(where) + " is \"" + other.name + "." + terminal.name + "\", " +
                    (offered == "1" ? "which has no unit" : "in " + offered),
                wanted(port),
                terminal.unit[0] == '@' ? "give \"" + other.name + "\" the " + (terminal.unit + 1) + " \"" + port.unit +
                                              "\", or name another component"
                : fitting(port).empty() ? std::string("add such a component")
                                        : std::string("name another component or terminal"));
  }

  void read_start() {
    const Value* start = scene_.root.find("start");
    if (start == nullptr || start->object() == nullptr) return;
    System& s = system();
    std::unordered_map<std::string, Variable*> positions, rates;
    for (Variable& v : s.x) {
      positions.emplace(v.name, &v);
      rates.emplace(v.name + ".rate", &v);
    }
    for (Variable& v : s.z) positions.emplace(v.name, &v);
    for (const Member& member : *start->object()) {
      const std::string where = pointer("/start", member.key);
      if (const auto p = positions.find(member.key); p != positions.end()) {
        if (const auto number = numbers_.read(member.value, where, p->second->unit)) {
          p->second->start = *number;
          p->second->start_given = true;
        }
      } else if (const auto r = rates.find(member.key); r != rates.end()) {
        if (const auto number = numbers_.read(member.value, where, rate_unit(r->second->unit))) {
          r->second->start_rate = *number;
          r->second->start_rate_given = true;
        }
      } else if (!faults_.is_unread(member.key)) {
        std::vector<std::string> names;
        for (const auto& [name, unused] : positions) names.push_back(name);
        for (const auto& [name, unused] : rates) names.push_back(name);
        std::sort(names.begin(), names.end());
        faults_.add("unknown-variable", where, "there is no variable \"" + member.key + "\"",
                    names.empty() ? "a variable; the scene has none"
                                  : "a variable of the scene: " + quoted_list(related(member.key, names)),
                    suggestion(member.key, names, "`bramah check SCENE` lists all variables"), true);
      }
    }
  }

  void make_patterns() {
    for (Group& group : system().groups) {
      const bramah_type& type = *group.type;
      const Index mh = type.holonomic_count, rows = mh + type.nonholonomic_count;
      const auto row_count = [&](int block) -> Index {
        switch (row_family(block)) {
          case RowFamily::force:
            return type.nx;
          case RowFamily::storage:
            return type.nz;
          case RowFamily::holonomic:
            return mh;
          case RowFamily::constraint:
            return rows;
          default:
            return type.output_count;
        }
      };
      const auto column_count = [&](int block) -> Index {
        switch (column_family(block)) {
          case ColumnFamily::x:
            return type.nx;
          case ColumnFamily::z:
            return type.nz;
          case ColumnFamily::u:
            return type.nu;
          default:
            return rows;
        }
      };
      std::array<std::vector<std::uint8_t>, BRAMAH_BLOCKS> marks;
      std::uint8_t* pointers[BRAMAH_BLOCKS];
      for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
        const auto k = static_cast<std::size_t>(b);
        marks[k].assign(static_cast<std::size_t>(row_count(b) * column_count(b)) + 1, 0);
        pointers[k] = marks[k].data();
      }
      for (Index i = 0; i < group.count; ++i) {
        if (type.structure(type.self, group.instances.at(i), pointers) == 0) continue;
        const Draft& draft = drafts_[static_cast<std::size_t>(group.component[static_cast<std::size_t>(i)])];
        faults_.add("component-broken", draft.where,
                    std::string(type.name) +
                        " couples what no balance can hold (a storage balance on an acceleration, a force on the rate "
                        "of a first-order variable, or a balance on a multiplier)",
                    "forces of t, x, v, a, z, u and storages of t, x, v, z, zdot, u",
                    "rewrite the component with a variable of its own");
        return;
      }
      // Entries that no instance connects to a variable are never asked for: ground's columns, unconnected ports.
      const System& s = system();
      const auto live = [&](const std::vector<std::int32_t>& map, std::int32_t slots, Index limit) {
        std::vector<bool> result(static_cast<std::size_t>(slots), false);
        for (std::size_t e = 0; e < map.size(); ++e) {
          if (map[e] < limit) result[e % static_cast<std::size_t>(slots)] = true;
        }
        return result;
      };
      const std::vector<bool> live_x = live(group.x, type.nx, s.n()), live_z = live(group.z, type.nz, s.nz()),
                              live_zu = live(group.z, type.nz, s.nz() + s.nu()),
                              live_u = live(group.u, type.nu, s.nz() + s.nu());
      for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
        const auto k = static_cast<std::size_t>(b);
        BlockPattern& pattern = group.patterns[k];
        pattern.rows = row_count(b);
        pattern.columns = column_count(b);
        pattern.start.assign(static_cast<std::size_t>(pattern.columns) + 1, 0);
        for (Index j = 0; j < pattern.columns; ++j) {
          const auto column = static_cast<std::size_t>(j);
          const bool live_column = column_family(b) == ColumnFamily::x ? live_x[column]
                                   : column_family(b) == ColumnFamily::z
                                       ? (b == BRAMAH_G_ZDOT ? live_z[column] : live_zu[column])
                                   : column_family(b) == ColumnFamily::u ? live_u[column]
                                                                         : true;
          for (Index i = 0; live_column && i < pattern.rows; ++i) {
            const auto row = static_cast<std::size_t>(i);
            const bool live_row = row_family(b) == RowFamily::force     ? live_x[row]
                                  : row_family(b) == RowFamily::storage ? live_z[row]
                                                                        : true;
            if (live_row && marks[k][static_cast<std::size_t>(i * pattern.columns + j)] != 0)
              pattern.row.push_back(static_cast<std::int32_t>(i));
          }
          pattern.start[column + 1] = static_cast<std::int32_t>(pattern.row.size());
        }
        group.pattern_views[k] = {pattern.rows, pattern.columns, static_cast<Index>(pattern.row.size()),
                                  pattern.start.data(), pattern.row.data()};
      }
    }
  }

  /// The pattern of a law that branches on the state is full, so that it seems to store wherever it is connected: clears
  /// variables whose storage is zero at the start and at states around it.
  void drop_without_storage(std::vector<bool>& stored) const {
    const System& s = compiled_.system;
    std::vector<bool> seen(s.z.size(), false);
    Blocks blocks(s);
    bool evaluated = false;
    for (int trial = 0; trial < 4 && seen != stored; ++trial) {
      State state = initial_state(s);
      const auto move = [&](Vector& values, const std::vector<Variable>& variables, double share) {
        for (std::size_t i = 0; i < variables.size(); ++i) {
          values[i] += trial * share * variables[i].nominal * (1.0 + 0.618 * static_cast<double>(i % 7));
        }
      };
      move(state.x, s.x, 0.0137);
      move(state.v, s.x, 0.0253);
      move(state.z, s.z, 0.0371);
      if (!blocks.evaluate(s, state, Request{}.blocks({BRAMAH_G_ZDOT})).ok()) continue;
      evaluated = true;
      for (std::size_t k = 0; k < s.groups.size(); ++k) {
        const Group& group = s.groups[k];
        const bramah_pattern& p = group.pattern_views[BRAMAH_G_ZDOT];
        const std::span<const double> values = blocks.block(k, BRAMAH_G_ZDOT);
        for (std::size_t e = 0; e < values.size(); ++e) {
          const std::size_t count = static_cast<std::size_t>(p.count), slots = static_cast<std::size_t>(group.type->nz);
          const std::int32_t row = group.z[e / count * slots + static_cast<std::size_t>(p.row[e % count])];
          if (row < s.nz() && values[e] != 0.0) seen[static_cast<std::size_t>(row)] = true;
        }
      }
    }
    for (std::size_t i = 0; evaluated && i < stored.size(); ++i) stored[i] = stored[i] && seen[i];
  }

  /// A coordinate without inertia or constraint and a first-order variable without storage have no equation.
  void check_structure() {
    if (!faults_.list.empty()) return;
    const System& s = system();
    std::vector<bool> x_held(s.x.size(), false), z_held(s.z.size(), false);
    for (const Group& group : s.groups) {
      const bramah_type& type = *group.type;
      const auto touches = [&](int block, bool by_column, Index local) {
        const bramah_pattern& p = group.pattern_views[static_cast<std::size_t>(block)];
        if (by_column) return p.start[local + 1] > p.start[local];
        return std::find(p.row, p.row + p.count, local) != p.row + p.count;
      };
      for (Index j = 0; j < type.nx; ++j) {
        const bool held = touches(BRAMAH_F_A, false, j) || touches(BRAMAH_R_V, true, j);
        for (Index i = 0; held && i < group.count; ++i) {
          const std::int32_t global = group.x[static_cast<std::size_t>(i * type.nx + j)];
          if (global < s.n()) x_held[static_cast<std::size_t>(global)] = true;
        }
      }
      for (Index j = 0; j < type.nz; ++j) {
        for (Index i = 0; touches(BRAMAH_G_ZDOT, false, j) && i < group.count; ++i) {
          const std::int32_t global = group.z[static_cast<std::size_t>(i * type.nz + j)];
          if (global < s.nz()) z_held[static_cast<std::size_t>(global)] = true;
        }
      }
    }
    const auto of = [&](const Variable& v) { return drafts_[static_cast<std::size_t>(v.component)].where; };
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (x_held[i]) continue;
      faults_.add("no-equation", of(s.x[i]), "coordinate " + s.x[i].name + " has neither inertia nor a constraint",
                  "a body's mass or a constraint that acts on it",
                  "connect what has mass or constrains it, or remove it", true);
    }
    drop_without_storage(z_held);
    for (std::size_t i = 0; i < s.z.size(); ++i) {
      if (z_held[i]) continue;
      const bool pressure = s.z[i].kind == "pressure";
      faults_.add("no-equation", of(s.z[i]), s.z[i].name + " has no storage, so its rate is undefined",
                  pressure ? "a hose, a cylinder chamber or another component that stores there"
                           : "a component that stores there",
                  pressure ? "connect one, or make it a pressure source" : "connect one, or remove it", true);
    }
  }

  const Scene& scene_;
  std::shared_ptr<Registry> registry_;
  std::vector<Diagnostic> earlier_;
  compiling::Faults faults_;
  Numbers numbers_;
  std::vector<std::string> libraries_;
  bool libraries_unread_ = false;  // there is something in their place, and it is reported
  std::set<std::string> broken_libraries_, forgotten_libraries_;
  std::vector<Draft> drafts_;
  std::unordered_map<std::string, std::size_t> by_name_;
  Compiled compiled_;
};

}  // namespace

Compiled compile(const Scene& scene, std::shared_ptr<Registry> registry, std::vector<Diagnostic> earlier) {
  return Compiler(scene, std::move(registry), std::move(earlier)).run();
}

}  // namespace bramah
