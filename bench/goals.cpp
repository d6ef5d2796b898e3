#include "goals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/tables.hpp"

namespace bramah::bench {
namespace {

bool is_true(const Value& object, std::string_view key) {
  const Value* member = object.find(key);
  return member != nullptr && member->boolean() != nullptr && *member->boolean();
}

std::vector<double> sizes_of(const Value& goal, const Value& take) {
  std::vector<double> sizes;
  const Value* list = goal.find("sizes");
  if (list == nullptr || list->list() == nullptr) return {number(take, "N")};
  for (const Value& size : *list->list()) {
    if (const double* N = size.number()) sizes.push_back(*N);
  }
  return sizes;
}

double figure(const Results& results, const Value& take, double N, const std::string& rung) {
  const Value* line = find_line(results.lines, text(take, "workload"), N, rung);
  if (line == nullptr) return NAN;
  return number(*line, text(take, "key")) / (is_true(take, "per_body") ? N : 1.0);
}

/// Of several tolerances the fastest whose error is small enough.
void take_fastest(const Results& results, const Value& take, double error, Goal& goal) {
  double fastest = HUGE_VAL, least_error = HUGE_VAL;
  for (const Value& line : results.lines) {
    if (text(line, "workload") != text(take, "workload") || number(line, "N") != number(take, "N")) continue;
    const double seconds = number(line, text(take, "key")), found = number(line, "error");
    if (std::isnan(found)) continue;
    least_error = std::min(least_error, found);
    if (found > error || seconds >= fastest) continue;
    fastest = seconds;
    goal.note = "tolerance " + short_number(number(line, "tolerance"), 2) + ", error " + short_number(found, 2) + ", " +
                short_number(number(line, "steps")) + " steps";
  }
  goal.measured = std::isfinite(fastest) ? fastest : NAN;
  if (std::isnan(goal.measured) && std::isfinite(least_error))
    goal.note = "no tolerance that was tried has a smaller error than " + short_number(least_error, 2);
}

void measure(const Results& results, const Value& entry, const Value& take, Goal& goal) {
  const std::string rung = text(take, "rung"), over = text(entry, "over");
  const double error = number(entry, "error");
  if (!std::isnan(error)) {
    take_fastest(results, take, error, goal);
    return;
  }
  double largest = -HUGE_VAL, smallest = HUGE_VAL;
  for (const double N : sizes_of(entry, take)) {
    const double value = figure(results, take, N, rung);
    if (std::isnan(value)) {
      goal.measured = NAN;
      return;
    }
    largest = std::max(largest, value);
    smallest = std::min(smallest, value);
  }
  goal.measured = is_true(entry, "flat") ? largest / smallest : largest;
  if (over.empty()) return;
  const Value* line = find_line(results.lines, text(take, "workload"), number(take, "N"), over);
  goal.measured = figure(results, take, number(take, "N"), over) / goal.measured;
  if (line != nullptr && number(*line, "columns") > 0.0)
    goal.note = "one column of the rival measured, times their number";
}

}  // namespace

const Value* find_line(const std::vector<Value>& lines, const std::string& workload, double N,
                       const std::string& rung) {
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const Value& line) {
    return text(line, "workload") == workload && number(line, "N") == N && text(line, "rung") == rung;
  });
  return found == lines.end() ? nullptr : &*found;
}

std::vector<Goal> read_goals(const std::string& file, const Results& results) {
  const Value root = read_json(file);
  const Value* list = root.find("goals");
  if (list == nullptr || list->list() == nullptr) throw std::runtime_error(file + ": expected a list \"goals\"");
  std::vector<Goal> goals;
  for (const Value& entry : *list->list()) {
    Goal goal;
    goal.what = text(entry, "goal");
    const Value* take = entry.find("take");
    const double at_most = number(entry, "at_most");
    goal.at_least = std::isnan(at_most);
    goal.limit = goal.at_least ? number(entry, "at_least") : at_most;
    if (take == nullptr || goal.what.empty() || std::isnan(goal.limit))
      throw std::runtime_error(file + ": goal " + std::to_string(goals.size() + 1) +
                               " needs \"goal\", \"take\", and \"at_most\" or \"at_least\"");
    goal.unit = goal.at_least || is_true(entry, "flat") ? "x" : text(entry, "unit").empty() ? "s" : text(entry, "unit");
    measure(results, entry, *take, goal);
    const std::string missed = text(entry, "missed");
    if (!goal.met() && !std::isnan(goal.measured) && !missed.empty())
      goal.note += (goal.note.empty() ? "" : "; ") + missed;
    goals.push_back(std::move(goal));
  }
  return goals;
}

}  // namespace bramah::bench
