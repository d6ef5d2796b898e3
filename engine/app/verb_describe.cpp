#include "app/catalogue.hpp"
#include "app/context.hpp"
#include "app/describe_type.hpp"
#include "app/failure.hpp"
#include "app/verbs.hpp"
#include "io/json_writer.hpp"
#include "io/tables.hpp"
#include "system/diagnostic.hpp"
#include "system/units.hpp"

namespace bramah {
namespace {

constexpr const char* kUnitRules =
    "A unit is a product of symbols: \"N.m/rad\", \"m^3/(s.Pa^0.5)\". Operators . * / ^ and parentheses, from left to right\n"
    "(a/b.c is a.c/b). SI prefixes p n u m c d k M G T stand before m g s N Pa J W Hz A K V L rad. Numbers without a unit\n"
    "are SI: \"80 mm\" and 0.08 are the same length.\n";

int describe_units(const Arguments& arguments) {
  Table table{{"unit", "also"}, {}, ""};
  JsonWriter json;
  json.begin_object().key("units").begin_list();
  for (const char* name : {"1",  "m",    "m^2",  "m^3",   "kg",      "kg/m^3",     "kg.m^2",
                           "s",  "Hz",   "rad",  "rad/s", "rad/s^2", "m/s",        "m/s^2",
                           "N",  "N.m",  "N/m",  "N.s/m", "N.m/rad", "N.m.s/rad",  "W",
                           "Pa", "1/Pa", "Pa.s", "m^3/s", "m^3/rad", "m^3/(s.Pa)", "m^3/(s.Pa^0.5)",
                           "A",  "V",    "K"}) {
    std::string others = alternatives(*parse_unit(name));
    const std::size_t comma = others.find(", ");
    others = comma == std::string::npos ? "" : others.substr(comma + 2);
    table.rows.push_back({name, others});
    json.begin_flat_object().member("unit", name).member("also", others).end_object();
  }
  json.end_list().member("rules", kUnitRules).end_object();
  deliver(arguments, "units.json", json.take(), as_text(table) + '\n' + kUnitRules);
  return exit_ok;
}

int run(const Arguments& arguments) {
  if (arguments.subject.empty()) {
    throw Failure::usage("`describe` without a type", "bramah describe TYPE, or bramah describe units",
                         "`bramah list` shows all types");
  }
  if (arguments.subject == "units") return describe_units(arguments);
  const Catalogue catalogue = load_catalogue();
  const bramah_type* type = catalogue.registry.find(arguments.subject);
  if (type != nullptr) {
    deliver(arguments, "describe.json", type_document(catalogue.registry, *type), type_text(catalogue.registry, *type));
    return exit_ok;
  }
  // "throttle" is as good as "hydraulics/throttle" for a guess.
  const std::vector<std::string> names = catalogue.registry.type_names();
  for (const std::string& name : names) {
    if (name.substr(name.find('/') + 1) == arguments.subject) {
      throw Failure::usage("no type \"" + arguments.subject + "\"", "a type with its library",
                           "did you mean \"" + name + "\"?");
    }
  }
  throw Failure::usage(
      "no type \"" + arguments.subject + "\"", "one of: " + quoted_list(names, 40),
      suggestion(arguments.subject, names,
                 "`bramah list` shows all types; a new library's folder goes into BRAMAH_PLUGIN_PATH"));
}

}  // namespace

constinit const Verb verb_describe = {
    "describe", "TYPE", "tell ports, parameters, variables and outputs of a component type",
    R"(Prints what a component connects to, which parameters it takes (unit, limits, default), the variables and constraint
rows it brings, its outputs, and a piece of scene to copy. `bramah describe units` lists the units that scenes may use.

Examples
  bramah describe hydraulics/throttle
  bramah describe units
)",
    run};

}  // namespace bramah
