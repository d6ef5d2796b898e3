// Every integrator against closed forms and against each other; the rates that one-step methods integrate against the
// linearizer; events; checkpoints.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/checkpoint.hpp"
#include "solve/choose_integrator.hpp"
#include "solve/rates.hpp"
#include "solve/simulate.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"
#include "support/scene_parts.hpp"

namespace bramah {
namespace {

using Kind = SimulateOptions::Integrator;
using support::compiled;
using support::Method;
using support::methods;
using support::name_of;
using support::with;
using testing::load;
using testing::Machine;

class Integrators : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, Integrators, ::testing::ValuesIn(methods), name_of);

// A rod in free fall, thrown: the parabola is exact for every method but for rounding and the error tolerance.
Compiled thrown_rod() {
  Scene scene;
  scene.root = Value::Object{
      {"bramah", 1},
      {"libraries", Value::List{"mechanics", "signals"}},
      {"components", Value::Object{{"push", Value::Object{{"type", "signals/constant"}, {"unit", "N"}, {"value", 0.0}}},
                                   {"gravity", Value::Object{{"type", "mechanics/gravity"},
                                                             {"acceleration", support::list({0, -10, 0})}}},
                                   {"rod", Value::Object{{"type", "mechanics/planar_body"},
                                                         {"gravity", "gravity"},
                                                         {"mass", 2},
                                                         {"inertia", 0.5},
                                                         {"position", support::list({0, 5})},
                                                         {"velocity", support::list({1, 3})},
                                                         {"angular_velocity", 2}}},
                                   {"lift", Value::Object{{"type", "mechanics/planar_force"},
                                                          {"on", "rod"},
                                                          {"magnitude", "push"},
                                                          {"direction", support::list({0, 1})}}}}}};
  return compile(scene, testing::registry());
}

EventOptions event(const System& system, const std::string& name, const std::string& of, double level, bool rises) {
  EventOptions result;
  result.name = name;
  EXPECT_TRUE(find_measured(system, of, result.of)) << of;
  result.level = level;
  result.rises = rises;
  return result;
}

TEST_P(Integrators, StopWhereAConditionComesTrue) {
  const Compiled rod = thrown_rod();
  SimulateOptions options = with(rod.options.simulate, GetParam());
  options.to_time = 10.0;
  options.events.push_back(event(rod.system, "top", "rod.y.rate", 0.0, false));
  options.events.push_back(event(rod.system, "ground", "rod.y", 0.0, false));
  options.events.back().stop = true;
  const Simulation run = simulate(rod.system, options, consistent_start(rod.system, rod.options, 0.0), {});
  ASSERT_EQ(run.events.size(), 2U);
  EXPECT_EQ(run.events[0].name, "top");
  EXPECT_NEAR(run.events[0].time, 0.3, 1e-8);  // 3 - 10 t = 0
  EXPECT_EQ(run.stopped_by, "ground");
  const double fall = (3.0 + std::sqrt(109.0)) / 10.0;  // 5 + 3 t - 5 t^2 = 0
  EXPECT_NEAR(run.last.t, fall, 1e-8);
  EXPECT_NEAR(run.last.x[0], fall, 1e-8);
  EXPECT_NEAR(run.last.v[1], -std::sqrt(109.0), 1e-7);
}

// At the top a force of 40 N sets in: from there y = 5.45 + 5 (t - 0.3)^2.
TEST_P(Integrators, HoldInputsFromAConditionOn) {
  const Compiled rod = thrown_rod();
  SimulateOptions options = with(rod.options.simulate, GetParam());
  options.to_time = 1.3;
  options.events.push_back(event(rod.system, "top", "rod.y.rate", 0.0, false));
  options.events.back().holds = {{0, 40.0}};
  std::vector<double> at_event;
  Observer observer;
  observer.output = [&](const State& state) {
    if (std::abs(state.t - 0.3) < 1e-7) at_event.push_back(state.a[1]);
  };
  options.output_step = 0.25;
  const Simulation run = simulate(rod.system, options, consistent_start(rod.system, rod.options, 0.0), observer);
  ASSERT_EQ(at_event.size(), 2U) << "an output on either side";
  EXPECT_NEAR(at_event[0], -10.0, 1e-9);
  EXPECT_NEAR(at_event[1], 10.0, 1e-9);
  EXPECT_NEAR(run.last.x[1], 10.45, 1e-7);
  ASSERT_EQ(run.last.held.size(), 1U);
}

// The double pendulum of two rods: no closed form, but four methods with little in common.
TEST_P(Integrators, AgreeOnADoublePendulum) {
  const Compiled chain = compiled(support::planar_chain(2, support::bent(0.7)));
  SimulateOptions options = chain.options.simulate;
  options.to_time = 2.0;
  const State start = consistent_start(chain.system, chain.options, 0.0);
  options.integrator = Kind::explicit_one_step;
  options.rel_tol = 1e-12;
  const State expected = simulate(chain.system, options, start, {}).last;
  options = with(options, GetParam());
  options.rel_tol = 1e-9;
  options.step = GetParam().step > 0.0 ? 2.5e-4 : 0.0;  // second order: an error of about h^2 of the motion
  const double tolerance = GetParam().step > 0.0 ? 3e-5 : 2e-7;
  const State found = simulate(chain.system, options, start, {}).last;
  for (std::size_t i = 0; i < chain.system.x.size(); ++i)
    EXPECT_NEAR(found.x[i], expected.x[i], tolerance) << chain.system.x[i].name;
}

TEST_P(Integrators, AgreeOnTheHydraulicFourBar) {
  const Machine machine = load("scenes/four_bar/overdamped.json", {"simulate.to_time=1.2"});
  const State start = reference_state(machine.system(), machine.options(), true, 0.0);
  SimulateOptions options = machine.options().simulate;
  const Simulation expected = simulate(machine.system(), options, start, {});
  options = with(options, GetParam());
  options.rel_tol = GetParam().kind == Kind::ida ? 1e-7 : 1e-8;
  const Simulation found = simulate(machine.system(), options, start, {});
  const Index crank = machine.system().find_x("crank.angle"), oil = machine.system().find_z("V2.p");
  const auto at = [](const Vector& v, Index i) { return v[static_cast<std::size_t>(i)]; };
  const double swing = std::abs(at(expected.last.x, crank) - at(start.x, crank));
  ASSERT_GT(swing, 1e-5);
  EXPECT_NEAR(at(found.last.x, crank), at(expected.last.x, crank), 1e-3 * swing);
  EXPECT_NEAR(at(found.last.z, oil), at(expected.last.z, oil),
              1e-3 * std::abs(at(expected.last.z, oil) - at(start.z, oil)));
  EXPECT_LT(found.statistics.worst_position, 1e-9) << found.statistics.worst_position_row;
}

// Two halves through a file against one run: adaptive methods start anew, the fixed-step method has the same bits.
TEST_P(Integrators, GoOnFromACheckpoint) {
  const Machine machine = load("scenes/four_bar/overdamped.json", {"simulate.to_time=1.3"});
  const State start = reference_state(machine.system(), machine.options(), true, 0.0);
  SimulateOptions options = with(machine.options().simulate, GetParam());
  options.rel_tol = 1e-8;
  options.output_step = 0.01;
  Checkpoint saved;
  std::vector<double> times, values;
  const Index crank = machine.system().find_x("crank.angle");
  Observer observer;
  observer.output = [&](const State& state) {
    times.push_back(state.t);
    values.push_back(state.x[static_cast<std::size_t>(crank)]);
  };
  bool due = true;
  double reached = 0.0;
  observer.progress = [&](double time, double) {
    reached = time;
    return true;
  };
  observer.checkpoint_due = [&] { return reached > 1.05 && std::exchange(due, false); };
  observer.checkpoint = [&](const Checkpoint& checkpoint) { saved = checkpoint; };
  const Simulation whole = simulate(machine.system(), options, start, observer);
  ASSERT_GT(saved.state.t, 1.05);
  const Checkpoint read = read_checkpoint(machine.system(), {"saved", checkpoint_text(machine.system(), saved)});
  EXPECT_EQ(read.state.x, saved.state.x);
  EXPECT_EQ(read.state.zdot, saved.state.zdot);
  EXPECT_EQ(read.memory, saved.memory);

  const std::vector<double> first_times = std::exchange(times, {}), first = std::exchange(values, {});
  const Simulation rest = resume(machine.system(), options, read, observer);
  ASSERT_LT(times.size(), first_times.size());
  const std::size_t before = first_times.size() - times.size();
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_EQ(times[k], first_times[before + k]);
    if (GetParam().kind == Kind::generalized_alpha) {
      EXPECT_EQ(values[k], first[before + k]) << "not the same bits at t = " << times[k];
    } else {
      EXPECT_NEAR(values[k], first[before + k], 1e-8);
    }
  }
  EXPECT_EQ(rest.last.t, whole.last.t);
}

TEST(Checkpoints, BelongToOneIntegratorAndOneScene) {
  const Machine machine = load("scenes/four_bar/overdamped.json", {"simulate.to_time=0.01"});
  const State start = reference_state(machine.system(), machine.options(), true, 0.0);
  const Simulation run = simulate(machine.system(), machine.options().simulate, start, {});
  SimulateOptions options = machine.options().simulate;
  options.integrator = Kind::implicit_one_step;
  EXPECT_THROW(resume(machine.system(), options, run.checkpoint, {}), AnalysisError);
  const Compiled other = compiled(support::planar_chain(1));
  try {
    read_checkpoint(other.system, {"saved", checkpoint_text(machine.system(), run.checkpoint)});
    FAIL() << "a checkpoint of another scene was taken";
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("link_1.x"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("crank.x"), std::string::npos) << error.what();
  }
}

TEST(Automatic, TakesTheExplicitMethodForAPendulumAndIdaForOil) {
  const Compiled chain = compiled(support::planar_chain(3, support::bent(0.5)));
  SimulateOptions options = chain.options.simulate;
  options.integrator = Kind::automatic;
  const ChosenIntegrator loose =
      choose_integrator(chain.system, options, consistent_start(chain.system, chain.options, 0.0));
  EXPECT_EQ(loose.integrator->name(), "explicit") << loose.reason;
  const Machine oil = load("scenes/four_bar/overdamped.json");
  options = oil.options().simulate;
  options.integrator = Kind::automatic;
  const ChosenIntegrator stiff =
      choose_integrator(oil.system(), options, reference_state(oil.system(), oil.options(), true, 0.0));
  EXPECT_EQ(stiff.integrator->name(), "ida") << stiff.reason;
}

// J applied to a motion that keeps the constraints gives the accelerations and rates of the linearizer, and I - gamma J
// is what `solve` inverts.
TEST(RatesOfOneStepMethods, HaveTheLinearizersJacobian) {
  for (const char* scene : {"scenes/four_bar/overdamped.json", "scenes/four_bar/spatial.json",
                            "scenes/bicycle/benchmark.json", "scenes/rolling/turning_disc.json"}) {
    const Machine machine = load(scene);
    const System& system = machine.system();
    State state = reference_state(system, machine.options(),
                                  machine.options().linearize.at == LinearizeOptions::At::equilibrium, 0.0);
    Linearizer linearizer(system, choose_partition(system, state));
    LinearModel model;
    linearizer.linearize(state, model);
    Rates rates(system, state);
    rates.linearize(state);
    const auto n = static_cast<Eigen::Index>(system.n()), nz = static_cast<Eigen::Index>(system.nz());
    Vector in(static_cast<std::size_t>(2 * n + nz)), out(in.size()), back(in.size());
    for (Eigen::Index j = 0; j < model.A.cols(); ++j) {
      Eigen::Map<Eigen::VectorXd>(in.data(), 2 * n + nz) = linearizer.motion().col(j).head(2 * n + nz);
      rates.apply(in, out);
      Eigen::VectorXd expected(2 * n + nz);
      expected << linearizer.motion().col(j).segment(n, n), linearizer.response().col(j).head(n),
          linearizer.response().col(j).tail(nz);
      const double size = expected.lpNorm<Eigen::Infinity>();
      const Eigen::Map<const Eigen::VectorXd> found(out.data(), 2 * n + nz);
      EXPECT_LE((found - expected).lpNorm<Eigen::Infinity>(), 1e-9 * size) << scene << ", state " << j;
      constexpr double gamma = 1e-3;
      ASSERT_TRUE(rates.factor(gamma)) << rates.singular();
      for (std::size_t i = 0; i < in.size(); ++i) back[i] = in[i] - gamma * out[i];
      rates.solve(back);
      for (std::size_t i = 0; i < in.size(); ++i)
        EXPECT_NEAR(back[i], in[i], 1e-9 * (1.0 + size)) << scene << ", state " << j << ", unknown " << i;
    }
  }
}

// All rods of the ladder lie flat at t = 0.72 s: every loop is singular there. All uprights turn alike, so the motion is
// that of one pendulum: J phi'' = -M g cos(phi), integrated here by a classical method of fourth order.
TEST(SingularPositions, AreCrossedOnTheRightBranch) {
  constexpr int loops = 5;
  const Compiled ladder = compiled(support::four_bar_ladder(loops));
  SimulateOptions options = ladder.options.simulate;
  options.integrator = Kind::explicit_one_step;
  options.to_time = 4.0;
  const double J = (loops + 1) / 3.0 + loops, M = ((loops + 1) / 2.0 + loops) * support::gravity;
  double angle = 0.5 * std::numbers::pi, rate = -1.0;
  constexpr double h = 1e-4;
  for (int k = 0; k < 40000; ++k) {
    const auto push = [&](double phi) { return -M * std::cos(phi) / J; };
    const double a1 = push(angle), a2 = push(angle + 0.5 * h * rate),
                 a3 = push(angle + 0.5 * h * (rate + 0.5 * h * a1)), a4 = push(angle + h * (rate + 0.5 * h * a2));
    angle += h * rate + h * h / 6.0 * (a1 + a2 + a3);
    rate += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  const State start = consistent_start(ladder.system, ladder.options, 0.0);
  for (const auto& [tolerance, bound] : {std::pair{1e-6, 1e-4}, {1e-8, 2e-6}, {1e-10, 2e-6}}) {
    options.rel_tol = tolerance;
    const Simulation run = simulate(ladder.system, options, start, {});
    const auto x = static_cast<std::size_t>(ladder.system.find_x("upright_0.x"));
    EXPECT_NEAR(run.last.x[x], 0.5 * std::cos(angle), bound) << "rel_tol " << tolerance;
    EXPECT_NEAR(run.last.x[x + 1], 0.5 * std::sin(angle), bound) << "rel_tol " << tolerance;
    EXPECT_LT(run.statistics.worst_position, 1e-9);
  }
}

// A rod falls through the point that a length is measured from: the length has no derivative there, and IDA does not get
// past. The error names the component, and the last good state lies just before.
TEST(Failures, NameTheComponentAndKeepTheLastGoodState) {
  Scene scene;
  scene.root = Value::Object{
      {"bramah", 1},
      {"libraries", Value::List{"mechanics"}},
      {"components",
       Value::Object{
           {"ground", Value::Object{{"type", "mechanics/ground"}}},
           {"gravity", Value::Object{{"type", "mechanics/gravity"}, {"acceleration", support::list({0, -10, 0})}}},
           {"rod", Value::Object{{"type", "mechanics/planar_body"},
                                 {"gravity", "gravity"},
                                 {"mass", 2},
                                 {"inertia", 0.5},
                                 {"position", support::list({0, 5})}}},
           {"height",
            Value::Object{{"type", "mechanics/planar_stroke"}, {"a", "ground"}, {"b", "rod"}, {"length", 5}}}}}};
  const Compiled machine = compile(scene, testing::registry());
  SimulateOptions options = machine.options.simulate;
  options.integrator = Kind::ida;
  options.to_time = 3.0;
  try {
    simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
    FAIL() << "it passed";
  } catch (const SimulationError& error) {
    // The body and the length that it closes are equally to blame.
    const bool of_body = error.found().find("limited by rod.y") != std::string::npos;
    EXPECT_EQ(error.pointer(), of_body ? "/components/rod" : "/components/height") << error.what();
    EXPECT_TRUE(of_body || error.found().find("limited by height.s") != std::string::npos) << error.what();
    EXPECT_NEAR(error.last().state.t, 1.0, 1e-3);  // 5 - 5 t^2 = 0
    EXPECT_TRUE(std::isfinite(error.last().state.x[1]));
  }
}

}  // namespace
}  // namespace bramah
