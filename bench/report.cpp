// The page of measurements: bramah_bench_report NAME reads bench/results/NAME.* and writes
//
//   docs/benchmarks.html               all of it, one file that stands alone
//   docs/benchmarks.md                 its tables, between the two marks in that file
//   docs/images/benchmarks_*.svg       its pictures
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "goals.hpp"
#include "io/plot.hpp"
#include "io/report.hpp"
#include "io/tables.hpp"
#include "results.hpp"

namespace bramah::bench {
namespace {

const std::string root = BRAMAH_SOURCE_DIR;
const std::string steps_note =
    "Mean cost of one step over the number of bodies: planar chains that fall, and ladders of four-bars, in motion, start-up "
    "apart; outputs off, the book of energy on. Growth: exponent of the step over the last three sizes.";
const std::string real_time_note =
    "Scenes from start to end by generalized_alpha with steps of 1 ms; the last column is a share of what was turned over.";

// Of a figure 0 ... 4, of a table's column: the same order everywhere.
constexpr const char* rungs[] = {"reduced", "pencil", "augmented", "sparse_differences", "differences"};
std::string title_of(const std::string& rung) {
  static const std::map<std::string, std::string> titles = {{"reduced", "reduced"},
                                                            {"pencil", "pencil (d)"},
                                                            {"augmented", "augmented (c)"},
                                                            {"sparse_differences", "sparse (b)"},
                                                            {"differences", "dense (a)"}};
  return titles.at(rung);
}

/// Exponent p of y ~ x^p over the last three points; NAN of fewer.
double exponent(const plot::Series& series) {
  constexpr std::size_t most = 3;
  const std::size_t n = series.x.size();
  if (n < 2) return NAN;
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  const std::size_t first = n > most ? n - most : 0;
  for (std::size_t i = first; i < n; ++i) {
    const double x = std::log(series.x[i]), y = std::log(series.y[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const auto count = static_cast<double>(n - first);
  return (count * sxy - sx * sy) / (count * sxx - sx * sx);
}

/// Figure `key` of every line of a workload (and rung) against N.
plot::Series series_of(const Results& results, const std::string& workload, const std::string& rung,
                       const std::string& key, bool per_body = false) {
  plot::Series series;
  series.style = plot::Style::line_with_dots;
  std::vector<std::pair<double, double>> points;
  for (const Value& line : results.lines) {
    if (text(line, "workload") != workload || text(line, "rung") != rung) continue;
    const double N = number(line, "N"), value = number(line, key);
    if (std::isfinite(value) && value > 0.0) points.emplace_back(N, per_body ? value / N : value);
  }
  std::sort(points.begin(), points.end());
  for (const auto& [N, value] : points) {
    series.x.push_back(N);
    series.y.push_back(value);
  }
  return series;
}

plot::Figure log_figure(const std::string& title, const std::string& y, const std::string& unit) {
  plot::Figure figure;
  figure.title = title;
  figure.width = 760;
  figure.height = 330;
  figure.x = {"N", "", plot::Scale::log};
  figure.y = {y, unit, plot::Scale::log};
  return figure;
}

void add(plot::Figure& figure, plot::Series series, const std::string& name, int colour, bool with_exponent) {
  if (series.x.empty()) return;
  const double p = exponent(series);
  series.name = name + (with_exponent && std::isfinite(p) ? ", N^" + short_number(p, 2) : "");
  series.colour = colour;
  figure.series.push_back(std::move(series));
}

plot::Figure rungs_figure(const Results& results, const std::string& family, const std::string& title,
                          const std::string& key, const std::string& y, const std::string& unit) {
  plot::Figure figure = log_figure(title, y, unit);
  int colour = 0;
  for (const char* rung : rungs)
    add(figure, series_of(results, "rungs_" + family, rung, key), title_of(rung), colour++, unit == "s");
  return figure;
}

plot::Figure per_body_figure(const Results& results, const std::string& family, const std::string& title) {
  plot::Figure figure = log_figure(title, "time per body", "s");
  int colour = 0;
  for (const char* key : {"assembly", "descriptor", "refactor", "newton"})
    add(figure, series_of(results, "costs_" + family, "", std::string(key) + "_s", true),
        std::string(key) == "descriptor" ? "descriptor linearization"
        : std::string(key) == "newton"   ? "Newton iteration"
        : std::string(key) == "refactor" ? "KLU refactor"
                                         : key,
        colour++, false);
  return figure;
}

std::string complex_text(const Value& value) {
  const double re = number(value, "re"), im = number(value, "im");
  return short_number(re, 4) + (im == 0.0 ? "" : (im > 0.0 ? " + " : " - ") + short_number(std::abs(im), 4) + "i");
}

const std::vector<Value>& list_of(const Value& object, std::string_view key) {
  static const std::vector<Value> none;
  const Value* member = object.find(key);
  return member != nullptr && member->list() != nullptr ? *member->list() : none;
}

/// Fig. 14 of the paper: errors of the nonzero eigenvalues by differences against h.
plot::Figure error_figure(const Value& comparison) {
  plot::Figure figure = log_figure("Four-bar: eigenvalue errors by differences", "relative error", "");
  figure.x = {"step h (SI)", "", plot::Scale::log};
  figure.y.low = 1e-10;
  figure.y.high = 10.0;
  const Value* reduced = comparison.find("reduced");
  if (reduced == nullptr) return figure;
  const std::vector<Value>& eigenvalues = list_of(*reduced, "eigenvalues");
  int colour = 0;
  for (std::size_t k = 0; k < eigenvalues.size() && colour < 5; ++k) {
    plot::Series series{complex_text(eigenvalues[k]), {}, {}, plot::Style::line_with_dots, colour};
    double largest = 0.0;
    for (const Value& contender : list_of(comparison, "augmented_fd")) {
      const std::vector<Value>& errors = list_of(contender, "errors");
      if (k >= errors.size() || errors[k].number() == nullptr) continue;
      series.x.push_back(number(contender, "h"));
      series.y.push_back(*errors[k].number());
      largest = std::max(largest, series.y.back());
    }
    if (largest < figure.y.low) continue;  // a spool that decays by itself is exact even so
    figure.series.push_back(std::move(series));
    ++colour;
  }
  return figure;
}

/// Eigenvalues within +-1 1/s, where the machine has two true zeros.
plot::Figure zeros_figure(const Value& comparison) {
  plot::Figure figure;
  figure.title = "Four-bar: eigenvalues around zero; two are true";
  figure.width = 760;
  figure.height = 420;
  figure.x = {"real part", "1/s", plot::Scale::symlog, -1.0, 1.0, 1e-10};
  figure.y = {"imaginary part", "1/s", plot::Scale::symlog, -1.0, 1.0, 1e-10};
  const auto add_all = [&](const Value* contender, const std::string& name, plot::Style style, int colour) {
    if (contender == nullptr) return;
    plot::Series series{name, {}, {}, style, colour};
    for (const Value& value : list_of(*contender, "eigenvalues")) {
      if (std::hypot(number(value, "re"), number(value, "im")) > 1.0) continue;
      series.x.push_back(number(value, "re"));
      series.y.push_back(number(value, "im"));
    }
    figure.series.push_back(std::move(series));
  };
  const double best = number(comparison, "best_h");
  for (const Value& contender : list_of(comparison, "augmented_fd")) {
    if (number(contender, "h") == best)
      add_all(&contender, "differences (a), h = " + short_number(best, 2), plot::Style::circles, 4);
  }
  add_all(comparison.find("augmented_exact"), "augmented, exact (c)", plot::Style::crosses, 2);
  add_all(comparison.find("augmented_pencil"), "pencil (d)", plot::Style::circles, 1);
  add_all(comparison.find("reduced"), "reduced", plot::Style::dots, 0);
  return figure;
}

std::string quantity(double value, const std::string& unit) {
  if (std::isnan(value)) return "-";
  if (unit == "s") return duration(value);
  constexpr double whole = 100.0;
  return (value >= whole ? short_number(std::round(value)) : short_number(value, 3)) + (unit == "x" ? " x" : "");
}

Table goals_table(const std::vector<Goal>& goals) {
  Table table;
  table.header = {"goal", "limit", "measured", "met", "note"};
  table.right = "lrrll";
  for (const Goal& goal : goals) {
    table.rows.push_back({goal.what, (goal.at_least ? ">= " : "<= ") + quantity(goal.limit, goal.unit),
                          quantity(goal.measured, goal.unit),
                          std::isnan(goal.measured) ? "not measured"
                          : goal.met()              ? "yes"
                                                    : "no",
                          goal.note});
  }
  return table;
}

Table rungs_table(const Results& results) {
  Table table;
  table.header = {"machine",     "N",      "rung",        "size",        "assembly", "reduction",
                  "eigenvalues", "memory", "worst error", "false zeros", "largest",  "looks"};
  table.right = "lrlrrrrrrrrl";
  for (const Value& line : results.lines) {
    const std::string workload = text(line, "workload"), rung = text(line, "rung");
    if (rung.empty()) continue;
    const Value* unstable = line.find("looks_unstable");
    const bool spectrum = std::isfinite(number(line, "error"));
    const auto time = [&](const char* key) { return quantity(number(line, key), "s"); };
    table.rows.push_back({workload.substr(workload.find('_') + 1), short_number(number(line, "N")),
                          title_of(rung) + (number(line, "columns") > 0.0 ? " *" : ""),
                          short_number(number(line, "size")), time("assembly_s"), time("reduction_s"),
                          time("eigenvalues_s"), short_number(number(line, "taken_MB"), 2) + " MB",
                          short_number(number(line, "error"), 2), short_number(number(line, "false_zeros")),
                          short_number(number(line, "largest_false_zero"), 2),
                          !spectrum                                                                       ? "-"
                          : unstable != nullptr && unstable->boolean() != nullptr && *unstable->boolean() ? "unstable"
                                                                                                          : "stable"});
  }
  return table;
}

/// Mean cost of a step over the bodies, by integrator; sizes to the next power of ten.
Table steps_table(const Results& results) {
  constexpr int powers[] = {1, 2, 3, 4};
  Table table;
  table.header = {"machine", "integrator", "10 bodies", "100", "1000", "10^4", "growth"};
  table.right = "llrrrrr";
  for (const char* machine : {"chain", "ladder"}) {
    for (const char* integrator : {"explicit", "implicit", "ida", "generalized_alpha"}) {
      std::vector<std::string> cells = {machine, integrator};
      plot::Series series;
      for (const int power : powers) {
        const auto line = std::find_if(results.lines.begin(), results.lines.end(), [&](const Value& l) {
          return text(l, "workload") == "steps_" + std::string(machine) + "_" + integrator &&
                 std::lround(std::log10(number(l, "bodies"))) == power;
        });
        const double cost = line == results.lines.end() ? NAN : number(*line, "per_body_s");
        cells.push_back(quantity(cost, "s"));
        if (!(cost > 0.0)) continue;
        series.x.push_back(number(*line, "bodies"));
        series.y.push_back(number(*line, "cpu_s"));
      }
      const double p = exponent(series);
      cells.push_back(std::isfinite(p) ? "N^" + short_number(p, 3) : "-");
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

Table real_time_table(const Results& results) {
  Table table;
  table.header = {"machine", "steps of 1 ms", "CPU time", "times real time", "energy unaccounted for"};
  table.right = "lrrrr";
  for (const Value& line : results.lines) {
    const std::string workload = text(line, "workload"), prefix = "real_time_";
    if (!workload.starts_with(prefix)) continue;
    table.rows.push_back({workload.substr(prefix.size()), short_number(number(line, "steps"), 6),
                          quantity(number(line, "cpu_s"), "s"), short_number(number(line, "times_real_time"), 3),
                          short_number(number(line, "error"), 2)});
  }
  return table;
}

Table workloads_table(const Results& results) {
  Table table;
  table.header = {"workload", "N", "CPU time", "error", "steps", "peak memory", "parts"};
  table.right = "lrrrrrl";
  for (const Value& line : results.lines) {
    const std::string workload = text(line, "workload");
    if (!text(line, "rung").empty() || workload.starts_with("steps_") || workload.starts_with("real_time_")) continue;
    std::string parts = text(line, "failure");
    for (const char* key : {"matrices", "modes", "jacobian", "all_eigenvalues", "assembly", "descriptor", "refactor"}) {
      const double value = number(line, std::string(key) + "_s");
      if (std::isfinite(value)) parts += (parts.empty() ? "" : ", ") + std::string(key) + " " + duration(value);
    }
    const double tolerance = number(line, "tolerance");
    if (std::isfinite(tolerance)) parts += ", tolerance " + short_number(tolerance, 2);
    table.rows.push_back({workload, short_number(number(line, "N")), quantity(number(line, "cpu_s"), "s"),
                          short_number(number(line, "error"), 2), short_number(number(line, "steps")),
                          short_number(number(line, "peak_MB"), 3) + " MB", parts});
  }
  return table;
}

Table micro_table(const Results& results) {
  Table table;
  table.header = {"work", "machine", "time", "per body", "variation"};
  table.right = "llrrr";
  for (const Micro& micro : micro_benchmarks(results.micro)) {
    const std::size_t slash = micro.name.find('/');
    table.rows.push_back({micro.name.substr(0, slash), slash < micro.name.size() ? micro.name.substr(slash + 1) : "",
                          quantity(micro.seconds, "s"), quantity(micro.per_body, "s"),
                          short_number(100.0 * micro.variation, 2) + " %"});
  }
  std::sort(table.rows.begin(), table.rows.end());
  return table;
}

std::string markdown(const Table& table) {
  std::string out;
  const auto row = [&](const std::vector<std::string>& cells) {
    out += '|';
    for (const std::string& cell : cells) out += ' ' + cell + " |";
    out += '\n';
  };
  row(table.header);
  out += '|';
  for (std::size_t k = 0; k < table.header.size(); ++k)
    out += k < table.right.size() && table.right[k] == 'r' ? " ---: |" : " --- |";
  out += '\n';
  for (const auto& cells : table.rows) row(cells);
  return out;
}

void write(const std::string& file, const std::string& content) {
  std::ofstream out(file);
  out << content;
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

/// Replaces what stands between the marks.
void write_between_marks(const std::string& file, const std::string& content) {
  const std::string begin = "<!-- measured: made by bench/run_bench.sh -->\n", end = "<!-- end of measured -->\n";
  std::string page = contents(file);
  const std::size_t from = page.find(begin), to = page.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from)
    throw std::runtime_error(file + ": expected the lines \"" + begin.substr(0, begin.size() - 1) + "\" and \"" +
                             end.substr(0, end.size() - 1) + "\"");
  write(file, page.substr(0, from + begin.size()) + content + page.substr(to));
}

std::string conditions(const Results& results) {
  return results.context("cpu_model") + ", " + results.context("compiler") + ", " + results.context("build_type") +
         ", commit " + results.context("commit");
}

void make_page(const std::string& name) {
  const Results results(root + "/bench/results/" + name);
  const std::vector<Goal> goals = read_goals(root + "/bench/goals.json", results);
  const auto met = std::count_if(goals.begin(), goals.end(), [](const Goal& goal) { return goal.met(); });

  const std::vector<std::pair<std::string, plot::Figure>> figures = {
      {"planar", rungs_figure(results, "planar_chain", "Planar chain of N links: time of the Jacobian", "jacobian_s",
                              "CPU time", "s")},
      {"spatial", rungs_figure(results, "spatial_chain", "Spatial chain of N links: time of the Jacobian", "jacobian_s",
                               "CPU time", "s")},
      {"hydraulic", rungs_figure(results, "hydraulic_chain",
                                 "Hydraulic chain, a cylinder on every 4th of N joints: time of the Jacobian",
                                 "jacobian_s", "CPU time", "s")},
      {"total", rungs_figure(results, "spatial_chain", "Spatial chain: Jacobian and all eigenvalues", "total_s",
                             "CPU time", "s")},
      {"sizes",
       rungs_figure(results, "spatial_chain", "Spatial chain of N links: size of the matrix", "size", "size", "")},
      {"per_body_planar", per_body_figure(results, "planar", "Planar chain: costs per body")},
      {"per_body_spatial", per_body_figure(results, "spatial", "Spatial chain: costs per body")},
      {"errors", error_figure(results.comparison)},
      {"zeros", zeros_figure(results.comparison)}};
  const auto svg_of = [&](const std::string& wanted) {
    const auto found = std::find_if(figures.begin(), figures.end(), [&](const auto& f) { return f.first == wanted; });
    return plot::svg(found->second);
  };

  Report page("Bramah, measured", conditions(results));
  page.facts({{"goals met", std::to_string(met) + " of " + std::to_string(goals.size())},
              {"four-bar, reduced Jacobian", quantity(goals.front().measured, "s")}});
  page.paragraph(
      "Five ways to the eigenvalues of one machine: (a) augmented, by central differences with the dense inverse of Eq. (97) "
      "as in the paper; (b) the same with sparse factors, reused where they can be; (c) the exact augmented Jacobian; "
      "(d) the exact sparse pencil by shift-invert; and the reduced Jacobian of this engine. Times are CPU times of one core.");
  page.heading("Goals");
  page.table(goals_table(goals));
  page.heading("Time against size");
  page.figures({svg_of("planar"), svg_of("spatial"), svg_of("hydraulic"), svg_of("total")});
  page.paragraph(
      "Exponents are fitted over the last three sizes of each curve. The pencil has no Jacobian: its matrices and "
      "their factorization stand there, and the operator written out belongs to the eigenvalues.");
  page.heading("Costs per body");
  page.figures({svg_of("per_body_planar"), svg_of("per_body_spatial")});
  page.heading("Digits");
  page.figures({svg_of("errors"), svg_of("zeros")});
  page.heading("Sizes");
  page.figure(svg_of("sizes"));
  page.heading("Rungs");
  page.table(rungs_table(results),
             "Error: worst relative error of a nonzero eigenvalue. Largest: magnitude of the largest zero, true ones "
             "included. *: one column measured, times their number.");
  page.heading("Workloads");
  page.table(workloads_table(results));
  page.heading("Cost of a step");
  page.table(steps_table(results), steps_note);
  page.heading("Real time");
  page.table(real_time_table(results), real_time_note);
  page.heading("Steps of the engine");
  page.table(micro_table(results), "Medians and their variation.");
  write(root + "/docs/benchmarks.html", page.html(conditions(results)));
  for (const auto& [figure_name, figure] : figures) {
    std::string file = root;
    file.append("/docs/images/benchmarks_").append(figure_name).append(".svg");
    write(file, plot::svg(figure, true));
  }
  std::string text = "\n" + conditions(results);
  text.append(". ").append(std::to_string(met)).append(" of ").append(std::to_string(goals.size()));
  text.append(" goals are met.\n\n").append(markdown(goals_table(goals)));
  const auto section = [&text](const char* heading, const std::string& note, const Table& table) {
    text.append("\n### ").append(heading).append("\n\n");
    if (!note.empty()) text.append(note).append("\n\n");
    text += markdown(table);
  };
  section("Rungs", "", rungs_table(results));
  section("Workloads", "", workloads_table(results));
  section("Cost of a step", steps_note, steps_table(results));
  section("Real time", real_time_note, real_time_table(results));
  write_between_marks(root + "/docs/benchmarks.md", text + "\n");
}

}  // namespace
}  // namespace bramah::bench

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: bramah_bench_report NAME   (of bench/results/NAME.json)\n";
    return 2;
  }
  try {
    bramah::bench::make_page(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "bramah_bench_report: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
