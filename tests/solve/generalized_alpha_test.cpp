// Generalized-alpha against closed forms, against IDA, and against itself with half the step.
#include <SuiteSparse_config.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>

#include "io/read_scene.hpp"
#include "solve/assemble.hpp"
#include "solve/integrator.hpp"
#include "solve/kkt.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "system/analysis_error.hpp"

extern "C" std::size_t bramah_allocation_count();

namespace bramah {
namespace {

using namespace support;
using testing::close;
using testing::load;
using testing::Machine;

Machine machine_of(const Scene& scene) { return {scene, compile(scene, testing::registry())}; }

SimulateOptions fixed(double step, double rho = 0.8) {
  SimulateOptions options;
  options.integrator = SimulateOptions::Integrator::generalized_alpha;
  options.step = step;
  options.rho_infinity = rho;
  return options;
}

/// Steps of the integrator over breakpoints, each state completed, as `simulate` does it.
class March {
 public:
  March(const System& system, const SimulateOptions& options, const State& start)
      : system_(system),
        blocks_(system),
        kkt_(system, choose_partition(system, start).rows),
        integrator_(make_generalized_alpha(system, options, start)),
        state_(start) {}

  void begin(double end) {
    state_.side = 1;
    apply_inputs(system_, state_);
    complete();
    end_ = end;
    integrator_->begin(state_, end);
  }
  const State& step() {
    integrator_->interpolate(integrator_->step(), state_);
    return state_;
  }
  template <class Each>
  const State& to(double end, Each&& each) {
    while (state_.t < end) {
      begin(std::min(end, next_breakpoint(system_, state_.t)));
      while (state_.t < end_) each(step());
    }
    complete();
    return state_;
  }
  const State& to(double end) {
    return to(end, [](const State&) {});
  }
  void complete() { kkt_.complete(state_, blocks_); }
  Integrator& integrator() { return *integrator_; }
  State& state() { return state_; }
  Violation violation() { return constraint_violation(system_, state_, blocks_); }

 private:
  const System& system_;
  Blocks blocks_;
  Kkt kkt_;
  std::unique_ptr<Integrator> integrator_;
  State state_;
  double end_ = 0.0;
};

/// A body that turns on a spring: angle'' = -omega^2 angle from 1 rad at rest.
Machine oscillator(double omega) {
  return machine_of(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
      "wheel": { "type": "mechanics/planar_body", "mass": 1, "inertia": 1, "angle": 1 },
      "spring": { "type": "mechanics/torsion_spring", "to": "wheel.angle", "stiffness": )" +
                                        std::to_string(omega * omega) + " } } }",
                                    "oscillator.json"));
}

std::vector<double> series(const Machine& machine, const SimulateOptions& options, const std::string& name, int steps) {
  const State start = consistent_start(machine.system(), machine.options(), 0.0);
  March march(machine.system(), options, start);
  march.begin(1e6);
  std::vector<double> values{machine.value(march.state(), name)};
  for (int i = 0; i < steps; ++i) values.push_back(machine.value(march.step(), name));
  return values;
}

// With rho = 1 it is the trapezoidal rule: x_n = cos(2 n atan(omega h / 2)), without damping at any frequency.
TEST(GeneralizedAlpha, IsTheTrapezoidalRuleWithoutDamping) {
  for (const double omega : {1.0, 20.0, 3000.0}) {
    const std::vector<double> found = series(oscillator(omega), fixed(0.01, 1.0), "wheel.angle", 1000);
    for (std::size_t n = 0; n < found.size(); n += 37) {
      const double expected = std::cos(2.0 * static_cast<double>(n) * std::atan(omega * 0.005));
      EXPECT_TRUE(close(found[n], expected, 1e-8, 1.0)) << "omega = " << omega << ", step " << n;
    }
  }
}

// At infinite frequency all three roots of the oscillator are -rho, hence x_{n+3} + 3 rho x_{n+2} + 3 rho^2 x_{n+1} +
// rho^3 x_n = 0, up to (omega h)^-2 = 1e-10.
TEST(GeneralizedAlpha, DampsInfiniteFrequencyByRho) {
  for (const double rho : {0.0, 0.3, 0.8, 1.0}) {
    const std::vector<double> x = series(oscillator(1e7), fixed(0.01, rho), "wheel.angle", 12);
    for (std::size_t n = 1; n + 3 < x.size(); ++n) {
      const double sum = x[n + 3] + 3.0 * rho * x[n + 2] + 3.0 * rho * rho * x[n + 1] + rho * rho * rho * x[n];
      EXPECT_NEAR(sum, 0.0, 1e-8) << "rho = " << rho << ", step " << n;
    }
    EXPECT_GT(std::abs(x[1]), 0.1 * rho) << "the recurrence is not satisfied by zeros alone";
  }
}

// A spool that lags its reference by tau << h: both roots of the variable and its rate are -rho, up to tau / h.
TEST(GeneralizedAlpha, DampsFirstOrderVariablesByRho) {
  const Machine machine = machine_of(read_scene_text(R"({ "bramah": 1, "libraries": ["hydraulics", "signals"],
      "components": {
        "supply": { "type": "hydraulics/pressure_source", "p": "7 MPa" },
        "zero": { "type": "signals/constant", "value": 0 },
        "valve": { "type": "hydraulics/directional_valve", "pump": "supply", "tank": "supply", "A": "supply",
                   "B": "supply", "reference": "zero", "C_v": 1e-8, "tau": 1e-12 } },
      "start": { "valve.U": 1 } })",
                                                     "spool.json"));
  for (const double rho : {0.0, 0.3, 0.8}) {
    const std::vector<double> U = series(machine, fixed(0.001, rho), "valve.U", 12);
    for (std::size_t n = 1; n + 2 < U.size(); ++n) {
      EXPECT_NEAR(U[n + 2] + 2.0 * rho * U[n + 1] + rho * rho * U[n], 0.0, 1e-7) << "rho = " << rho << ", step " << n;
    }
    EXPECT_GT(std::abs(U[1]), 0.1 * rho);
  }
}

// ---- order and agreement with IDA --------------------------------------------------------------------------------

struct Motion {
  std::string name;
  Machine machine;
  double from, end, step;  // s; the step is halved twice
  std::vector<std::string> numbers;
  bool from_equilibrium = false;
};

std::vector<Motion> motions() {
  std::vector<Motion> list;
  list.push_back({"double pendulum",
                  machine_of(planar_chain(2, bent(0.8))),
                  0.0,
                  1.0,
                  2e-3,
                  {"link_1.x", "link_2.angle", "link_2.angle.rate", "joint_1.lambda_x", "joint_2.lambda_y"}});
  list.push_back({"chain in space",
                  machine_of(spatial_chain(2, Axes::alternating, bent(0.8))),
                  0.0,
                  0.5,
                  2e-3,
                  {"link_1.x", "link_2.e1", "link_2.e2.rate", "joint_2.lambda_z"}});
  list.push_back({"skate",
                  load("scenes/rolling/skate.json", {"start.skate.angle.rate=3"}),
                  0.0,
                  1.0,
                  4e-3,
                  {"skate.x", "skate.y", "skate.angle", "skate.angle.rate", "edge.lambda_edge"}});
  list.push_back(
      {"disc",
       load("scenes/rolling/disc.json", {"start.wheel.lean.rate=1"}),
       0.0,
       1.0,
       2e-3,
       {"wheel.x", "wheel.y", "wheel.yaw", "wheel.lean.rate", "wheel.lambda_contact", "wheel.lambda_rolling_y"}});
  // The load of 250 N.m, under which they rest, falls off at 1.5 s.
  for (const char* friction : {"overdamped", "underdamped_high_friction", "underdamped_low_friction"}) {
    list.push_back({friction,
                    load("scenes/four_bar/" + std::string(friction) + ".json"),
                    1.49,
                    1.505,
                    1e-4,
                    {"crank.angle", "crank.angle.rate", "V1.p", "V2.p", "V3.p", "O1.lambda_y"},
                    true});
  }
  return list;
}

// Against IDA: the error falls by four as the step is halved, in positions, rates, pressures and multipliers.
TEST(GeneralizedAlpha, IsOfSecondOrderAndAgreesWithIda) {
  for (const Motion& motion : motions()) {
    SCOPED_TRACE(motion.name);
    const Machine& machine = motion.machine;
    const State start = reference_state(machine.system(), machine.options(), motion.from_equilibrium, motion.from);
    SimulateOptions options;
    options.output_step = 1e9;
    options.from_time = motion.from;
    options.to_time = motion.end;
    options.rel_tol = 1e-12;
    const State exact = simulate(machine.system(), options, start, {}).last;
    std::vector<State> found;
    for (double h = motion.step; found.size() < 3; h *= 0.5) {
      March march(machine.system(), fixed(h), start);
      double position = 0.0, velocity = 0.0;
      found.push_back(march.to(motion.end, [&](const State&) {
        const Violation v = march.violation();
        position = std::max(position, v.position);
        velocity = std::max(velocity, v.velocity);
      }));
      EXPECT_LT(position, 1e-11) << "h = " << h;
      EXPECT_LT(velocity, 1e-10) << "h = " << h;
    }
    for (const std::string& name : motion.numbers) {
      const double expected = machine.value(exact, name);
      std::vector<double> error;
      for (const State& state : found) error.push_back(machine.value(state, name) - expected);
      for (std::size_t i = 0; i < 2; ++i) {
        const double order = std::log2(std::abs(error[i] / error[i + 1]));
        EXPECT_NEAR(order, 2.0, 0.1) << name << " = " << expected << ", errors " << error[i] << " and " << error[i + 1];
      }
    }
  }
}

// ---- constraints -------------------------------------------------------------------------------------------------

// A thousand seconds of a pendulum that swings by 80 degrees: both levels hold at every step, whatever rho.
TEST(GeneralizedAlpha, HoldsConstraintsForAThousandSeconds) {
  const Machine machine = machine_of(planar_chain(1, bent(1.4)));
  const State start = consistent_start(machine.system(), machine.options(), 0.0);
  for (const double rho : {0.5, 0.9, 1.0}) {
    March march(machine.system(), fixed(0.01, rho), start);
    double position = 0.0, velocity = 0.0;
    march.to(1000.0, [&](const State&) {
      const Violation v = march.violation();
      position = std::max(position, v.position);
      velocity = std::max(velocity, v.velocity);
    });
    EXPECT_LT(position, 1e-13) << "rho = " << rho;
    EXPECT_LT(velocity, 1e-11) << "rho = " << rho;
    EXPECT_EQ(march.integrator().work().steps, 100000) << "rho = " << rho;
  }
}

// ---- the grid ----------------------------------------------------------------------------------------------------

TEST(GeneralizedAlpha, MeetsTheEndOfASegmentExactly) {
  const Machine machine = oscillator(1.0);
  const State start = consistent_start(machine.system(), machine.options(), 0.0);
  const auto times = [&](double end) {
    std::vector<double> list;
    March march(machine.system(), fixed(0.1), start);
    march.to(end, [&](const State& state) { list.push_back(state.t); });
    return list;
  };
  const auto expect = [](const std::vector<double>& found, std::size_t steps, double end) {
    ASSERT_EQ(found.size(), steps);
    EXPECT_DOUBLE_EQ(found.front(), std::min(0.1, end));
    EXPECT_EQ(found.back(), end);
  };
  expect(times(1.0), 10, 1.0);
  expect(times(1.03), 11, 1.03);
  expect(times(1.0 + 1e-12), 10, 1.0 + 1e-12);  // too little is left for a step of its own
  expect(times(0.04), 1, 0.04);
}

TEST(GeneralizedAlpha, InterpolatesBetweenSteps) {
  const Machine machine = oscillator(2.0);
  const State start = consistent_start(machine.system(), machine.options(), 0.0);
  constexpr double h = 0.01;
  March march(machine.system(), fixed(h), start);
  march.begin(1.0);
  for (int i = 0; i < 40; ++i) march.step();
  State state = march.state();
  for (const double t : {0.39, 0.3925, 0.395, 0.399, 0.4}) {
    march.integrator().interpolate(t, state);
    EXPECT_EQ(state.t, t);
    // Of the method itself: (omega h)^2 times a number of order one; of a line: (omega h)^2 / 8.
    EXPECT_TRUE(close(machine.value(state, "wheel.angle"), std::cos(2.0 * t), 3e-4, 1.0)) << t;
    EXPECT_TRUE(close(machine.value(state, "wheel.angle.rate"), -2.0 * std::sin(2.0 * t), 3e-4, 2.0)) << t;
  }
}

// ---- real time ---------------------------------------------------------------------------------------------------

std::size_t klu_allocations = 0;

// KLU takes its memory through SuiteSparse's own pointers.
class CountedKlu {
 public:
  CountedKlu() : malloc_(SuiteSparse_config.malloc_func), realloc_(SuiteSparse_config.realloc_func) {
    SuiteSparse_config.malloc_func = [](std::size_t size) { return ++klu_allocations, std::malloc(size); };
    SuiteSparse_config.realloc_func = [](void* old, std::size_t size) {
      return ++klu_allocations, std::realloc(old, size);
    };
  }
  ~CountedKlu() {
    SuiteSparse_config.malloc_func = malloc_;
    SuiteSparse_config.realloc_func = realloc_;
  }
  CountedKlu(const CountedKlu&) = delete;
  CountedKlu& operator=(const CountedKlu&) = delete;

 private:
  void* (*malloc_)(std::size_t);
  void* (*realloc_)(void*, std::size_t);
};

TEST(GeneralizedAlpha, AllocatesNothingAfterItsStart) {
  const CountedKlu counted;
  std::vector<Machine> machines;
  machines.push_back(load("scenes/four_bar/underdamped_high_friction.json"));
  machines.push_back(machine_of(planar_chain(3, bent(0.8))));
  for (const Machine& machine : machines) {
    const State start = reference_state(machine.system(), machine.options(), false, 0.0);
    March march(machine.system(), fixed(0.001), start);
    march.begin(1.0);
    const std::size_t own = bramah_allocation_count(), klu = klu_allocations;
    EXPECT_GT(own, 0U);
    EXPECT_GT(klu, 0U);
    const long factorizations = march.integrator().work().factorizations;
    for (int i = 0; i < 900; ++i) march.step();
    EXPECT_GT(march.integrator().work().factorizations, factorizations) << "a step that factors was among them";
    EXPECT_EQ(bramah_allocation_count(), own);
    EXPECT_EQ(klu_allocations, klu);
  }
}

// ---- checkpoints -------------------------------------------------------------------------------------------------

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// A run that is taken up by another integrator, made from another state, has the bits of one that never stopped:
// wherever it is interrupted, with factors of any age, across breakpoints and a shortened last step.
TEST(GeneralizedAlpha, GoesOnFromACheckpointWithTheSameBits) {
  struct Run {
    Machine machine;
    double step, end;
  };
  std::vector<Run> runs;
  runs.push_back({load("scenes/four_bar/underdamped_high_friction.json"), 0.003, 1.7});
  runs.push_back({machine_of(planar_chain(3, bent(0.8))), 0.01, 1.234});
  runs.push_back({machine_of(spatial_ladder(2)), 0.01, 0.5});
  runs.push_back({load("scenes/rolling/disc.json", {"start.wheel.lean.rate=1"}), 0.01, 2.0});
  long factorizations = 0;
  for (const Run& run : runs) {
    const System& system = run.machine.system();
    const State start = consistent_start(system, run.machine.options(), 0.0);
    struct Checkpoint {
      State state;
      Vector memory;
      double end;
    };
    std::vector<Checkpoint> checkpoints;
    const auto end_of = [&](double t) { return std::min(run.end, next_breakpoint(system, t)); };
    double segment = end_of(0.0);
    March whole(system, fixed(run.step), start);
    int steps = 0;
    whole.to(run.end, [&](const State& state) {
      if (++steps % 37 == 0) checkpoints.push_back({state, whole.integrator().memory(), segment});
      if (state.t == segment) segment = end_of(state.t);
    });
    ASSERT_GT(checkpoints.size(), 0U);
    factorizations += whole.integrator().work().factorizations;
    for (const Checkpoint& checkpoint : checkpoints) {
      if (checkpoint.state.t >= checkpoint.end) continue;
      March rest(system, fixed(run.step), checkpoint.state);
      rest.begin(checkpoint.end);
      rest.integrator().recall(checkpoint.memory);
      while (rest.state().t < checkpoint.end) rest.step();
      rest.to(run.end);
      EXPECT_TRUE(same_bits(rest.state().x, whole.state().x)) << "from t = " << checkpoint.state.t;
      EXPECT_TRUE(same_bits(rest.state().v, whole.state().v)) << "from t = " << checkpoint.state.t;
      EXPECT_TRUE(same_bits(rest.state().z, whole.state().z)) << "from t = " << checkpoint.state.t;
    }
  }
  EXPECT_GT(factorizations, 20);
}

TEST(GeneralizedAlpha, RefusesTheCheckpointOfAnotherScene) {
  const Machine one = machine_of(planar_chain(1)), two = machine_of(planar_chain(2));
  const State start_one = consistent_start(one.system(), one.options(), 0.0),
              start_two = consistent_start(two.system(), two.options(), 0.0);
  March a(one.system(), fixed(0.01), start_one), b(two.system(), fixed(0.01), start_two);
  a.begin(1.0);
  b.begin(1.0);
  const Vector memory = b.integrator().memory();
  EXPECT_THROW(a.integrator().recall(memory), AnalysisError);
  EXPECT_THROW(b.integrator().recall(std::span(memory).first(10)), AnalysisError);
}

// ---- refusals ----------------------------------------------------------------------------------------------------

// Half a second is too long for a four-bar that falls over.
TEST(GeneralizedAlpha, NamesWhatKeepsItFromGoingOn) {
  const Machine machine = machine_of(four_bar_ladder(1));
  const State start = consistent_start(machine.system(), machine.options(), 0.0);
  SimulateOptions options = fixed(0.5);
  options.to_time = 20.0;
  try {
    simulate(machine.system(), options, start, {});
    FAIL() << "it passed";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.found(),
              "at t = 0.5 s with a step of 0.5 s Newton's method did not converge; with a shorter \"step\" it may; the "
              "step was limited by across_1.x.rate");
    EXPECT_EQ(error.pointer(), "/components/across_1");
    EXPECT_EQ(error.last().state.t, 0.0);
  }
}

TEST(GeneralizedAlpha, RefusesStepsAndRadiiThatAreNone) {
  const Machine machine = machine_of(planar_chain(1));
  const State start = consistent_start(machine.system(), machine.options(), 0.0);
  EXPECT_THROW(make_generalized_alpha(machine.system(), fixed(0.0), start), AnalysisError);
  EXPECT_THROW(make_generalized_alpha(machine.system(), fixed(0.01, 1.1), start), AnalysisError);
  EXPECT_THROW(make_generalized_alpha(machine.system(), fixed(0.01, -0.1), start), AnalysisError);
}

// ---- as a scene asks for it --------------------------------------------------------------------------------------

TEST(GeneralizedAlpha, IsChosenByTheScene) {
  const Machine machine = load("scenes/four_bar/overdamped.json", {"simulate.integrator=generalized_alpha",
                                                                   "simulate.step=1 ms", "simulate.rho_infinity=0.6"});
  const SimulateOptions& options = machine.options().simulate;
  EXPECT_EQ(options.rho_infinity, 0.6);
  const State start = reference_state(machine.system(), machine.options(), true, 0.0);
  std::vector<double> times;
  Observer observer;
  observer.output = [&](const State& state) { times.push_back(state.t); };
  const Simulation run = simulate(machine.system(), options, start, observer);
  EXPECT_EQ(run.statistics.integrator, "generalized_alpha");
  EXPECT_EQ(run.last.t, 3.0);
  EXPECT_EQ(times.size(), 603U);  // every 5 ms, twice where the torque bends and where it falls off
  EXPECT_LT(run.statistics.worst_position, 1e-13);
  EXPECT_LT(run.statistics.worst_velocity, 1e-11);
  // The crank has turned by 3.5e-5 rad and is back; 1 ms is long against its 0.7 ms.
  const SimulateOptions reference = load("scenes/four_bar/overdamped.json").options().simulate;
  const State ida = simulate(machine.system(), reference, start, {}).last;
  EXPECT_NEAR(machine.value(run.last, "crank.angle"), machine.value(ida, "crank.angle"), 0.01 * 3.5e-5);
  EXPECT_TRUE(close(machine.value(run.last, "V1.p"), machine.value(ida, "V1.p"), 1e-9));
}

}  // namespace
}  // namespace bramah
