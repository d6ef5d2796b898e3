// Laws that end: a run stops where a quantity leaves its limits, with every integrator at the same time; laws that go on
// are told of; no analysis begins outside.
#include "system/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "io/read_scene.hpp"
#include "solve/equilibrium.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"

namespace bramah::testing {
namespace {

using support::Method;
using ::testing::AllOf;
using ::testing::HasSubstr;

Compiled compiled(const std::string& text) { return compile(read_scene_text(text, "limits.json"), registry()); }

/// A disc without spin that falls flat from a lean of 0.3 rad.
const std::string disc = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "gravity": { "type": "mechanics/gravity" },
    "d": { "type": "mechanics/rolling_disc", "gravity": "gravity", "mass": 1, "A": 0.0225, "C": 0.045, "a": 0.3,
           "lean": 0.3 } },
  "simulate": { "to_time": 0.8, "rel_tol": 1e-9 } })";

/// A mass on a stroke of 0.9 m pulls oil through a small throttle; `p` is where the oil starts, `c_1` the dead length.
std::string suction(const std::string& p, const std::string& c_1) {
  return R"({ "bramah": 1, "libraries": ["mechanics", "hydraulics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "gravity": { "type": "mechanics/gravity", "acceleration": [0, 9.81, 0] },
    "m": { "type": "mechanics/planar_body", "mass": 1000, "inertia": 1, "position": [0, 0.9], "gravity": "gravity" },
    "s": { "type": "mechanics/planar_stroke", "a": "ground", "b": "m", "length": 0.9 },
    "sl": { "type": "mechanics/planar_slot", "a": "ground", "b": "m", "direction": [0, 1] },
    "P": { "type": "hydraulics/volume" }, "R": { "type": "hydraulics/volume" },
    "hP": { "type": "hydraulics/hose", "volume": "P", "V_h": 1e-5, "B_h": 1e9, "B_oil": 1.5e9 },
    "hR": { "type": "hydraulics/hose", "volume": "R", "V_h": 1e-5, "B_h": 1e9, "B_oil": 1.5e9 },
    "cyl": { "type": "hydraulics/cylinder", "stroke": "s.s", "piston_side": "P", "rod_side": "R", "D_2": 0.05,
             "D_3": 0.03, "l": 0.6, "c_1": )" +
         c_1 + R"(, "B_oil": 1.5e9, "B_c": 3e10 },
    "tank": { "type": "hydraulics/pressure_source", "p": 1e5 },
    "th": { "type": "hydraulics/throttle", "a": "P", "b": "tank", "C_d": 0.7, "A_t": "1 mm^2", "rho_oil": 850 },
    "th2": { "type": "hydraulics/throttle", "a": "R", "b": "tank", "C_d": 0.7, "A_t": "10 mm^2", "rho_oil": 850 } },
  "start": { "P.p": ")" +
         p + R"(", "R.p": "1 bar" }, "simulate": { "to_time": 0.2 } })";
}

class Limit : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, Limit, ::testing::ValuesIn(support::methods), support::name_of);
INSTANTIATE_TEST_SUITE_P(Automatic, Limit, ::testing::Values(support::automatic), support::name_of);

TEST_P(Limit, EndsTheRunWhereItIsReached) {
  const Compiled machine = compiled(disc);
  const SimulateOptions options = support::with(machine.options.simulate, GetParam());
  try {
    simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
    FAIL() << "the disc went through the floor";
  } catch (const SimulationError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("d.lean, reaches 1.5708 rad"), HasSubstr("lies flat on the plane")));
    EXPECT_EQ(error.pointer(), "/components/d");
    // (A + m a^2) lean'' = m g a sin(lean) from rest: the energy integral from 0.3 rad to pi/2. The fixed step of 1 ms
    // is of second order.
    EXPECT_NEAR(error.last().state.t, 0.4703312864881, GetParam().step > 0.0 ? 1e-5 : 1e-7);
  }
}

TEST_P(Limit, IsToldOfWhereTheLawGoesOn) {
  const Compiled machine = compiled(suction("1 bar", "0.5"));
  SimulateOptions options = support::with(machine.options.simulate, GetParam());
  if (options.step > 0.0) options.step = 1e-4;
  const Simulation run = simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
  ASSERT_EQ(run.limits_passed.size(), 1U);
  const LimitPassed& passed = run.limits_passed.front();
  EXPECT_EQ(passed.component, "P");
  EXPECT_EQ(passed.quantity, "p");
  EXPECT_GT(passed.first_time, 0.0);
  EXPECT_LT(passed.first_time, passed.farthest_time);
  // The oil tears: what is missing is vapour, w = p_w (3 dV/V)^(1/3).
  EXPECT_LT(passed.value, -1e3);
  EXPECT_GT(passed.value, -5e4);
}

std::string refusal(const std::string& scene, bool equilibrium) {
  const Compiled machine = compiled(scene);
  try {
    if (equilibrium) {
      find_equilibrium(machine.system, machine.options.equilibrium);
    } else {
      consistent_start(machine.system, machine.options, 0.0);
    }
  } catch (const AnalysisError& error) {
    return error.what();
  }
  return "";
}

TEST(Limits, HoldAtTheStart) {
  EXPECT_EQ(refusal(suction("1 bar", "0.5"), false), "");
  EXPECT_THAT(refusal(suction("-50 bar", "0.5"), false), AllOf(HasSubstr("P.p, is -5e+06 Pa, below -100000 Pa")));
  EXPECT_THAT(refusal(suction("-50 bar", "1.4"), false),
              AllOf(HasSubstr("P.p"), HasSubstr("cyl.l_2, is -0.5 m, below 0 m")));
}

TEST(Limits, HoldAtEquilibria) {
  // Nothing moves the mass: no weight in the plane, and no pressure.
  std::string scene = suction("0 bar", "1.4");
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"[0, 9.81, 0]", "[0, 0, -9.81]"},
                                 {R"("p": 1e5)", R"("p": 0)"},
                                 {R"("R.p": "1 bar")", R"("R.p": 0)"}})
    scene.replace(scene.find(from), from.size(), to);
  EXPECT_THAT(refusal(scene, true), HasSubstr("cyl.l_2, is -0.5 m, below 0 m: the law of cyl ends there"));
}

TEST(Limits, GiveANoteWhereTheLawGoesOn) {
  const Compiled machine = compiled(suction("-0.2 bar", "0.5"));
  const std::vector<StartNote> notes = start_notes(machine.system, machine.options, false, 0.0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].kind, "beyond a limit");
  EXPECT_THAT(notes[0].found, HasSubstr("P.p, is -20000 Pa, below 0 Pa"));
}

}  // namespace
}  // namespace bramah::testing
