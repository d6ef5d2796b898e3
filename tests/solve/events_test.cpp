// Events with every integrator: what is shown after them against closed forms, how often they happen, near which levels,
// and runs that are taken up again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "io/checkpoint.hpp"
#include "io/read_scene.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"
#include "support/numbers.hpp"
#include "support/scene_parts.hpp"
#include "system/analysis_error.hpp"
#include "system/measure.hpp"

namespace bramah {
namespace {

using support::exact;
using support::Method;
using support::methods;
using testing::close;

/// A machine of components and the section "simulate".
struct Scenario {
  Scenario(const std::string& components, const std::string& section)
      : compiled(compile(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics", "signals"], "components": {
      "none": { "type": "signals/constant", "unit": "1", "value": 0 }, )" +
                                             components + R"(}, "simulate": {)" + section + "} }",
                                         "events.json"),
                         testing::registry())) {}
  [[nodiscard]] SimulateOptions with(const Method& method) const {
    return support::with(compiled.options.simulate, method);
  }
  [[nodiscard]] State start() const { return consistent_start(compiled.system, compiled.options, 0.0); }
  Compiled compiled;
};

/// All that a run shows: time, then every number of the machine that has a name.
struct Shown {
  std::vector<std::string> names;
  std::vector<Vector> rows;
  [[nodiscard]] double at(std::size_t row, const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? NAN : rows[row][static_cast<std::size_t>(found - names.begin()) + 1];
  }
};

class Recorder {
 public:
  explicit Recorder(const System& system) : meter_(system, all(system)) {
    shown.names = measured_names(system);
    observer.output = [this](const State& state) {
      Vector& row = shown.rows.emplace_back(1, state.t);
      const Vector& values = meter_.read(state);
      row.insert(row.end(), values.begin(), values.end());
    };
  }
  Shown shown;
  Observer observer;

 private:
  static std::vector<Measured> all(const System& system) {
    std::vector<Measured> columns;
    for (const std::string& name : measured_names(system))
      EXPECT_TRUE(find_measured(system, name, columns.emplace_back()));
    return columns;
  }
  Meter meter_;
};

class Events : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, Events, ::testing::ValuesIn(methods), support::name_of);

// ---- what is shown after events ------------------------------------------------------------------------------------

/// 2 kg in a slot, pushed at an angle by 5 N, which changes its sign where the speed reaches 3 m/s: the speed is a
/// triangle of period 8 s.
Scenario shuttle(double to_time) {
  return {R"("ground": { "type": "mechanics/ground" },
    "u":    { "type": "signals/constant", "unit": "N", "value": 5 },
    "body": { "type": "mechanics/planar_body", "mass": 2, "inertia": 1 },
    "slot": { "type": "mechanics/planar_slot", "a": "ground", "b": "body" },
    "push": { "type": "mechanics/planar_force", "on": "body", "magnitude": "u", "direction": [0.6, 0.8] })",
          R"("to_time": )" + exact(to_time) + R"(, "output_step": 0.37, "events": {
    "forth": { "of": "body.x.rate", "rises_above": 3, "hold": { "u": -5 } },
    "back":  { "of": "body.x.rate", "falls_below": -3, "hold": { "u": 5 } } })"};
}

/// Every column at t, on the side before or after an event.
void expect_shuttle(const Shown& shown, std::size_t row, double tolerance) {
  const double t = shown.rows[row][0];
  const bool after_event = row > 0 && shown.rows[row - 1][0] == t;
  const double nearest = 2.0 + 4.0 * std::round((t - 2.0) / 4.0);
  double phase = std::floor((t + 2.0) / 4.0);  // of the triangle: even ones rise
  if (t > 1.0 && std::abs(t - nearest) < 1e-6) phase = (nearest + 2.0) / 4.0 - (after_event ? 0.0 : 1.0);
  const double sign = std::fmod(phase, 2.0) == 0.0 ? 1.0 : -1.0, s = t - 4.0 * phase;  // from the middle of the ramp
  const double v = sign * 1.5 * s, x = sign * 0.75 * s * s + (sign > 0.0 ? 0.0 : 6.0);
  SCOPED_TRACE("t = " + exact(t) + (after_event ? " after" : ""));
  const std::pair<const char*, double> expected[] = {{"body.x", x},
                                                     {"body.y", 0.0},
                                                     {"body.angle", 0.0},
                                                     {"body.x.rate", v},
                                                     {"body.y.rate", 0.0},
                                                     {"body.angle.rate", 0.0},
                                                     {"body.x.acceleration", sign * 1.5},
                                                     {"body.y.acceleration", 0.0},
                                                     {"body.angle.acceleration", 0.0},
                                                     {"slot.lambda_across", sign * 4.0},
                                                     {"u", sign * 5.0},
                                                     {"body.energy", v * v},
                                                     {"push.power", sign * 3.0 * v},
                                                     {"energy", v * v},
                                                     {"power", sign * 3.0 * v}};
  for (const auto& [name, value] : expected)
    EXPECT_TRUE(close(shown.at(row, name), value, tolerance, 1.0)) << name << " at t = " << t;
}

TEST_P(Events, EveryColumnIsThatOfTheClosedForm) {
  const Scenario scenario = shuttle(15.0);
  Recorder recorder(scenario.compiled.system);
  const Simulation run =
      simulate(scenario.compiled.system, scenario.with(GetParam()), scenario.start(), recorder.observer);
  ASSERT_EQ(run.events.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(run.events[k].name, k % 2 == 0 ? "forth" : "back");
    EXPECT_NEAR(run.events[k].time, 2.0 + 4.0 * static_cast<double>(k), 1e-8);
  }
  ASSERT_EQ(recorder.shown.rows.size(), 41U + 1U + 8U);
  for (std::size_t row = 0; row < recorder.shown.rows.size(); ++row) expect_shuttle(recorder.shown, row, 1e-7);
  EXPECT_LT(run.statistics.energy.relative(), 1e-7);
}

// ---- runs that are taken up again ------------------------------------------------------------------------------------

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// Continues the run from checkpoints of every kind: every `every`-th step. The rest must be what the whole run shows
/// from there on, bit for bit where `tolerance` is 0.
void expect_the_rest(const System& system, const SimulateOptions& options, const State& start, int every,
                     double tolerance) {
  Recorder whole(system);
  struct Saved {
    Checkpoint checkpoint;
    std::size_t rows;
  };
  std::vector<Saved> saved;
  int steps = 0;
  whole.observer.checkpoint_due = [&] { return ++steps % every == 0; };
  whole.observer.checkpoint = [&](const Checkpoint& checkpoint) {
    saved.push_back({read_checkpoint(system, {"saved", checkpoint_text(system, checkpoint)}), whole.shown.rows.size()});
  };
  const Simulation run = simulate(system, options, start, whole.observer);
  ASSERT_GT(saved.size(), 5U);
  for (const auto& [checkpoint, rows] : saved) {
    if (checkpoint.state.t >= options.to_time) continue;
    SCOPED_TRACE("from t = " + exact(checkpoint.state.t));
    Recorder rest(system);
    const Simulation again = resume(system, options, checkpoint, rest.observer);
    ASSERT_EQ(rest.shown.rows.size(), whole.shown.rows.size() - rows);
    for (std::size_t k = 0; k < rest.shown.rows.size(); ++k) {
      const Vector &found = rest.shown.rows[k], &expected = whole.shown.rows[rows + k];
      if (tolerance == 0.0) {
        ASSERT_TRUE(same_bits(found, expected)) << "at t = " << exact(expected[0]);
        continue;
      }
      for (std::size_t i = 0; i < found.size(); ++i)
        ASSERT_TRUE(close(found[i], expected[i], tolerance, 1.0))
            << (i == 0 ? "time" : rest.shown.names[i - 1]) << " at t = " << expected[0];
    }
    const std::size_t before = run.events.size() - again.events.size();
    for (std::size_t k = 0; k < again.events.size(); ++k) {
      EXPECT_EQ(again.events[k].name, run.events[before + k].name);
      EXPECT_NEAR(again.events[k].time, run.events[before + k].time, tolerance);
    }
  }
}

TEST_P(Events, AContinuedRunShowsTheRestOfTheWholeRun) {
  const Scenario scenario = shuttle(7.0);
  SimulateOptions options = scenario.with(GetParam());
  options.step = options.step > 0.0 ? 0.013 : 0.0;
  options.max_step = 0.1;
  expect_the_rest(scenario.compiled.system, options, scenario.start(), 3, options.step > 0.0 ? 0.0 : 1e-7);
}

/// A pendulum that is pushed by steps and ramps against the ends of its travel.
Scenario rattling_pendulum() {
  return {R"("ground": { "type": "mechanics/ground" },
    "gravity": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] },
    "u":    { "type": "signals/table", "unit": "N", "times": [0, 0.31, 0.31, 0.77, 1.21], "values": [4, 4, -6, -6, 9] },
    "w":    { "type": "signals/constant", "unit": "N", "value": 0 },
    "rod":  { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.3, "position": [0, -1], "gravity": "gravity" },
    "pin":  { "type": "mechanics/planar_revolute", "a": "ground", "b": "rod", "point_b": [0, 1] },
    "len":  { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [1, -1], "b": "rod" },
    "stop": { "type": "mechanics/end_stop", "along": "len.s", "lower": 0.95, "upper": 1.04, "stiffness": 3000,
              "damping": 0.3 },
    "push": { "type": "mechanics/planar_force", "on": "rod", "magnitude": "u", "direction": [1, 0] },
    "more": { "type": "mechanics/planar_force", "on": "rod", "magnitude": "w", "direction": [1, 1] })",
          R"("to_time": 1.5, "output_step": 0.05, "events": {
    "hit":   { "of": "stop.depth", "rises_above": 1e-3, "hold": { "w": 1 } },
    "off":   { "of": "stop.force", "falls_below": 0.5, "hold": { "w": 0 } },
    "turns": { "of": "rod.angle.acceleration", "falls_below": 0, "hold": { "none": 0 } },
    "pulls": { "of": "pin.lambda_y", "rises_above": 9.5, "hold": { "none": 0 } } })"};
}

// Breakpoints, kinks of laws, conditions on what jumps, and checkpoints at all of them.
TEST_P(Events, AContinuedRunMeetsTheSameKinksAndJumps) {
  const Scenario scenario = rattling_pendulum();
  SimulateOptions options = scenario.with(GetParam());
  options.step = options.step > 0.0 ? 0.007 : 0.0;
  options.max_step = 0.02;
  expect_the_rest(scenario.compiled.system, options, scenario.start(), options.step > 0.0 ? 1 : 40,
                  options.step > 0.0 ? 0.0 : 1e-3);  // what a restart changes, after four hits of a stiff stop
}

TEST(EventMemory, OfAnOldCheckpointStartsAnew) {
  const Scenario scenario = shuttle(1.0);
  const System& system = scenario.compiled.system;
  const Simulation run = simulate(system, scenario.with(methods[1]), scenario.start(), {});
  std::string text = checkpoint_text(system, run.checkpoint);
  const std::size_t events = text.find("\"events\"");
  ASSERT_NE(events, std::string::npos);
  text = text.substr(0, text.rfind(',', events)) + "\n}\n";  // what came after has been added since
  const Checkpoint old = read_checkpoint(system, {"old", text});
  EXPECT_TRUE(old.events.empty());
  EXPECT_EQ(old.chosen_at.x, old.state.x);
  SimulateOptions longer = scenario.with(methods[1]);
  longer.to_time = 3.0;
  EXPECT_EQ(resume(system, longer, old, {}).events.size(), 1U);
}

// ---- levels ------------------------------------------------------------------------------------------------------

/// x = offset + amplitude cos(10 t), with `events` on the level `offset`.
Scenario oscillator(double offset, double amplitude, double periods) {
  return {R"("mass": { "type": "mechanics/mass", "mass": 1, "position": )" + exact(offset + amplitude) + R"( },
    "spring": { "type": "mechanics/spring_damper", "to": "mass.x", "stiffness": 100, "free_length": )" +
              exact(offset) + " }",
          R"("to_time": )" + exact(periods * 0.2 * std::numbers::pi) + R"(, "output_step": 1, "events": {
    "falls": { "of": "mass.x", "falls_below": )" +
              exact(offset) + R"(, "hold": { "none": 0 } },
    "rises": { "of": "mass.x", "rises_above": )" +
              exact(offset) + R"(, "hold": { "none": 0 } } })"};
}

std::pair<int, int> falls_and_rises(const Simulation& run) {
  std::pair<int, int> counts;
  for (const EventTaken& event : run.events) ++(event.name == "falls" ? counts.first : counts.second);
  return counts;
}

// Bands follow the motion and the rounding of the values, not the level.
TEST_P(Events, ASmallMotionAboutALevelCrossesIt) {
  struct Motion {
    double offset, amplitude, resolved;  // by which a time is, part of the period
  };
  for (const auto& [offset, amplitude, resolved] :
       {Motion{0.0, 1.0, 1e-6}, Motion{1.0, 1.0, 1e-6}, Motion{1.0, 1e-6, 1e-4}, Motion{-300.0, 1e-3, 1e-4},
        Motion{1.0, 1e-9, 3e-2}}) {
    SCOPED_TRACE("about " + exact(offset) + " by " + exact(amplitude));
    const Scenario scenario = oscillator(offset, amplitude, 5.0);
    SimulateOptions options = scenario.with(GetParam());
    const Simulation run = simulate(scenario.compiled.system, options, scenario.start(), {});
    EXPECT_EQ(falls_and_rises(run), std::make_pair(5, 5));
    const double period = 0.2 * std::numbers::pi, fixed_step = options.step > 0.0 ? 1e-4 : 0.0;
    for (std::size_t k = 0; k < run.events.size(); ++k)
      EXPECT_NEAR(run.events[k].time, (0.25 + 0.5 * static_cast<double>(k)) * period, (resolved + fixed_step) * period)
          << k;
  }
}

// One crossing is one event, however often a step looks at it again.
TEST_P(Events, EachCrossingCountsOnce) {
  const Scenario scenario = oscillator(0.0, 1.0, 40.0);
  SimulateOptions options = scenario.with(GetParam());
  for (const double tolerance : {1e-9, 1e-6, 1e-4}) {
    SCOPED_TRACE(tolerance);
    options.rel_tol = tolerance;
    const Simulation run = simulate(scenario.compiled.system, options, scenario.start(), {});
    EXPECT_EQ(falls_and_rises(run), std::make_pair(40, 40));
  }
}

// The same on a pendulum, whose state is put back onto its constraints at every event.
TEST_P(Events, EachCrossingOfAPendulumCountsOnce) {
  const Scenario scenario(R"("ground": { "type": "mechanics/ground" },
    "gravity": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] },
    "rod": { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.01, "position": [0.7, -0.7], "angle": 0.8,
             "gravity": "gravity" },
    "pin": { "type": "mechanics/planar_revolute", "a": "ground", "b": "rod", "point_b": [0, 1] })",
                          R"("to_time": 20, "output_step": 1, "events": {
    "falls": { "of": "rod.x", "falls_below": 0.3, "hold": { "none": 0 } }, "rises": { "of": "rod.x", "rises_above": 0.3, "hold": { "none": 0 } } })");
  SimulateOptions options = scenario.with(GetParam());
  for (const double tolerance : {1e-9, 1e-6, 1e-4}) {
    SCOPED_TRACE(tolerance);
    options.rel_tol = tolerance;
    const Simulation run = simulate(scenario.compiled.system, options, scenario.start(), {});
    const auto [falls, rises] = falls_and_rises(run);
    EXPECT_GE(falls, 9);
    EXPECT_LE(falls, 10);
    EXPECT_EQ(rises, 9);
    for (std::size_t k = 0; k < run.events.size(); ++k) EXPECT_EQ(run.events[k].name, k % 2 == 0 ? "falls" : "rises");
  }
}

/// A force against the motion, switched where the speed leaves a band about zero: a mass that starts at 1 m/s.
Scenario relay(double half_band) {
  return {R"("u": { "type": "signals/constant", "unit": "N", "value": -1 },
    "mass": { "type": "mechanics/mass", "mass": 1, "velocity": 1 },
    "push": { "type": "mechanics/coordinate_force", "on": "mass.x", "force": "u" })",
          R"("to_time": 2, "output_step": 0.25, "events": {
    "up":   { "of": "mass.x.rate", "rises_above": )" +
              exact(half_band) + R"(, "hold": { "u": -1 } },
    "down": { "of": "mass.x.rate", "falls_below": )" +
              exact(-half_band) + R"(, "hold": { "u": 1 } } })"};
}

// Levels nearer to each other than any band: each event puts the other one in order.
TEST_P(Events, ARelayHoldsOrIsStoppedByName) {
  for (const double half_band : {1e-2, 1e-3, 1e-11, 1e-13, 1e-16, 0.0}) {
    SCOPED_TRACE(half_band);
    const Scenario scenario = relay(half_band);
    const SimulateOptions options = scenario.with(GetParam());
    const State start = scenario.start();
    if (half_band > 1e-6) {
      const Simulation run = simulate(scenario.compiled.system, options, start, {});
      // From t = 1 + half_band on the speed goes to and fro in 4 half_band.
      EXPECT_NEAR(static_cast<double>(run.events.size()), 1.0 + (1.0 - half_band) / (2.0 * half_band), 1.0);
      EXPECT_NEAR(run.last.x[0], 0.5, half_band * half_band + 1e-7);
      continue;
    }
    try {
      simulate(scenario.compiled.system, options, start, {});
      FAIL() << "went on";
    } catch (const AnalysisError& error) {
      EXPECT_NE(std::string(error.what()).find("events follow each other without end"), std::string::npos)
          << error.what();
      EXPECT_TRUE(std::string(error.what()).find("up") != std::string::npos ||
                  std::string(error.what()).find("down") != std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace bramah
