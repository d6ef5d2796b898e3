#include "app/results.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "app/equilibrium_report.hpp"

namespace bramah {
namespace {

std::string side_text(int side) { return side < 0 ? "-" : "+"; }

template <class List, class Name>
std::vector<std::string> names(const List& list, Name&& name) {
  std::vector<std::string> result;
  result.reserve(list.size());
  for (const auto& item : list) result.push_back(name(item));
  return result;
}
std::vector<std::string> quantity_names(const std::vector<NamedQuantity>& list) {
  return names(list, [](const NamedQuantity& q) { return q.name; });
}
std::vector<std::string> coordinate_names(const System& system, const std::vector<Index>& list) {
  return names(list, [&](Index i) { return system.x[static_cast<std::size_t>(i)].name; });
}

/// Every number of the state with its name and unit: x, z and multipliers.
template <class Visit>
void each_value(const System& system, const State& state, Visit&& visit) {
  for (std::size_t i = 0; i < system.x.size(); ++i) visit(system.x[i].name, system.x[i].unit, state.x[i]);
  for (std::size_t i = 0; i < system.z.size(); ++i) visit(system.z[i].name, system.z[i].unit, state.z[i]);
  for (std::size_t i = 0; i < state.lambda.size(); ++i) {
    const auto row = static_cast<Index>(i);
    visit(system.multiplier_name(row), system.multiplier_unit(row), state.lambda[i]);
  }
}

void write_state(JsonWriter& json, const System& system, const State& state) {
  json.key("variables").begin_object();
  each_value(system, state,
             [&](const std::string& name, const std::string&, double value) { json.member(name, value); });
  json.end_object();
  json.key("inputs").begin_object();
  for (std::size_t i = 0; i < system.inputs.size(); ++i)
    json.member(system.inputs[i].name, state.z[system.z.size() + i]);
  json.end_object();
}

}  // namespace

std::string involved_states(const LinearModel& model, const Eigen::VectorXd& shares) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(shares.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return shares(a) > shares(b); });
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, order.size()) && shares(order[k]) >= 0.1; ++k) {
    text += (k == 0 ? "" : ", ") + model.states[static_cast<std::size_t>(order[k])].name + " " +
            short_number(std::round(100.0 * shares(order[k])), 3) + " %";
  }
  return text;
}

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

Sizes sizes_of(const System& system, const Partition* partition) {
  Sizes sizes{system.n(), system.m(), system.l(), system.nz() - system.spools(), system.spools(), 0};
  if (partition == nullptr) return sizes;
  sizes.redundant = static_cast<Index>(partition->redundant.size());
  for (const RedundantRow& row : partition->redundant) sizes.redundant_states += row.row < system.m() ? 2 : 1;
  return sizes;
}

void write_sizes(JsonWriter& json, const Sizes& s) {
  json.key("sizes").begin_flat_object();
  json.member("n", s.n).member("m", s.m).member("l", s.l).member("r", s.r).member("u", s.u);
  json.member("redundant", s.redundant).member("reduced", s.reduced()).member("augmented", s.augmented()).end_object();
}

Table sizes_table(const Sizes& s) {
  const auto row = [](const char* letter, Index count, const char* meaning) {
    return std::vector<std::string>{letter, std::to_string(count), meaning};
  };
  return {
      {},
      {row("n", s.n, "coordinates"), row("m", s.m, "holonomic constraint rows"),
       row("l", s.l, "nonholonomic constraint rows"), row("redundant", s.redundant, "rows that follow from the others"),
       row("r", s.r, "first-order variables (pressures, ...)"), row("u", s.u, "spools"),
       row("reduced", s.reduced(), "states of the smallest linear model, 2n - 2m - l + r + u without redundant rows"),
       row("augmented", s.augmented(), "states without the reduction, 2n + r + u")},
      "lr"};
}

std::string equilibrium_document(const System& system, const Equilibrium& equilibrium, const Stability& stability,
                                 const std::vector<StartNote>& notes) {
  JsonWriter json;
  json.begin_object();
  write_state(json, system, equilibrium.state);
  write_free_directions(json, equilibrium.free_directions);
  json.key("units").begin_object();
  each_value(system, equilibrium.state,
             [&](const std::string& name, const std::string& unit, double) { json.member(name, unit); });
  for (const InputSignal& input : system.inputs) json.member(input.name, input.unit);
  json.end_object();
  json.member("time", equilibrium.state.t)
      .member("iterations", equilibrium.iterations)
      .member("steps", equilibrium.steps)
      .member("residual", equilibrium.residual);
  write_stability(json, equilibrium, stability);
  write_moved(json, equilibrium);
  write_notes(json, notes);
  json.end_object();
  return json.take();
}

Table variables_table(const System& system, const State& state) {
  Table table{{"variable", "value", "unit"}, {}, "lr"};
  for (std::size_t i = 0; i < system.x.size(); ++i)
    table.rows.push_back({system.x[i].name, short_number(state.x[i], 10), system.x[i].unit});
  for (std::size_t i = 0; i < system.z.size(); ++i)
    table.rows.push_back({system.z[i].name, short_number(state.z[i], 10), system.z[i].unit});
  return table;
}

Table multipliers_table(const System& system, const State& state) {
  Table table{{"multiplier", "value", "unit"}, {}, "lr"};
  for (std::size_t i = 0; i < state.lambda.size(); ++i) {
    const auto row = static_cast<Index>(i);
    table.rows.push_back({system.multiplier_name(row), short_number(state.lambda[i], 8), system.multiplier_unit(row)});
  }
  return table;
}

std::string free_directions_text(const std::vector<FreeDirection>& directions) {
  if (directions.empty()) return "";
  std::string out = "Free directions, along which the equilibrium stays one (\"hold\" a variable of each to choose):\n";
  for (const FreeDirection& direction : directions) {
    std::string line;
    for (const auto& [name, share] : direction.variables)
      line += (line.empty() ? "  " : ", ") + name + " " + short_number(share, 3);
    out += line + '\n';
  }
  return out;
}

void write_matrix(JsonWriter& json, std::string_view name, const Eigen::MatrixXd& matrix) {
  json.key(name).begin_list();
  std::vector<double> row(static_cast<std::size_t>(matrix.cols()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row[static_cast<std::size_t>(j)] = matrix(i, j);
    json.values(row);
  }
  json.end_list();
}

std::string linear_document(const System& system, const Linearization& linear) {
  const LinearModel& model = linear.model;
  JsonWriter json;
  json.begin_object();
  write_sizes(json, sizes_of(system, &linear.partition));
  json.key("states").values(quantity_names(model.states));
  json.key("inputs").values(quantity_names(model.inputs));
  json.key("outputs").values(quantity_names(model.outputs));
  write_matrix(json, "A", model.A);
  write_matrix(json, "B", model.B);
  write_matrix(json, "C", model.C);
  write_matrix(json, "D", model.D);
  json.key("units").begin_object();
  for (const auto* list : {&model.states, &model.inputs, &model.outputs}) {
    for (const NamedQuantity& q : *list) {
      const bool is_output_and_state =
          list == &model.outputs && std::any_of(model.states.begin(), model.states.end(),
                                                [&](const NamedQuantity& s) { return s.name == q.name; });
      if (!is_output_and_state) json.member(q.name, q.unit);
    }
  }
  json.end_object();
  json.key("partition").begin_object();
  json.key("independent").values(coordinate_names(system, linear.partition.ai));
  json.key("admissible_dependent").values(coordinate_names(system, linear.partition.ad));
  json.key("dependent").values(coordinate_names(system, linear.partition.d));
  write_conditions(json, linear.conditions);
  json.end_object();
  json.key("redundant_rows").begin_list();
  for (const RedundantRow& row : linear.partition.redundant) {
    json.begin_flat_object().member("row", system.constraint(row.row).name).key("follows_from").begin_object();
    for (const auto& [other, coefficient] : row.follows_from) json.member(system.constraint(other).name, coefficient);
    json.end_object().end_object();
  }
  json.end_list();
  write_redundancy(json, describe_redundancy(system, linear.state, linear.partition), system);
  json.key("kinks").begin_list();
  for (const KinkTaken& kink : model.kinks) {
    json.begin_flat_object()
        .member("component", kink.component)
        .member("name", kink.name)
        .member("side", side_text(kink.side))
        .end_object();
  }
  json.end_list();
  json.key("at").begin_object();
  json.member("kind", linear.at_equilibrium ? "equilibrium" : "start")
      .member("time", linear.state.t)
      .member("side", side_text(linear.state.side));
  write_state(json, system, linear.state);
  json.key("rates").begin_object();
  for (std::size_t i = 0; i < system.x.size(); ++i) json.member(system.x[i].name, linear.state.v[i]);
  for (std::size_t i = 0; i < system.z.size(); ++i) json.member(system.z[i].name, linear.state.zdot[i]);
  json.end_object();
  write_free_directions(json, linear.equilibrium ? linear.equilibrium->free_directions : std::vector<FreeDirection>{});
  json.end_object();
  write_equilibrium(json, linear);
  write_notes(json, linear.notes);
  json.end_object();
  return json.take();
}

std::string redundancy_text(const std::vector<RedundantSet>& sets, const System& system) {
  std::string out;
  for (const RedundantSet& set : sets) {
    out += "Redundant: " + counted(set.rows.size(), "row") + " of " + set.joints +
           (set.geometry.empty() ? "" : " " + set.geometry) + "\n";
    out += "  follow from the others  " + row_names(system, set.rows) + "\n";
    if (!set.undetermined.empty()) out += "  undetermined            " + set.undetermined + "\n";
    out += "  to avoid it             " + set.remedy + "\n";
  }
  if (!sets.empty()) {
    out +=
        "Redundant rows agree with the others, and the motion does not depend on them. Their multipliers are not unique;\n"
        "those of least norm are given.\n";
  }
  return out;
}

std::vector<StartNote> tell_start_notes(const Context& context, bool equilibrium) {
  std::vector<StartNote> notes = start_notes(context.system(), context.options(), equilibrium, context.start_time());
  for (const StartNote& note : notes) {
    if (!context.arguments.quiet) say("note: " + note.found + "\n  " + note.remedy + '\n');
  }
  return notes;
}

void write_notes(JsonWriter& json, const std::vector<StartNote>& notes) {
  json.key("notes").begin_list();
  for (const StartNote& note : notes) {
    json.begin_object().member("kind", note.kind).key("names").begin_list(true);
    for (const std::string& name : note.names) json.value(name);
    json.end_list().member("found", note.found).member("remedy", note.remedy).end_object();
  }
  json.end_list();
}

void write_redundancy(JsonWriter& json, const std::vector<RedundantSet>& sets, const System& system) {
  json.key("redundant_sets").begin_list();
  for (const RedundantSet& set : sets) {
    json.begin_object()
        .member("joints", set.joints)
        .member("geometry", set.geometry)
        .key("components")
        .begin_list(true);
    for (const Index i : set.components) json.value(system.component_name(i));
    json.end_list().key("rows").begin_list(true);
    for (const Index row : set.rows) json.value(system.constraint(row).name);
    json.end_list().member("undetermined", set.undetermined).member("remedy", set.remedy).end_object();
  }
  json.end_list();
}

void write_conditions(JsonWriter& json, const Conditions& conditions) {
  json.key("condition").begin_flat_object();
  json.member("C_xd", conditions.C_xd).member("D_dd", conditions.D_dd).end_object();
}

std::string linear_notes(const System& system, const Linearization& linear) {
  std::string out;
  if (!linear.at_equilibrium) {
    out +=
        "Linearized at the start state. Away from equilibria and steady motions the model holds for short times only.\n";
  }
  out += redundancy_text(describe_redundancy(system, linear.state, linear.partition), system);
  if (!linear.model.kinks.empty()) {
    out += "Laws with a kink at this state; derivatives are those of side " +
           side_text(linear.model.kinks.front().side) + ":\n";
    for (const KinkTaken& kink : linear.model.kinks) out += "  " + kink.component + ": " + kink.name + '\n';
  }
  return out;
}

std::string complex_text(std::complex<double> value, int digits) {
  std::string text = short_number(value.real(), digits);
  if (value.imag() != 0.0)
    text += (value.imag() < 0.0 ? " - " : " + ") + short_number(std::abs(value.imag()), digits) + "i";
  return text;
}

void write_eigenvalues(JsonWriter& json, std::string_view name, const std::vector<std::complex<double>>& eigenvalues) {
  json.key(name).begin_list();
  for (const std::complex<double>& value : eigenvalues) {
    json.begin_flat_object().member("re", value.real()).member("im", value.imag()).end_object();
  }
  json.end_list();
}

Census census_of(const System& system, const Linearization& linear) {
  Census census{find_spectrum(linear.model), {}, ""};
  Descriptor descriptor(system, linear.partition.rows);
  descriptor.evaluate(linear.state);
  census.unpredicted = descriptor.changing();
  if (!census.unpredicted.empty()) return census;
  census.predicted = predict_zeros(descriptor);
  settle_doubtful(linear.model, *census.predicted, census.spectrum);
  return census;
}

namespace {

/// Shares of states in every nonzero mode, and their sums by the component that owns them.
void write_participation(JsonWriter& json, const LinearModel& model, const Spectrum& spectrum) {
  const Eigen::MatrixXd shares = participation(spectrum);
  json.key("participation").begin_list();
  for (Eigen::Index k = 0; k < shares.cols(); ++k) {
    std::vector<std::pair<std::string, double>> components;
    json.begin_object().key("states").begin_object();
    for (Eigen::Index i = 0; i < shares.rows(); ++i) {
      const std::string& name = model.states[static_cast<std::size_t>(i)].name;
      const std::string owner = name.substr(0, name.find('.'));
      json.member(name, shares(i, k));
      const auto known =
          std::find_if(components.begin(), components.end(), [&](const auto& c) { return c.first == owner; });
      if (known == components.end()) {
        components.emplace_back(owner, shares(i, k));
      } else {
        known->second += shares(i, k);
      }
    }
    json.end_object().key("components").begin_object();
    for (const auto& [owner, share] : components) json.member(owner, share);
    json.end_object().end_object();
  }
  json.end_list();
}

}  // namespace

std::string spectrum_document(const System& system, const Linearization& linear, const Census& census) {
  const LinearModel& model = linear.model;
  const Spectrum& spectrum = census.spectrum;
  JsonWriter json;
  json.begin_object();
  json.member("unstable", spectrum.unstable_count()).member("zeros", spectrum.zero_count()).key("zeros_predicted");
  if (census.predicted) {
    json.value(census.predicted->count());
  } else {
    json.null();
  }
  json.key("states").values(quantity_names(model.states));
  json.key("eigenvalues").begin_list();
  for (const Mode& mode : spectrum.modes) {
    const double magnitude = std::abs(mode.eigenvalue);
    json.begin_flat_object().member("re", mode.eigenvalue.real()).member("im", mode.eigenvalue.imag());
    json.member("zero", mode.zero).member("cause", mode.cause);
    json.member("damping_ratio", mode.zero ? NAN : -mode.eigenvalue.real() / magnitude);
    json.member("frequency_hz", mode.zero ? 0.0 : std::abs(mode.eigenvalue.imag()) / (2.0 * std::numbers::pi));
    json.member("condition", mode.condition).member("doubtful", mode.doubtful).end_object();
  }
  json.end_list();
  const auto shares = [&](const std::vector<std::pair<std::string, double>>& list) {
    json.begin_object();
    for (const auto& [name, share] : list) json.member(name, share);
    json.end_object();
  };
  json.key("zero_blocks").begin_list();
  for (const ZeroBlock& block : spectrum.zeros) {
    json.begin_flat_object()
        .member("size", block.size)
        .member("kind", block.kind)
        .member("cause", block.cause)
        .key("moves");
    shares(block.moves);
    json.end_object();
  }
  json.end_list().key("conserved").begin_list();
  for (const auto& sum : spectrum.conserved) shares(sum);
  json.end_list();
  json.key("mode_shapes").begin_list();
  for (Eigen::Index k = 0; k < spectrum.right.cols(); ++k) {
    json.begin_object();
    for (Eigen::Index i = 0; i < spectrum.right.rows(); ++i) {
      const std::complex<double> share = spectrum.right(i, k);
      json.key(model.states[static_cast<std::size_t>(i)].name).values(std::vector<double>{share.real(), share.imag()});
    }
    json.end_object();
  }
  json.end_list();
  json.key("left_vectors").begin_list();
  for (Eigen::Index k = 0; k < spectrum.left.cols(); ++k) {
    json.begin_object();
    for (Eigen::Index i = 0; i < spectrum.left.rows(); ++i) {
      const std::complex<double> share = spectrum.left(i, k);
      json.key(model.states[static_cast<std::size_t>(i)].name).values(std::vector<double>{share.real(), share.imag()});
    }
    json.end_object();
  }
  json.end_list();
  write_participation(json, model, spectrum);
  write_modal_details(json, system, linear, spectrum);
  write_equilibrium(json, linear);
  write_notes(json, linear.notes);
  json.end_object();
  return json.take();
}

std::string spectrum_notes(const Census& census) {
  const Spectrum& spectrum = census.spectrum;
  const auto unstable = static_cast<std::size_t>(spectrum.unstable_count());
  const auto zeros = static_cast<std::size_t>(spectrum.zero_count());
  std::string out = unstable == 0 ? "No eigenvalue to the right of the imaginary axis"
                                  : counted(unstable, "eigenvalue") + " to the right of the imaginary axis";
  out += zeros == 0 ? ".\n" : "; " + counted(zeros, "zero") + ", explained above.\n";
  if (!census.predicted) {
    out += "Zeros were not foretold: " + census.unpredicted + ".\n";
  } else if (static_cast<std::size_t>(census.predicted->count()) != zeros) {
    out += "Warning: the ranks of the unreduced matrices foretell " +
           counted(static_cast<std::size_t>(census.predicted->count()), "zero") + ", the reduced Jacobian has " +
           std::to_string(zeros) + ": the machine is near a change of rank; its smallest accepted pivot is " +
           short_number(std::min(census.predicted->accepted, spectrum.smallest_accepted), 2) + ".\n";
  }
  for (const auto& sum : spectrum.conserved) {
    out += "Conserved:";
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double share = sum[k].second;
      out += std::string(share < 0.0 ? " - "
                         : k == 0    ? " "
                                     : " + ") +
             short_number(std::abs(share), 5) + " " + sum[k].first;
    }
    out += '\n';
  }
  for (const Mode& mode : spectrum.modes) {
    if (mode.doubtful) out += "Warning: " + complex_text(mode.eigenvalue, 6) + " is " + mode.cause + '\n';
  }
  return out;
}

Table spectrum_table(const LinearModel& model, const Spectrum& spectrum) {
  Table table{{"eigenvalue (1/s)", "damping", "frequency", "condition", "of which states"}, {}, "lrrrl"};
  const Eigen::MatrixXd shares = participation(spectrum);
  for (std::size_t k = 0; k < spectrum.modes.size(); ++k) {
    const Mode& mode = spectrum.modes[k];
    const double hertz = std::abs(mode.eigenvalue.imag()) / (2.0 * std::numbers::pi);
    const std::string condition = short_number(mode.condition, 2);
    if (mode.zero) {
      table.rows.push_back({"0", "", "", condition, mode.cause});
    } else {
      table.rows.push_back({complex_text(mode.eigenvalue, 15),
                            short_number(-mode.eigenvalue.real() / std::abs(mode.eigenvalue), 4),
                            hertz > 0.0 ? short_number(hertz, 5) + " Hz" : "", condition,
                            involved_states(model, shares.col(static_cast<Eigen::Index>(k)))});
    }
  }
  return table;
}

}  // namespace bramah
