#include "app/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>

#include "app/failure.hpp"
#include "app/mode_set_json.hpp"
#include "app/parallel.hpp"
#include "app/progress.hpp"
#include "app/results.hpp"
#include "app/varied_scene.hpp"
#include "solve/family.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

using Complex = std::complex<double>;

constexpr double on_axis = 50.0;  // real parts below so many times their rounding count as zero

/// The scene at any values of the swept parameters.
class SweptScene {
 public:
  SweptScene(const Context& context, Sweep& sweep, Journal& journal)
      : context_(context),
        sweep_(sweep),
        journal_(journal),
        varied_(context, names_of(sweep)),
        threads_(context.arguments.threads),
        progress_("sweep", !context.arguments.quiet) {
    asked_ = 1;
    for (const SweptParameter& over : sweep.over) asked_ *= over.values.size();
  }

  struct Spot {
    LinearModel model;
    Spectrum spectrum;
    ModeSet modes;
  };
  /// Throws AnalysisError or SceneError where there is no answer.
  Spot look(const std::vector<double>& at) {
    const VariedScene::Compilation compilation(varied_, at);
    const Linearization linear = linearize_at(compilation.get(), at);
    Spot spot{linear.model, find_spectrum(linear.model), {}};
    spot.modes = mode_set(spot.spectrum, linear.partition, linear.motion);
    return spot;
  }

  /// Many at once; failures are noted.
  std::vector<std::optional<ModeSet>> look_at_all(const std::vector<std::vector<double>>& list) {
    std::vector<std::optional<ModeSet>> sets(list.size());
    std::vector<std::string> messages(list.size());
    for_each_index(list.size(), threads_, [&](std::size_t k) {
      if (InterruptGuard::interrupted() || journal_.is_broken()) {
        messages[k] = "interrupted";
      } else if (!recall(list[k], sets[k], messages[k])) {
        messages[k] = reason_against([&] { sets[k] = look(list[k]).modes; });
        note(list[k], sets[k], messages[k]);
      }
      const std::scoped_lock lock(mutex_);
      ++done_;
      progress_.show(std::min(1.0, static_cast<double>(done_) / static_cast<double>(std::max(asked_, done_))),
                     std::to_string(done_) + " points");
    });
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (sets[k]) continue;
      const auto same = [&](const SweepFailure& failure) { return failure.at == list[k]; };
      if (std::none_of(sweep_.failures.begin(), sweep_.failures.end(), same))
        sweep_.failures.push_back({list[k], messages[k]});
    }
    journal_.check();
    sweep_.interrupted = InterruptGuard::interrupted();
    return sets;
  }

  /// Follows the equilibria across the lines, at their first values, or along a line. Before points of these are looked at.
  void follow_across() {
    const double first = sweep_.over[0].values.front();
    follow(sweep_.over[1].values, across_, nullptr, [first](double second) { return std::vector{first, second}; });
  }
  void follow_line(std::size_t line) {
    const bool grid = sweep_.over.size() > 1;
    std::optional<State> guess;
    if (grid) guess = across_.guess(sweep_.over[1].values[line]);
    along_.resize(std::max(along_.size(), line + 1));
    follow(sweep_.over[0].values, along_[line], guess ? &*guess : nullptr,
           [this, line](double value) { return sweep_.at(line, value); });
  }
  [[nodiscard]] const Family& family(std::size_t line) const { return along_[line]; }

  [[nodiscard]] int threads() const { return threads_; }
  /// The partition of the point where it was chosen holds everywhere, unless it cannot.
  void prescribe(Prescribed prescribed) { prescribed_ = std::move(prescribed); }
  /// Points where it could not, in order.
  [[nodiscard]] std::vector<std::vector<double>> chosen_again() const { return chosen_again_; }
  Prescribed partition_at(const std::vector<double>& at) {
    const VariedScene::Compilation compilation(varied_, at);
    const Partition found = linearize(compilation.get(), compilation.get().options.linearize.prescribed).partition;
    return {found.ai, found.ad};
  }
  void clear_progress() { progress_.clear(); }

 private:
  static std::vector<std::string> names_of(const Sweep& sweep) {
    std::vector<std::string> names;
    for (const SweptParameter& over : sweep.over) names.push_back(over.name);
    return names;
  }

  void follow(const std::vector<double>& values, Family& family, const State* guess,
              const std::function<std::vector<double>(double)>& place) {
    if (context_.options().linearize.at != LinearizeOptions::At::equilibrium) return;
    const auto solve = [&](double value, const State* near) {
      if (InterruptGuard::interrupted()) throw AnalysisError("sweep", "interrupted", "time to go on", "");
      try {
        const VariedScene::Compilation compilation(varied_, place(value));
        const System& system = compilation.get().system;
        const Options& options = compilation.get().options;
        if (near != nullptr) return continue_equilibrium(system, options.equilibrium, *near).state;
        Rest rest{find_equilibrium(system, options.equilibrium, options.simulate.from_time), {}};
        State state = rest.equilibrium.state;
        if (!sweep_.first) {
          rest.stability = judge_stability(system, state, most_judged);
          sweep_.first = std::move(rest);
        }
        return state;
      } catch (const SceneError& error) {
        const Diagnostic& d = error.diagnostics().front();
        throw AnalysisError("sweep", d.found, d.expected, d.remedy, d.pointer);
      }
    };
    reason_against([&] { family.follow(context_.system(), values, solve, guess); });  // its points say it again
  }

  /// On the family that was followed through `at`.
  std::optional<State> guess(const std::vector<double>& at) const {
    if (at.size() == 1) return along_.empty() ? std::nullopt : along_[0].guess(at[0]);
    if (at[0] == sweep_.over[0].values.front()) return across_.guess(at[1]);
    const std::vector<double>& seconds = sweep_.over[1].values;
    const auto line = static_cast<std::size_t>(std::find(seconds.begin(), seconds.end(), at[1]) - seconds.begin());
    return line < along_.size() ? along_[line].guess(at[0]) : std::nullopt;
  }

  Linearization linearize_at(const Compiled& compiled, const std::vector<double>& at) {
    const std::optional<State> near = guess(at);
    const State* const start = near ? &*near : nullptr;
    std::optional<Linearization> kept;
    try {
      kept.emplace(linearize(compiled, prescribed_, {}, start));
      if (kept->conditions.worst() <= LinearizerAlong::worst_condition) return std::move(*kept);
    } catch (const AnalysisError& error) {
      if (error.analysis() != "partition" && error.analysis() != "linearize") throw;
    }
    Linearization linear = linearize(compiled, compiled.options.linearize.prescribed, {}, start);
    if (kept && kept->conditions.worst() <= 10.0 * linear.conditions.worst()) return std::move(*kept);
    const std::scoped_lock lock(mutex_);
    chosen_again_.push_back(at);
    return linear;
  }

  void note(const std::vector<double>& at, const std::optional<ModeSet>& set, const std::string& message) {
    if (!set) {
      if (!InterruptGuard::interrupted()) journal_.add(at, [&](JsonWriter& json) { json.member("message", message); });
      return;
    }
    bool again = false;
    {
      const std::scoped_lock lock(mutex_);
      again = std::find(chosen_again_.begin(), chosen_again_.end(), at) != chosen_again_.end();
    }
    journal_.add(at, [&](JsonWriter& json) {
      json.member("chosen_again", again);
      write_mode_set(json, *set);
    });
  }
  /// As the journal has it; false where it has nothing.
  bool recall(const std::vector<double>& at, std::optional<ModeSet>& set, std::string& message) {
    const Value* entry = journal_.find(at);
    if (entry == nullptr) return false;
    if (const Value* text = entry->find("message"); text != nullptr && text->text() != nullptr) {
      message = *text->text();
      return true;
    }
    const Value* again = entry->find("chosen_again");
    set = read_mode_set(*entry);
    if (!set || again == nullptr || again->boolean() == nullptr) {
      set.reset();
      return false;
    }
    if (*again->boolean()) {
      const std::scoped_lock lock(mutex_);
      chosen_again_.push_back(at);
    }
    return true;
  }

  const Context& context_;
  Sweep& sweep_;
  Journal& journal_;
  VariedScene varied_;
  Family across_;
  std::vector<Family> along_;
  int threads_;
  std::mutex mutex_;
  Progress progress_;
  std::size_t asked_ = 0, done_ = 0;
  Prescribed prescribed_;
  std::vector<std::vector<double>> chosen_again_;
};

int sign_of(const Tracks::Point& point, std::size_t track) {
  if (track >= point.value.size() || point.mode[track] < 0) return 0;
  const double real = point.value[track].real();
  return std::abs(real) <= on_axis * point.error[track] ? 0 : real > 0.0 ? 1 : -1;
}

/// A value to be found between two points of a line.
struct Task {
  enum class Kind { crossing, meeting } kind = Kind::crossing;
  std::size_t line = 0, before = 0, after = 0;  // points
  int track = 0, partner = -1;                  // meeting: the tracks that meet
  bool is_critical = true;                      // else a branch point alone
  bool becomes_unstable = true;
  bool splits = true;
};

/// Events along one line.
class Search {
 public:
  Search(const Tracks& tracks, std::size_t line, std::vector<Task>& tasks, std::vector<std::string>& notes)
      : tracks_(tracks), line_(line), tasks_(tasks), notes_(notes) {
    for (std::size_t k = 0; k < tracks.points.size(); ++k) {
      if (!tracks.points[k].failed) good_.push_back(k);
    }
  }

  void run() {
    for (const Tracks::Branch& branch : tracks_.branches) {
      Task task{Task::Kind::meeting, line_, branch.before, branch.after, branch.first, branch.second};
      task.is_critical = false;
      task.splits = branch.splits;
      tasks_.push_back(task);
    }
    const std::size_t count = good_.empty() ? 0 : tracks_.points[good_.back()].value.size();
    for (std::size_t track = 0; track < count; ++track) follow(track);
  }

 private:
  void follow(std::size_t track) {
    int last_sign = 0;
    std::size_t last = 0, on_axis_since = 0, run = 0;  // positions in good_
    for (std::size_t g = 0; g < good_.size(); ++g) {
      const int sign = sign_of(tracks_.points[good_[g]], track);
      if (sign == 0) {
        if (run++ == 0) on_axis_since = g;
        continue;
      }
      if (last_sign != 0 && sign != last_sign) {
        Task task{Task::Kind::crossing, line_, good_[last], good_[g], static_cast<int>(track)};
        task.becomes_unstable = sign > 0;
        tasks_.push_back(task);
      } else if (run > 1 || (run == 1 && last_sign == 0)) {
        // On the axis for a while: with another mode it leaves the axis, to either side.
        if (last_sign > 0) reaches_axis(track, on_axis_since, g);
        if (sign > 0) leaves_axis(track, on_axis_since, g);
      }
      last_sign = sign;
      last = g;
      run = 0;
    }
    if (run > 0 && last_sign > 0) reaches_axis(track, on_axis_since, good_.size());
  }

  [[nodiscard]] bool is_mode(std::size_t g, std::size_t track) const {
    const Tracks::Point& point = tracks_.points[good_[g]];
    return track < point.mode.size() && point.mode[track] >= 0;
  }
  /// On the axis at the places begin ... end - 1; those where the mode is a zero say nothing.
  void reaches_axis(std::size_t track, std::size_t begin, std::size_t end) {
    std::size_t still = begin;
    while (still < end && !is_mode(still, track)) ++still;
    if (still < end) meeting(track, still, begin - 1, false);
  }
  void leaves_axis(std::size_t track, std::size_t begin, std::size_t end) {
    std::size_t still = end;
    while (still > begin && !is_mode(still - 1, track)) --still;
    if (still > begin) meeting(track, still - 1, end, true);
  }

  /// The track is on the axis at `still` and off it at `off`; its mirror image there is what it met.
  void meeting(std::size_t track, std::size_t still, std::size_t off, bool becomes_unstable) {
    const Tracks::Point &axis = tracks_.points[good_[still]], &point = tracks_.points[good_[off]];
    const Complex mirror = -std::conj(point.value[track]);
    int partner = -1;
    double nearest = 1e-6 * std::abs(mirror);
    for (std::size_t k = 0; k < std::min(point.value.size(), axis.value.size()); ++k) {
      const double distance = std::abs(point.value[k] - mirror);
      if (k == track || axis.mode[k] < 0 || point.mode[k] < 0 || distance > nearest) continue;
      nearest = distance;
      partner = static_cast<int>(k);
    }
    if (partner < 0) {
      notes_.push_back("The real part of mode m" + std::to_string(track + 1) +
                       " differs from zero by more than rounding on one side only of " + digits(axis.at, 10) + " ... " +
                       digits(point.at, 10) + "; it is not counted as a crossing.");
      return;
    }
    Task task{Task::Kind::meeting,     line_,  good_[std::min(still, off)], good_[std::max(still, off)],
              static_cast<int>(track), partner};
    task.becomes_unstable = becomes_unstable;
    task.splits = becomes_unstable;
    tasks_.push_back(task);
  }

  const Tracks& tracks_;
  std::size_t line_;
  std::vector<Task>& tasks_;
  std::vector<std::string>& notes_;
  std::vector<std::size_t> good_;
};

/// The answer to a task.
struct Found {
  std::string failure;
  double at = 0.0;
  Complex eigenvalue;
  long others_unstable = 0;
  std::string states;
};

/// A real eigenvalue that passes zero is zero by rank in a small range around the crossing: a line through the nearest
/// values outside of it. Their distance, near 1e-8, squared is the error of the line.
double across_zero(const std::function<double(double)>& f, double a, double zero, double b) {
  const auto outside = [&](double end) {
    double step = 1e-12 * (end - zero), x = zero;
    while (f(x) == 0.0 && x != end) {
      step *= 4.0;
      x = std::abs(step) < std::abs(end - zero) ? zero + step : end;
    }
    return x;
  };
  const double left = outside(a), right = outside(b), f_left = f(left), f_right = f(right);
  return f_left == f_right ? zero : left - f_left * (right - left) / (f_right - f_left);
}

Found solve(SweptScene& scene, const Sweep& sweep, const Task& task) {
  const Tracks::Point &a = sweep.lines[task.line].points[task.before], &b = sweep.lines[task.line].points[task.after];
  const auto track = static_cast<std::size_t>(task.track),
             partner = static_cast<std::size_t>(std::max(task.partner, 0));
  Found found;
  found.failure = reason_against([&] {
    const SweptScene::Spot base = scene.look(sweep.at(task.line, a.at));
    // Where the modes of the first end are at another point.
    const auto values = [&](const ModeSet& set) {
      const ModeMatch match = match_modes(base.modes, set);
      const auto value = [&](std::size_t k) -> Complex {
        const int mode = match.to[static_cast<std::size_t>(a.mode[k])];
        return mode < 0 ? 0.0 : set.values[static_cast<std::size_t>(mode)];
      };
      return std::pair{value(track), task.kind == Task::Kind::meeting ? value(partner) : Complex()};
    };
    // The squared half-distance of two eigenvalues that meet is smooth and changes its sign where they do.
    const auto measure = [&](Complex first, Complex second) {
      return task.kind == Task::Kind::crossing ? first.real() : ((first - second) * (first - second)).real() / 4.0;
    };
    const auto f = [&](double p) {
      const auto [first, second] = values(scene.look(sweep.at(task.line, p)).modes);
      return measure(first, second);
    };
    const double fa = measure(a.value[track], a.value[partner]), fb = measure(b.value[track], b.value[partner]);
    const double tolerance = 2.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(a.at), std::abs(b.at));
    found.at = bracketed_root(f, a.at, fa, b.at, fb, tolerance);
    if (task.kind == Task::Kind::crossing && f(found.at) == 0.0) found.at = across_zero(f, a.at, found.at, b.at);
    const SweptScene::Spot spot = scene.look(sweep.at(task.line, found.at));
    const auto [first, second] = values(spot.modes);
    found.eigenvalue = task.kind == Task::Kind::crossing ? first : 0.5 * (first + second);
    const Complex own = first;
    for (std::size_t k = 0; k < spot.modes.values.size(); ++k) {
      const Complex value = spot.modes.values[k];
      const bool is_own =
          value == own || value == std::conj(own) || (task.kind == Task::Kind::meeting && value == second);
      if (!is_own && value.real() > on_axis * spot.modes.error[k]) ++found.others_unstable;
    }
    found.states = involved_states(base.model, participation(base.spectrum).col(a.mode[track]));
  });
  return found;
}

/// Where the equilibria that were followed end.
void note_ends(const SweptScene& scene, Sweep& sweep) {
  for (std::size_t line = 0; line < sweep.lines.size(); ++line) {
    const Family& family = scene.family(line);
    if (!family.is_lost()) continue;
    if (!family.fold()) {
      sweep.notes.push_back("The equilibria that are followed end at " + digits(family.last(), 10) +
                            ", and no fold was found there: " + family.why());
      continue;
    }
    CriticalValue critical;
    critical.fold = true;
    critical.at = family.fold()->at;
    critical.line = line;
    critical.states =
        family.fold()->variable + " = " + with_unit(short_number(family.fold()->value, 7), family.fold()->unit);
    // The mode that comes to rest there: the slowest of the last point.
    for (const Tracks::Point& point : sweep.lines[line].points) {
      if (point.failed) continue;
      double slowest = HUGE_VAL;
      critical.others_unstable = 0;
      for (std::size_t k = 0; k < point.value.size(); ++k) {
        if (point.mode[k] < 0) continue;
        if (point.value[k].real() > on_axis * point.error[k]) ++critical.others_unstable;
        if (std::abs(point.value[k]) >= slowest) continue;
        slowest = std::abs(point.value[k]);
        critical.track = static_cast<int>(k);
      }
    }
    sweep.critical.push_back(std::move(critical));
  }
}

void find_events(SweptScene& scene, Sweep& sweep) {
  note_ends(scene, sweep);
  std::vector<Task> tasks;
  for (std::size_t line = 0; line < sweep.lines.size(); ++line)
    Search(sweep.lines[line], line, tasks, sweep.notes).run();
  std::vector<Found> found(tasks.size());
  for_each_index(tasks.size(), scene.threads(), [&](std::size_t k) { found[k] = solve(scene, sweep, tasks[k]); });
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const Task& task = tasks[k];
    if (!found[k].failure.empty()) {
      const std::vector<Tracks::Point>& points = sweep.lines[task.line].points;
      sweep.notes.push_back("What mode m" + std::to_string(task.track + 1) + " does between " +
                            digits(points[task.before].at, 10) + " and " + digits(points[task.after].at, 10) +
                            " is not known: " + found[k].failure);
      continue;
    }
    if (!task.is_critical) {
      sweep.branches.push_back(
          {found[k].at, task.line, task.track, task.partner, found[k].eigenvalue.real(), task.splits});
      continue;
    }
    if (found[k].eigenvalue.imag() < 0.0) continue;  // its conjugate is counted
    CriticalValue critical;
    critical.at = found[k].at;
    critical.line = task.line;
    critical.track = task.track;
    critical.oscillatory =
        std::abs(found[k].eigenvalue.imag()) >
        1e-6 * std::abs(sweep.lines[task.line].points[task.after].value[static_cast<std::size_t>(task.track)]);
    critical.eigenvalue = critical.oscillatory ? found[k].eigenvalue : 0.0;
    critical.becomes_unstable = task.becomes_unstable;
    critical.others_unstable = found[k].others_unstable;
    critical.states = found[k].states;
    sweep.critical.push_back(critical);
  }
  const auto by_place = [&](const auto& p, const auto& q) {
    if (p.line != q.line) return p.line < q.line;
    return sweep.over[0].values.front() < sweep.over[0].values.back() ? p.at < q.at : p.at > q.at;
  };
  std::stable_sort(sweep.critical.begin(), sweep.critical.end(), by_place);
  std::stable_sort(sweep.branches.begin(), sweep.branches.end(), by_place);
}

void name_states(SweptScene& scene, Sweep& sweep) {
  for (std::size_t line = 0; line < sweep.lines.size(); ++line) {
    for (const Tracks::Point& point : sweep.lines[line].points) {
      if (point.mode.size() <= sweep.states.size()) continue;
      const SweptScene::Spot spot = scene.look(sweep.at(line, point.at));
      const Eigen::MatrixXd shares = participation(spot.spectrum);
      for (std::size_t k = sweep.states.size(); k < point.mode.size(); ++k)
        sweep.states.push_back(point.mode[k] < 0 ? "" : involved_states(spot.model, shares.col(point.mode[k])));
    }
  }
}

void note_partitions(const SweptScene& scene, Sweep& sweep) {
  std::vector<std::vector<double>> list = scene.chosen_again();
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  if (list.empty()) return;
  sweep.notes.push_back(
      "At " + counted(list.size(), "point") + " between " + digits(list.front()[0], 10) + " and " +
      digits(list.back()[0], 10) +
      " the independent coordinates of the first point are tied, or nearly so; there they were chosen "
      "again. Eigenvalues do not depend on that choice.");
}

void note_doubts(Sweep& sweep, const std::vector<std::pair<double, double>>& doubts) {
  for (const auto& [from, to] : doubts) {
    const bool is_one_place = digits(from, 9) == digits(to, 9);
    sweep.notes.push_back(is_one_place ? "At " + digits(from, 9) +
                                             " modes coincide in value and shape; which is which beyond is convention."
                                       : "Between " + digits(from, 12) + " and " + digits(to, 12) +
                                             " modes cannot be told apart for certain; their order there is a guess.");
  }
}

/// That of the first point that has one. Throws where no point has.
void prescribe_partition(const Context& context, SweptScene& scene, const Sweep& sweep) {
  const std::vector<double>& along = sweep.over[0].values;
  for (const double value : along) {
    const std::string failure = reason_against([&] { scene.prescribe(scene.partition_at(sweep.at(0, value))); });
    if (failure.empty() || InterruptGuard::interrupted()) return;
  }
  if (sweep.over.size() > 1) return;
  try {
    scene.partition_at(sweep.at(0, along[0]));
  } catch (const SceneError& error) {
    throw Failure::scene(context.scene.source, error, {});
  }
}

}  // namespace

std::vector<double> Sweep::at(std::size_t line, double value) const {
  if (over.size() == 1) return {value};
  return {value, over[1].values[line]};
}

void check_sweep(const Context& context) {
  if (!context.options().sweep.over.empty()) return;
  throw Failure::usage("a scene without \"sweep\", and no --over", "a parameter and its values",
                       "write for instance --over COMPONENT.PARAMETER=1:9:41");
}

Sweep run_sweep(const Context& context, Journal& journal) {
  Sweep sweep;
  sweep.over = context.options().sweep.over;
  const InterruptGuard guard(journal.last_words());
  SweptScene scene(context, sweep, journal);
  const std::vector<double>& along = sweep.over[0].values;
  const std::size_t lines = sweep.over.size() == 1 ? 1 : sweep.over[1].values.size();
  prescribe_partition(context, scene, sweep);
  if (lines > 1) scene.follow_across();
  ModeFollower across;  // at the first value of the first parameter, along the second
  for (std::size_t line = 0; line < lines; ++line) {
    if (lines > 1) {
      const std::vector<double>& seconds = sweep.over[1].values;
      const std::vector<double> step(seconds.begin() + static_cast<std::ptrdiff_t>(line > 0 ? line - 1 : 0),
                                     seconds.begin() + static_cast<std::ptrdiff_t>(line + 1));
      const Tracks walked = across.follow(step, [&](const std::vector<double>& values) {
        std::vector<std::vector<double>> list;
        list.reserve(values.size());
        for (const double value : values) list.push_back({along[0], value});
        return scene.look_at_all(list);
      });
      sweep.added += walked.points.size() - step.size();
    }
    scene.follow_line(line);
    ModeFollower follower = across;
    sweep.lines.push_back(follower.follow(along, [&](const std::vector<double>& values) {
      std::vector<std::vector<double>> list;
      list.reserve(values.size());
      for (const double value : values) list.push_back(sweep.at(line, value));
      return scene.look_at_all(list);
    }));
    for (const Tracks::Point& point : sweep.lines.back().points) sweep.added += point.asked ? 0 : 1;
    note_doubts(sweep, sweep.lines.back().doubts);
  }
  if (!sweep.interrupted) {
    name_states(scene, sweep);
    find_events(scene, sweep);
  }
  note_partitions(scene, sweep);
  if (sweep.first) {
    tell_equilibrium(context, sweep.first->equilibrium);
    tell_stability(context, sweep.first->stability);
  }
  return sweep;
}

}  // namespace bramah
