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
    "compare", "SCENE", "hold the reduced Jacobian against others, exact and by differences",
    R"(Computes the eigenvalues on five rungs: from the augmented matrix of all coordinates, velocities and first-order
variables by central differences and dense inverses, with steps h = 0.1 ... 1e-12 (or those of the scene's
"compare": {"steps": [...]}); by differences with sparse factors, at the best h; from the exact augmented matrix; from
the exact pencil with multipliers, by shift-invert; and from the reduced model. Prints the error of each eigenvalue, the
number and size of false zeros, whether they make the machine look unstable, what each takes, and marks the best h.
What would take more than about a minute is left out, and said to be.

Example
  bramah compare scenes/four_bar/overdamped.json

--json prints {"reduced": {"size", "eigenvalues", "time_s", ...}, "augmented_exact": {"errors", "false_zeros",
"largest_false_zero", ...}, "augmented_pencil": {...}, "augmented_fd": [{"h", "errors", "time_s", ...}],
"augmented_fd_sparse": {"h", ...}}; time_s is the sum of assembly_s, reduction_s and eigenvalues_s.
)",
    run};

}  // namespace bramah
