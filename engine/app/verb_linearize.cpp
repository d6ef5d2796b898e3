#include "app/context.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/verbs.hpp"

namespace bramah {
namespace {

constexpr Eigen::Index kMostShown = 24;  // columns on a terminal; --json has all

std::string matrix_text(const char* name, const Eigen::MatrixXd& matrix, const std::vector<NamedQuantity>& rows,
                        const std::vector<NamedQuantity>& columns) {
  std::string out = std::string("\n") + name + "  (" + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ")\n";
  if (matrix.cols() > kMostShown) return out + "  too wide to show; --json prints it\n";
  if (matrix.size() == 0) return "";
  Table table;
  table.header.emplace_back();
  for (const NamedQuantity& column : columns) table.header.push_back(column.name);
  table.right = "l" + std::string(columns.size(), 'r');
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    std::vector<std::string> row = {rows[static_cast<std::size_t>(i)].name};
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j) == 0.0 ? "0" : short_number(matrix(i, j), 7));
    table.rows.push_back(std::move(row));
  }
  return out + as_text(table);
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const Linearization linear = linearize(context);
  const LinearModel& model = linear.model;
  std::string out = "dX/dt = A X + B u,  y = C X + D u,  all SI\n\n" + as_text(sizes_table(sizes_of(context.system(), &linear.partition)));
  out += matrix_text("A", model.A, model.states, model.states) + matrix_text("B", model.B, model.states, model.inputs);
  out += matrix_text("C", model.C, model.outputs, model.states) + matrix_text("D", model.D, model.outputs, model.inputs);
  const std::string notes = linear_notes(context.system(), linear) + free_directions_text(linear.free_directions);
  if (!notes.empty()) out += '\n' + notes;
  deliver(arguments, "linear_model.json", linear_document(context.system(), linear), out);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_linearize = {
    "linearize", "SCENE", "derive the linear model with the smallest possible Jacobian, exactly",
    R"(Linearizes about the equilibrium, or about the start state where the scene says "linearize": {"at": "start"}. The model
has no dependent coordinates and no multipliers: its states are the independent coordinates, their rates, coordinates
tied by nonholonomic constraints only, and the first-order variables. Derivatives are exact; where a law has a kink they
are those of the side that the scene names, and the kink is reported. Redundant constraint rows are found and named.

Examples
  bramah linearize scenes/four_bar/overdamped.json
  bramah linearize scenes/four_bar/overdamped.json --set linearize.side=- --json

--json prints {"sizes": {"n","m","l","r","u","redundant","reduced","augmented"}, "states": [...], "inputs": [...],
"outputs": [...], "A": [[...]], "B": [[...]], "C": [[...]], "D": [[...]], "units", "partition", "redundant_rows", ...}
)",
    run};

}  // namespace bramah
