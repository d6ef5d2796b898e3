// Ports connected to terminals, and what is said of those that cannot be.
#include <algorithm>
#include <map>
#include <optional>

#include "system/compiler.hpp"

namespace bramah::compiling {

namespace {

bool fits(const bramah_port_info& port, const bramah_terminal_info& terminal) {
  if (std::string_view(port.kind) == terminal.kind && port.slots == terminal.slots) return true;
  if (port.slots != 1 || terminal.slots != 1 || port.family == BRAMAH_X) return false;
  // A signal may stand for any first-order variable, and any first-order variable may be read as a signal.
  return terminal.source == BRAMAH_SIGNAL || (port.family == BRAMAH_U && terminal.family == BRAMAH_Z);
}

bool fits_unit(const bramah_port_info& port, const bramah_terminal_info& terminal, const Draft& other) {
  if (port.slots != 1 || port.unit[0] == '\0') return true;
  const std::string offered =
      other.texts.empty() && terminal.unit[0] == '@' ? "" : parameter_unit(*other.type, terminal.unit, other.texts);
  if (offered.empty()) return true;
  const std::optional<Unit> a = parse_unit(port.unit), b = parse_unit(offered);
  return a && b && a->same_dimension(*b);
}

std::string spoken(std::string kind) {
  std::replace(kind.begin(), kind.end(), '_', ' ');
  return kind == "input" ? "signal" : kind;
}

/// The place of the first slot of a port in the arguments of its family.
std::size_t first_slot(const bramah_type& type, const bramah_port_info& port) {
  std::size_t slot = 0;
  for (const bramah_port_info* before = type.ports; before != &port; ++before) {
    if (before->family == port.family) slot += static_cast<std::size_t>(before->slots);
  }
  return slot;
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return text;
}

}  // namespace

void Compiler::connect() {
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
    const std::size_t faults = faults_.list.size();
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
    if (faults_.list.size() == faults) check_sense(draft, group);
  }
  if (faults_.list.empty()) check_gravity();
}

void Compiler::check_sense(const Draft& draft, const Group& group) {
  const bramah_type& type = *draft.type;
  const auto position = static_cast<std::size_t>(draft.position);
  const auto variable_of = [&](const bramah_port_info& port) {
    const bool is_x = port.family == BRAMAH_X;
    return (is_x ? group.x
                 : group.z)[position * static_cast<std::size_t>(is_x ? type.nx : type.nz) + first_slot(type, port)];
  };
  // What is connected to a component of unknown type has no place.
  const auto is_known = [&](const bramah_port_info& port) {
    const std::string& reference = *draft.value->find(port.name)->text();
    return drafts_[by_name_.at(reference.substr(0, reference.find('.')))].type != nullptr;
  };
  for (std::int32_t i = 0; i < type.port_count; ++i) {
    for (std::int32_t j = 0; j < i; ++j) {
      const bramah_port_info &a = type.ports[j], &b = type.ports[i];
      const bool alike = std::string_view(a.kind) == b.kind && a.family != BRAMAH_U;
      if (!alike || draft.value->find(a.name) == nullptr || draft.value->find(b.name) == nullptr) continue;
      if (variable_of(a) != variable_of(b) || !is_known(a) || !is_known(b)) continue;
      const std::string both = std::string("\"") + a.name + "\" and \"" + b.name + "\" are the same ";
      const std::string where = pointer(draft.where, b.name);
      if (std::string_view(b.kind).ends_with("frame")) {
        faults_.add("inconsistent", where, both + "body", "two bodies", "name the other body, or \"ground\"");
      } else if (std::string_view(b.kind) == "pressure" && a.required != 0 && b.required != 0) {
        faults_.warn("unusual", where, both + "volume", "volumes of their own", "name the other volume");
      }
    }
  }
}

void Compiler::check_gravity() {
  const System& s = system();
  std::vector<const Draft*> without;
  std::size_t with = 0;
  for (const Draft& draft : drafts_) {
    if (draft.type == nullptr || !draft.sound) continue;
    const bramah_type& type = *draft.type;
    const Group& group = s.groups[static_cast<std::size_t>(draft.group)];
    bool planar = false;
    for (std::int32_t k = 0; k < type.terminal_count; ++k)
      planar |= type.terminals[k].source == BRAMAH_OWN && std::string_view(type.terminals[k].kind) == "planar_frame";
    for (std::int32_t k = 0; k < type.port_count; ++k) {
      const bramah_port_info& port = type.ports[k];
      if (port.family != BRAMAH_U || std::string_view(port.kind) != "gravity") continue;
      if (draft.value->find(port.name) == nullptr) {
        without.push_back(&draft);
        continue;
      }
      ++with;
      const auto place =
          static_cast<Index>(group.u[static_cast<std::size_t>(draft.position * type.nu) + first_slot(type, port)]) -
          s.nz() - s.nu();
      if (!planar || place < 0 || place + 3 > static_cast<Index>(s.z_constants.size())) continue;
      const double* g = &s.z_constants[static_cast<std::size_t>(place)];
      if (g[0] == 0.0 && g[1] == 0.0 && g[2] != 0.0)
        faults_.warn("unusual", pointer(draft.where, port.name),
                     "the gravity of \"" + draft.name + "\" is along z and has no part in the plane x-y",
                     "a part in the plane", "give the field an \"acceleration\" such as [0, -9.81, 0]");
    }
  }
  for (const Draft* draft : without) {
    if (with == 0) break;
    faults_.warn("unusual", draft->where, "\"" + draft->name + "\" feels no gravity, and other bodies do",
                 "a port \"gravity\" at all bodies, or at none", "add \"gravity\" to it");
  }
}

std::vector<std::string> Compiler::fitting(const bramah_port_info& port) const {
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

std::string Compiler::wanted(const bramah_port_info& port) const {
  const std::vector<std::string> names = fitting(port);
  const std::string unit =
      port.unit[0] == '\0' || port.unit == std::string_view("1") ? "" : std::string(" in ") + port.unit;
  return std::string("a component with a ") + spoken(port.kind) + unit + " (" + port.doc + ")" +
         (names.empty() ? "; the scene has none" : ": " + quoted_list(names));
}

void Compiler::check_connected(const Draft& draft, const bramah_port_info& port) {
  if (port.required == 0 || draft.value->find(port.name) != nullptr || draft.meant.contains(port.name)) return;
  faults_.add("missing-port", draft.where,
              std::string("port \"") + port.name + "\" of " + draft.type->name + " is not connected", wanted(port),
              std::string("add \"") + port.name + "\" to \"" + draft.name + '"', true);
}

Index Compiler::resolve(const Draft& draft, const bramah_port_info& port, const Value& value) {
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
    case BRAMAH_CONSTANT: return constants_of(other, port.family) + chosen->first;
    case BRAMAH_SIGNAL: return system().nz() + other.input;
    default: return (chosen->family == BRAMAH_X ? other.first_x : other.first_z) + chosen->first;
  }
}

void Compiler::check_units(const bramah_port_info& port, const bramah_terminal_info& terminal, const Draft& other,
                           const std::string& where) {
  if (fits_unit(port, terminal, other) || (!other.sound && terminal.unit[0] == '@')) return;
  const std::string offered = parameter_unit(*other.type, terminal.unit, other.texts);
  faults_.add("wrong-unit", where,
              named(where) + " is \"" + other.name + "." + terminal.name + "\", " +
                  (offered == "1" ? "which has no unit" : "in " + offered),
              wanted(port),
              terminal.unit[0] == '@' ? "give \"" + other.name + "\" the " + (terminal.unit + 1) + " \"" + port.unit +
                                            "\", or name another component"
              : fitting(port).empty() ? std::string("add such a component")
                                      : std::string("name another component or terminal"));
}

Index Compiler::constants_of(Draft& draft, int family) {
  System& s = system();
  Index& first = family == BRAMAH_X ? draft.x_constants : draft.z_constants;
  Vector& pool = family == BRAMAH_X ? s.x_constants : s.z_constants;
  if (first < 0) {
    first = static_cast<Index>(pool.size());
    pool.insert(pool.end(), draft.constants.begin(), draft.constants.end());
  }
  return first + (family == BRAMAH_X ? s.n() : s.nz() + s.nu());
}

}  // namespace bramah::compiling
