#include "app/comparison.hpp"
#include "app/failure.hpp"
#include "app/progress.hpp"
#include "app/verbs.hpp"

namespace bramah {
namespace {

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const Linearization linear = linearize(context);
  Progress progress("compare");
  const Comparison comparison = compare(context, linear, [&](double share) { progress.show(share, ""); });
  progress.clear();
  deliver(arguments, "compare.json", comparison_document(comparison), comparison_text(comparison));
  return exit_ok;
}

}  // namespace

constinit const Verb verb_compare = {
    "compare", "SCENE", "hold the reduced Jacobian against the augmented one, exact and by differences",
    R"(Computes the eigenvalues three times: from the reduced model; from the augmented matrix of all coordinates, velocities
and first-order variables, exactly; and from the same matrix by central differences with steps h = 0.1 ... 1e-12 (or
those of the scene's "compare": {"steps": [...]}). Prints the error of each eigenvalue, the number and size of false
zeros, whether they make the machine look unstable, the time of each, and marks the best h.

Example
  bramah compare scenes/four_bar/overdamped.json

--json prints {"reduced": {"size", "eigenvalues", "time_s", ...}, "augmented_exact": {"errors", "false_zeros",
"largest_false_zero", ...}, "augmented_fd": [{"h", "errors", "false_zeros", "largest_false_zero", "time_s", ...}]}
)",
    run};

}  // namespace bramah
