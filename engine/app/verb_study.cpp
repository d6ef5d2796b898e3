#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/progress.hpp"
#include "app/results.hpp"
#include "app/study_report.hpp"
#include "app/verbs.hpp"

namespace bramah {
namespace {

namespace fs = std::filesystem;

/// Writes into the results folder and remembers what.
class Folder {
 public:
  explicit Folder(fs::path path) : path_(std::move(path)) { make_folder(path_); }
  void write(const std::string& name, const std::string& content) {
    write_file(path_ / name, content);
    files_.push_back(name);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] std::vector<std::string>& files() { return files_; }

 private:
  fs::path path_;
  std::vector<std::string> files_;
};

/// The scene's options with outputs where the overlay begins and closely after it: errors between coarse outputs would
/// go unseen.
SimulateOptions simulate_options(const Context& context, const Spectrum& spectrum) {
  SimulateOptions options = context.options().simulate;
  const double from = context.options().study.linear_from;
  if (from <= options.from_time || from >= options.to_time) return options;
  const bool every_step = options.output_step == 0.0 && options.output_times.empty();
  if (every_step) return options;
  const auto on_grid = [&](double t) {
    const double k = options.output_step > 0.0 ? (t - options.from_time) / options.output_step : 0.5;
    return std::abs(k - std::round(k)) < 1e-9;
  };
  std::vector<double> times = overlay_times(spectrum, from, options.to_time);
  times.insert(times.begin(), from);
  std::erase_if(times, on_grid);
  std::vector<double> merged;
  std::set_union(times.begin(), times.end(), options.output_times.begin(), options.output_times.end(),
                 std::back_inserter(merged));
  options.output_times = std::move(merged);
  return options;
}

void simulate_study(const Context& context, Folder& folder, StudyResults& results) {
  const SimulateOptions options = simulate_options(context, results.census.spectrum);
  const State* start = options.from == SimulateOptions::From::equilibrium ? &results.equilibrium->state : nullptr;
  OutputFile csv(folder.path() / "time_series.csv");
  csv.write(csv_header(context.options().outputs));
  const double linear_from = context.options().study.linear_from;
  TransientSetup setup;
  setup.start = start;
  try {
    results.transient = run_transient(context, options, setup, [&](const State& state, const Vector& values) {
      csv.write(csv_row(state.t, values));
      results.recording.take(context.system(), state, values, linear_from);
    });
  } catch (const AnalysisError&) {
    say("results up to the failure are in " + csv.leave_part().string() + '\n');
    throw;
  }
  csv.commit();
  folder.files().emplace_back("time_series.csv");
  for (std::string& warning : limit_warnings(results.transient->simulation.limits_passed))
    results.remarks.push_back(std::move(warning));
  for (const AnalysisError& doubt : doubts_of(results.transient->simulation))
    results.remarks.emplace_back(doubt.what());
  if (results.transient->interrupted) {
    results.remarks.push_back("The simulation was interrupted at t = " + short_number(results.transient->last_time) +
                              " s.");
  }
}

void overlay_study(const Context& context, Folder& folder, StudyResults& results) {
  if (results.recording.from.empty()) {
    results.remarks.push_back("The simulation ends before study.linear_from = " +
                              short_number(context.options().study.linear_from) + " s: there is no linear overlay.");
    return;
  }
  if (!results.linear.at_equilibrium) {
    results.remarks.emplace_back(
        "The linear model is that of the start state, not of the equilibrium: there is no linear overlay.");
    return;
  }
  results.overlay = overlay_linear(context, results.linear, results.recording);
  std::string csv = csv_header(context.options().outputs);
  for (std::size_t k = 0; k < results.overlay->linear.size(); ++k) {
    csv += csv_row(results.recording.times[results.overlay->first + k], results.overlay->linear[k]);
  }
  folder.write("linear_response.csv", csv);
}

std::string summary(const Context& context, const StudyResults& results, Folder& folder) {
  JsonWriter json;
  json.begin_object().member("scene", context.scene.source.name).member("title", context.options().study.title);
  json.member("bramah", BRAMAH_VERSION).key("settings").values(context.arguments.settings);
  json.member("folder", folder.path().string());
  write_sizes(json, sizes_of(context.system(), &results.linear.partition));
  Eigenvalues eigenvalues;
  for (const Mode& mode : results.census.spectrum.modes) eigenvalues.push_back(mode.eigenvalue);
  write_eigenvalues(json, "eigenvalues", eigenvalues);
  if (results.transient) {
    json.key("simulation").begin_object();
    write_statistics(json, *results.transient);
    json.end_object().key("units").begin_object().member("time", "s");
    for (const Measured& output : context.options().outputs) json.member(output.name, output.unit);
    json.end_object();
  }
  if (results.overlay) {
    json.key("overlay").begin_object().member("from", results.overlay->from).key("errors").begin_object();
    for (const Overlay::Error& error : results.overlay->errors) {
      json.key(error.name).begin_flat_object().member("deviation", error.deviation).member("largest", error.largest);
      json.member("peak", error.peak);
      json.member("relative", error.relative()).end_object();
    }
    json.end_object().end_object();
  }
  write_equilibrium(json, results.equilibrium ? &*results.equilibrium : nullptr,
                    results.stability ? &*results.stability : nullptr);
  json.key("remarks").values(results.remarks);
  folder.files().emplace_back("summary.json");
  json.key("files").values(folder.files()).end_object();
  return json.take();
}

std::string text(const Context& context, const StudyResults& results, const Folder& folder) {
  const Sizes sizes = sizes_of(context.system(), &results.linear.partition);
  std::string out = context.options().study.title.empty() ? context.scene.source.name : context.options().study.title;
  out += "\n\nLinear model " + std::to_string(sizes.reduced()) + " x " + std::to_string(sizes.reduced()) +
         ", without the reduction " + std::to_string(sizes.augmented()) + " x " + std::to_string(sizes.augmented()) +
         "\n";
  out += as_text(spectrum_table(results.linear.model, results.census.spectrum));
  const std::string notes = linear_notes(context.system(), results.linear);
  if (!notes.empty()) out += '\n' + notes;
  if (results.transient) out += "\nSimulation\n" + as_text(statistics_table(*results.transient));
  if (results.overlay) out += "\nLinear model against simulation\n" + as_text(overlay_table(*results.overlay));
  if (results.comparison) out += "\nReduced against augmented\n" + as_text(comparison_table(*results.comparison));
  for (const std::string& remark : results.remarks) out += '\n' + remark + '\n';
  return out + "\nResults are in " + folder.path().string() + "; open " + (folder.path() / "report.html").string() +
         '\n';
}

/// A vehicle that rolls on has none, and its scene does not ask for one.
bool needs_equilibrium(const Options& options) {
  return options.linearize.at == LinearizeOptions::At::equilibrium ||
         (options.simulate.asked && options.simulate.from == SimulateOptions::From::equilibrium);
}

/// A note on the start is a remark of the report.
std::vector<StartNote> remark_on_start(const Context& context, bool equilibrium, StudyResults& results) {
  std::vector<StartNote> notes = start_notes(context.system(), context.options(), equilibrium, context.start_time());
  for (const StartNote& note : notes) results.remarks.push_back("Start: " + note.found + "; " + note.remedy + '.');
  return notes;
}

void remark_on_rest(const Rest& rest, StudyResults& results) {
  if (const std::string moved = moved_text(rest.equilibrium); !moved.empty())
    results.remarks.push_back("The equilibrium is away from the start values: " + moved + '.');
  if (rest.stability.verdict == Stability::Verdict::unstable)
    results.remarks.push_back("The equilibrium is " + stability_text(rest.stability) + '.');
}

/// Whether the scene asks for anything at its start state.
bool needs_start(const Options& options) {
  return options.linearize.at == LinearizeOptions::At::start ||
         (options.simulate.asked && options.simulate.from == SimulateOptions::From::start);
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  Folder folder(arguments.out.empty() ? fs::path("results") / fs::path(arguments.subject).stem()
                                      : fs::path(arguments.out));
  StudyResults results;
  if (needs_equilibrium(context.options())) {
    Rest rest = find_rest(context, context.start_time());
    folder.write("equilibrium.json", equilibrium_document(context.system(), rest.equilibrium, rest.stability,
                                                          remark_on_start(context, true, results)));
    remark_on_rest(rest, results);
    results.equilibrium = std::move(rest.equilibrium);
    results.stability = std::move(rest.stability);
  }
  if (needs_start(context.options())) remark_on_start(context, false, results);
  results.linear = linearize(context.compiled, context.options().linearize.prescribed, context.options().outputs);
  results.linear.stability = results.stability;
  folder.write("linear_model.json", linear_document(context.system(), results.linear));
  results.census = census_of(context.system(), results.linear);
  folder.write("spectrum.json", spectrum_document(context.system(), results.linear, results.census));
  if (context.options().simulate.asked) simulate_study(context, folder, results);
  if (results.transient && context.options().study.linear_from >= 0.0) overlay_study(context, folder, results);
  if (context.scene.root.find("compare") != nullptr) {
    Progress progress("compare");
    results.comparison = compare(context, results.linear, [&](double share) { progress.show(share, ""); });
    folder.write("compare.json", comparison_document(*results.comparison));
  }
  const StudyFigures figures = study_figures(context, results);
  if (!figures.transient.empty()) folder.write("transient.svg", sheet_of(figures.transient, figures.columns));
  for (const auto& [name, figure] : figures.others) folder.write(name + ".svg", plot::svg(figure, true));
  folder.write("report.html", study_page(context, results, figures));
  const std::string document = summary(context, results, folder);
  write_file(folder.path() / "summary.json", document);
  print(arguments.json ? document : text(context, results, folder));
  return results.transient && results.transient->interrupted ? exit_interrupted : exit_ok;
}

}  // namespace

constinit const Verb verb_study = {
    "study", "SCENE", "all that the scene asks for, into a folder with a report",
    R"(Finds the equilibrium (unless the scene begins at its start state throughout), linearizes, computes the spectrum;
simulates if the scene has "simulate", with the linear model beside it from "study": {"linear_from": time} on, where
outputs are closer; compares if the scene has "compare". Without --out the folder is results/NAME-OF-SCENE. Open
report.html in a browser; it needs nothing else.

Example
  bramah study scenes/four_bar/overdamped.json --out results/four_bar

Writes equilibrium.json, linear_model.json, spectrum.json, time_series.csv, linear_response.csv, compare.json,
transient.svg, spectrum.svg, compare_*.svg, report.html, summary.json. --json prints the summary.
)",
    run};

}  // namespace bramah
