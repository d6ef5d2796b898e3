#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/transient.hpp"
#include "app/verbs.hpp"
#include "io/checkpoint.hpp"
#include "io/npy_file.hpp"
#include "io/read_scene.hpp"
#include "system/measure.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

constexpr const char* kOptions[] = {"--resume", "--save-every", "--binary", "--output"};

std::string document(const Context& context, const Transient& transient, const std::vector<StartNote>& notes,
                     const std::optional<Rest>& rest, const std::string& file) {
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
  write_notes(json, notes);
  write_equilibrium(json, rest ? &rest->equilibrium : nullptr, rest ? &rest->stability : nullptr);
  json.end_object();
  return json.take();
}

/// Bytes of the header and of `rows` rows of the CSV that is there, whose header must be `header`.
std::uintmax_t bytes_of_rows(const std::filesystem::path& there, const std::string& header, long rows) {
  std::ifstream in(there, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || line + '\n' != header) throw WriteError::other_columns(there);
  std::uintmax_t bytes = header.size();
  for (long row = 0; row < rows; ++row) {
    if (!std::getline(in, line) || in.eof()) throw WriteError::fewer_rows(there, static_cast<std::size_t>(rows));
    bytes += line.size() + 1;
  }
  return bytes;
}

/// Whether the checkpoint of --resume lies in the folder of --out: the series that is there then goes on.
bool goes_on_in_place(const Arguments& arguments) {
  std::error_code ignored;
  return !arguments.out.empty() && !arguments.resume.empty() &&
         std::filesystem::equivalent(std::filesystem::absolute(arguments.resume).parent_path(), arguments.out, ignored);
}

/// Where the rows go: a file, which appears when it is complete, or standard output.
class Series {
 public:
  /// `from`: the checkpoint of --resume; where it lies in the folder of --out, the series that is there goes on.
  Series(const Arguments& arguments, const std::vector<Measured>& outputs, const Checkpoint* from)
      : to_stdout_(arguments.out.empty() && !arguments.json) {
    bool goes_on = false;
    const std::string header = csv_header(outputs);
    if (!arguments.out.empty()) {
      const std::filesystem::path folder(arguments.out);
      make_folder(folder);
      file_ = folder / (arguments.binary ? "time_series.npy" : "time_series.csv");
      goes_on = from != nullptr && !OutputFile::there_is(file_).empty() && goes_on_in_place(arguments);
      if (arguments.binary) {
        std::vector<std::string> columns = {"time"};
        for (const Measured& output : outputs) columns.push_back(output.name);
        if (goes_on) {
          npy_.emplace(file_, columns, static_cast<std::size_t>(from->outputs));
        } else {
          npy_.emplace(file_, columns);
        }
        npy_->keep_on_failure();
      } else {
        if (goes_on) {
          csv_.emplace(file_, bytes_of_rows(OutputFile::there_is(file_), header, from->outputs));
        } else {
          csv_.emplace(file_);
        }
        csv_->keep_on_failure();
      }
    }
    if (!npy_ && !goes_on) write(header);
  }
  void row(double time, const Vector& values) {
    if (npy_) {
      record_.assign(1, time);
      record_.insert(record_.end(), values.begin(), values.end());
      npy_->row(record_);
    } else if (csv_ || to_stdout_) {
      write(csv_row(time, values));
    }
  }
  /// All rows so far are in the file: what a checkpoint goes on from.
  void flush() {
    if (csv_) csv_->flush();
    if (npy_) npy_->flush();
  }
  void commit() {
    if (csv_) csv_->commit();
    if (npy_) npy_->commit();
  }
  /// Where the rows of a broken run are; empty where they went to standard output.
  std::filesystem::path leave_part() {
    if (csv_) return csv_->leave_part();
    return npy_ ? npy_->leave_part() : std::filesystem::path{};
  }
  /// Empty where there is none.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] bool scrolls() const { return to_stdout_ && isatty(STDOUT_FILENO) == 1; }

 private:
  void write(const std::string& line) {
    if (csv_) csv_->write(line);
    if (to_stdout_) print(line);
  }
  bool to_stdout_;
  std::filesystem::path file_;
  std::optional<OutputFile> csv_;
  std::optional<NpyFile> npy_;
  Vector record_;
};

std::optional<Checkpoint> checkpoint_to_resume(const Arguments& arguments, const Context& context) {
  const System& system = context.system();
  if (arguments.resume.empty()) return std::nullopt;
  Source source{arguments.resume, ""};
  try {
    source = read_source(arguments.resume);
    Checkpoint from = read_checkpoint(system, source);
    const double t = from.state.t;
    const SimulateOptions& options = context.options().simulate;
    // A run that was killed after its last checkpoint is complete but for the name of its series.
    if (!(options.to_time > t) && !(options.to_time == t && goes_on_in_place(arguments))) {
      throw Failure::analysis(
          {}, AnalysisError("simulate",
                            "the checkpoint is at t = " + digits(t, 17) +
                                " s, and the simulation ends at to_time = " + digits(options.to_time, 17) + " s",
                            "a to_time after the checkpoint", "set \"to_time\" to a later time", "/simulate/to_time"));
    }
    return from;
  } catch (const SceneError& error) {
    throw Failure::scene(source, error, {});
  }
}

void check(const Arguments& arguments) {
  if (!arguments.out.empty()) return;
  if (arguments.binary) throw Failure::usage("--binary without --out", "a folder for time_series.npy", "add --out DIR");
  if (arguments.save_every > 0.0)
    throw Failure::usage("--save-every without --out", "a folder for checkpoint.json", "add --out DIR");
}

/// The checkpoint is that of the end: nothing is left to simulate.
int complete(const Context& context, const Checkpoint& at_end, Series& series) {
  Transient transient;
  transient.last_time = at_end.state.t;
  transient.final_values = Meter(context.system(), context.options().outputs).read(at_end.state);
  series.commit();
  if (!context.arguments.quiet) say("the run was complete; its series is " + series.file().string() + '\n');
  if (context.arguments.json) print(document(context, transient, {}, {}, series.file().string()));
  return exit_ok;
}

int run(const Arguments& arguments) {
  check(arguments);
  const Context context = load(arguments);
  const std::optional<Checkpoint> from = checkpoint_to_resume(arguments, context);
  Series series(arguments, context.options().outputs, from ? &*from : nullptr);
  const std::filesystem::path saved = std::filesystem::path(arguments.out) / "checkpoint.json";
  const auto save = [&](const Checkpoint& checkpoint) {
    if (arguments.out.empty()) return;
    series.flush();
    write_file(saved, checkpoint_text(context.system(), checkpoint));
  };
  if (from && from->state.t == context.options().simulate.to_time) return complete(context, *from, series);
  TransientSetup setup;
  setup.resume = from ? &*from : nullptr;
  setup.show_progress = !series.scrolls();  // rows that scroll by are progress enough
  setup.save = save;
  // A run that is killed, or finds no room, can be continued from its last checkpoint: one is written after the first step.
  constexpr double seconds_between = 5.0;
  setup.save_every = arguments.out.empty() ? 0.0 : arguments.save_every > 0.0 ? arguments.save_every : seconds_between;
  std::vector<StartNote> notes;
  const bool at_equilibrium = context.options().simulate.from == SimulateOptions::From::equilibrium;
  if (!from) notes = tell_start_notes(context, at_equilibrium);
  std::optional<Rest> rest;
  if (!from && at_equilibrium) {
    rest = find_rest(context, context.start_time());
    setup.start = &rest->equilibrium.state;
  }
  Transient transient;
  try {
    transient = run_transient(context, context.options().simulate, setup,
                              [&](const State& state, const Vector& values) { series.row(state.t, values); });
  } catch (const WriteError& error) {
    if (arguments.out.empty()) throw;
    std::error_code ignored;
    const bool checkpoint = std::filesystem::exists(saved, ignored);
    throw WriteError(error.file(),
                     error.found() + "; rows so far are in " + series.file().string() + ".part" +
                         (checkpoint ? ", the last checkpoint is " + saved.string() : std::string()),
                     error.remedy() + (checkpoint ? ", and go on with --resume " + saved.string() : std::string()));
  } catch (const SimulationError& error) {
    for (const std::string& warning : limit_warnings(error.limits_passed())) say("warning: " + warning + '\n');
    if (arguments.out.empty()) throw;
    save(error.last());
    say("results up to the failure are in " + series.leave_part().string() + ", the last good state is in " +
        saved.string() + "; mend the scene or its settings and go on with --resume\n");
    throw;
  }
  save(transient.simulation.checkpoint);
  series.commit();  // a kill before this leaves the part and a checkpoint of the end, which `complete` takes
  if (!arguments.quiet) {
    say(as_text(statistics_table(transient), ""));
    if (!series.file().empty()) say("wrote " + series.file().string() + " and " + saved.string() + '\n');
  }
  for (const std::string& warning : limit_warnings(transient.simulation.limits_passed))
    say("warning: " + warning + '\n');
  for (const AnalysisError& doubt : doubts_of(transient.simulation))
    say("warning: " + std::string(doubt.what()) + '\n');
  if (transient.interrupted)
    say("interrupted; results up to t = " + short_number(transient.last_time, 10) + " s are kept" +
        (arguments.out.empty() ? "" : ", --resume " + saved.string() + " goes on") + '\n');
  if (arguments.json) print(document(context, transient, notes, rest, series.file().string()));
  return transient.interrupted ? exit_interrupted : exit_ok;
}

}  // namespace

constinit const Verb verb_simulate = {
    "simulate",
    "SCENE",
    "run the machine in time",
    R"(Simulates as the scene's "simulate" says: from its start values or from the equilibrium, between from_time and to_time,
with output every output_step (every step of the integrator where there is none). At jumps of an input there are two
rows with the same time: before and after. Columns are the scene's "outputs", all variables where it lists none; SI.
Without --out the CSV goes to standard output. A summary goes to standard error. Ctrl-C keeps the results so far.
With --out a checkpoint is kept in DIR/checkpoint.json: every few seconds, at the end, and where the run is interrupted,
killed or fails. --resume DIR/checkpoint.json goes on from it; with the same --out the series that is there goes on, too.
The integrator "generalized_alpha" then goes on with the same bits, the others start anew.

Examples
  bramah simulate scenes/four_bar/overdamped.json --out results
  bramah simulate scenes/four_bar/overdamped.json --set "simulate.output_step=1 ms" > series.csv
  bramah simulate scenes/four_bar/overdamped.json --out more --resume results/checkpoint.json --set simulate.to_time=4

--output NAME         only these columns, any number of times: variables, energies, powers, ...
--resume FILE         go on from a checkpoint
--save-every SECONDS  write the checkpoint so often, too
--binary              DIR/time_series.npy instead of .csv: numpy.load(FILE)["NAME"] is a column

--out writes DIR/time_series.csv with the header time,NAME,...
--json prints {"summary": {...}, "final": {"time", NAME: value}, "units": {...}, "time_series": FILE}
)",
    run,
    kOptions};

}  // namespace bramah
