#include <cstdio>
#include <optional>

#include "app/context.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/verbs.hpp"
#include "solve/start.hpp"

namespace bramah {
namespace {

/// The scene's start values made consistent, or why that cannot be.
struct Assembly {
  State state;
  std::optional<Partition> partition;
  std::optional<Failure> failure;
  std::vector<StartNote> notes;
};

Assembly assemble(const Context& context) {
  Assembly result;
  try {
    result.state = consistent_start(context.system(), context.options(), context.start_time());
    result.notes = tell_start_notes(context, false);
    result.partition = choose_partition(context.system(), result.state, context.options().linearize.prescribed);
  } catch (const AnalysisError& error) {
    result.state = initial_state(context.system(), context.start_time());
    result.failure = Failure::analysis(context.scene.source, error);
  }
  return result;
}

std::vector<RedundantSet> redundancy(const Context& context, const Assembly& assembly) {
  if (!assembly.partition) return {};
  return describe_redundancy(context.system(), assembly.state, *assembly.partition);
}

bool held(const std::vector<Index>& list, std::size_t i) {
  return std::find(list.begin(), list.end(), static_cast<Index>(i)) != list.end();
}

std::string document(const Context& context, const Assembly& assembly) {
  const System& system = context.system();
  JsonWriter json;
  json.begin_object();
  write_sizes(json, sizes_of(system, assembly.partition ? &*assembly.partition : nullptr));
  const auto variable = [&](const Variable& v, bool second_order, double assembled, bool is_held) {
    json.begin_flat_object().member("name", v.name).member("unit", v.unit).member("order", second_order ? 2 : 1);
    json.member("kind", v.kind).member("start", v.start).member("assembled", assembly.failure ? NAN : assembled);
    json.member("nominal", v.nominal).member("held", is_held).end_object();
  };
  json.key("variables").begin_list();
  for (std::size_t i = 0; i < system.x.size(); ++i)
    variable(system.x[i], true, assembly.state.x[i], held(context.options().equilibrium.hold_x, i));
  for (std::size_t i = 0; i < system.z.size(); ++i)
    variable(system.z[i], false, assembly.state.z[i], held(context.options().equilibrium.hold_z, i));
  json.end_list().key("inputs").begin_list();
  for (std::size_t i = 0; i < system.inputs.size(); ++i) {
    json.begin_flat_object().member("name", system.inputs[i].name).member("unit", system.inputs[i].unit);
    json.member("value", assembly.state.z[system.z.size() + i]).end_object();
  }
  json.end_list();
  const auto rows = [&](const char* name, const std::vector<Row>& list) {
    json.key(name).begin_list();
    for (const Row& row : list) json.begin_flat_object().member("name", row.name).member("unit", row.unit).end_object();
    json.end_list();
  };
  rows("holonomic_rows", system.holonomic);
  rows("nonholonomic_rows", system.nonholonomic);
  rows("outputs", system.outputs);
  json.key("redundant_rows").begin_list(true);
  if (assembly.partition) {
    for (const RedundantRow& row : assembly.partition->redundant) json.value(system.constraint(row.row).name);
  }
  json.end_list();
  write_redundancy(json, redundancy(context, assembly), system);
  write_notes(json, assembly.notes);
  json.key("warnings").begin_list();
  for (const Diagnostic& one : context.compiled.warnings) {
    json.begin_object().member("code", one.code).member("at", one.pointer).member("found", one.found);
    json.member("expected", one.expected).member("remedy", one.remedy).end_object();
  }
  json.end_list();
  json.member("assembled", !assembly.failure).end_object();
  return json.take();
}

std::string text(const Context& context, const Assembly& assembly) {
  const System& system = context.system();
  std::string out =
      context.scene.source.name + ": the scene is sound: " + counted(system.components.size(), "component") + "\n\n";
  out += as_text(sizes_table(sizes_of(system, assembly.partition ? &*assembly.partition : nullptr)));
  Table variables{{"variable", "unit", "start", "assembled", ""}, {}, "llrr"};
  const auto add = [&](const Variable& v, double assembled, bool is_held) {
    variables.rows.push_back({v.name, v.unit, short_number(v.start), assembly.failure ? "-" : short_number(assembled),
                              is_held ? "held" : ""});
  };
  for (std::size_t i = 0; i < system.x.size(); ++i)
    add(system.x[i], assembly.state.x[i], held(context.options().equilibrium.hold_x, i));
  for (std::size_t i = 0; i < system.z.size(); ++i)
    add(system.z[i], assembly.state.z[i], held(context.options().equilibrium.hold_z, i));
  out += '\n' + as_text(variables);
  Table inputs{{"input", "unit", "value"}, {}, "llr"};
  for (std::size_t i = 0; i < system.inputs.size(); ++i) {
    inputs.rows.push_back(
        {system.inputs[i].name, system.inputs[i].unit, short_number(assembly.state.z[system.z.size() + i])});
  }
  Table rows{{"row", "unit", ""}, {}, "ll"};
  std::vector<bool> redundant(system.holonomic.size() + system.nonholonomic.size(), false);
  if (assembly.partition) {
    for (const RedundantRow& row : assembly.partition->redundant) redundant[static_cast<std::size_t>(row.row)] = true;
  }
  for (std::size_t i = 0; i < redundant.size(); ++i) {
    const Row& row = system.constraint(static_cast<Index>(i));
    rows.rows.push_back({row.name, row.unit, redundant[i] ? "redundant" : ""});
  }
  Table outputs{{"output", "unit"}, {}, ""};
  for (const Row& row : system.outputs) outputs.rows.push_back({row.name, row.unit});
  for (const Table* table : {&inputs, &rows, &outputs}) {
    if (!table->rows.empty()) out += '\n' + as_text(*table);
  }
  const std::string repeated = redundancy_text(redundancy(context, assembly), system);
  return repeated.empty() ? out : out + '\n' + repeated;
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const Assembly assembly = assemble(context);
  if (assembly.failure && arguments.json) throw Failure(*assembly.failure);
  deliver(arguments, "check.json", document(context, assembly), text(context, assembly));
  if (assembly.failure) throw Failure(*assembly.failure);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_check = {
    "check", "SCENE", "read a scene and say what is in it, or everything that is wrong with it",
    R"(Reads the scene, loads its libraries, connects its components and assembles the start positions.
A sound scene is listed: sizes, variables with units and start values, inputs, constraint rows, outputs.
For a wrong scene every fault is reported at once: where it stands, what was found, what was expected, what to do.

Example
  bramah check scenes/four_bar/overdamped.json
)",
    run};

}  // namespace bramah
