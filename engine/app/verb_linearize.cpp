#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "app/context.hpp"
#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/sparse_model.hpp"
#include "app/transient.hpp"
#include "app/verbs.hpp"
#include "io/matrix_files.hpp"
#include "io/output_file.hpp"
#include "linear/spectrum.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

constexpr Eigen::Index kMostShown = 24;  // columns on a terminal; --json has all

constexpr const char* kOptions[] = {"--output"};

std::string matrix_text(const char* name, const Eigen::MatrixXd& matrix, const std::vector<NamedQuantity>& rows,
                        const std::vector<NamedQuantity>& columns) {
  std::string out =
      std::string("\n") + name + "  (" + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ")\n";
  if (matrix.cols() > kMostShown) return out + "  too wide to show; --json prints it\n";
  if (matrix.size() == 0) return "";
  Table table;
  table.header.emplace_back();
  for (const NamedQuantity& column : columns) table.header.push_back(column.name);
  table.right = "l" + std::string(columns.size(), 'r');
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    std::vector<std::string> row = {rows[static_cast<std::size_t>(i)].name};
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      row.push_back(matrix(i, j) == 0.0 ? "0" : short_number(matrix(i, j), 7));
    table.rows.push_back(std::move(row));
  }
  return out + as_text(table);
}

std::vector<std::string> names_of(const std::vector<NamedQuantity>& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const NamedQuantity& q : list) names.push_back(q.name);
  return names;
}

DenseView view(const Eigen::MatrixXd& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())};
}

/// A.csv ... D.csv and one MAT file, for other programs.
void write_matrices(const Arguments& arguments, const LinearModel& model) {
  const std::filesystem::path folder(arguments.out);
  make_folder(folder);
  const std::vector<std::string> states = names_of(model.states), inputs = names_of(model.inputs),
                                 outputs = names_of(model.outputs);
  write_file(folder / "A.csv", csv_of(view(model.A), states, states));
  write_file(folder / "B.csv", csv_of(view(model.B), states, inputs));
  write_file(folder / "C.csv", csv_of(view(model.C), outputs, states));
  write_file(folder / "D.csv", csv_of(view(model.D), outputs, inputs));
  write_file(folder / "linear_model.mat", mat_file({{"A", view(model.A), {}},
                                                    {"B", view(model.B), {}},
                                                    {"C", view(model.C), {}},
                                                    {"D", view(model.D), {}},
                                                    {"states", {}, states},
                                                    {"inputs", {}, inputs},
                                                    {"outputs", {}, outputs}}));
}

/// The model at each of linearize.times of the simulation: A(t), B(t), C(t), D(t). One partition as long as it holds.
int run_along(const Context& context) {
  const System& system = context.system();
  SimulateOptions options = context.options().simulate;
  const std::vector<double>& times = context.options().linearize.times;
  options.output_step = 0.0;
  options.output_times = times;
  JsonWriter json;
  json.begin_object();
  Table table{{"time", "largest real part", "condition", "independent coordinates"}, {}, "rrrl"};
  LinearizerAlong linearizer(system, context.options().linearize.prescribed, context.options().outputs);
  LinearModel model;
  std::size_t next = 0;
  std::optional<Rest> rest;
  TransientSetup setup;
  if (options.from == SimulateOptions::From::equilibrium) {
    rest = find_rest(context, options.from_time);
    setup.start = &rest->equilibrium.state;
  }
  const Transient transient = run_transient(context, options, setup, [&](const State& state, const Vector&) {
    // Both sides of a jump of the inputs are output; the later one counts.
    if (next == times.size() || state.t != times[next] || (state.side < 0 && state.t < options.to_time)) return;
    State here = state;
    here.side = context.options().linearize.side;
    const int choices = linearizer.choices();
    linearizer.linearize(here, model);
    // A partition that still serves shows that the rank is what it was.
    if (linearizer.choices() > choices && !linearizer.partition().redundant.empty()) refuse_singular(system, here);
    if (next == 0) {
      json.key("states")
          .values(names_of(model.states))
          .key("inputs")
          .values(names_of(model.inputs))
          .key("outputs")
          .values(names_of(model.outputs));
      json.key("models").begin_list();
    }
    json.begin_object().member("time", here.t).key("states").values(names_of(model.states));
    write_conditions(json, linearizer.conditions());
    write_matrix(json, "A", model.A);
    write_matrix(json, "B", model.B);
    write_matrix(json, "C", model.C);
    write_matrix(json, "D", model.D);
    json.end_object();
    double abscissa = -HUGE_VAL;
    for (const Mode& mode : find_spectrum(model).modes) abscissa = std::max(abscissa, mode.eigenvalue.real());
    std::string independent;
    for (const Index i : linearizer.partition().ai)
      independent += (independent.empty() ? "" : ", ") + system.x[static_cast<std::size_t>(i)].name;
    table.rows.push_back({short_number(here.t, 8) + " s", short_number(abscissa, 8),
                          short_number(linearizer.conditions().worst(), 2), independent});
    ++next;
  });
  if (next == 0) json.key("models").begin_list();
  json.end_list().member("interrupted", transient.interrupted);
  write_equilibrium(json, rest ? &rest->equilibrium : nullptr, rest ? &rest->stability : nullptr);
  json.end_object();
  deliver(context.arguments, "linear_models.json", json.take(),
          as_text(table) +
              "\nEigenvalues along a motion belong to the chosen coordinates; they say little about stability.\n");
  return transient.interrupted ? exit_interrupted : exit_ok;
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  if (context.options().linearize.form == LinearizeOptions::Form::descriptor) return run_descriptor(context);
  if (!context.options().linearize.times.empty()) return run_along(context);
  const Linearization linear = linearize_outputs(context);
  const LinearModel& model = linear.model;
  std::string out = "dX/dt = A X + B u,  y = C X + D u,  all SI\n\n" +
                    as_text(sizes_table(sizes_of(context.system(), &linear.partition)));
  out += matrix_text("A", model.A, model.states, model.states) + matrix_text("B", model.B, model.states, model.inputs);
  out +=
      matrix_text("C", model.C, model.outputs, model.states) + matrix_text("D", model.D, model.outputs, model.inputs);
  const std::string notes = linear_notes(context.system(), linear) +
                            (linear.equilibrium ? free_directions_text(linear.equilibrium->free_directions) : "");
  out += "\nCondition of the partition: C_xd " + short_number(linear.conditions.C_xd, 2) + ", D_dd " +
         short_number(linear.conditions.D_dd, 2) + "\n";
  if (!notes.empty()) out += '\n' + notes;
  if (!arguments.out.empty()) write_matrices(arguments, model);
  deliver(arguments, "linear_model.json", linear_document(context.system(), linear), out);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_linearize = {
    "linearize",
    "SCENE",
    "derive the linear model with the smallest possible Jacobian, exactly",
    R"(Linearizes about the equilibrium, or about the start state where the scene says "linearize": {"at": "start"}. The model
has no dependent coordinates and no multipliers: its states are the independent coordinates, their rates, coordinates
tied by nonholonomic constraints only, and the first-order variables. Derivatives are exact; where a law has a kink they
are those of the side that the scene names, and the kink is reported. Redundant constraint rows are found and named.
With "linearize": {"times": [...]} the model is given at these times of the simulation, one after another.
With "form": "descriptor" nothing is reduced: sparse E and A of E dX/dt = A X, for systems of any size.

Examples
  bramah linearize scenes/four_bar/overdamped.json
  bramah linearize scenes/four_bar/overdamped.json --set linearize.side=- --json

--output NAME   only these rows of C and D, any number of times

--out DIR writes linear_model.json, A.csv, B.csv, C.csv, D.csv and linear_model.mat (MATLAB, Octave, SciPy, Julia).
--json prints {"sizes": {"n","m","l","r","u","redundant","reduced","augmented"}, "states": [...], "inputs": [...],
"outputs": [...], "A": [[...]], "B": [[...]], "C": [[...]], "D": [[...]], "units", "partition", "redundant_rows", ...}
)",
    run,
    kOptions};

}  // namespace bramah
