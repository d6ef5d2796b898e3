#include "solve/start.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "solve/assemble.hpp"
#include "solve/kkt.hpp"
#include "solve/near_assembly.hpp"
#include "solve/redundancy.hpp"
#include "system/limits.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

constexpr double kept = 1e-6;  // of a rate or its nominal: what counts as unchanged

std::vector<Index> given_rates(const System& system) {
  std::vector<Index> given;
  for (Index i = 0; i < system.n(); ++i) {
    if (system.x[static_cast<std::size_t>(i)].rate_given()) given.push_back(i);
  }
  return given;
}

void assemble_start(const System& system, const Options& options, State& state) {
  assemble_start_positions(system, state, options.equilibrium.hold_x);
  assemble_start_velocities(system, state, options.equilibrium.hold_x, given_rates(system));
}

/// Names of the components that list members belong to, each once.
std::vector<std::string> components_of(const System& system, const std::vector<Index>& list, const auto& component) {
  std::vector<std::string> names;
  for (const Index i : list) {
    const std::string& name = system.component_name(component(i));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

/// Of constraint rows.
std::vector<std::string> joints_of(const System& system, const std::vector<Index>& rows) {
  return components_of(system, rows, [&](Index i) { return system.constraint(i).component; });
}

StartNote note_on(const System& system, const NearAssembly& other, bool held) {
  StartNote note{"near assembly", {}, "", ""};
  std::vector<std::string> ways, same;
  const std::vector<std::string> joints = joints_of(system, other.rows);
  for (const auto& [i, way] : other.coordinates) {
    const Variable& x = system.x[static_cast<std::size_t>(i)];
    note.names.push_back(x.name);
    ways.push_back(x.name + " " + (way < 0.0 ? "" : "+") + with_unit(way, x.unit));
  }
  for (const Index i : other.kept) same.push_back(system.x[static_cast<std::size_t>(i)].name);
  note.found = "two assemblies are near: " + list_of(joints) + " also " + (joints.size() == 1 ? "closes" : "close") +
               (same.empty() ? "" : ", with the same " + list_of(same) + ",") + " at " + list_of(ways) + ", " +
               digits(other.distance) + " nominals away; the start values were moved by " + digits(other.moved) +
               ", to the assembly that was taken";
  note.remedy = "to be sure of the one that is meant, give " + note.names.front() +
                " a start value on its side, and hold it" + (held ? " in place of a coordinate that is held" : "");
  return note;
}

StartNote note_on(const System& system, const std::vector<Index>& changed, const State& state) {
  StartNote note{"rate changed", {}, "", ""};
  std::vector<std::string> changes;
  for (const Index i : changed) {
    const Variable& x = system.x[static_cast<std::size_t>(i)];
    const std::string unit = x.unit == "1" ? " 1/s" : " " + x.unit + "/s";
    note.names.push_back(x.name + ".rate");
    changes.push_back(x.name + ".rate from " + digits(x.start_rate, 6) + " to " +
                      digits(state.v[static_cast<std::size_t>(i)], 6) + unit);
  }
  note.found = "the constraints do not allow the start rates that are given; changed were " + list_of(changes);
  note.remedy = "give rates that agree with each other, or fewer of them: those that nobody gives follow";
  return note;
}

/// Joints that repeat each other and disagree by what System::assembly_tolerance lets pass.
std::optional<StartNote> note_on_rounding(const System& system, const State& state) {
  Blocks blocks(system);
  if (system.m() == 0 || !blocks.evaluate(system, state, Request{}.rows("c")).ok()) return std::nullopt;
  if (!leaves_rounding(system, state, blocks.c)) return std::nullopt;
  const auto largest =
      std::max_element(blocks.c.begin(), blocks.c.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  const Row& open = system.constraint(largest - blocks.c.begin());
  const std::vector<RedundantSet> sets = describe_redundancy(system, state, choose_partition(system, state));
  const auto set = std::find_if(sets.begin(), sets.end(), [&](const RedundantSet& s) {
    return std::binary_search(s.components.begin(), s.components.end(), open.component);
  });
  StartNote note{"rounded data", {}, "", ""};
  note.names.push_back(open.name);
  note.found = (set == sets.end() ? system.component_name(open.component) : set->joints) +
               " repeat each other and disagree by a rounding: when the others close, " + open.name +
               " stays open by " + with_unit(std::abs(*largest), open.unit);
  note.remedy =
      "give the points and axes with more digits, or choose by \"assembly\": {\"tolerance\": ...} what may "
      "stay open, now " +
      digits(system.assembly_tolerance) + " m";
  return note;
}

}  // namespace

std::optional<StartNote> singular_note(const System& system, const State& state) {
  const auto singular = find_singular_position(system, state);
  if (!singular) return std::nullopt;
  const std::string joints = list_of(joints_of(system, singular->rows)),
                    bodies = list_of(components_of(system, singular->coordinates, [&](Index i) {
                      return system.x[static_cast<std::size_t>(i)].component;
                    }));
  StartNote note{"singular position", {}, "", ""};
  for (const Index row : singular->rows) note.names.push_back(system.constraint(row).name);
  if (singular->kind == SingularPosition::Kind::near) {
    note.kind = "nearly singular";
    note.found = "the position is nearly singular: about " + digits(singular->distance) +
                 " nominals away the rows of " + joints + " depend on each other; linear models here keep about " +
                 std::to_string(static_cast<int>(singular->digits)) + " digits";
    note.remedy = "move the start values of " + bodies + " away from it, or read no more digits than that";
  } else if (singular->kind == SingularPosition::Kind::locked) {
    note.found =
        "the position is singular: the rows of " + joints +
        " depend on each other here only, and any motion that they leave opens them in second order, so that the "
        "structure is locked";
    note.remedy = "a locked structure has no motion to linearize; leave out a joint, or change a length";
  } else {
    note.found = "the position is singular, a bifurcation: the rows of " + joints +
                 " depend on each other here only, and the mechanism can go on in two ways, which differ in how " +
                 bodies + " move";
    note.remedy =
        "no single linear model exists here: move the start values to the branch that is meant; a simulation "
        "goes on along its start velocity";
  }
  return note;
}

namespace {

/// Laws that go on beyond their limits, and do so at the start.
void add_limit_notes(const System& system, const State& state, std::vector<StartNote>& notes) {
  Limits limits(system);
  for (const auto& [k, text] : limits.passed(state)) {
    const Limits::Info& limit = limits.info()[k];
    const std::string& name = system.component_name(limit.component);
    notes.push_back({"beyond a limit", {name + "." + limit.name}, text, "check the start values of " + name});
  }
}

/// Start values that the assembly moves by more than the machine is large: mostly a wrong unit.
void add_far_notes(const System& system, const Vector& start, const State& state, std::vector<StartNote>& notes) {
  double largest = 0.0;  // of the machine where it stands
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    if (system.x[i].unit != "m") continue;
    largest = std::max(largest, std::abs(state.x[i]));
  }
  const double size = std::max(largest, system.scales.length);
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    const Variable& x = system.x[i];
    if (x.unit != "m" || !(std::abs(state.x[i] - start[i]) > 2.0 * size)) continue;
    notes.push_back({"moved far",
                     {x.name},
                     "the assembly moves " + x.name + " from " + digits(start[i], 6) + " m to " +
                         digits(state.x[i], 6) + " m, farther than the machine is large",
                     "check the start value and its unit"});
  }
}

std::vector<Index> changed_rates(const System& system, const State& state) {
  std::vector<Index> changed = given_rates(system);
  std::erase_if(changed, [&](Index index) {
    const auto i = static_cast<std::size_t>(index);
    const double given = system.x[i].start_rate;
    return std::abs(state.v[i] - given) <= kept * std::max(std::abs(given), system.x[i].nominal);
  });
  return changed;
}

}  // namespace

State consistent_start(const System& system, const Options& options, double t) {
  State state = initial_state(system, t);
  assemble_start(system, options, state);
  require_within_limits(system, "start", state);
  complete(system, state);
  return state;
}

void complete(const System& system, State& state) {
  const Partition partition = choose_partition(system, state);
  Blocks blocks(system);
  Kkt(system, partition.rows).complete(state, blocks);
  take_minimum_norm(system, partition, state.lambda);
}

State reference_state(const System& system, const Options& options, bool equilibrium, double t) {
  return equilibrium ? find_equilibrium(system, options.equilibrium, t).state : consistent_start(system, options, t);
}

std::vector<StartNote> start_notes(const System& system, const Options& options, bool equilibrium, double t) {
  State state = initial_state(system, t);
  const Vector start = state.x;
  if (equilibrium) {
    assemble_start_positions(system, state, options.equilibrium.hold_x);
  } else {
    assemble_start(system, options, state);
  }
  std::vector<StartNote> notes;
  add_far_notes(system, start, state, notes);
  if (const auto other = find_near_assembly(system, state, start, options.equilibrium.hold_x))
    notes.push_back(note_on(system, *other, !options.equilibrium.hold_x.empty()));
  if (const auto rounding = note_on_rounding(system, state)) notes.push_back(*rounding);
  if (const auto singular = singular_note(system, state)) notes.push_back(*singular);
  if (equilibrium) return notes;
  add_limit_notes(system, state, notes);
  if (const std::vector<Index> changed = changed_rates(system, state); !changed.empty())
    notes.push_back(note_on(system, changed, state));
  return notes;
}

}  // namespace bramah
