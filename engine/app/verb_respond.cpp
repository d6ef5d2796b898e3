#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "app/context.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/study_report.hpp"
#include "app/verbs.hpp"
#include "io/output_file.hpp"
#include "io/tables.hpp"
#include "linear/transfer.hpp"
#include "system/analysis_error.hpp"
#include "system/units.hpp"

namespace bramah {
namespace {

constexpr int kPerDecade = 20;
constexpr double kBeyond = 10.0;  // how far below the slowest and above the fastest mode the frequencies reach

/// rad/s, evenly spaced on a logarithmic axis that covers all modes.
std::vector<double> frequencies_for(const Spectrum& spectrum) {
  double slowest = HUGE_VAL, fastest = 0.0;
  for (const Mode& mode : spectrum.modes) {
    if (mode.zero || mode.doubtful) continue;
    slowest = std::min(slowest, std::abs(mode.eigenvalue));
    fastest = std::max(fastest, std::abs(mode.eigenvalue));
  }
  if (fastest == 0.0) slowest = fastest = 1.0;
  const double first = std::log10(slowest / kBeyond), last = std::log10(fastest * kBeyond);
  const int count = 1 + static_cast<int>(std::ceil(kPerDecade * (last - first)));
  std::vector<double> list;
  list.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) list.push_back(std::pow(10.0, first + (last - first) * k / (count - 1)));
  return list;
}

constexpr const char* kOptions[] = {"--step", "--impulse", "--input", "--output"};

/// Responses in time to one kind of input, all paths.
struct InTime {
  const char* name;       // "step", "impulse"
  const char* per_input;  // what the unit is per
  std::vector<double> times;
  std::vector<Eigen::MatrixXd> of_input;  // of each input of the model: outputs by column
};

/// "TO" or "TO:COUNT".
std::vector<double> times_of(const char* option, const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto to = parse_quantity(text.substr(0, colon));
  const auto unit = to ? parse_unit(to->unit.empty() ? "s" : to->unit) : std::nullopt;
  const auto count =
      colon == std::string::npos ? Quantity{201.0, ""} : parse_quantity(text.substr(colon + 1)).value_or(Quantity{});
  constexpr double most = 1e6;
  const bool is_count =
      count.unit.empty() && count.value >= 2.0 && count.value <= most && count.value == std::floor(count.value);
  if (!unit || !unit->same_dimension(*parse_unit("s")) || !(unit->to_si(to->value) > 0.0) || !is_count) {
    throw Failure::usage(std::string(option) + " " + text,
                         "TO or TO:COUNT, a time above 0 and a whole number from 2 to 1000000",
                         std::string("write for instance ") + option + " \"50 ms:201\"");
  }
  std::vector<double> times;
  const int last = static_cast<int>(count.value) - 1;
  times.reserve(static_cast<std::size_t>(last) + 1);
  for (int k = 0; k <= last; ++k) times.push_back(unit->to_si(to->value) * k / last);
  return times;
}

/// Positions of the inputs that --input names, all of them without it.
std::vector<std::size_t> chosen_inputs(const Arguments& arguments, const LinearModel& model) {
  std::vector<std::size_t> chosen;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    names.push_back(model.inputs[i].name);
    const bool is_wanted =
        std::find(arguments.inputs.begin(), arguments.inputs.end(), names.back()) != arguments.inputs.end();
    if (arguments.inputs.empty() || is_wanted) chosen.push_back(i);
  }
  for (const std::string& wanted : arguments.inputs) {
    if (std::find(names.begin(), names.end(), wanted) != names.end()) continue;
    throw Failure::usage("the scene has no input \"" + wanted + "\"", "one of: " + quoted_list(names),
                         suggestion(wanted, names, "`bramah check SCENE` lists the inputs"));
  }
  return chosen;
}

bool is_path(const InTime& response, std::size_t input, std::size_t output) {
  return !response.of_input[input].row(static_cast<Eigen::Index>(output)).isZero(0.0);
}

std::vector<double> values_of(const InTime& response, std::size_t input, std::size_t output) {
  const Eigen::VectorXd row = response.of_input[input].row(static_cast<Eigen::Index>(output));
  return {row.data(), row.data() + row.size()};
}

std::string unit_of(const InTime& response, const LinearModel& model, std::size_t input, std::size_t output) {
  return model.outputs[output].unit + " per " + model.inputs[input].unit + response.per_input;
}

Table time_table(const InTime& response, const LinearModel& model, const std::vector<std::size_t>& inputs) {
  Table table{{std::string(response.name) + " of", "to", "at the end", "largest", "at", "unit"}, {}, "llrrrl"};
  for (const std::size_t i : inputs) {
    for (std::size_t o = 0; o < model.outputs.size(); ++o) {
      if (!is_path(response, i, o)) continue;
      const std::vector<double> values = values_of(response, i, o);
      const auto peak =
          std::max_element(values.begin(), values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
      table.rows.push_back({model.inputs[i].name, model.outputs[o].name, short_number(values.back(), 6),
                            short_number(*peak, 6),
                            short_number(response.times[static_cast<std::size_t>(peak - values.begin())], 4) + " s",
                            unit_of(response, model, i, o)});
    }
  }
  return table;
}

/// A row a time, a column a path.
std::string time_csv(const InTime& response, const LinearModel& model, const std::vector<std::size_t>& inputs) {
  std::string text = "time";
  std::vector<std::vector<double>> columns;
  for (const std::size_t i : inputs) {
    for (std::size_t o = 0; o < model.outputs.size(); ++o) {
      if (!is_path(response, i, o)) continue;
      text.append(",").append(csv_field(model.inputs[i].name + " to " + model.outputs[o].name));
      columns.push_back(values_of(response, i, o));
    }
  }
  text += '\n';
  for (std::size_t k = 0; k < response.times.size(); ++k) {
    text += exact_number(response.times[k]);
    for (const std::vector<double>& column : columns) text.append(",").append(exact_number(column[k]));
    text += '\n';
  }
  return text;
}

std::vector<plot::Figure> time_figures(const InTime& response, const LinearModel& model,
                                       const std::vector<std::size_t>& inputs) {
  constexpr std::size_t most = 24;  // of one file
  std::vector<plot::Figure> figures;
  for (const std::size_t i : inputs) {
    for (std::size_t o = 0; o < model.outputs.size() && figures.size() < most; ++o) {
      if (!is_path(response, i, o)) continue;
      plot::Figure figure;
      figure.title = model.outputs[o].name + ", " + response.name + " of " + model.inputs[i].name;
      figure.x = {"time", "s"};
      figure.y = {"", unit_of(response, model, i, o)};
      figure.series.push_back({"", response.times, values_of(response, i, o), plot::Style::line, 0});
      figures.push_back(std::move(figure));
    }
  }
  return figures;
}

std::vector<InTime> responses_in_time(const Arguments& arguments, const LinearModel& model) {
  std::vector<InTime> list;
  if (!arguments.step.empty()) list.push_back({"step", "", times_of("--step", arguments.step), {}});
  if (!arguments.impulse.empty()) list.push_back({"impulse", ".s", times_of("--impulse", arguments.impulse), {}});
  for (InTime& response : list) {
    const bool is_step = std::string_view(response.name) == "step";
    for (Eigen::Index i = 0; i < model.B.cols(); ++i)
      response.of_input.push_back(is_step ? step_response(model, i, response.times)
                                          : impulse_response(model, i, response.times));
  }
  return list;
}

void write_files(const Arguments& arguments, const LinearModel& model, const std::vector<std::size_t>& inputs,
                 const std::vector<InTime>& in_time) {
  if (arguments.out.empty()) return;
  const std::filesystem::path folder(arguments.out);
  make_folder(folder);
  const auto write = [&](const std::string& name, const std::string& content) {
    write_file(folder / name, content);
    if (!arguments.quiet) say("wrote " + (folder / name).string() + "\n");
  };
  for (const InTime& response : in_time) {
    const std::string name = response.name;
    write(name + ".csv", time_csv(response, model, inputs));
    write(name + ".svg", sheet_of(time_figures(response, model, inputs), 2));
  }
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const Linearization linear = linearize_outputs(context);
  const LinearModel& model = linear.model;
  if (model.inputs.empty()) {
    throw AnalysisError("respond", "a scene without inputs", "at least one signal or pressure source",
                        "add a component such as signals/constant and connect it");
  }
  const std::vector<std::size_t> inputs = chosen_inputs(arguments, model);
  const std::vector<InTime> in_time = responses_in_time(arguments, model);
  const Spectrum spectrum = find_spectrum(model);
  const std::vector<double> frequencies = frequencies_for(spectrum);
  const std::vector<Eigen::MatrixXcd> gains = frequency_response(model, frequencies);
  const ModalAccess access = modal_access(model, spectrum);

  JsonWriter json;
  json.begin_object().key("frequencies_rad_s").values(frequencies);
  for (const InTime& response : in_time) json.key(std::string(response.name) + "_times_s").values(response.times);
  json.key("paths").begin_list();
  Table table{{"from", "to", "largest gain", "at", "phase there", "finite zeros"}, {}, "llrrrr"};
  for (const std::size_t i : inputs) {
    for (std::size_t o = 0; o < model.outputs.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(i);
      std::vector<double> gain, phase;
      std::size_t peak = 0;
      for (std::size_t k = 0; k < frequencies.size(); ++k) {
        gain.push_back(std::abs(gains[k](row, column)));
        phase.push_back(std::arg(gains[k](row, column)));
        if (gain[k] > gain[peak]) peak = k;
      }
      if (gain[peak] == 0.0) continue;  // this input never reaches this output
      const std::vector<std::complex<double>> zeros = transfer_zeros(model, column, row);
      json.begin_object().member("input", model.inputs[i].name).member("output", model.outputs[o].name);
      json.member("unit", model.outputs[o].unit + " per " + model.inputs[i].unit)
          .key("gain")
          .values(gain)
          .key("phase_rad")
          .values(phase);
      write_eigenvalues(json, "zeros", zeros);
      for (const InTime& response : in_time) json.key(response.name).values(values_of(response, i, o));
      json.end_object();
      table.rows.push_back({model.inputs[i].name, model.outputs[o].name, short_number(gain[peak], 5),
                            short_number(frequencies[peak], 4) + " rad/s",
                            short_number(phase[peak] * 180.0 / M_PI, 4) + " deg", std::to_string(zeros.size())});
    }
  }
  json.end_list().key("modes").begin_list();
  for (Eigen::Index k = 0; k < access.controllability.rows(); ++k) {
    const Mode& mode = spectrum.modes[static_cast<std::size_t>(k)];
    json.begin_object()
        .member("re", mode.eigenvalue.real())
        .member("im", mode.eigenvalue.imag())
        .key("controllability")
        .begin_object();
    for (std::size_t i = 0; i < model.inputs.size(); ++i)
      json.member(model.inputs[i].name, access.controllability(k, static_cast<Eigen::Index>(i)));
    json.end_object().key("observability").begin_object();
    for (std::size_t o = 0; o < model.outputs.size(); ++o)
      json.member(model.outputs[o].name, access.observability(k, static_cast<Eigen::Index>(o)));
    json.end_object().end_object();
  }
  json.end_list().end_object();
  write_files(arguments, model, inputs, in_time);
  std::string text = as_text(table) + '\n';
  for (const InTime& response : in_time) text += as_text(time_table(response, model, inputs)) + '\n';
  deliver(arguments, "response.json", json.take(), text + linear_notes(context.system(), linear));
  return exit_ok;
}

}  // namespace

constinit const Verb verb_respond = {
    "respond",
    "SCENE",
    "responses in frequency and time, transfer zeros, and how inputs and outputs reach the modes",
    R"(Linearizes as `bramah linearize` and gives, for every input and every output of the scene that it reaches, the gain and
phase over frequencies that cover all modes, and the finite zeros of the path. For every mode: how well each input moves
it and each output sees it, between 0 (not at all) and 1. Paths with no gain at all are left out.

  --step TO:COUNT, --impulse TO:COUNT  also the responses in time, from rest, to a unit step or a unit impulse of each
                                       input: COUNT times (201) from 0 to TO; exact, by matrix exponentials
  --input NAME, --output NAME          only these; any variable, rate, multiplier or output of a component can be one

Examples
  bramah respond scenes/four_bar/overdamped.json
  bramah respond scenes/four_bar/overdamped.json --step "50 ms" --input torque --output V2.p --out results
  bramah respond scenes/four_bar/overdamped.json --set linearize.side=- --json

--out writes response.json, and step.csv, step.svg, impulse.csv, impulse.svg where they are asked for.
--json prints {"frequencies_rad_s": [...], "paths": [{"input", "output", "unit", "gain": [...], "phase_rad": [...],
"zeros": [{"re", "im"}]}], "modes": [{"re", "im", "controllability": {INPUT: 0..1}, "observability": {OUTPUT: 0..1}}]}
)",
    run,
    kOptions};

}  // namespace bramah
