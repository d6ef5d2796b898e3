// Sound components become instances; their variables and rows get numbers, and the variables start values.
#include <algorithm>
#include <functional>
#include <map>

#include "plugin/border.hpp"
#include "system/compiler.hpp"

namespace bramah::compiling {
namespace {

/// Marks the start values of a component that depend on a number which the scene writes out, by their exact derivatives:
/// a zero that is written is given, one that nobody wrote is not.
void mark_set_starts(System& s, const Draft& draft, std::size_t own_x, std::size_t own_z) {
  const bramah_type& type = *draft.type;
  const auto* tangent = extension<bramah_tangent>(type, BRAMAH_EXTENSION_TANGENT);
  if (tangent == nullptr || tangent->start == nullptr || own_x == 0) return;
  const AtBorder at("configure of tangents", draft.name.c_str(), type);
  std::vector<std::vector<double>> moves = draft.numbers;
  for (auto& list : moves) std::fill(list.begin(), list.end(), 0.0);
  for (std::size_t p = 0; p < moves.size(); ++p) {
    if (tangent->differentiable[p] == 0 || draft.value->find(type.parameters[p].name) == nullptr) continue;
    for (double& move : moves[p]) {
      move = 1.0;
      Instances moving(type, 1);
      if (tangent->configure(type.self, moving.next(), parameter_values(draft.numbers, draft.texts).data(),
                             parameter_values(moves, draft.texts).data()) != 0)
        return;
      moving.constructed();
      std::vector<double> x(own_x), v(own_x), z(own_z);
      tangent->start(type.self, moving.at(0), x.data(), v.data(), z.data());
      for (std::size_t i = 0; i < own_x; ++i) {
        Variable& variable = s.x[static_cast<std::size_t>(draft.first_x) + i];
        variable.start_set |= x[i] != 0.0;
        variable.start_rate_set |= v[i] != 0.0;
      }
      move = 0.0;
    }
  }
}

}  // namespace

void Compiler::make_instances() {
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
      Component& component = system().components.emplace_back();
      component.name = draft.name;
      component.type = draft.type;
      component.group = component.position = -1;
      continue;
    }
    draft.group = group_of[draft.type];
    Group& group = system().groups[static_cast<std::size_t>(draft.group)];
    draft.position = static_cast<Index>(group.component.size());
    group.component.push_back(static_cast<Index>(k));
    Component& component = system().components.emplace_back();
    component.name = draft.name;
    component.type = draft.type;
    component.group = draft.group;
    component.position = draft.position;
    component.numbers = draft.numbers;
    component.texts = draft.texts;
    void* instance = group.instances.next();
    const AtBorder at("configure", draft.name.c_str(), *draft.type);
    if (draft.type->configure(draft.type->self, instance, parameter_values(draft.numbers, draft.texts).data()) != 0) {
      const std::string why = take_fault(*draft.type);
      faults_.add("component-broken", draft.where,
                  std::string(draft.type->name) + " could not be configured" + (why.empty() ? "" : ": " + why),
                  "a working component", "this is a fault of its library");
      stop_if_faulty();
    }
    if (!group.instances.constructed()) {
      faults_.add("component-broken", draft.where,
                  std::string(draft.type->name) + " writes behind the " + std::to_string(draft.type->instance_bytes) +
                      " bytes of its instance",
                  "a table whose instance_bytes is the size of an instance", "repair the table of its library");
      stop_if_faulty();
    }
    struct Context {
      Faults* faults;
      const Draft* draft;
    } context{&faults_, &draft};
    if (draft.type->check == nullptr) continue;
    const AtBorder at_check("check", draft.name.c_str(), *draft.type);
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

void Compiler::number_variables() {
  System& s = system();
  for (std::size_t k = 0; k < drafts_.size(); ++k) {
    Draft& draft = drafts_[k];
    if (draft.type == nullptr) continue;
    const bramah_type& type = *draft.type;
    const AtBorder at("start or constants", draft.name.c_str(), type);
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
    if (draft.sound) mark_set_starts(s, draft, x.size(), z.size());
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
        if (type.terminals[i].source == BRAMAH_SIGNAL) unit = parameter_unit(type, type.terminals[i].unit, draft.texts);
      }
      s.inputs.push_back({draft.name, unit, &type, signal, instance, component});
    }
  }
  if (s.n() + s.nz() == 0 && faults_.list.empty() && faults_.unread.empty()) {
    faults_.add("no-variables", "/components", "components without any variable",
                "at least one body, volume or other owner of variables", "add what moves or stores", true);
  }
}

void Compiler::keep_origins() {
  System& s = system();
  for (std::size_t k = 0; k < drafts_.size(); ++k) {
    const Draft& draft = drafts_[k];
    Component& component = s.components[k];
    component.first_x = draft.first_x;
    component.first_z = draft.first_z;
    component.input = draft.input;
    if (draft.x_constants >= 0) component.x_constants = s.n() + draft.x_constants;
    if (draft.z_constants >= 0) component.z_constants = s.nz() + s.nu() + draft.z_constants;
  }
  s.constants = numbers_.constants();
}

void Compiler::read_start() {
  const Value* start = scene_.root.find("start");
  if (start == nullptr || start->object() == nullptr) return;
  System& s = system();
  std::unordered_map<std::string, Variable*> positions, rates;
  for (Variable& v : s.x) {
    positions.emplace(v.name, &v);
    rates.emplace(v.name + ".rate", &v);
  }
  for (Variable& v : s.z) positions.emplace(v.name, &v);
  const auto start_of = [&](const Variable& v) -> StartRef {
    const bool second = std::less_equal<>()(s.x.data(), &v) && std::less<>()(&v, s.x.data() + s.x.size());
    if (second) return {StartRef::Kind::x, &v - s.x.data()};
    return {StartRef::Kind::z, &v - s.z.data()};
  };
  for (const Member& member : *start->object()) {
    const std::string where = pointer("/start", member.key);
    const auto read = [&](const std::string& unit, StartRef what) {
      return numbers_.read(member.value, where, unit, [&](Constant& c) { c.starts.push_back(what); });
    };
    if (const auto p = positions.find(member.key); p != positions.end()) {
      if (const auto number = read(p->second->unit, start_of(*p->second))) {
        p->second->start = *number;
        p->second->start_given = true;
      }
    } else if (const auto r = rates.find(member.key); r != rates.end()) {
      if (const auto number = read(rate_unit(r->second->unit), {StartRef::Kind::v, r->second - s.x.data()})) {
        r->second->start_rate = *number;
        r->second->start_rate_given = true;
      }
    } else if (!faults_.is_unread(member.key)) {
      std::vector<std::string> names;
      names.reserve(positions.size() + rates.size());
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

}  // namespace bramah::compiling
