#include "regression.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "io/tables.hpp"
#include "results.hpp"

namespace bramah::bench {
namespace {

// A change counts where it exceeds this part, and `spread` times the variations of both measurements together.
constexpr double least_change = 0.15;
constexpr double spread = 3.0;
// Of single runs, which have no variation of their own; and times too short to be told from the clock.
constexpr double single_run = 0.10;
constexpr double readable = 2e-7;  // s

struct Figure {
  double seconds = 0.0, variation = 0.0;
};

std::map<std::string, Figure> figures_of(const std::string& file) {
  std::map<std::string, Figure> figures;
  if (!file.ends_with(".jsonl")) {
    for (const Micro& micro : micro_benchmarks(read_json(file)))
      figures[micro.name] = {micro.seconds, std::isnan(micro.variation) ? single_run : micro.variation};
    return figures;
  }
  for (const Value& line : read_json_lines(file)) {
    std::string name = text(line, "workload") + "/" + short_number(number(line, "N"));
    if (!text(line, "rung").empty()) name += "/" + text(line, "rung");
    if (std::isfinite(number(line, "tolerance"))) name += "/" + short_number(number(line, "tolerance"), 2);
    for (const Member& member : *line.object()) {
      const double* seconds = member.value.number();
      if (seconds != nullptr && member.key.ends_with("_s") && member.key != "wall_s")
        figures[name + " " + member.key.substr(0, member.key.size() - 2)] = {*seconds, single_run};
    }
  }
  return figures;
}

}  // namespace

Regression changes_between(const std::string& old_file, const std::string& new_file) {
  const std::map<std::string, Figure> before = figures_of(old_file), after = figures_of(new_file);
  Regression result;
  for (const auto& [name, old] : before) {
    const auto found = after.find(name);
    if (found == after.end()) {
      result.only_before.push_back(name);
      continue;
    }
    const Figure& now = found->second;
    const double noise = std::max(least_change, spread * std::hypot(old.variation, now.variation));
    const double change = std::abs(std::log(now.seconds / old.seconds));
    if (change > std::log1p(noise) && std::max(now.seconds, old.seconds) > readable) {
      result.changes.push_back({name, old.seconds, now.seconds, noise});
    } else {
      ++result.within_noise;
    }
  }
  for (const auto& [name, now] : after) {
    if (!before.contains(name)) result.only_after.push_back(name);
  }
  std::sort(result.changes.begin(), result.changes.end(),
            [](const Change& a, const Change& b) { return a.ratio() > b.ratio(); });
  return result;
}

}  // namespace bramah::bench
