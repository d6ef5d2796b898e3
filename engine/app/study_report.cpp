#include "app/study_report.hpp"

#include "app/results.hpp"
#include "io/report.hpp"

namespace bramah {
namespace {

std::vector<std::pair<std::string, std::string>> facts(const Context& context, const StudyResults& results) {
  const Sizes sizes = sizes_of(context.system(), &results.linear.partition);
  std::vector<std::pair<std::string, std::string>> list;
  list.emplace_back("linear model", std::to_string(sizes.reduced()) + " × " + std::to_string(sizes.reduced()));
  list.emplace_back("without the reduction",
                    std::to_string(sizes.augmented()) + " × " + std::to_string(sizes.augmented()));
  double worst = -HUGE_VAL;
  for (const Mode& mode : results.census.spectrum.modes) {
    if (!mode.zero) worst = std::max(worst, mode.eigenvalue.real());
  }
  if (std::isfinite(worst)) list.emplace_back("largest real part", short_number(worst, 5) + " 1/s");
  if (results.transient) {
    list.emplace_back("simulated in", duration(results.transient->simulation.statistics.seconds));
    list.emplace_back("worst constraint violation",
                      short_number(results.transient->simulation.statistics.worst_position, 2));
  }
  return list;
}

/// Lines of text as paragraphs.
void paragraphs(Report& report, const std::string& text) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) report.paragraph(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

const plot::Figure* find(const StudyFigures& figures, const std::string& name) {
  for (const auto& [file, figure] : figures.others) {
    if (file == name) return &figure;
  }
  return nullptr;
}

}  // namespace

Table overlay_table(const Overlay& overlay) {
  Table table{
      {"output", "deviation at t = " + short_number(overlay.from) + " s", "largest |linear - simulation|", "relative"},
      {},
      "lrrr"};
  for (const Overlay::Error& error : overlay.errors) {
    if (error.peak == 0.0 && error.largest == 0.0) continue;  // at rest
    const double relative = error.relative();
    table.rows.push_back({error.name, with_unit(short_number(error.deviation, 5), error.unit),
                          with_unit(short_number(error.largest, 3), error.unit),
                          std::isnan(relative) ? "-" : short_number(100.0 * relative, 4) + " %"});
  }
  return table;
}

std::string study_page(const Context& context, const StudyResults& results, const StudyFigures& figures) {
  const System& system = context.system();
  const StudyOptions& study = context.options().study;
  Report report(study.title.empty() ? context.scene.source.name : study.title, study.description);
  report.facts(facts(context, results));
  for (const std::string& remark : results.remarks) report.paragraph(remark);

  if (results.transient) {
    report.heading("Transient");
    if (results.overlay) {
      report.paragraph("Deviation from the equilibrium. From t = " + short_number(results.overlay->from) +
                       " s on the linear model starts from the simulated state and sees the same inputs.");
    }
    std::vector<std::string> panels;
    for (const plot::Figure& figure : figures.transient) panels.push_back(plot::svg(figure));
    report.figures(panels);
    if (results.overlay) report.table(overlay_table(*results.overlay), "Linear model against simulation");
    report.table(statistics_table(*results.transient), "Integrator");
  }

  report.heading("Spectrum");
  if (const plot::Figure* figure = find(figures, "spectrum")) report.figure(plot::svg(*figure));
  report.table(spectrum_table(results.linear.model, results.census.spectrum));
  paragraphs(report, linear_notes(system, results.linear));

  if (results.comparison) {
    report.heading("Reduced against augmented");
    if (const plot::Figure* figure = find(figures, "compare_errors")) report.figure(plot::svg(*figure));
    report.table(comparison_table(*results.comparison));
    report.table(comparison_costs(*results.comparison), "What each takes, differences with the best h");
    if (const plot::Figure* figure = find(figures, "compare_false_zeros")) report.figure(plot::svg(*figure));
    report.paragraph(
        "False zeros stand for nothing in the machine. Those with a positive real part would be read as an instability.");
  }

  const State& state = results.equilibrium ? results.equilibrium->state : results.linear.state;
  report.heading(results.equilibrium ? "Equilibrium" : "Start state");
  report.table(variables_table(system, state));
  if (system.m() + system.l() > 0) report.table(multipliers_table(system, state));
  if (results.equilibrium) paragraphs(report, free_directions_text(results.equilibrium->free_directions));

  report.heading("Sizes");
  report.table(sizes_table(sizes_of(system, &results.linear.partition)));
  return report.html("Bramah " BRAMAH_VERSION ", scene " + context.scene.source.name +
                     (context.arguments.settings.empty() ? "" : ", with settings of the command line") +
                     ". All numbers in SI.");
}

}  // namespace bramah
