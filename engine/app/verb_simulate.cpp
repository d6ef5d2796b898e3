#include <unistd.h>

#include <filesystem>
#include <optional>

#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/transient.hpp"
#include "app/verbs.hpp"

namespace bramah {
namespace {

std::string document(const Context& context, const Transient& transient, const std::string& file) {
  JsonWriter json;
  json.begin_object().key("summary").begin_object();
  write_statistics(json, transient);
  json.end_object().key("final").begin_object().member("time", transient.last_time);
  const std::vector<Measured>& outputs = context.options().outputs;
  for (std::size_t k = 0; k < transient.final_values.size(); ++k)
    json.member(outputs[k].name, transient.final_values[k]);
  json.end_object().key("units").begin_object().member("time", "s");
  for (const Measured& output : outputs) json.member(output.name, output.unit);
  json.end_object().key("time_series");
  file.empty() ? json.null() : json.value(file);
  json.end_object();
  return json.take();
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const std::filesystem::path folder(arguments.out), file = folder / "time_series.csv";
  const bool to_stdout = arguments.out.empty() && !arguments.json;
  std::optional<OutputFile> csv;
  if (!arguments.out.empty()) {
    make_folder(folder);
    csv.emplace(file);
  }
  const auto write = [&](const std::string& line) {
    if (csv) csv->write(line);
    if (to_stdout) print(line);
  };
  write(csv_header(context.options().outputs));
  Transient transient;
  try {
    // Rows that scroll by are progress enough.
    transient = run_transient(context, context.options().simulate, nullptr, !(to_stdout && isatty(STDOUT_FILENO) == 1),
                              [&](const State& state, const Vector& values) { write(csv_row(state.t, values)); });
  } catch (const AnalysisError&) {
    if (csv) say("results up to the failure are in " + csv->leave_part().string() + '\n');
    throw;
  }
  if (csv) csv->commit();
  say(as_text(statistics_table(transient), ""));
  if (csv) say("wrote " + file.string() + '\n');
  if (transient.interrupted)
    say("interrupted; results up to t = " + short_number(transient.last_time, 10) + " s are kept\n");
  if (arguments.json) print(document(context, transient, csv ? file.string() : ""));
  return transient.interrupted ? exit_interrupted : exit_ok;
}

}  // namespace

constinit const Verb verb_simulate = {
    "simulate", "SCENE", "run the machine in time",
    R"(Simulates as the scene's "simulate" says: from its start values or from the equilibrium, between from_time and to_time,
with output every output_step (every step of the integrator where there is none). At jumps of an input there are two
rows with the same time: before and after. Columns are the scene's "outputs", all variables where it lists none; SI.
Without --out the CSV goes to standard output. A summary goes to standard error. Ctrl-C keeps the results so far.

Examples
  bramah simulate scenes/four_bar/overdamped.json --out results
  bramah simulate scenes/four_bar/overdamped.json --set "simulate.output_step=1 ms" > series.csv

--out writes DIR/time_series.csv with the header time,NAME,...
--json prints {"summary": {...}, "final": {"time", NAME: value}, "units": {...}, "time_series": FILE}
)",
    run};

}  // namespace bramah
