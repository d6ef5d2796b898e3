// What changed between two results: bramah_bench_regress OLD NEW, both NAME.json of Google Benchmark or both
// NAME.workloads.jsonl. Ends with 1 where something has become slower beyond noise, with 2 where it cannot tell.
#include <algorithm>
#include <cmath>
#include <iostream>
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

int compare(const std::string& old_file, const std::string& new_file) {
  const std::map<std::string, Figure> before = figures_of(old_file), after = figures_of(new_file);
  struct Change {
    std::string name;
    double before, after, noise;
    [[nodiscard]] double ratio() const { return after / before; }
  };
  std::vector<Change> changes;
  std::vector<std::string> gone, added;
  std::size_t same = 0;
  for (const auto& [name, old] : before) {
    const auto found = after.find(name);
    if (found == after.end()) {
      gone.push_back(name);
      continue;
    }
    const Figure& now = found->second;
    const double noise = std::max(least_change, spread * std::hypot(old.variation, now.variation));
    const double change = std::abs(std::log(now.seconds / old.seconds));
    if (change > std::log1p(noise) && std::max(now.seconds, old.seconds) > readable) {
      changes.push_back({name, old.seconds, now.seconds, noise});
    } else {
      ++same;
    }
  }
  for (const auto& [name, now] : after) {
    if (!before.contains(name)) added.push_back(name);
  }
  if (same + changes.size() == 0) {
    std::cerr << "nothing to compare: " << old_file << " and " << new_file << " have no work in common\n";
    return 2;
  }
  std::sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.ratio() > b.ratio(); });
  Table table;
  table.header = {"work", "before", "after", "ratio", "noise", ""};
  table.right = "lrrrrl";
  bool slower = false;
  for (const Change& change : changes) {
    slower = slower || change.ratio() > 1.0;
    table.rows.push_back({change.name, duration(change.before), duration(change.after), short_number(change.ratio(), 3),
                          short_number(100.0 * change.noise, 2) + " %", change.ratio() > 1.0 ? "slower" : "faster"});
  }
  if (!changes.empty()) std::cout << as_text(table) << '\n';
  std::cout << same << " works within noise, " << changes.size() << " beyond it\n";
  for (const std::string& name : gone) std::cout << "only before: " << name << '\n';
  for (const std::string& name : added) std::cout << "only after:  " << name << '\n';
  return slower ? 1 : 0;
}

}  // namespace
}  // namespace bramah::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: bramah_bench_regress OLD NEW   (two NAME.json, or two NAME.workloads.jsonl)\n";
    return 2;
  }
  try {
    return bramah::bench::compare(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "bramah_bench_regress: " << error.what() << '\n';
    return 2;
  }
}
