#include "app/vary.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "app/failure.hpp"
#include "app/parallel.hpp"
#include "app/progress.hpp"
#include "app/transient.hpp"
#include "app/varied_scene.hpp"
#include "io/parse_json.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "system/measure.hpp"

namespace bramah {
namespace {

using Figure = VaryOptions::Figure;

const char* name_of(Figure figure) {
  switch (figure) {
    case Figure::final_value: return "final";
    case Figure::min: return "min";
    case Figure::max: return "max";
    case Figure::mean: return "mean";
    case Figure::rms: break;
  }
  return "rms";
}

/// Figures of outputs, from rows as they come: none is kept.
class Accumulator {
 public:
  void take(double time, const Vector& row) {
    if (last_.empty()) {
      begin_ = time;
      min_ = max_ = row;
      integral_.assign(row.size(), 0.0);
      squares_.assign(row.size(), 0.0);
    } else {
      add(time - time_, row);
    }
    time_ = time;
    last_ = row;
  }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double figure(std::size_t output, Figure figure) const {
    const double length = time_ - begin_;
    switch (figure) {
      case Figure::final_value: return last_[output];
      case Figure::min: return min_[output];
      case Figure::max: return max_[output];
      case Figure::mean: return length > 0.0 ? integral_[output] / length : last_[output];
      case Figure::rms: break;
    }
    return length > 0.0 ? std::sqrt(squares_[output] / length) : std::abs(last_[output]);
  }

 private:
  void add(double step, const Vector& row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      min_[i] = std::min(min_[i], row[i]);
      max_[i] = std::max(max_[i], row[i]);
      integral_[i] += 0.5 * step * (last_[i] + row[i]);
      squares_[i] += 0.5 * step * (last_[i] * last_[i] + row[i] * row[i]);
    }
  }
  double begin_ = 0.0, time_ = 0.0;
  Vector last_, min_, max_, integral_, squares_;
};

/// The parameters of a run: the last of the grid changes fastest, but for the draws. A draw has the same random numbers at
/// every point of the grid, so that the points are compared under equal conditions.
std::vector<double> values_at(const VaryOptions& options, std::size_t run) {
  const std::size_t draw = run % options.count;
  std::size_t point = run / options.count;
  std::vector<double> values(options.over.size());
  for (std::size_t k = options.over.size(); k-- > 0;) {
    const std::vector<double>& all = options.over[k].values;
    values[k] = all[point % all.size()];
    point /= all.size();
  }
  for (std::size_t k = 0; k < options.random.size(); ++k) {
    const double share = random_share(options.seed, draw, static_cast<std::uint32_t>(k));
    values.push_back(options.random[k].distribution.quantile(share));
  }
  return values;
}

/// False where Ctrl-C came first.
bool simulate_one(const Compiled& compiled, std::vector<double>& values, std::string& warning) {
  const System& system = compiled.system;
  const SimulateOptions& options = compiled.options.simulate;
  const VaryOptions& vary = compiled.options.vary;
  const State start =
      reference_state(system, compiled.options, options.from == SimulateOptions::From::equilibrium, options.from_time);
  Meter meter(system, vary.of);
  Accumulator figures;
  Observer observer;
  observer.output = [&](const State& state) { figures.take(state.t, meter.read(state)); };
  observer.progress = [](double, double) { return !InterruptGuard::interrupted(); };
  const Simulation simulation = simulate(system, options, start, observer);
  if (simulation.stopped) return false;
  if (const auto doubts = doubts_of(simulation); !doubts.empty()) throw AnalysisError(doubts.front());
  for (const std::string& one : limit_warnings(simulation.limits_passed))
    warning += (warning.empty() ? "" : "; ") + one;
  values.push_back(figures.time());
  for (std::size_t output = 0; output < vary.of.size(); ++output) {
    for (const Figure figure : vary.figures) values.push_back(figures.figure(output, figure));
  }
  return true;
}

constexpr std::pair<VariedRun::Status, const char*> words[] = {{VariedRun::Status::ok, "ok"},
                                                               {VariedRun::Status::failed, "failed"},
                                                               {VariedRun::Status::interrupted, "interrupted"}};

/// As the journal has it; false where it has nothing.
bool recall(const Value* entry, std::size_t figures, VariedRun& run) {
  if (entry == nullptr) return false;
  const Value *status = entry->find("status"), *values = entry->find("values"), *message = entry->find("message");
  if (status == nullptr || status->text() == nullptr || values == nullptr || message == nullptr ||
      message->text() == nullptr)
    return false;
  VariedRun found;
  found.at = run.at;
  found.message = *message->text();
  for (const auto& [one, word] : words) {
    if (*status->text() == word) found.status = one;
  }
  const bool is_whole = read_numbers(*values, found.values) && found.status != VariedRun::Status::interrupted &&
                        found.values.size() == (found.status == VariedRun::Status::ok ? figures : 0);
  if (is_whole) run = std::move(found);
  return is_whole;
}

void simulate_one(VariedScene& scene, VariedRun& run) {
  bool whole = true;
  std::string warning;
  run.message = reason_against([&] {
    const VariedScene::Compilation compilation(scene, run.at);
    whole = simulate_one(compilation.get(), run.values, warning);
  });
  if (whole) run.status = run.message.empty() ? VariedRun::Status::ok : VariedRun::Status::failed;
  if (run.status == VariedRun::Status::ok) run.message = warning;
}

/// Value of `sorted` below which lies `share` of all.
double percentile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

FigureStatistics statistics_of(std::vector<double> values) {
  FigureStatistics result;
  if (values.empty()) return result;
  const auto count = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  result.mean = sum / count;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  if (values.size() > 1) result.deviation = std::sqrt(squares / (count - 1.0));
  std::sort(values.begin(), values.end());
  result.min = values.front();
  result.max = values.back();
  result.low = percentile(values, 0.05);
  result.median = percentile(values, 0.5);
  result.high = percentile(values, 0.95);
  return result;
}

}  // namespace

std::size_t Vary::count(VariedRun::Status status) const {
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [&](const VariedRun& run) { return run.status == status; }));
}

const char* word_for(VariedRun::Status status) {
  return std::find_if(std::begin(words), std::end(words), [&](const auto& one) { return one.first == status; })->second;
}

void check_vary(const Context& context) {
  if (context.options().vary.asked) return;
  throw Failure::usage(
      "a scene without \"vary\"", "numbers that change, and how",
      "write for instance \"vary\": { \"over\": { \"COMPONENT.PARAMETER\": [1, 2, 3] } } into the scene");
}

Vary run_vary(const Context& context, Journal& journal) {
  const VaryOptions& options = context.options().vary;
  Vary vary;
  for (const SweptParameter& one : options.over) vary.parameters.push_back({one.name, one.unit});
  for (const RandomParameter& one : options.random) vary.parameters.push_back({one.name, one.unit});
  vary.figures.push_back({"time", "s"});
  for (const Measured& output : options.of) {
    for (const Figure figure : options.figures)
      vary.figures.push_back({output.name + "." + name_of(figure), output.unit});
  }
  std::vector<std::string> names;
  for (const RunFigure& parameter : vary.parameters) names.push_back(parameter.name);
  vary.runs.resize(options.runs());

  const InterruptGuard guard(journal.last_words());
  VariedScene scene(context, names);
  if (context.options().simulate.from == SimulateOptions::From::equilibrium)
    reason_against([&] { vary.rest = find_rest(context, context.start_time()); });  // runs may have one all the same
  Progress progress("vary", !context.arguments.quiet);
  std::mutex mutex;
  std::size_t done = 0;
  for_each_index(vary.runs.size(), context.arguments.threads, [&](std::size_t k) {
    VariedRun& run = vary.runs[k];
    run.at = values_at(options, k);
    if (journal.is_broken() || InterruptGuard::interrupted()) return;
    if (!recall(journal.find(run.at), vary.figures.size(), run)) {
      simulate_one(scene, run);
      if (run.status == VariedRun::Status::interrupted) return;
      journal.add(run.at, [&](JsonWriter& json) {
        json.member("status", word_for(run.status)).key("values").values(run.values).member("message", run.message);
      });
    }
    const std::scoped_lock lock(mutex);
    ++done;
    progress.show(static_cast<double>(done) / static_cast<double>(vary.runs.size()),
                  std::to_string(done) + " of " + std::to_string(vary.runs.size()) + " runs");
  });
  journal.check();
  vary.interrupted = InterruptGuard::interrupted();
  return vary;
}

std::vector<FigureStatistics> statistics_of(const Vary& vary) {
  std::vector<FigureStatistics> all;
  for (std::size_t k = 0; k < vary.figures.size(); ++k) {
    std::vector<double> values;
    for (const VariedRun& run : vary.runs) {
      if (run.status == VariedRun::Status::ok) values.push_back(run.values[k]);
    }
    all.push_back(statistics_of(std::move(values)));
  }
  return all;
}

}  // namespace bramah
