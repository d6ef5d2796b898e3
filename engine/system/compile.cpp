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

void Faults::add(std::string code, std::string where, std::string found, std::string expected, std::string remedy, bool at_key) {
  Diagnostic d;
  d.code = std::move(code);
  d.pointer = std::move(where);
  d.found = std::move(found);
  d.expected = std::move(expected);
  d.remedy = std::move(remedy);
  d.at_key = at_key;
  list.push_back(std::move(d));
}

void Numbers::read_constants(const Value* section) {
  if (section == nullptr || section->object() == nullptr) return;
  for (const Member& member : *section->object()) {
    const std::string where = pointer("/constants", member.key);
    Constant constant;
    if (const double* number = member.value.number()) {
      constant.value = *number;
      constant.plain = true;
    } else if (const std::string* text = member.value.text()) {
      const std::optional<Quantity> quantity = parse_quantity(*text);
      const std::optional<Unit> unit = quantity ? parse_unit(quantity->unit) : std::nullopt;
      if (!unit) {
        faults_.add("bad-number", where, description(member.value), "a number, or a number with a unit such as \"1500 MPa\"",
                    "write a constant as a quantity");
        continue;
      }
      constant.value = unit->to_si(quantity->value);
      constant.unit = *unit;
      constant.plain = quantity->unit.empty();
    } else {
      faults_.add("bad-number", where, description(member.value), "a number, or a number with a unit", "");
      continue;
    }
    constants_.emplace(member.key, constant);
  }
}

std::optional<double> Numbers::read(const Value& value, const std::string& where, std::string_view unit_text) {
  const std::optional<Unit> wanted = parse_unit(unit_text);
  const std::string shown(unit_text.empty() ? "1" : unit_text);
  if (const double* number = value.number()) return *number;
  const std::string* text = value.text();
  if (text == nullptr) {
    faults_.add("wrong-kind", where, description(value), "a number in " + shown + ", or text such as \"1 " + shown + "\"",
                "write one number");
    return std::nullopt;
  }
  if (!text->empty() && text->front() == '=') {
    const std::string name = text->substr(1);
    const auto constant = constants_.find(name);
    if (constant == constants_.end()) {
      std::vector<std::string> names;
      for (const auto& [key, unused] : constants_) names.push_back(key);
      faults_.add("unknown-constant", where, "constant \"" + name + "\"",
                  names.empty() ? "a name from the section \"constants\", which is empty" : "one of: " + quoted_list(names),
                  suggestion(name, names, "add it to \"constants\""));
      return std::nullopt;
    }
    used_.insert(name);
    if (!constant->second.plain && wanted && !constant->second.unit.same_dimension(*wanted)) {
      faults_.add("wrong-unit", where, "constant \"" + name + "\" of another dimension", "a quantity in " + shown,
                  "use a constant in " + alternatives(*wanted));
      return std::nullopt;
    }
    return constant->second.value;
  }
  const std::optional<Quantity> quantity = parse_quantity(*text);
  if (!quantity) {
    faults_.add("bad-number", where, description(value), "a number with a unit, such as \"1 " + shown + "\"",
                "write the number first; constants are written \"=name\"");
    return std::nullopt;
  }
  const std::optional<Unit> unit = parse_unit(quantity->unit);
  if (!unit) {
    faults_.add("unknown-unit", where, "unit \"" + quantity->unit + "\"",
                "a unit for " + shown + (wanted ? ": " + alternatives(*wanted) : std::string()),
                "products are written with a dot: N.m, kg.m^2, m^3/(s.Pa^0.5)");
    return std::nullopt;
  }
  if (quantity->unit.empty() && shown != "1") return quantity->value;  // "0.3" as text: SI, like a plain number
  if (wanted && !unit->same_dimension(*wanted)) {
    faults_.add("wrong-unit", where, "\"" + *text + "\"", "a quantity in " + shown,
                "use one of: " + alternatives(*wanted) + "; or a plain number, which is " + shown);
    return std::nullopt;
  }
  return unit->to_si(quantity->value);
}

void Numbers::report_unused(const Value* section) {
  if (section == nullptr || section->object() == nullptr) return;
  for (const Member& member : *section->object()) {
    if (used_.count(member.key) == 0) {
      faults_.add("unused", pointer("/constants", member.key), "constant \"" + member.key + "\" is used nowhere",
                  "every constant to be used", "remove it, or refer to it as \"=" + member.key + "\"", true);
    }
  }
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
  bool sound = false;  // parameters complete
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
  Compiler(const Scene& scene, std::shared_ptr<Registry> registry)
      : scene_(scene), registry_(std::move(registry)), numbers_(faults_) {}

  Compiled run() {
    load_libraries();
    numbers_.read_constants(scene_.root.find("constants"));
    read_components();
    stop_if_faulty();  // without types and parameters nothing further can be said
    make_instances();
    number_variables();
    connect();
    read_start();
    stop_if_faulty();
    make_patterns();
    check_structure();
    system().registry = registry_;
    read_options(scene_.root, compiled_.system, numbers_, faults_, compiled_.options);
    numbers_.report_unused(scene_.root.find("constants"));
    stop_if_faulty();
    return std::move(compiled_);
  }

 private:
  System& system() { return compiled_.system; }

  void stop_if_faulty() {
    if (!faults_.list.empty()) throw SceneError(std::move(faults_.list));
  }

  void load_libraries() {
    const Value* libraries = scene_.root.find("libraries");
    if (libraries == nullptr || libraries->list() == nullptr) return;
    std::size_t index = 0;
    for (const Value& name : *libraries->list()) {
      const std::string where = pointer("/libraries", index++);
      if (name.text() == nullptr) continue;
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
      if (draft.type != nullptr) read_parameters(draft);
      by_name_.emplace(draft.name, drafts_.size());
      drafts_.push_back(std::move(draft));
    }
  }

  void find_type(Draft& draft) {
    const Value* type = draft.value->find("type");
    if (type == nullptr || type->text() == nullptr) {
      faults_.add("missing-type", draft.where, "a component without a type", "a member \"type\" such as \"mechanics/revolute\"",
                  "`bramah list` shows all types");
      return;
    }
    draft.type = registry_->find(*type->text());
    if (draft.type != nullptr) return;
    const std::string library = type->text()->substr(0, type->text()->find('/'));
    if (broken_libraries_.count(library) > 0) return;  // reported already
    const std::string where = pointer(draft.where, "type");
    if (std::find(libraries_.begin(), libraries_.end(), library) == libraries_.end() &&
        type->text()->find('/') != std::string::npos) {
      const std::vector<std::string> offered = registry_->available();
      const bool exists = std::find(offered.begin(), offered.end(), library) != offered.end();
      faults_.add("unknown-type", where, "type \"" + *type->text() + "\"",
                  "a type of the scene's libraries: " + quoted_list(libraries_),
                  exists ? "add \"" + library + "\" to \"libraries\"" : suggestion(library, offered, "`bramah list` shows all types"));
      return;
    }
    std::vector<std::string> known;
    for (const std::string& name : registry_->type_names()) {
      if (name.substr(0, name.find('/')) == library) known.push_back(name);
    }
    if (known.empty()) known = registry_->type_names();
    faults_.add("unknown-type", where, "type \"" + *type->text() + "\"", "one of: " + quoted_list(known),
                suggestion(*type->text(), known, "`bramah list` shows all types"));
  }

  void read_parameters(Draft& draft) {
    const bramah_type& type = *draft.type;
    const std::size_t before = faults_.list.size();
    std::vector<std::string> keys;
    for (std::int32_t i = 0; i < type.port_count; ++i) keys.emplace_back(type.ports[i].name);
    for (std::int32_t i = 0; i < type.parameter_count; ++i) keys.emplace_back(type.parameters[i].name);
    for (const Member& member : *draft.value->object()) {
      if (member.key == "type" || std::find(keys.begin(), keys.end(), member.key) != keys.end()) continue;
      faults_.add("unknown-key", pointer(draft.where, member.key), "unknown key \"" + member.key + "\" of " + type.name,
                  "one of: " + quoted_list(keys), suggestion(member.key, keys, std::string("`bramah describe ") + type.name + "` explains them"), true);
    }
    for (std::int32_t i = 0; i < type.port_count; ++i) {
      const bramah_port_info& port = type.ports[i];
      if (port.required != 0 && draft.value->find(port.name) == nullptr) {
        faults_.add("missing-port", draft.where, std::string("port \"") + port.name + "\" of " + type.name + " is not connected",
                    std::string("the name of a component with a ") + port.kind + " (" + port.doc + ")",
                    std::string("add \"") + port.name + "\": \"...\"", true);
      }
    }
    const auto count = static_cast<std::size_t>(type.parameter_count);
    draft.numbers.resize(count);
    draft.texts.resize(count);
    // Texts first: they may name the unit of the others.
    for (const bool texts : {true, false}) {
      for (std::size_t i = 0; i < count; ++i) {
        if ((type.parameters[i].kind == BRAMAH_TEXT) == texts) read_parameter(draft, type.parameters[i], i);
      }
    }
    draft.sound = faults_.list.size() == before;
  }

  void read_parameter(Draft& draft, const bramah_parameter_info& info, std::size_t index) {
    const Value* value = draft.value->find(info.name);
    const std::string where = pointer(draft.where, info.name);
    std::vector<double>& numbers = draft.numbers[index];
    const std::string unit = parameter_unit(*draft.type, info.unit, draft);
    if (value == nullptr) {
      if (info.required != 0) {
        faults_.add("missing-parameter", draft.where, std::string("parameter \"") + info.name + "\" of " + draft.type->name + " is missing",
                    std::string(info.doc) + (unit.empty() || unit == "1" ? "" : ", in " + unit), std::string("add \"") + info.name + "\"", true);
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
          faults_.add("wrong-kind", where, description(*value), "text", "put it in quotation marks");
          return;
        }
        draft.texts[index] = *value->text();
        if (std::string_view(info.name) == "unit" && !parse_unit(*value->text())) {
          faults_.add("unknown-unit", where, "unit \"" + *value->text() + "\"", "a unit such as \"N.m\"", "`bramah describe units` lists them");
          draft.texts[index] = "1";
        }
        return;
      case BRAMAH_CHOICE: {
        const int chosen = value->text() == nullptr ? -1 : choice_index(info, *value->text());
        if (chosen < 0) {
          std::vector<std::string> words;
          for (const char* const* word = info.choices; *word != nullptr; ++word) words.emplace_back(*word);
          faults_.add("wrong-choice", where, description(*value), "one of: " + quoted_list(words),
                      value->text() == nullptr ? "write one of these words" : suggestion(*value->text(), words, "write one of these words"));
          return;
        }
        numbers = {static_cast<double>(chosen)};
        return;
      }
      case BRAMAH_NUMBER:
        if (const auto number = numbers_.read(*value, where, unit)) {
          numbers = {*number};
          check_limits(info, *number, unit, where);
        }
        return;
      default: break;
    }
    if (value->list() == nullptr) {
      faults_.add("wrong-kind", where, description(*value),
                  info.kind == BRAMAH_VECTOR ? "a list of " + std::to_string(info.count) + " numbers in " + unit : "a list of numbers in " + unit,
                  "write [a, b, ...]");
      return;
    }
    if (info.kind == BRAMAH_VECTOR && static_cast<Index>(value->list()->size()) != info.count) {
      faults_.add("wrong-length", where, description(*value), "a list of " + std::to_string(info.count) + " numbers", "");
      return;
    }
    std::size_t k = 0;
    for (const Value& item : *value->list()) {
      const std::string here = pointer(where, k++);
      if (const auto number = numbers_.read(item, here, unit)) {
        numbers.push_back(*number);
        check_limits(info, *number, unit, here);
      }
    }
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
    if (!low && !high && std::isfinite(number)) return;
    std::string expected;
    if (std::isfinite(info.lower)) expected = (info.lower_open != 0 ? "above " : "at least ") + with_unit(info.lower, unit);
    if (std::isfinite(info.upper)) {
      expected += (expected.empty() ? "" : " and ") + std::string(info.upper_open != 0 ? "below " : "at most ") + with_unit(info.upper, unit);
    }
    faults_.add("out-of-range", where, with_unit(number, unit), expected.empty() ? "a finite number" : expected, info.doc);
  }

  void make_instances() {
    std::map<const bramah_type*, Index> counts;
    std::vector<const bramah_type*> order;
    for (const Draft& draft : drafts_) {
      if (counts[draft.type]++ == 0) order.push_back(draft.type);
    }
    std::map<const bramah_type*, Index> group_of;
    system().groups.reserve(order.size());
    for (const bramah_type* type : order) {
      group_of[type] = static_cast<Index>(system().groups.size());
      system().groups.emplace_back(*type, counts[type]);
    }
    for (std::size_t k = 0; k < drafts_.size(); ++k) {
      Draft& draft = drafts_[k];
      draft.group = group_of[draft.type];
      Group& group = system().groups[static_cast<std::size_t>(draft.group)];
      draft.position = static_cast<Index>(group.component.size());
      group.component.push_back(static_cast<Index>(k));
      system().components.push_back({draft.name, draft.type, draft.group, draft.position});
      std::vector<bramah_value> values;
      for (std::size_t i = 0; i < draft.numbers.size(); ++i) {
        values.push_back({sizeof(bramah_value), draft.numbers[i].data(), static_cast<Index>(draft.numbers[i].size()), draft.texts[i].c_str()});
      }
      void* instance = group.instances.at(draft.position);
      if (draft.type->configure(draft.type->self, instance, values.data()) != 0) {
        faults_.add("component-broken", draft.where, std::string(draft.type->name) + " could not be configured", "a working component",
                    "this is a fault of its library");
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
                              (parameter == nullptr ? std::string() : std::string(parameter) + " = ") + found, expected,
                              "change one of them", !written);
          },
          &context);
    }
  }

  void number_variables() {
    System& s = system();
    for (std::size_t k = 0; k < drafts_.size(); ++k) {
      Draft& draft = drafts_[k];
      const bramah_type& type = *draft.type;
      const auto component = static_cast<Index>(k);
      const void* instance = s.groups[static_cast<std::size_t>(draft.group)].instances.at(draft.position);
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
      if (type.start != nullptr) type.start(type.self, instance, x.data(), v.data(), z.data());
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
          list[static_cast<std::size_t>((terminal.family == BRAMAH_X ? draft.first_x : draft.first_z) + j)].kind = terminal.kind;
        }
      }
      draft.first_holonomic = s.m();
      draft.first_nonholonomic = s.l();
      draft.first_output = s.ny();
      const auto add_rows = [&](std::vector<Row>& rows, const bramah_row_info* info, std::int32_t count) {
        for (std::int32_t i = 0; i < count; ++i) rows.push_back({draft.name + "." + info[i].name, info[i].unit, component});
      };
      add_rows(s.holonomic, type.holonomic, type.holonomic_count);
      add_rows(s.nonholonomic, type.nonholonomic, type.nonholonomic_count);
      add_rows(s.outputs, type.outputs, type.output_count);
      if (const auto* constants = extension<bramah_constants>(type, BRAMAH_EXTENSION_CONSTANTS)) {
        draft.constants.resize(static_cast<std::size_t>(constants->count));
        constants->values(type.self, instance, draft.constants.data());
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
    if (s.n() + s.nz() == 0) {
      faults_.add("no-variables", "/components", "components without any variable", "at least one body, volume or other owner of variables",
                  "add what moves or stores");
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
      const bramah_type& type = *draft.type;
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

  /// Position in State's vectors of what the port connects to; 0 after a fault.
  Index resolve(const Draft& draft, const bramah_port_info& port, const Value& value) {
    const std::string where = pointer(draft.where, port.name);
    const std::string wanted = std::string("the name of a component with a ") + port.kind;
    if (value.text() == nullptr) {
      faults_.add("wrong-kind", where, description(value), wanted + ", as text", "write \"component\" or \"component.terminal\"");
      return 0;
    }
    const std::string& reference = *value.text();
    const std::size_t dot = reference.find('.');
    const std::string name = reference.substr(0, dot);
    const auto found = by_name_.find(name);
    if (found == by_name_.end()) {
      std::vector<std::string> fitting;
      for (const Draft& other : drafts_) {
        for (std::int32_t i = 0; i < other.type->terminal_count; ++i) {
          if (fits(port, other.type->terminals[i])) {
            fitting.push_back(other.name);
            break;
          }
        }
      }
      faults_.add("unknown-component", where, "component \"" + name + "\"", wanted + (fitting.empty() ? "; the scene has none" : ": " + quoted_list(fitting)),
                  suggestion(name, fitting, "check the spelling, or add the component"));
      return 0;
    }
    Draft& other = drafts_[found->second];
    std::vector<std::string> terminals;
    const bramah_terminal_info* chosen = nullptr;
    for (std::int32_t i = 0; i < other.type->terminal_count; ++i) {
      const bramah_terminal_info& terminal = other.type->terminals[i];
      terminals.push_back(other.name + "." + terminal.name + " (" + terminal.kind + ")");
      const bool named = dot != std::string::npos && reference.substr(dot + 1) == terminal.name;
      if (chosen == nullptr && (named || (dot == std::string::npos && fits(port, terminal)))) chosen = &terminal;
    }
    if (chosen == nullptr || !fits(port, *chosen)) {
      faults_.add("wrong-terminal", where, "\"" + reference + "\"" + (chosen == nullptr ? std::string(", which ") + other.type->name + (dot == std::string::npos ? " has no fitting terminal for" : " does not have") : std::string(", a ") + chosen->kind),
                  std::string("a ") + port.kind + (terminals.empty() ? "; this component has no terminals" : "; it has " + quoted_list(terminals)),
                  "connect \"" + std::string(port.name) + "\" to another component");
      return 0;
    }
    check_units(port, *chosen, other, where);
    switch (chosen->source) {
      case BRAMAH_CONSTANT: return constants_of(other, port.family) + chosen->first;
      case BRAMAH_SIGNAL: return system().nz() + other.input;
      default: return (chosen->family == BRAMAH_X ? other.first_x : other.first_z) + chosen->first;
    }
  }

  void check_units(const bramah_port_info& port, const bramah_terminal_info& terminal, const Draft& other, const std::string& where) {
    const std::string offered = parameter_unit(*other.type, terminal.unit, other);
    if (port.unit[0] == '\0' || offered.empty() || port.slots != 1) return;
    const std::optional<Unit> a = parse_unit(port.unit), b = parse_unit(offered);
    if (a && b && a->same_dimension(*b)) return;
    faults_.add("wrong-unit", where, "\"" + other.name + "\" in " + offered, std::string("a signal or variable in ") + port.unit,
                "give \"" + other.name + "\" the unit \"" + port.unit + "\", or connect something else");
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
      } else {
        std::vector<std::string> names;
        for (const auto& [name, unused] : positions) names.push_back(name);
        for (const auto& [name, unused] : rates) names.push_back(name);
        std::sort(names.begin(), names.end());
        faults_.add("unknown-variable", where, "variable \"" + member.key + "\"", "a variable of the scene: " + quoted_list(names),
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
          case RowFamily::force: return type.nx;
          case RowFamily::storage: return type.nz;
          case RowFamily::holonomic: return mh;
          case RowFamily::constraint: return rows;
          default: return type.output_count;
        }
      };
      const auto column_count = [&](int block) -> Index {
        switch (column_family(block)) {
          case ColumnFamily::x: return type.nx;
          case ColumnFamily::z: return type.nz;
          case ColumnFamily::u: return type.nu;
          default: return rows;
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
                    std::string(type.name) + " couples what no balance can hold (a storage balance on an acceleration, a force on the rate of a first-order variable, or a balance on a multiplier)",
                    "forces of t, x, v, a, z, u and storages of t, x, v, z, zdot, u", "rewrite the component with a variable of its own");
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
                              live_zu = live(group.z, type.nz, s.nz() + s.nu()), live_u = live(group.u, type.nu, s.nz() + s.nu());
      for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
        const auto k = static_cast<std::size_t>(b);
        BlockPattern& pattern = group.patterns[k];
        pattern.rows = row_count(b);
        pattern.columns = column_count(b);
        pattern.start.assign(static_cast<std::size_t>(pattern.columns) + 1, 0);
        for (Index j = 0; j < pattern.columns; ++j) {
          const auto column = static_cast<std::size_t>(j);
          const bool live_column = column_family(b) == ColumnFamily::x   ? live_x[column]
                                   : column_family(b) == ColumnFamily::z ? (b == BRAMAH_G_ZDOT ? live_z[column] : live_zu[column])
                                   : column_family(b) == ColumnFamily::u ? live_u[column]
                                                                         : true;
          for (Index i = 0; live_column && i < pattern.rows; ++i) {
            const auto row = static_cast<std::size_t>(i);
            const bool live_row = row_family(b) == RowFamily::force ? live_x[row] : row_family(b) == RowFamily::storage ? live_z[row] : true;
            if (live_row && marks[k][static_cast<std::size_t>(i * pattern.columns + j)] != 0) pattern.row.push_back(static_cast<std::int32_t>(i));
          }
          pattern.start[column + 1] = static_cast<std::int32_t>(pattern.row.size());
        }
        group.pattern_views[k] = {pattern.rows, pattern.columns, static_cast<Index>(pattern.row.size()), pattern.start.data(), pattern.row.data()};
      }
    }
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
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (x_held[i]) continue;
      faults_.add("no-equation", drafts_[static_cast<std::size_t>(s.x[i].component)].where, "coordinate " + s.x[i].name + " has neither inertia nor a constraint",
                  "a body's mass or a constraint that acts on it", "connect it, or remove it", true);
    }
    for (std::size_t i = 0; i < s.z.size(); ++i) {
      if (z_held[i]) continue;
      faults_.add("no-equation", drafts_[static_cast<std::size_t>(s.z[i].component)].where, s.z[i].name + " has no storage, so its rate is undefined",
                  "a hose, a cylinder chamber or another component that stores there", "connect one, or use a pressure source", true);
    }
  }

  const Scene& scene_;
  std::shared_ptr<Registry> registry_;
  compiling::Faults faults_;
  Numbers numbers_;
  std::vector<std::string> libraries_;
  std::set<std::string> broken_libraries_;
  std::vector<Draft> drafts_;
  std::unordered_map<std::string, std::size_t> by_name_;
  Compiled compiled_;
};

}  // namespace

Compiled compile(const Scene& scene, std::shared_ptr<Registry> registry) {
  return Compiler(scene, std::move(registry)).run();
}

}  // namespace bramah
