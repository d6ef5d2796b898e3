#include <filesystem>

#include "app/failure.hpp"
#include "app/vary.hpp"
#include "app/verbs.hpp"
#include "io/output_file.hpp"

namespace bramah {
namespace {

constexpr const char* kOptions[] = {"--threads", "--resume"};

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  check_vary(context);
  Journal journal(context, "vary", "vary.journal");
  const Vary vary = run_vary(context, journal);
  if (!arguments.out.empty()) {
    const std::filesystem::path folder(arguments.out);
    write_file(folder / "vary.csv", vary_csv(vary));
    if (!arguments.quiet) say("wrote " + (folder / "vary.csv").string() + "\n");
  }
  deliver(arguments, "vary.json", vary_document(vary), vary_text(vary));
  journal.finish(vary.interrupted);
  if (vary.interrupted) return exit_interrupted;
  return vary.count(VariedRun::Status::ok) > 0 ? exit_ok : exit_analysis;
}

}  // namespace

constinit const Verb verb_vary = {
    "vary",
    "SCENE",
    "many simulations: over a grid of parameters, or with parameters drawn by lot",
    R"(Simulates the scene once for every point of the grid, or every random draw, that its section "vary" asks for, as --set
and `simulate` would each time, and gives figures of each run and their statistics over all runs: final value, min, max,
mean over time and rms of each output, from the rows of output. Only figures are kept, no series. A run that fails is
listed with its reason; the others are kept. All cores are used; results do not depend on how many, and the numbers that
are drawn depend on the seed alone.

  --threads N     at most so many runs at a time
  --resume FILE   go on from the journal that a broken run has left

Example
  bramah vary scenes/linear/pendulum.json --out results

--out writes vary.json and vary.csv (a row a run: parameters, figures, status, message). Until these are there, each run
is written into vary.journal when it ends: after Ctrl-C, a kill or a full disk, --resume DIR/vary.journal does the rest.
--json prints {"parameters": [{"name", "unit"}], "figures": [{"name", "unit", "mean", "standard_deviation", "min", "max",
"p5", "p50", "p95"}], "runs": [{"run", "at", "status", "values", "message"}], "failed", "interrupted",
"equilibrium"}
The exit code is 0 if any run succeeded, 1 if none did, 130 after Ctrl-C, with the complete runs kept.
)",
    run,
    kOptions};

}  // namespace bramah
