#include <filesystem>
#include <functional>
#include <string>

#include "app/failure.hpp"
#include "app/sweep.hpp"
#include "app/verbs.hpp"
#include "io/output_file.hpp"

namespace bramah {
namespace {

constexpr const char* kOptions[] = {"--over", "--threads", "--resume"};

/// Sweeps, and delivers what `deliver_results` makes of it.
int run(const Arguments& arguments, const std::string& journal_name,
        const std::function<void(const Sweep&)>& deliver_results) {
  const Context context = load(arguments);
  check_sweep(context);
  Journal journal(context, "sweep", journal_name);
  const Sweep sweep = run_sweep(context, journal);
  deliver_results(sweep);
  journal.finish(sweep.interrupted);
  return sweep.interrupted ? exit_interrupted : exit_ok;
}

void write_files(const Arguments& arguments, const Sweep& sweep) {
  if (arguments.out.empty()) return;
  const std::filesystem::path folder(arguments.out);
  const auto write = [&](const std::string& name, const std::string& content) {
    write_file(folder / name, content);
    if (!arguments.quiet) say("wrote " + (folder / name).string() + "\n");
  };
  write("sweep.csv", sweep_csv(sweep));
  for (const auto& [name, figure] : sweep_figures(sweep)) write(name + ".svg", plot::svg(figure, true));
}

int run_sweep_verb(const Arguments& arguments) {
  return run(arguments, "sweep.journal", [&](const Sweep& sweep) {
    write_files(arguments, sweep);
    deliver(arguments, "sweep.json", sweep_document(sweep), sweep_text(sweep));
  });
}

int run_critical_verb(const Arguments& arguments) {
  return run(arguments, "critical.journal", [&](const Sweep& sweep) {
    deliver(arguments, "critical.json", critical_document(sweep), critical_text(sweep));
  });
}

}  // namespace

constinit const Verb verb_sweep = {
    "sweep",
    "SCENE",
    "eigenvalues along a parameter, or over two: root locus, critical values",
    R"(Takes one number of the scene through the values of its section "sweep", or of --over, as --set would set it each time:
equilibrium or start state, linear model, spectrum. Modes are followed by their shapes, with more points between where
they come close, so that crossing modes keep their names and veering ones are not mixed up. Zeros by rank are kept apart.
A point without an answer is listed with its reason; the others are kept. All cores are used; results do not depend on
how many.

  --over PARAMETER=FROM:TO:COUNT   or PARAMETER=A,B,C; instead of the scene's "sweep"; twice for a grid. PARAMETER is
                                   COMPONENT.PARAMETER, constants.NAME or start.VARIABLE
  --threads N                      at most so many points at a time
  --resume FILE                    go on from the journal that a broken run has left

Examples
  bramah sweep scenes/bicycle/benchmark.json --over "constants.v=0.2:9:45" --out results
  bramah sweep scenes/four_bar/overdamped.json --over "seal.sigma_2=1:400:60"

Prints the largest real part along the parameter and where it passes zero. --out writes sweep.json, sweep.csv (a row a
point), root_locus.svg, real_parts.svg, frequencies.svg. Until these are there, each point is written into sweep.journal
when it is known: after Ctrl-C, a kill or a full disk, --resume DIR/sweep.journal does the rest.
--json prints {"over": [{"parameter", "unit", "values"}], "modes": [{"name", "states_at_first"}], "points": [{"at",
"failed", "zeros", "unstable", "re": [...], "im": [...]}], "critical": [...] (see critical), "branch_points": [{"at",
"first", "second", "re", "becomes"}], "points_added", "equilibrium", "failures": [{"at", "message"}], "notes", "interrupted"}
)",
    run_sweep_verb,
    kOptions};

constinit const Verb verb_critical = {
    "critical",
    "SCENE",
    "the values of a parameter at which the machine gains or loses stability",
    R"(Sweeps as `bramah sweep` and finds where the real part of a mode passes zero, to about the precision of the number itself:
with its frequency where the mode oscillates (flutter) or without (divergence), which side is unstable, and the states
that take part. Zeros by rank never count. What happens twice between neighbouring points may go unseen: take more.

  --over PARAMETER=FROM:TO:COUNT   or PARAMETER=A,B,C; instead of the scene's "sweep"
  --threads N                      at most so many points at a time
  --resume FILE                    go on from the journal that a broken run has left

Example
  bramah critical scenes/bicycle/benchmark.json --over "constants.v=0.2:9:45"

--out writes critical.json, and critical.journal until that is there, for --resume as in `bramah sweep`.
--json prints {"over": [...], "critical": [{"at": [value], "mode", "kind", "oscillatory", "rad_s", "frequency_hz",
"becomes", "others_unstable", "states"}], "equilibrium", "failures": [...], "notes", "interrupted"}
)",
    run_critical_verb,
    kOptions};

}  // namespace bramah
