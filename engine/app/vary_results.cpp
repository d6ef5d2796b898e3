// Many runs as JSON, CSV and text.
#include <algorithm>
#include <cmath>

#include "app/results.hpp"
#include "app/vary.hpp"
#include "io/tables.hpp"

namespace bramah {
namespace {

constexpr std::size_t most_rows = 40, most_failures = 8;  // for people; files have all

std::string heading(const RunFigure& figure) {
  return figure.unit == "1" || figure.unit.empty() ? figure.name : figure.name + " (" + figure.unit + ")";
}

void write_parameters(JsonWriter& json, const Vary& vary) {
  json.key("parameters").begin_list();
  for (const RunFigure& one : vary.parameters)
    json.begin_flat_object().member("name", one.name).member("unit", one.unit).end_object();
  json.end_list();
}

void write_figures(JsonWriter& json, const Vary& vary) {
  const std::vector<FigureStatistics> statistics = statistics_of(vary);
  json.key("figures").begin_list();
  for (std::size_t k = 0; k < vary.figures.size(); ++k) {
    const FigureStatistics& s = statistics[k];
    json.begin_flat_object().member("name", vary.figures[k].name).member("unit", vary.figures[k].unit);
    json.member("mean", s.mean).member("standard_deviation", s.deviation).member("min", s.min).member("max", s.max);
    json.member("p5", s.low).member("p50", s.median).member("p95", s.high).end_object();
  }
  json.end_list();
}

std::string failures_text(const Vary& vary) {
  std::string text;
  std::size_t shown = 0;
  for (std::size_t k = 0; k < vary.runs.size() && shown < most_failures; ++k) {
    const VariedRun& run = vary.runs[k];
    if (run.status != VariedRun::Status::failed) continue;
    std::string place;
    for (std::size_t i = 0; i < run.at.size(); ++i)
      place += (i > 0 ? ", " : "") + vary.parameters[i].name + " " +
               with_unit(short_number(run.at[i], 8), vary.parameters[i].unit);
    text += "Run " + std::to_string(k + 1) + " failed, " + place + ": " + run.message + "\n";
    ++shown;
  }
  const std::size_t failed = vary.count(VariedRun::Status::failed);
  if (failed > shown) text += "... " + counted(failed, "failed run") + " in all.\n";
  const auto warned = [](const VariedRun& run) { return run.status == VariedRun::Status::ok && !run.message.empty(); };
  if (const auto first = std::find_if(vary.runs.begin(), vary.runs.end(), warned); first != vary.runs.end())
    text += "Warning: " + counted(static_cast<std::size_t>(std::count_if(first, vary.runs.end(), warned)), "run") +
            " went beyond where a law holds, run " + std::to_string(first - vary.runs.begin() + 1) +
            " for one: " + first->message + "\n";
  if (vary.interrupted)
    text += "Interrupted: " + counted(vary.count(VariedRun::Status::ok), "complete run") + " kept.\n";
  return text.empty() ? "" : "\n" + text;
}

}  // namespace

std::string vary_document(const Vary& vary) {
  JsonWriter json;
  json.begin_object();
  write_parameters(json, vary);
  write_figures(json, vary);
  json.key("runs").begin_list();
  for (std::size_t k = 0; k < vary.runs.size(); ++k) {
    const VariedRun& run = vary.runs[k];
    json.begin_flat_object().member("run", k + 1).key("at").values(run.at).member("status", word_for(run.status));
    json.key("values").values(run.values).member("message", run.message).end_object();
  }
  json.end_list().member("failed", vary.count(VariedRun::Status::failed)).member("interrupted", vary.interrupted);
  write_equilibrium(json, vary.rest ? &vary.rest->equilibrium : nullptr, vary.rest ? &vary.rest->stability : nullptr);
  json.end_object();
  return json.take();
}

std::string vary_csv(const Vary& vary) {
  std::string text = "run";
  for (const RunFigure& parameter : vary.parameters) text += "," + csv_field(parameter.name);
  for (const RunFigure& figure : vary.figures) text += "," + csv_field(figure.name);
  text += ",status,message\n";
  for (std::size_t k = 0; k < vary.runs.size(); ++k) {
    const VariedRun& run = vary.runs[k];
    text += std::to_string(k + 1);
    for (const double value : run.at) text += "," + exact_number(value);
    for (std::size_t i = 0; i < vary.figures.size(); ++i)
      text += run.values.empty() ? "," : "," + exact_number(run.values[i]);
    text.append(",").append(word_for(run.status)).append(",").append(csv_field(run.message)).append("\n");
  }
  return text;
}

std::string vary_text(const Vary& vary) {
  std::string text = counted(vary.runs.size(), "run") + ": " + std::to_string(vary.count(VariedRun::Status::ok)) +
                     " ok, " + std::to_string(vary.count(VariedRun::Status::failed)) + " failed\n";
  if (vary.count(VariedRun::Status::ok) > 0) {
    Table table{{"figure", "mean", "std. deviation", "min", "5 %", "median", "95 %", "max"}, {}, "lrrrrrrr"};
    const std::vector<FigureStatistics> statistics = statistics_of(vary);
    for (std::size_t k = 0; k < std::min(most_rows, vary.figures.size()); ++k) {
      const FigureStatistics& s = statistics[k];
      std::vector<std::string> row = {heading(vary.figures[k])};
      for (const double value : {s.mean, s.deviation, s.min, s.low, s.median, s.high, s.max})
        row.push_back(short_number(value, 5));
      table.rows.push_back(std::move(row));
    }
    text += "\n" + as_text(table);
    if (vary.figures.size() > most_rows)
      text += "  the first of " + counted(vary.figures.size(), "figure") + "; --out DIR and --json give all\n";
  }
  return text + failures_text(vary);
}

}  // namespace bramah
