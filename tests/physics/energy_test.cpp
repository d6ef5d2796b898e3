// Energies and powers of components against closed forms, and the book that a simulation keeps of them.
#include <cmath>
#include <numbers>
#include <numeric>

#include "bramah/component.hpp"
#include "moving.hpp"
#include "solve/assemble.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"
#include "support/scene_parts.hpp"
#include "system/measure.hpp"

namespace bramah::testing {
namespace {

using support::list;
using support::scene_of;
using Kind = SimulateOptions::Integrator;

Machine machine_of(Scene scene) {
  Machine machine;
  machine.scene = std::move(scene);
  machine.compiled = compile(machine.scene, registry());
  return machine;
}
State start_of(const Machine& machine) { return consistent_start(machine.system(), machine.options(), 0.0); }
Simulation run(const Machine& machine, Kind integrator, double rel_tol, double to_time) {
  SimulateOptions options = machine.options().simulate;
  options.integrator = integrator;
  options.rel_tol = rel_tol;
  options.step = 1e-3;
  options.to_time = to_time;
  return simulate(machine.system(), options, start_of(machine), {});
}

// A mass between a spring with damper and a constant force.
constexpr double m = 2.0, k = 50.0, c = 3.0, F = 1.0, x_0 = 0.4, v_0 = -1.0;
Machine oscillator(double damping, double force) {
  return machine_of(
      scene_of("oscillator", Value::List{"mechanics", "signals"},
               {{"push", Value::Object{{"type", "signals/constant"}, {"unit", "N"}, {"value", force}}},
                {"mass", Value::Object{{"type", "mechanics/mass"}, {"mass", m}, {"position", x_0}, {"velocity", v_0}}},
                {"load", Value::Object{{"type", "mechanics/coordinate_force"}, {"on", "mass.x"}, {"force", "push"}}},
                {"spring",
                 Value::Object{
                     {"type", "mechanics/spring_damper"}, {"to", "mass.x"}, {"stiffness", k}, {"damping", damping}}}}));
}

class EnergyBook : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, EnergyBook,
                         ::testing::Values(Kind::ida, Kind::explicit_one_step, Kind::implicit_one_step,
                                           Kind::generalized_alpha));

TEST_P(EnergyBook, OfADampedOscillatorUnderLoad) {
  const Machine machine = oscillator(c, F);
  const Simulation simulation = run(machine, GetParam(), 1e-10, 3.0);
  const EnergyBalance& book = simulation.statistics.energy;
  ASSERT_EQ(book.unknown, "");
  const double x = simulation.last.x[0], v = simulation.last.v[0];
  const double at_start = 0.5 * m * v_0 * v_0 + 0.5 * k * x_0 * x_0, at_end = 0.5 * m * v * v + 0.5 * k * x * x;
  EXPECT_TRUE(close(book.at_start, at_start, 1e-15));
  EXPECT_TRUE(close(book.at_end, at_end, 1e-14));
  // The method of fixed steps is of second order: 1 ms against a period of 1.3 s.
  const double tolerance = GetParam() == Kind::generalized_alpha ? 2e-5 : 1e-7;
  EXPECT_TRUE(close(book.brought_in - book.taken_out, at_end - at_start, tolerance));
  EXPECT_LT(book.unaccounted, tolerance * at_start);
  EXPECT_EQ(book.most_taken_out, "spring");
  EXPECT_EQ(book.most_brought_in, "load");
}

TEST_P(EnergyBook, OfASpringThatLosesNothing) {
  const Machine machine = oscillator(0.0, 0.0);
  const Simulation simulation = run(machine, GetParam(), 1e-9, 10.0);
  const EnergyBalance& book = simulation.statistics.energy;
  EXPECT_EQ(book.brought_in, 0.0);
  EXPECT_EQ(book.taken_out, 0.0);
  EXPECT_TRUE(close(book.activity, book.at_start, 1e-3)) << "all of it is kinetic at times";
  EXPECT_TRUE(close(book.relative(), book.unaccounted / book.activity, 1e-15));
}

TEST(EnergyBookOfHydraulics, OfAHoseThatFills) {
  // p = p_s - (p_s - p_0) exp(-t G / K); the source gives p_s int Q dt = p_s K (p - p_0).
  constexpr double p_s = 2e7, p_0 = 1e5, G = 1e-11, V = 1e-3, B_oil = 1.5e9, B_h = 5e8, K = V * (1 / B_oil + 1 / B_h);
  const Machine machine = machine_of(scene_of(
      "filling", Value::List{"hydraulics"},
      {{"supply", Value::Object{{"type", "hydraulics/pressure_source"}, {"p", p_s}}},
       {"volume", Value::Object{{"type", "hydraulics/volume"}}},
       {"hose",
        Value::Object{{"type", "hydraulics/hose"}, {"volume", "volume"}, {"V_h", V}, {"B_h", B_h}, {"B_oil", B_oil}}},
       {"gap", Value::Object{{"type", "hydraulics/leakage"}, {"a", "supply"}, {"b", "volume"}, {"C_L", G}}}}));
  const Simulation simulation = run(machine, Kind::ida, 1e-11, 0.5);
  const EnergyBalance& book = simulation.statistics.energy;
  ASSERT_EQ(book.unknown, "");
  const double p = p_s - (p_s - p_0) * std::exp(-0.5 * G / K);
  EXPECT_TRUE(close(book.at_end, 0.5 * K * p * p, 1e-9));
  EXPECT_TRUE(close(book.brought_in, p_s * K * (p - p_0), 1e-9));
  EXPECT_TRUE(close(book.taken_out, p_s * K * (p - p_0) - 0.5 * K * (p * p - p_0 * p_0), 1e-9));
  EXPECT_EQ(book.most_brought_in, "supply");
  EXPECT_EQ(book.most_taken_out, "gap");
  // The powers now.
  EXPECT_TRUE(close(machine.value(simulation.last, "supply.power"), G * (p_s - p) * p_s, 1e-8));
  EXPECT_TRUE(close(machine.value(simulation.last, "gap.power"), -G * (p_s - p) * (p_s - p), 1e-8));
  EXPECT_TRUE(close(machine.value(simulation.last, "power"), p * G * (p_s - p), 1e-8)) << "what the hose takes";
}

TEST(EnergyBookOfConstraints, ThatMoveDoWork) {
  // A body on a shaker: the drive gives what it has, m v^2 / 2 with v = A omega cos(omega t).
  constexpr double A = 0.1, omega = 7.0;
  const Machine machine =
      machine_of(scene_of("shaker", Value::List{"mechanics"},
                          {{"body", Value::Object{{"type", "mechanics/planar_body"}, {"mass", m}, {"inertia", 1}}},
                           {"shaker", Value::Object{{"type", "mechanics/planar_shaker"},
                                                    {"body", "body"},
                                                    {"direction", list({1, 0})},
                                                    {"amplitude", A},
                                                    {"omega", omega}}}}));
  const Simulation simulation = run(machine, Kind::explicit_one_step, 1e-10, 1.0);
  const EnergyBalance& book = simulation.statistics.energy;
  const double v = A * omega * std::cos(omega), peak = 0.5 * m * A * A * omega * omega;
  EXPECT_TRUE(close(book.at_end, 0.5 * m * v * v, 1e-9));
  EXPECT_TRUE(close(book.at_start, peak, 1e-12));
  // Every quarter of a period all of it goes in or out: 4 quarters in 4 pi / 2 / omega = 0.898 s, the last one to t = 1 s.
  EXPECT_TRUE(close(book.taken_out - book.brought_in, book.at_start - book.at_end, 1e-7));
  EXPECT_TRUE(close(book.taken_out, 2.0 * peak + (peak - 0.5 * m * v * v), 2e-3))
      << "to steps across the turning points";
  EXPECT_LT(book.relative(), 1e-7);
  EXPECT_EQ(book.most_brought_in, "shaker");
  // f . v at some time: the drive carries the inertia.
  const double t = simulation.last.t;
  EXPECT_TRUE(close(machine.value(simulation.last, "shaker.power"),
                    -m * A * A * omega * omega * omega * std::sin(omega * t) * std::cos(omega * t), 1e-8));
}

TEST(EnergyBookAtRest, TakesRoundingForRounding) {
  // A door that hangs still: 287 J against the origin, and nothing moves.
  const Machine machine = load("scenes/redundant/door.json");
  const EnergyBalance book = run(machine, Kind::explicit_one_step, 1e-9, 1.0).statistics.energy;
  EXPECT_GT(book.at_start, 200.0);
  EXPECT_LT(book.activity, 1e-12);
  EXPECT_EQ(book.relative(), 0.0);
}

TEST(EnergyBookOfWrongRuns, ShowsThem) {
  // All error tests pass, and the energy is wrong: the pendulum's period by a third and more.
  const Machine machine = load("scenes/benchmarks/pendulum.json");
  EXPECT_GT(run(machine, Kind::ida, 1e-2, 10.0).statistics.energy.relative(), 0.1);
  EXPECT_LT(run(machine, Kind::ida, 1e-8, 10.0).statistics.energy.relative(), 1e-4);
  // Through singular positions. Loose formulas damp: whatever steps they take, most of the energy is gone after 30 s. At
  // 1e-3 over 10 s the loss would hang on the last bits of the start, 2 % or 9 %.
  const Machine ladder = load("scenes/benchmarks/four_bars.json");
  for (const double rel_tol : {3e-2, 2e-2, 1e-2}) {
    const Simulation wrong = run(ladder, Kind::ida, rel_tol, 30.0);
    const EnergyBalance& book = wrong.statistics.energy;
    const double lost = ladder.value(start_of(ladder), "energy") - ladder.value(wrong.last, "energy");
    EXPECT_GT(book.relative(), 0.5) << "rel_tol " << rel_tol;
    EXPECT_TRUE(close(book.at_start - book.at_end, lost, 1e-13)) << "rel_tol " << rel_tol;
    EXPECT_GE(book.unaccounted, (1.0 - 1e-13) * lost)
        << "nothing brings energy in or takes it out, rel_tol " << rel_tol;
  }
  EXPECT_LT(run(ladder, Kind::explicit_one_step, 1e-9, 10.0).statistics.energy.relative(), 1e-7);
}

TEST(EnergyOf, StiffMotionIsNotInventedByInterpolation) {
  // Between slow steps of a stiff machine slopes are not to be trusted; springs with dampers would take out what no one has.
  const Machine machine = load("scenes/benchmarks/flyball_governor.json");
  EXPECT_LT(run(machine, Kind::implicit_one_step, 1e-4, 10.0).statistics.energy.relative(), 0.01);
}

/// A mass that does not say what it stores.
struct Mute {
  Coordinate x;
  void describe(Description& is) {
    is.called("mute/mass", "a mass without a word");
    is.own("x", x, "m", "place");
  }
  template <class T>
  void balance(const At<T>&, Rows<T>& rows) const {
    rows.inertia(x, 2.0);
  }
};

TEST(EnergyOf, WhatIsNotSaidIsNamed) {
  const auto with_mute = std::make_shared<Registry>(
      std::vector<std::filesystem::path>{std::string(BRAMAH_BINARY_DIR) + "/lib/bramah/plugins"});
  with_mute->add(detail::library<Mute>("mute", "1.0.0"), "memory");
  Machine machine;
  machine.scene =
      scene_of("mute", Value::List{"mechanics", "mute"},
               {{"silent", Value::Object{{"type", "mute/mass"}}},
                {"spring", Value::Object{{"type", "mechanics/spring_damper"}, {"to", "silent.x"}, {"stiffness", k}}}});
  machine.compiled = compile(machine.scene, with_mute);
  State state = start_of(machine);
  state.x[0] = 0.1;
  const Simulation simulation = simulate(machine.system(), machine.options().simulate, state, {});
  EXPECT_EQ(simulation.statistics.energy.unknown, "silent (mute/mass) does not say what it stores");
  EXPECT_TRUE(close(machine.value(state, "spring.energy"), 0.5 * k * 0.01, 1e-15));
  try {
    FAIL() << machine.value(state, "energy") << ": the energy of the whole is not known";
  } catch (const AnalysisError& error) {
    EXPECT_EQ(error.pointer(), "/components/silent");
    EXPECT_NE(std::string(error.what()).find("silent (mute/mass)"), std::string::npos) << error.what();
  }
}

TEST(EnergyOf, TheWholeGrowsByThePowersOfAll) {
  // In motion, whatever moves: d(sum of E)/dt by extrapolated differences along the path against the sum of the powers.
  for (const char* scene :
       {"scenes/crane/dig_cycle.json", "scenes/four_bar/spatial.json", "scenes/redundant/stewart.json",
        "scenes/articulated_vehicle/straight.json", "scenes/rolling/disc.json", "scenes/bicycle/benchmark.json",
        "scenes/benchmarks/car_axis.json", "plugins/paper_four_bar/scene.json"}) {
    const Machine machine = load(scene);
    const System& system = machine.system();
    State state = start_of(machine);
    for (std::size_t i = 0; i < system.x.size(); ++i) state.v[i] += system.x[i].nominal * std::sin(double(i) + 1.0);
    assemble_velocities(system, state);
    complete(system, state);
    Energies energies(system);
    const auto energy = [&](double t) {
      State there = state;
      for (std::size_t i = 0; i < system.x.size(); ++i) {
        there.x[i] += t * (state.v[i] + 0.5 * t * state.a[i]);
        there.v[i] += t * state.a[i];
      }
      for (std::size_t i = 0; i < system.z.size(); ++i) there.z[i] += t * state.zdot[i];
      EXPECT_TRUE(energies.evaluate(there, true).ok()) << scene;
      return std::accumulate(energies.energy().begin(), energies.energy().end(), 0.0);
    };
    constexpr double h = 1e-4;
    const double rate = (8.0 * (energy(h / 2) - energy(-h / 2)) - (energy(h) - energy(-h))) / (6.0 * h);
    ASSERT_TRUE(energies.evaluate(state, true).ok()) << scene;
    EXPECT_TRUE(energies.unsaid().empty()) << scene;
    const Vector& powers = energies.power();
    const double turnover = std::accumulate(powers.begin(), powers.end(), energies.activity(),
                                            [](double sum, double power) { return sum + std::abs(power); });
    EXPECT_TRUE(close(machine.value(state, "power"), rate, 1e-7, turnover)) << scene;
  }
}

}  // namespace
}  // namespace bramah::testing
