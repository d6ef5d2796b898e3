#include "app/comparison.hpp"

#include <algorithm>
#include <cmath>

#include "app/results.hpp"
#include "linear/spectrum.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

// What takes longer than some half a minute is left out, and said to be.
constexpr double kMostInverting = 1e11;  // multiplications in all dense inverses
constexpr Index kMostStates = 1000;      // of dense unreduced eigenvalues

Eigenvalues eigenvalues_of(const Spectrum& spectrum) {
  Eigenvalues list;
  for (const Mode& mode : spectrum.modes) list.push_back(mode.eigenvalue);
  return list;
}

/// Why a rung is left out of this machine's comparison; empty: it is not.
std::string left_out(Rung rung, const System& system, const Partition& partition, std::size_t steps) {
  const auto rows = static_cast<Index>(partition.rows.size());
  const Index states = 2 * system.n() + system.nz(), size = states + rows;
  const double inverting = 4.0 * static_cast<double>(states) * std::pow(static_cast<double>(size), 3);
  if (rung == Rung::differences && inverting * static_cast<double>(steps) > kMostInverting)
    return "left out: " + std::to_string(2 * states) + " dense inverses of size " + std::to_string(size) +
           " for each h";
  if (rung != Rung::reduced && size > kMostStates)
    return "left out: dense eigenvalues of size " + std::to_string(rung == Rung::pencil ? size : states);
  return "";
}

void write_contender(JsonWriter& json, const Contender& contender) {
  const auto number = [&](const char* key, double value) { json.member(key, contender.failure.empty() ? value : NAN); };
  if (!contender.failure.empty()) json.member("failure", contender.failure);
  json.member("looks_unstable", contender.looks_unstable);
  write_eigenvalues(json, "eigenvalues", contender.eigenvalues);
  json.key("errors").values(contender.errors);
  json.key("false_zeros");
  contender.failure.empty() ? json.value(contender.false_zeros) : json.null();
  number("largest_false_zero", contender.largest_false_zero);
  number("largest_real_part_of_false_zeros", contender.largest_real_part);
  number("time_s", contender.cost.total());
  number("assembly_s", contender.cost.assembly);
  number("reduction_s", contender.cost.reduction);
  number("eigenvalues_s", contender.cost.eigenvalues);
  number("peak_MB", contender.cost.peak_MB);
}

std::string title(const Contender& contender) {
  switch (contender.rung) {
    case Rung::reduced: return "reduced, exact";
    case Rung::augmented: return "augmented, exact";
    case Rung::pencil: return "pencil, shift-invert";
    case Rung::sparse_differences: return "sparse differences, h = " + short_number(contender.h, 3);
    case Rung::differences: break;
  }
  return "differences, h = " + short_number(contender.h, 3);
}

}  // namespace

std::size_t Comparison::best() const {
  const auto least =
      std::min_element(differences.begin(), differences.end(),
                       [](const Contender& a, const Contender& b) { return a.worst_error() < b.worst_error(); });
  return static_cast<std::size_t>(least - differences.begin());
}

Comparison compare(const Context& context, const Linearization& linear, const std::function<void(double)>& progress) {
  constexpr int last_decade = 12;
  std::vector<double> steps = context.options().compare.steps;
  for (int k = 1; k <= last_decade && context.options().compare.steps.empty(); ++k) steps.push_back(std::pow(10.0, -k));

  Comparison result;
  const System& system = context.system();
  const double parts = static_cast<double>(steps.size() + 4);
  double done = 0.0;
  const Spectrum spectrum = find_spectrum(linear.model);
  result.reduced = eigenvalues_of(spectrum);
  result.reduced_size = result.reduced.size();
  result.reduced_looks_unstable = looks_unstable(result.reduced);
  result.true_zeros = static_cast<std::size_t>(spectrum.zero_count());
  const Eigenvalues nonzero(result.reduced.begin(), result.reduced.end() - spectrum.zero_count());

  Measuring how;
  // Between the slowest and the fastest: where a user who knew them would put it.
  double logarithms = 0.0;
  for (const std::complex<double>& value : nonzero) logarithms += std::log(std::abs(value));
  if (!nonzero.empty()) how.shift = std::exp(logarithms / static_cast<double>(nonzero.size()));
  const auto contend = [&](Rung rung, double h) {
    progress(done++ / parts);
    Contender contender;
    how.h = h;
    contender.failure = left_out(rung, system, linear.partition, steps.size());
    if (contender.failure.empty()) {
      try {
        contender = measure(rung, system, linear.partition, linear.state, how);
        hold_against(nonzero, result.true_zeros, contender);
      } catch (
          const AnalysisError& error) {  // as a step so large that a law has no value, or so small that nothing is left
        contender = Contender{};
        contender.failure = error.found();
      }
    }
    contender.rung = rung;
    contender.h = h;
    return contender;
  };
  result.reduced_cost = contend(Rung::reduced, 0.0).cost;
  result.exact = contend(Rung::augmented, 0.0);
  result.augmented_size = static_cast<std::size_t>(2 * system.n() + system.nz());
  result.pencil = contend(Rung::pencil, 0.0);
  for (const double h : steps) result.differences.push_back(contend(Rung::differences, h));
  result.sparse_differences =
      contend(Rung::sparse_differences, result.differences.empty() ? how.h : result.differences[result.best()].h);
  return result;
}

std::string comparison_document(const Comparison& comparison) {
  JsonWriter json;
  json.begin_object().key("reduced").begin_object();
  json.member("size", comparison.reduced_size)
      .member("zeros", comparison.true_zeros)
      .member("looks_unstable", comparison.reduced_looks_unstable);
  write_eigenvalues(json, "eigenvalues", comparison.reduced);
  const Cost& cost = comparison.reduced_cost;
  json.member("time_s", cost.total()).member("assembly_s", cost.assembly).member("reduction_s", cost.reduction);
  json.member("eigenvalues_s", cost.eigenvalues).member("peak_MB", cost.peak_MB).end_object();
  json.key("augmented_exact").begin_object().member("size", comparison.augmented_size);
  write_contender(json, comparison.exact);
  json.end_object().key("augmented_pencil").begin_object().member("size", comparison.pencil.size);
  write_contender(json, comparison.pencil);
  json.end_object().key("augmented_fd").begin_list();
  for (const Contender& contender : comparison.differences) {
    json.begin_object().member("h", contender.h);
    write_contender(json, contender);
    json.end_object();
  }
  json.end_list().key("augmented_fd_sparse").begin_object().member("h", comparison.sparse_differences.h);
  write_contender(json, comparison.sparse_differences);
  json.end_object();
  if (!comparison.differences.empty()) json.member("best_h", comparison.differences[comparison.best()].h);
  json.end_object();
  return json.take();
}

Table comparison_table(const Comparison& comparison) {
  Table table;
  table.header = {"Jacobian", "size"};
  const std::size_t nonzero = comparison.reduced.size() - comparison.true_zeros;
  const std::size_t shown = std::min<std::size_t>(nonzero, 6);
  for (std::size_t k = 0; k < shown; ++k) table.header.push_back("error " + std::to_string(k + 1));
  if (nonzero > shown) table.header.emplace_back("worst");
  for (const char* name : {"false zeros", "largest", "real part", "looks", "time", ""}) table.header.emplace_back(name);
  table.right = "lr" + std::string(shown + (nonzero > shown ? 1 : 0), 'r') + "rrrlrl";

  const auto row = [&](const Contender& c, bool best) {
    std::vector<std::string> cells = {title(c), c.size > 0 ? std::to_string(c.size) : "-"};
    for (std::size_t k = 0; k < shown; ++k) cells.push_back(c.failure.empty() ? short_number(c.errors[k], 2) : "-");
    if (nonzero > shown) cells.push_back(c.failure.empty() ? short_number(c.worst_error(), 2) : "-");
    if (!c.failure.empty()) {
      cells.insert(cells.end(), {"-", "-", "-", "-", "-", c.failure});
    } else {
      const bool zeros = !c.unclaimed.empty();
      cells.insert(cells.end(),
                   {std::to_string(c.false_zeros), zeros ? short_number(c.largest_false_zero, 2) : "",
                    zeros ? short_number(c.largest_real_part, 2) : "", c.looks_unstable ? "unstable" : "stable",
                    duration(c.cost.total()), best ? "<- best h" : ""});
    }
    table.rows.push_back(std::move(cells));
  };
  std::vector<std::string> reduced = {"reduced, exact", std::to_string(comparison.reduced_size)};
  reduced.resize(table.header.size() - 6, "0");
  reduced.insert(reduced.end(), {"0", "", "", comparison.reduced_looks_unstable ? "unstable" : "stable",
                                 duration(comparison.reduced_cost.total()), ""});
  table.rows.push_back(std::move(reduced));
  row(comparison.pencil, false);
  row(comparison.exact, false);
  row(comparison.sparse_differences, false);
  for (std::size_t k = 0; k < comparison.differences.size(); ++k) {
    const Contender& c = comparison.differences[k];
    row(c, c.failure.empty() && k == comparison.best());
  }
  return table;
}

Table comparison_costs(const Comparison& comparison) {
  Table table;
  table.header = {"Jacobian", "assembly", "reduction", "eigenvalues", "memory (MB)"};
  table.right = "lrrrr";
  const auto row = [&](const std::string& name, const Cost& cost) {
    table.rows.push_back({name, duration(cost.assembly), duration(cost.reduction), duration(cost.eigenvalues),
                          short_number(cost.peak_MB, 3)});
  };
  row("reduced, exact", comparison.reduced_cost);
  std::vector<const Contender*> others = {&comparison.pencil, &comparison.exact, &comparison.sparse_differences};
  if (!comparison.differences.empty()) others.push_back(&comparison.differences[comparison.best()]);
  for (const Contender* contender : others) {
    if (contender->failure.empty()) row(title(*contender), contender->cost);
  }
  return table;
}

std::string comparison_text(const Comparison& comparison) {
  std::string out = "Nonzero eigenvalues of the reduced model (1/s):\n";
  for (std::size_t k = 0; k + comparison.true_zeros < comparison.reduced.size(); ++k) {
    out += "  " + std::to_string(k + 1) + "  " + complex_text(comparison.reduced[k], 15) + '\n';
  }
  out += "and " + counted(comparison.true_zeros, "true zero") + ". Errors are relative, column k for eigenvalue k.\n\n";
  out += as_text(comparison_table(comparison));
  out +=
      "\nFalse zeros are eigenvalues of the augmented matrix that stand for nothing in the machine; \"largest\" and\n"
      "\"real part\" are the largest magnitude and the largest real part among them and the true zeros.\n\n"
      "What each takes, differences with the best h (CPU time, memory beyond what was there before):\n\n";
  return out + as_text(comparison_costs(comparison));
}

}  // namespace bramah
