#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/context.hpp"
#include "app/equilibrium_report.hpp"
#include "app/failure.hpp"
#include "app/results.hpp"
#include "app/verbs.hpp"
#include "io/matrix_files.hpp"
#include "io/output_file.hpp"
#include "linear/sensitivity.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

constexpr const char* kOptions[] = {"--by"};
constexpr std::size_t most_shown = 20;  // numbers on a terminal; --json and --out have all

struct Failed {
  std::string name, why;
};

struct Findings {
  Spectrum spectrum;
  std::vector<Sensitivity> ranked;  // most important first
  std::vector<Failed> failed;
};

Findings find(const Context& context, const Linearization& linear) {
  const System& system = context.system();
  Linearizer linearizer(system, linear.partition);
  LinearModel model;  // linear.model again: the linearizer must have been there
  linearizer.linearize(linear.state, model);
  Findings findings{find_spectrum(linear.model), {}, {}};
  std::vector<SceneNumber> numbers;
  for (const std::string& name : context.arguments.by) numbers.push_back(find_number(system, name));
  if (context.arguments.by.empty()) numbers = differentiable_numbers(system);
  const Follows follows = linear.at_equilibrium ? Follows::equilibrium : Follows::start;
  for (const SceneNumber& number : numbers) {
    try {
      findings.ranked.push_back(find_sensitivity(system, context.options().equilibrium, follows, linear.state,
                                                 linearizer, findings.spectrum, number));
    } catch (const AnalysisError& error) {
      findings.failed.push_back({number.name, error.what()});
    }
  }
  std::stable_sort(findings.ranked.begin(), findings.ranked.end(),
                   [](const Sensitivity& a, const Sensitivity& b) { return a.importance > b.importance; });
  return findings;
}

std::string unit_of(const SceneNumber& number) {
  return number.unit.empty() || number.unit == "1" ? "1/s" : "1/s per " + number.unit;
}

/// Places of the eigenvalues of a defective group, from 0.
std::vector<double> members(const Spectrum& spectrum, std::size_t group) {
  std::vector<double> places;
  for (std::size_t k = 0; k < spectrum.modes.size(); ++k) {
    if (spectrum.modes[k].group == static_cast<int>(group)) places.push_back(static_cast<double>(k));
  }
  return places;
}

std::string document(const Linearization& linear, const Findings& findings) {
  JsonWriter json;
  json.begin_object();
  std::vector<std::complex<double>> eigenvalues;
  for (Eigen::Index k = 0; k < findings.spectrum.left.cols(); ++k)
    eigenvalues.push_back(findings.spectrum.modes[static_cast<std::size_t>(k)].eigenvalue);
  write_eigenvalues(json, "eigenvalues", eigenvalues);
  json.key("defective").begin_list();
  for (std::size_t k = 0; k < findings.spectrum.defective.size(); ++k) {
    const DefectiveGroup& group = findings.spectrum.defective[k];
    json.begin_flat_object().member("re", group.mean.real()).member("im", group.mean.imag());
    json.key("members").values(members(findings.spectrum, k)).end_object();
  }
  json.end_list().key("sensitivities").begin_list();
  for (const Sensitivity& one : findings.ranked) {
    json.begin_object();
    json.member("number", one.number.name).member("value", one.number.value).member("unit", one.number.unit);
    json.member("importance", one.importance);
    write_eigenvalues(json, "derivatives", one.eigenvalues);
    write_eigenvalues(json, "defective_means", one.means);
    json.end_object();
  }
  json.end_list().key("failed").begin_list();
  for (const Failed& failed : findings.failed)
    json.begin_flat_object().member("number", failed.name).member("why", failed.why).end_object();
  json.end_list();
  write_equilibrium(json, linear);
  write_notes(json, linear.notes);
  json.end_object();
  return json.take();
}

std::string csv(const Findings& findings) {
  std::vector<std::string> rows, columns = {"value", "importance"};
  for (Eigen::Index k = 0; k < findings.spectrum.left.cols(); ++k) {
    columns.push_back("mode_" + std::to_string(k + 1) + ".re");
    columns.push_back("mode_" + std::to_string(k + 1) + ".im");
  }
  const std::size_t modes = (columns.size() - 2) / 2;
  for (std::size_t k = 0; k < findings.spectrum.defective.size(); ++k) {
    columns.push_back("mean_" + std::to_string(k + 1) + ".re");
    columns.push_back("mean_" + std::to_string(k + 1) + ".im");
  }
  Eigen::MatrixXd table(static_cast<Eigen::Index>(findings.ranked.size()), static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index i = 0; i < table.rows(); ++i) {
    const Sensitivity& one = findings.ranked[static_cast<std::size_t>(i)];
    rows.push_back(one.number.name);
    table(i, 0) = one.number.value;
    table(i, 1) = one.importance;
    for (std::size_t k = 0; k < one.eigenvalues.size(); ++k) {
      table(i, static_cast<Eigen::Index>(2 + 2 * k)) = one.eigenvalues[k].real();
      table(i, static_cast<Eigen::Index>(3 + 2 * k)) = one.eigenvalues[k].imag();
    }
    for (std::size_t k = 0; k < one.means.size(); ++k) {
      table(i, static_cast<Eigen::Index>(2 + 2 * (modes + k))) = one.means[k].real();
      table(i, static_cast<Eigen::Index>(3 + 2 * (modes + k))) = one.means[k].imag();
    }
  }
  return csv_of({table.data(), static_cast<std::size_t>(table.rows()), static_cast<std::size_t>(table.cols())}, rows,
                columns);
}

/// One row for each number and the eigenvalue that it moves most; conjugates are not repeated.
Table ranking(const Findings& findings) {
  Table table{{"number", "value", "relative", "eigenvalue (1/s)", "moves by", ""}, {}, "lrrrrl"};
  for (std::size_t i = 0; i < std::min(most_shown, findings.ranked.size()); ++i) {
    const Sensitivity& one = findings.ranked[i];
    std::string of, by;
    double largest = -1.0;
    const auto offer = [&](std::complex<double> derivative, std::complex<double> eigenvalue, const char* prefix) {
      const double relative = std::abs(derivative / eigenvalue);
      if (!(relative > largest * (1.0 + 1e-9))) return;
      largest = relative;
      of = prefix + complex_text(eigenvalue, 6);
      by = complex_text(derivative, 8);
    };
    for (std::size_t k = 0; k < one.eigenvalues.size(); ++k)
      offer(one.eigenvalues[k], findings.spectrum.modes[k].eigenvalue, "");
    for (std::size_t k = 0; k < one.means.size(); ++k)
      offer(one.means[k], findings.spectrum.defective[k].mean, "mean at ");
    if (of.empty()) continue;
    table.rows.push_back({one.number.name, with_unit(short_number(one.number.value, 6), one.number.unit),
                          short_number(one.importance, 3), of, by, unit_of(one.number)});
  }
  return table;
}

int run(const Arguments& arguments) {
  const Context context = load(arguments);
  const Linearization linear = linearize(context);
  const Findings findings = find(context, linear);
  std::string out = as_text(ranking(findings));
  if (findings.ranked.size() > most_shown)
    out += "\nThe " + std::to_string(most_shown) + " most important of " + std::to_string(findings.ranked.size()) +
           " numbers; --json prints all, for every eigenvalue.\n";
  for (const DefectiveGroup& group : findings.spectrum.defective)
    out += "\nThe " + counted(static_cast<std::size_t>(group.size), "eigenvalue") + " at " +
           complex_text(group.mean, 6) +
           " coincide and are defective: fewer vectors than eigenvalues. They move by a root of the change, so that no "
           "derivative exists; the derivative of their mean does, and stands in their place.\n";
  const auto zeros = static_cast<std::size_t>(findings.spectrum.zero_count());
  if (zeros > 0)
    out += '\n' + counted(zeros, "zero") + " of the spectrum: told by `bramah modes`, not differentiated.\n";
  for (const Failed& failed : findings.failed) out += "\n" + failed.name + ": " + failed.why + '\n';
  out += '\n' + linear_notes(context.system(), linear);
  if (!arguments.out.empty()) {
    make_folder(arguments.out);
    write_file(std::filesystem::path(arguments.out) / "sensitivity.csv", csv(findings));
  }
  deliver(arguments, "sensitivity.json", document(linear, findings), out);
  return exit_ok;
}

}  // namespace

constinit const Verb verb_sensitivity = {
    "sensitivity",
    "SCENE",
    "how eigenvalues move with every number of the scene, exactly",
    R"(Derivatives of all nonzero eigenvalues by parameters, constants and start values, exact, with the motion of the
equilibrium counted: held variables stay where they are. At a start state the independent coordinates and their rates
follow their start values. Ranked by importance: the largest relative change of an eigenvalue per relative change of the
number, 1 meaning that one per cent moves an eigenvalue by one per cent.

  --by NAME     only this number, any number of times: component.parameter, component.parameter.2 for the third number
                of a list, constants.NAME, start.VARIABLE

Examples
  bramah sensitivity scenes/four_bar/overdamped.json
  bramah sensitivity scenes/four_bar/overdamped.json --by seal.F_c --by constants.B_oil

--out DIR writes sensitivity.json and sensitivity.csv. --json prints {"eigenvalues": [{"re", "im"}], "sensitivities":
[{"number", "value", "unit", "importance", "derivatives": [{"re", "im"}], "defective_means": [{"re", "im"}]}], "defective":
[{"re", "im", "members"}], "failed": [{"number", "why"}]}; derivatives are in SI and in the order of the eigenvalues.
Eigenvalues that coincide and have fewer vectors than copies have no derivative (null); "defective" lists their means and
their places from 0, "defective_means" how the means move.
)",
    run,
    kOptions};

}  // namespace bramah
