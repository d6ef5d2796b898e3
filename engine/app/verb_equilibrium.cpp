#include "app/context.hpp"
#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/verbs.hpp"

namespace bramah {
namespace {

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const System& system = context.system();
  const auto [equilibrium, stability] = find_rest(context, context.start_time());
  const std::vector<StartNote> notes = tell_start_notes(context, true);
  std::string out = as_text(variables_table(system, equilibrium.state));
  if (system.m() + system.l() > 0) out += '\n' + as_text(multipliers_table(system, equilibrium.state));
  if (!system.inputs.empty()) {
    Table inputs{{"input", "value", "unit"}, {}, "lr"};
    for (std::size_t i = 0; i < system.inputs.size(); ++i) {
      inputs.rows.push_back(
          {system.inputs[i].name, short_number(equilibrium.state.z[system.z.size() + i], 10), system.inputs[i].unit});
    }
    out += '\n' + as_text(inputs);
  }
  out +=
      "\nfound in " + counted(static_cast<std::size_t>(equilibrium.iterations), "iteration") +
      (equilibrium.steps > 0 ? " and " + counted(static_cast<std::size_t>(equilibrium.steps), "step") + " of settling"
                             : "") +
      ", largest residual " + short_number(equilibrium.residual, 2) + " of its terms\n" + stability_text(stability) +
      '\n' + free_directions_text(equilibrium.free_directions) +
      redundancy_text(equilibrium.redundancy, context.system());
  deliver(arguments, "equilibrium.json", equilibrium_document(system, equilibrium, stability, notes), out);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_equilibrium = {
    "equilibrium", "SCENE", "find the state of rest",
    R"(Finds the state with all velocities and rates zero, from the start values of the scene, which may be rough. Variables
that the scene lists under "hold" keep their start values; directions in which the equilibrium could still move are
reported by name. Prints variables (SI), multipliers of the constraints, inputs.

Examples
  bramah equilibrium scenes/four_bar/overdamped.json
  bramah equilibrium scenes/four_bar/overdamped.json --set "start.V3.p=4 MPa" --json

--json prints {"variables": {NAME: value}, "inputs": {NAME: value}, "free_directions": [{NAME: share}], ...}
)",
    run};

}  // namespace bramah
