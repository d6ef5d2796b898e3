#include "system/scene_number.hpp"

#include <algorithm>
#include <charconv>

#include "system/analysis_error.hpp"
#include "system/compile_parts.hpp"

namespace bramah {

namespace {

[[noreturn]] void refuse(std::string_view name, const std::string& found, const std::string& expected,
                         const std::string& remedy, const std::string& where = {}) {
  throw AnalysisError("derivatives by \"" + std::string(name) + '"', found, expected, remedy, where);
}

const std::vector<double>& numbers_of(const System& system, const ParameterRef& p) {
  return system.components[static_cast<std::size_t>(p.component)].numbers[static_cast<std::size_t>(p.parameter)];
}

bool is_number(const bramah_parameter_info& info) {
  return info.kind == BRAMAH_NUMBER || info.kind == BRAMAH_VECTOR || info.kind == BRAMAH_LIST;
}

bool is_differentiable(const bramah_type& type, std::int32_t parameter) {
  const auto* tangent = extension<bramah_tangent>(type, BRAMAH_EXTENSION_TANGENT);
  return tangent != nullptr && tangent->differentiable[parameter] != 0;
}

const Component& component_of(const System& system, const ParameterRef& p) {
  return system.components[static_cast<std::size_t>(p.component)];
}

std::string unit_of(const System& system, const ParameterRef& p) {
  const Component& c = component_of(system, p);
  return parameter_unit(*c.type, c.type->parameters[p.parameter].unit, c.texts);
}

void check_differentiable(const System& system, std::string_view name, const ParameterRef& p) {
  const Component& c = component_of(system, p);
  const char* const parameter = c.type->parameters[p.parameter].name;
  if (is_differentiable(*c.type, p.parameter)) return;
  const bool any = extension<bramah_tangent>(*c.type, BRAMAH_EXTENSION_TANGENT) != nullptr;
  refuse(name, std::string("the type ") + c.type->name + " gives no derivatives by \"" + parameter + '"',
         any ? "a parameter that the type declares as bramah::Parameter" : "a type that gives second derivatives",
         any ? std::string("declare \"") + parameter + "\" as bramah::Parameter in the component, not as double"
             : std::string("build its library again with this SDK, or add the extension ") + BRAMAH_EXTENSION_TANGENT,
         pointer(pointer("/components", c.name), parameter));
}

SceneNumber parameter_number(const System& system, std::string name, const ParameterRef& p) {
  SceneNumber number;
  number.name = std::move(name);
  number.value = numbers_of(system, p)[static_cast<std::size_t>(p.element)];
  number.unit = unit_of(system, p);
  number.parameters = {p};
  return number;
}

const Variable& variable_of(const System& system, const StartRef& s) {
  return (s.kind == StartRef::Kind::z ? system.z : system.x)[static_cast<std::size_t>(s.index)];
}

SceneNumber start_number(const System& system, const StartRef& s) {
  const Variable& variable = variable_of(system, s);
  const bool rate = s.kind == StartRef::Kind::v;
  SceneNumber number;
  number.name = "start." + variable.name + (rate ? ".rate" : "");
  number.value = rate ? variable.start_rate : variable.start;
  number.unit = rate ? compiling::rate_unit(variable.unit) : variable.unit;
  number.starts = {s};
  return number;
}

SceneNumber constant_number(const System& system, const Constant& constant) {
  SceneNumber number;
  number.name = "constants." + constant.name;
  number.value = constant.value;
  number.parameters = constant.parameters;
  number.starts = constant.starts;
  if (!number.parameters.empty()) {
    number.unit = unit_of(system, number.parameters.front());
  } else if (!number.starts.empty()) {
    number.unit = start_number(system, number.starts.front()).unit;
  }
  return number;
}

SceneNumber find_constant(const System& system, std::string_view name, std::string_view key) {
  std::vector<std::string> names;
  for (const Constant& constant : system.constants) {
    names.push_back("constants." + constant.name);
    if (constant.name != key) continue;
    if (constant.parameters.empty() && constant.starts.empty()) {
      refuse(name, "no parameter and no start value is written \"=" + constant.name + '"',
             "a constant that the machine depends on", "name another number", pointer("/constants", constant.name));
    }
    for (const ParameterRef& p : constant.parameters) check_differentiable(system, name, p);
    return constant_number(system, constant);
  }
  refuse(name, "there is no such constant",
         names.empty() ? "a constant of the scene, which has none" : "one of: " + quoted_list(names),
         suggestion(name, names, "name a constant of the scene"), "/constants");
}

/// The start values that the scene gives.
std::vector<StartRef> given_starts(const System& system) {
  std::vector<StartRef> list;
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    if (system.x[i].start_given) list.push_back({StartRef::Kind::x, static_cast<Index>(i)});
    if (system.x[i].start_rate_given) list.push_back({StartRef::Kind::v, static_cast<Index>(i)});
  }
  for (std::size_t i = 0; i < system.z.size(); ++i) {
    if (system.z[i].start_given) list.push_back({StartRef::Kind::z, static_cast<Index>(i)});
  }
  return list;
}

SceneNumber find_start(const System& system, std::string_view name) {
  std::vector<std::string> names;
  for (const StartRef& s : given_starts(system)) {
    SceneNumber number = start_number(system, s);
    if (number.name == name) return number;
    names.push_back(std::move(number.name));
  }
  refuse(name, "the scene gives no such start value",
         names.empty() ? "a start value that the scene gives; it gives none" : "one of: " + quoted_list(names),
         suggestion(name, names, "add it to \"start\""), "/start");
}

/// Names of all numbers of a component that are differentiable.
std::vector<std::string> names_of(const System& system, Index index) {
  std::vector<std::string> names;
  const Component& c = system.components[static_cast<std::size_t>(index)];
  for (std::int32_t p = 0; p < c.type->parameter_count; ++p) {
    const bramah_parameter_info& info = c.type->parameters[p];
    if (!is_number(info) || !is_differentiable(*c.type, p)) continue;
    const std::string name = c.name + "." + info.name;
    if (info.kind == BRAMAH_NUMBER) names.push_back(name);
    for (std::size_t k = 0; info.kind != BRAMAH_NUMBER && k < c.numbers[static_cast<std::size_t>(p)].size(); ++k)
      names.push_back(name + "." + std::to_string(k));
  }
  return names;
}

SceneNumber find_parameter(const System& system, std::string_view name, Index index, std::string_view rest) {
  const Component& c = system.components[static_cast<std::size_t>(index)];
  const std::size_t dot = rest.find('.');
  const std::string_view key = rest.substr(0, dot);
  const std::string where = pointer("/components", c.name);
  const std::vector<std::string> names = names_of(system, index);
  const std::string expected = names.empty() ? "a number; " + c.name + " has none" : "one of: " + quoted_list(names);
  for (std::int32_t p = 0; p < c.type->parameter_count; ++p) {
    const bramah_parameter_info& info = c.type->parameters[p];
    if (info.name != key) continue;
    const std::string here = pointer(where, info.name);
    if (!is_number(info))
      refuse(name, std::string("\"") + info.name + "\" is a " + (info.kind == BRAMAH_TEXT ? "text" : "choice"),
             expected, "name a number", here);
    const auto count = static_cast<Index>(c.numbers[static_cast<std::size_t>(p)].size());
    ParameterRef ref{index, p, 0};
    if (info.kind == BRAMAH_NUMBER && dot != std::string_view::npos)
      refuse(name, std::string("\"") + info.name + "\" is one number", '"' + c.name + "." + info.name + '"',
             "leave out what follows", here);
    if (info.kind != BRAMAH_NUMBER) {
      const std::string_view text = dot == std::string_view::npos ? "" : rest.substr(dot + 1);
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ref.element);
      const bool whole = error == std::errc() && end == text.data() + text.size();
      if (!whole || ref.element < 0 || ref.element >= count)
        refuse(name, std::string("\"") + info.name + "\" is a list of " + std::to_string(count) + " numbers",
               "one of them: " + c.name + "." + info.name + ".0 to ." + std::to_string(count - 1),
               "name one element, counted from 0", here);
    }
    check_differentiable(system, name, ref);
    return parameter_number(system, std::string(name), ref);
  }
  refuse(name, std::string(c.type->name) + " has no parameter \"" + std::string(key) + '"', expected,
         suggestion(name, names, std::string("`bramah describe ") + c.type->name + "` explains them"), where);
}

}  // namespace

SceneNumber find_number(const System& system, std::string_view name) {
  const std::size_t dot = name.find('.');
  const std::string_view first = name.substr(0, dot);
  const std::string_view rest = dot == std::string_view::npos ? std::string_view() : name.substr(dot + 1);
  std::vector<std::string> names;
  for (std::size_t k = 0; k < system.components.size(); ++k) {
    if (system.components[k].name == first) return find_parameter(system, name, static_cast<Index>(k), rest);
    names.push_back(system.components[k].name);
  }
  if (first == "constants") return find_constant(system, name, rest);
  if (first == "start") return find_start(system, name);
  refuse(name, "there is no component \"" + std::string(first) + '"',
         "component.parameter, component.parameter.0, constants.name or start.variable",
         suggestion(first, names, "`bramah check SCENE` lists all components"));
}

std::vector<SceneNumber> differentiable_numbers(const System& system) {
  std::vector<SceneNumber> list;
  std::vector<ParameterRef> driven;
  std::vector<StartRef> started;
  for (const Constant& constant : system.constants) {
    driven.insert(driven.end(), constant.parameters.begin(), constant.parameters.end());
    started.insert(started.end(), constant.starts.begin(), constant.starts.end());
    const bool all = std::all_of(constant.parameters.begin(), constant.parameters.end(), [&](const ParameterRef& p) {
      return is_differentiable(*component_of(system, p).type, p.parameter);
    });
    if (all && !(constant.parameters.empty() && constant.starts.empty()))
      list.push_back(constant_number(system, constant));
  }
  for (std::size_t k = 0; k < system.components.size(); ++k) {
    for (const std::string& name : names_of(system, static_cast<Index>(k))) {
      SceneNumber number = find_number(system, name);
      const ParameterRef& own = number.parameters.front();
      const bool by_constant = std::any_of(driven.begin(), driven.end(), [&](const ParameterRef& p) {
        return p.component == own.component && p.parameter == own.parameter && p.element == own.element;
      });
      if (!by_constant) list.push_back(std::move(number));
    }
  }
  for (const StartRef& s : given_starts(system)) {
    const bool by_constant = std::any_of(started.begin(), started.end(),
                                         [&](const StartRef& t) { return t.kind == s.kind && t.index == s.index; });
    if (!by_constant) list.push_back(start_number(system, s));
  }
  return list;
}

}  // namespace bramah
