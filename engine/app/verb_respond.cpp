#include <algorithm>
#include <cmath>

#include "app/context.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/verbs.hpp"
#include "linear/transfer.hpp"
#include "system/analysis_error.hpp"

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

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const Linearization linear = linearize(context);
  const LinearModel& model = linear.model;
  if (model.inputs.empty()) {
    throw AnalysisError("respond", "a scene without inputs", "at least one signal or pressure source",
                        "add a component such as signals/constant and connect it");
  }
  const Spectrum spectrum = find_spectrum(model);
  const std::vector<double> frequencies = frequencies_for(spectrum);
  const std::vector<Eigen::MatrixXcd> response = frequency_response(model, frequencies);
  const ModalAccess access = modal_access(model, spectrum);

  JsonWriter json;
  json.begin_object().key("frequencies_rad_s").values(frequencies).key("paths").begin_list();
  Table table{{"from", "to", "largest gain", "at", "phase there", "finite zeros"}, {}, "llrrrr"};
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    for (std::size_t o = 0; o < model.outputs.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(i);
      std::vector<double> gain, phase;
      std::size_t peak = 0;
      for (std::size_t k = 0; k < frequencies.size(); ++k) {
        gain.push_back(std::abs(response[k](row, column)));
        phase.push_back(std::arg(response[k](row, column)));
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
  deliver(arguments, "response.json", json.take(), as_text(table) + '\n' + linear_notes(context.system(), linear));
  return exit_ok;
}

}  // namespace

constinit const Verb verb_respond = {
    "respond", "SCENE", "frequency responses, transfer zeros, and how inputs and outputs reach the modes",
    R"(Linearizes as `bramah linearize` and gives, for every input and every output of the scene that it reaches, the gain and
phase over frequencies that cover all modes, and the finite zeros of the path. For every mode: how well each input moves
it and each output sees it, between 0 (not at all) and 1. Paths with no gain at all are left out.

Examples
  bramah respond scenes/four_bar/overdamped.json
  bramah respond scenes/four_bar/overdamped.json --set linearize.side=- --json

--json prints {"frequencies_rad_s": [...], "paths": [{"input", "output", "unit", "gain": [...], "phase_rad": [...],
"zeros": [{"re", "im"}]}], "modes": [{"re", "im", "controllability": {INPUT: 0..1}, "observability": {OUTPUT: 0..1}}]}
)",
    run};

}  // namespace bramah
