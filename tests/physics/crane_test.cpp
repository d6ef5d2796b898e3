// Hydraulic machines with valves that open and shut: an excavator's dig cycle, a crane against its end stops, and the
// parts of both alone, where motions are known in closed form.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ledger.hpp"
#include "moving.hpp"
#include "support/scene_parts.hpp"

namespace bramah::testing {
namespace {

using support::list;
using support::names;
using support::scene_of;

/// Oil of every volume and of all, and energy, each relative to what was turned over.
void expect_closed(const Ledger& ledger, double tolerance) {
  std::vector<OilAccount> accounts = ledger.oil();
  accounts.push_back(ledger.all_oil());
  double worst_oil = 0.0;
  for (const OilAccount& a : accounts) {
    EXPECT_TRUE(close(a.stored, a.entered, tolerance, a.passed)) << a.volume << ", of " << a.passed << " m^3";
    worst_oil = std::max(worst_oil, std::abs(a.stored - a.entered) / a.passed);
  }
  const EnergyAccount e = ledger.energy();
  EXPECT_TRUE(close(e.stored + e.dissipated, e.pumped + e.loads, tolerance, e.pumped))
      << "pumped " << e.pumped << " J, loads " << e.loads << " J, dissipated " << e.dissipated << " J, stored "
      << e.stored << " J";
  ::testing::Test::RecordProperty("oil", std::to_string(worst_oil * 1e12) + "e-12");
  ::testing::Test::RecordProperty(
      "energy", std::to_string((e.stored + e.dissipated - e.pumped - e.loads) / e.pumped * 1e12) + "e-12");
}

State start_of(const Machine& machine) { return consistent_start(machine.system(), machine.options(), 0.0); }

/// Height (m) of the teeth of the bucket above the ground.
double teeth(const Machine& machine, const State& state) {
  const double angle = machine.value(state, "bucket.angle");
  return machine.value(state, "bucket.y") + std::sin(angle) * 0.95 + std::cos(angle) * 0.25;
}

TEST(Excavator, DigsForTwentySeconds) {
  const Machine machine = load("scenes/crane/dig_cycle.json");
  const State start = start_of(machine);
  EXPECT_EQ(linear_model(machine, start).A.rows(), 41) << "2 x 6 motions, 26 pressures, flows and so on, 3 spools";

  Ledger ledger(machine);
  const Simulation cycle = ledger.keep(machine.options().simulate, start);
  EXPECT_EQ(cycle.last.t, 20.0);
  expect_closed(ledger, 1e-8);
  EXPECT_LT(cycle.statistics.energy.relative(), 1e-8) << "the engine's own book";
  EXPECT_NEAR(teeth(machine, cycle.last), teeth(machine, start), 0.5) << "back above the next cut";
}

TEST(Crane, MeetsItsStopsAndItsReliefValve) {
  const Machine machine = load("scenes/crane/end_stops.json");
  Ledger ledger(machine);
  const Simulation run = ledger.keep(machine.options().simulate, start_of(machine));
  expect_closed(ledger, 1e-8);
  const auto taken = [&](const std::string& name) {
    return std::count_if(run.events.begin(), run.events.end(), [&](const EventTaken& e) { return e.name == name; });
  };
  for (const char* event : {"relief.edge", "stops.upper_end", "stops.lower_end", "load_check.edge", "seal.break_away"})
    EXPECT_GE(taken(event), 1) << event;
}

TEST(Crane, StallsOnItsReliefValve) {
  // In the upper stop all that the pump delivers passes the relief valve: p = p_tank + p_crack + Q / G.
  Machine machine = load("scenes/crane/end_stops.json", {"simulate.to_time=4.5"});
  const Simulation run = simulate(machine.system(), machine.options().simulate, start_of(machine), {});
  const double Q = 35e-6 * 25.0;  // 35 cm^3/rev at 25 rev/s
  // To what the creep of the seal still takes.
  EXPECT_TRUE(close(machine.value(run.last, "supply.p"), 1e5 + 16e6 + Q / 1e-9, 1e-7));
  // The stop carries what the oil has more than the boom takes, here without the creep of the seal.
  EXPECT_GT(machine.value(run.last, "stops.depth"), 4e-3);
}

Simulation run(const Machine& machine, double end, double rel_tol = 1e-11) {
  SimulateOptions options = machine.options().simulate;
  options.to_time = end;
  options.rel_tol = rel_tol;
  return simulate(machine.system(), options, start_of(machine), {});
}
Machine machine_of(Scene scene) {
  Machine machine;
  machine.scene = std::move(scene);
  machine.compiled = compile(machine.scene, registry());
  return machine;
}

Machine bouncing(double damping) {
  return machine_of(
      scene_of("bounce", names({"mechanics"}),
               {{"m", Value::Object{{"type", "mechanics/mass"}, {"mass", 3.0}, {"position", 0.5}, {"velocity", 2.0}}},
                {"stop", Value::Object{{"type", "mechanics/end_stop"},
                                       {"along", "m.x"},
                                       {"lower", 0.0},
                                       {"upper", 1.0},
                                       {"stiffness", 3e5},
                                       {"damping", damping}}}}));
}

TEST(EndStop, BouncesLikeASpring) {
  // Half a period of m and k in each stop, free flight of 1 m between them.
  const double contact = std::numbers::pi * std::sqrt(3.0 / 3e5), period = 2.0 * (1.0 / 2.0 + contact);
  const Machine machine = bouncing(0.0);
  for (const int bounces : {1, 4}) {
    // A quarter of the way back, after an odd number of contacts.
    const double t = 0.25 + contact + 0.125 + 0.5 * period * (bounces - 1);
    const double sign = bounces % 2 == 1 ? -1.0 : 1.0;
    const Simulation s = run(machine, t);
    // Two restarts a contact; without them, errors at the kinks are a thousand times as large.
    EXPECT_TRUE(close(machine.value(s.last, "m.x"), bounces % 2 == 1 ? 0.75 : 0.25, 1e-7)) << bounces;
    EXPECT_TRUE(close(machine.value(s.last, "m.x.rate"), sign * 2.0, 1e-8)) << bounces;
    EXPECT_EQ(s.events.size(), 2U * static_cast<std::size_t>(bounces)) << "into and out of the stop";
  }
}

TEST(EndStop, LosesWhatHuntAndCrossleySay) {
  // v dv / (1 + chi v) = -(k / m) d dd: the primitive (v - ln(1 + chi v) / chi) / chi is that of impact and rebound.
  const double chi = 0.3;
  const auto primitive = [&](double v) { return (v - std::log1p(chi * v) / chi) / chi; };
  double low = -2.0, high = 0.0;  // the rebound, where primitive falls
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (primitive(middle) > primitive(2.0) ? low : high) = middle;
  }
  const Machine machine = bouncing(chi);
  const Simulation s = run(machine, 0.25 + 0.1);
  EXPECT_TRUE(close(machine.value(s.last, "m.x.rate"), low, 1e-8));
  EXPECT_LT(machine.value(s.last, "m.x"), 1.0) << "free again";
}

TEST(ReliefValve, LimitsTheRiseOfPressure) {
  // K pdot = Q up to p_crack, K pdot = Q - G (p - p_crack) beyond.
  const double K = 1e-3 * (1.0 / 1.5e9 + 1.0 / 7e8), Q = 1e-5 * 100.0, G = 2e-10;
  const Machine machine = machine_of(scene_of(
      "rise", names({"hydraulics", "signals"}),
      {{"tank", Value::Object{{"type", "hydraulics/pressure_source"}, {"p", 0.0}}},
       {"speed", Value::Object{{"type", "signals/constant"}, {"unit", "rad/s"}, {"value", 100.0}}},
       {"V", Value::Object{{"type", "hydraulics/volume"}}},
       {"hose",
        Value::Object{{"type", "hydraulics/hose"}, {"volume", "V"}, {"V_h", 1e-3}, {"B_h", 7e8}, {"B_oil", 1.5e9}}},
       {"pump", Value::Object{{"type", "hydraulics/pump"},
                              {"inlet", "tank"},
                              {"outlet", "V"},
                              {"speed", "speed"},
                              {"q", 1e-5},
                              {"p_set", 1e9},
                              {"alpha_min", 1.0}}},
       {"relief",
        Value::Object{{"type", "hydraulics/relief_valve"}, {"a", "V"}, {"b", "tank"}, {"p_crack", 2e7}, {"G_v", G}}}}));
  const double opens = K * (2e7 - 1e5) / Q;
  for (const double t : {0.5 * opens, opens + 2e-3, opens + 1e-2}) {
    const double expected = t < opens ? 1e5 + Q * t / K : 2e7 + Q / G * -std::expm1(-G * (t - opens) / K);
    const Simulation s = run(machine, t);
    EXPECT_TRUE(close(machine.value(s.last, "V.p"), expected, 1e-9)) << t;
    ASSERT_EQ(s.events.size(), t < opens ? 0U : 1U);
    if (t > opens) {
      EXPECT_EQ(s.events[0].name, "relief.edge");
      EXPECT_TRUE(close(s.events[0].time, opens, 1e-9));
    }
  }
}

TEST(StickSlip, CreepsBelowItsStaticFriction) {
  // m vdot = F - F_s v / v_b: sticks as a creep at v_b F / F_s.
  const double m = 20.0, F = 350.0, F_s = 500.0, v_b = 1e-3;
  const Machine machine = machine_of(
      scene_of("creep", names({"mechanics", "friction", "signals"}),
               {{"m", Value::Object{{"type", "mechanics/mass"}, {"mass", m}}},
                {"pull", Value::Object{{"type", "signals/constant"}, {"unit", "N"}, {"value", F}}},
                {"drive", Value::Object{{"type", "mechanics/coordinate_force"}, {"on", "m.x"}, {"force", "pull"}}},
                {"seal", Value::Object{{"type", "friction/stick_slip"},
                                       {"along", "m.x"},
                                       {"F_c", 300.0},
                                       {"F_s", F_s},
                                       {"v_b", v_b},
                                       {"v_s", 0.02}}}}));
  const double t = 5e-5, rate = F_s / (v_b * m);
  const Simulation s = run(machine, t);
  EXPECT_TRUE(close(machine.value(s.last, "m.x.rate"), F / F_s * v_b * -std::expm1(-rate * t), 1e-9));
}

}  // namespace
}  // namespace bramah::testing
