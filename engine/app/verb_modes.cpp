#include "app/context.hpp"
#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/sparse_model.hpp"
#include "app/verbs.hpp"

namespace bramah {
namespace {

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  if (context.options().modes.select != ModesOptions::Select::all) return run_selected_modes(context);
  Linearization linear = linearize(context);
  const Census census = census_of(context.system(), linear);
  if (linear.equilibrium) {
    linear.stability = judge_stability(linear.model, census.spectrum);
    tell_stability(context, *linear.stability);
  }
  std::string out = as_text(spectrum_table(linear.model, census.spectrum));
  const std::string energies = energy_text(context.system(), linear, census.spectrum);
  if (!energies.empty()) out += '\n' + energies;
  const std::string notes = spectrum_notes(census) + linear_notes(context.system(), linear);
  if (!notes.empty()) out += '\n' + notes;
  deliver(arguments, "spectrum.json", spectrum_document(context.system(), linear, census), out);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_modes = {
    "modes", "SCENE", "eigenvalues of the linear model, with the cause of every zero",
    R"(Linearizes as `bramah linearize` and prints the eigenvalues, most dangerous first, zeros last: damping ratio, frequency,
condition number (how many times rounding is magnified) and the states that take part. Zeros are counted by ranks, never
by an absolute limit; each names its cause, and the sums that the machine conserves are listed. A second table shows the
components that hold the kinetic, potential and pressure energy of each mode, and those that dissipate its power.

Examples
  bramah modes scenes/four_bar/overdamped.json
  bramah modes scenes/four_bar/overdamped.json --set "seal.F_c=21 N" --set "seal.F_s=83 N" --set seal.sigma_2=33

Of systems with thousands of states a scene selects: "modes": {"count": 20} the slowest, {"band": ["1 Hz", "2 Hz"]} those
in a band, {"within": "10 1/s"} all with |s| below, largest real part first. They come from the sparse unreduced form, with
their residuals and a proof that none was missed ("prove": false skips it); --out DIR writes selected_modes.json and mode_shapes.csv.

--json prints {"unstable": n, "zeros": n, "zeros_predicted": n, "states": [...], "eigenvalues": [{"re", "im", "zero",
"cause", "damping_ratio", "frequency_hz", "condition", "doubtful"}], "zero_blocks": [{"size", "kind", "cause", "moves"}],
"conserved": [{STATE: share}], "mode_shapes": [{STATE: [re, im]}], "left_vectors": [{STATE: [re, im]}], "participation":
[{"states": {STATE: share}, "components": {NAME: share}}], "full_shapes": [{"variables": {NAME: [re, im]},
"multipliers": {NAME: [re, im]}}], "energies": [{"kinetic", "potential", "pressure", "dissipated", "components": {NAME:
{...}}}]}
)",
    run};

}  // namespace bramah
