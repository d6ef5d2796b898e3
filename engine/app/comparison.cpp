#include "app/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>

#include "app/results.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

constexpr double kUnstable = 1e-9;  // what a reader without error bounds takes for a positive real part

bool looks_unstable(const Eigenvalues& eigenvalues) {
  return std::any_of(eigenvalues.begin(), eigenvalues.end(),
                     [](const auto& value) { return value.real() > kUnstable; });
}

Eigenvalues eigenvalues_of(const Spectrum& spectrum) {
  Eigenvalues list;
  for (const Mode& mode : spectrum.modes) list.push_back(mode.eigenvalue);
  return list;
}

/// Median of several runs, fewer of long ones.
template <class Work>
double median_seconds(Work&& work, double budget) {
  std::vector<double> runs;
  for (double total = 0.0; runs.empty() || (total < budget && runs.size() < 101);) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    runs.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    total += runs.back();
  }
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end());
  return *middle;
}

/// Each nonzero eigenvalue of the reduced model claims the nearest one left, the nearest pairs first.
void match(const Comparison& comparison, Contender& contender) {
  const std::size_t wanted = comparison.reduced.size() - comparison.true_zeros, offered = contender.eigenvalues.size();
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < wanted; ++i) {
    for (std::size_t j = 0; j < offered; ++j) {
      pairs.emplace_back(std::abs(contender.eigenvalues[j] - comparison.reduced[i]) / std::abs(comparison.reduced[i]),
                         i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  contender.errors.assign(wanted, NAN);
  std::vector<bool> claimed(offered, false);
  for (const auto& [error, i, j] : pairs) {
    if (claimed[j] || !std::isnan(contender.errors[i])) continue;
    contender.errors[i] = error;
    claimed[j] = true;
  }
  contender.largest_real_part = -HUGE_VAL;
  for (std::size_t j = 0; j < offered; ++j) {
    if (claimed[j]) continue;
    contender.unclaimed.push_back(contender.eigenvalues[j]);
    contender.largest_false_zero = std::max(contender.largest_false_zero, std::abs(contender.eigenvalues[j]));
    contender.largest_real_part = std::max(contender.largest_real_part, contender.eigenvalues[j].real());
  }
  contender.false_zeros = static_cast<long>(contender.unclaimed.size()) - static_cast<long>(comparison.true_zeros);
  contender.looks_unstable = looks_unstable(contender.eigenvalues);
}

void write_contender(JsonWriter& json, const Contender& contender) {
  json.member("looks_unstable", contender.looks_unstable);
  write_eigenvalues(json, "eigenvalues", contender.eigenvalues);
  json.key("errors").values(contender.errors);
  json.key("false_zeros");
  contender.failure.empty() ? json.value(contender.false_zeros) : json.null();
  json.member("largest_false_zero", contender.largest_false_zero);
  json.member("largest_real_part_of_false_zeros", contender.largest_real_part).member("time_s", contender.seconds);
}

}  // namespace

double Contender::worst_error() const {
  if (!failure.empty()) return HUGE_VAL;
  return errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end());
}

std::size_t Comparison::best() const {
  const auto least =
      std::min_element(differences.begin(), differences.end(),
                       [](const Contender& a, const Contender& b) { return a.worst_error() < b.worst_error(); });
  return static_cast<std::size_t>(least - differences.begin());
}

Comparison compare(const Context& context, const Linearization& linear, const std::function<void(double)>& progress) {
  constexpr double budget = 0.05;  // seconds for the repetitions of one measurement
  std::vector<double> steps = context.options().compare.steps;
  for (int k = 1; k <= 12 && context.options().compare.steps.empty(); ++k) steps.push_back(std::pow(10.0, -k));

  Comparison result;
  const System& system = context.system();
  Linearizer linearizer(system, linear.partition);
  LinearModel model;
  progress(0.0);
  // Every contender is timed to its plain eigenvalues; the reduced ones shown are those of the full analysis.
  result.reduced_seconds = median_seconds(
      [&] {
        linearizer.linearize(linear.state, model);
        result.reduced = plain_eigenvalues(model);
      },
      budget);
  const Spectrum spectrum = find_spectrum(linear.model);
  result.reduced = eigenvalues_of(spectrum);
  result.reduced_size = result.reduced.size();
  result.reduced_looks_unstable = looks_unstable(result.reduced);
  result.true_zeros = static_cast<std::size_t>(
      std::count_if(spectrum.modes.begin(), spectrum.modes.end(), [](const Mode& m) { return m.zero; }));

  result.exact.seconds = median_seconds(
      [&] {
        linearizer.linearize_augmented(linear.state, model);
        result.exact.eigenvalues = plain_eigenvalues(model);
      },
      budget);
  result.augmented_size = result.exact.eigenvalues.size();
  match(result, result.exact);

  for (const double h : steps) {
    progress(static_cast<double>(1 + result.differences.size()) / static_cast<double>(1 + steps.size()));
    Contender contender;
    contender.h = h;
    try {
      contender.seconds = median_seconds(
          [&] {
            contender.eigenvalues =
                plain_eigenvalues(augmented_by_differences(system, linear.partition, linear.state, h));
          },
          budget);
      match(result, contender);
    } catch (const AnalysisError& error) {  // a step so large that a law has no value, or so small that nothing is left
      contender.failure = error.found();
      contender.seconds = contender.largest_false_zero = contender.largest_real_part = NAN;
    }
    result.differences.push_back(std::move(contender));
  }
  return result;
}

std::string comparison_document(const Comparison& comparison) {
  JsonWriter json;
  json.begin_object().key("reduced").begin_object();
  json.member("size", comparison.reduced_size)
      .member("zeros", comparison.true_zeros)
      .member("looks_unstable", comparison.reduced_looks_unstable);
  write_eigenvalues(json, "eigenvalues", comparison.reduced);
  json.member("time_s", comparison.reduced_seconds).end_object();
  json.key("augmented_exact").begin_object().member("size", comparison.augmented_size);
  write_contender(json, comparison.exact);
  json.end_object().key("augmented_fd").begin_list();
  for (const Contender& contender : comparison.differences) {
    json.begin_object().member("h", contender.h);
    if (!contender.failure.empty()) json.member("failure", contender.failure);
    write_contender(json, contender);
    json.end_object();
  }
  json.end_list();
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

  const auto row = [&](const std::string& name, const Contender& c, bool best) {
    std::vector<std::string> cells = {name, std::to_string(comparison.augmented_size)};
    for (std::size_t k = 0; k < shown; ++k) cells.push_back(c.failure.empty() ? short_number(c.errors[k], 2) : "-");
    if (nonzero > shown) cells.push_back(c.failure.empty() ? short_number(c.worst_error(), 2) : "-");
    if (!c.failure.empty()) {
      cells.insert(cells.end(), {"-", "-", "-", "-", "-", c.failure});
    } else {
      cells.insert(cells.end(), {std::to_string(c.false_zeros), short_number(c.largest_false_zero, 2),
                                 short_number(c.largest_real_part, 2), c.looks_unstable ? "unstable" : "stable",
                                 duration(c.seconds), best ? "<- best h" : ""});
    }
    table.rows.push_back(std::move(cells));
  };
  std::vector<std::string> reduced = {"reduced, exact", std::to_string(comparison.reduced_size)};
  reduced.resize(table.header.size() - 6, "0");
  reduced.insert(reduced.end(), {"0", "", "", comparison.reduced_looks_unstable ? "unstable" : "stable",
                                 duration(comparison.reduced_seconds), ""});
  table.rows.push_back(std::move(reduced));
  row("augmented, exact", comparison.exact, false);
  for (std::size_t k = 0; k < comparison.differences.size(); ++k) {
    row("differences, h = " + short_number(comparison.differences[k].h, 3), comparison.differences[k],
        k == comparison.best());
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
      "\"real part\" are the largest magnitude and the largest real part among them and the true zeros.\n";
  return out;
}

}  // namespace bramah
