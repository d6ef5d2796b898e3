// Settings from the command line, all the way to a compiled system or to the fault that it reports.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/read_scene.hpp"
#include "support/machine.hpp"
#include "system/compile.hpp"

namespace bramah {
namespace {

const char* const pendulum = R"({"bramah": 1, "libraries": ["mechanics"], "constants": {"m": "3 kg"},
  "components": {
    "ground": {"type": "mechanics/ground"},
    "rod": {"type": "mechanics/planar_body", "mass": "=m", "inertia": 0.5, "position": [1, 0]},
    "pin": {"type": "mechanics/planar_revolute", "a": "rod", "point_a": [-1, 0], "b": "ground"}}})";

Compiled with(const std::vector<std::string>& settings) {
  Scene scene = read_scene_text(pendulum, "pendulum.json");
  for (const std::string& setting : settings) apply_setting(scene, setting);
  return compile(scene, testing::registry());
}

/// Every fault of the scene after the settings.
std::vector<Diagnostic> faults(const std::vector<std::string>& settings) {
  try {
    with(settings);
  } catch (const SceneError& error) {
    return error.diagnostics();
  }
  return {};
}

Diagnostic only_fault(const std::string& setting) {
  const std::vector<Diagnostic> all = faults({setting});
  EXPECT_EQ(all.size(), 1U) << setting;
  return all.empty() ? Diagnostic{} : all.front();
}

TEST(Apply, ReachesTheSystem) {
  const Compiled result = with({"start.rod.angle=90 deg", "start.rod.x.rate=-2 cm/s", "simulate.to_time=2.5",
                                "simulate.from=equilibrium", "linearize.side=-", "rod.inertia=0.25 kg.m^2"});
  EXPECT_DOUBLE_EQ(result.system.x[2].start, 1.5707963267948966);
  EXPECT_EQ(result.system.x[0].start_rate, -0.02);
  EXPECT_EQ(result.options.simulate.to_time, 2.5);
  EXPECT_TRUE(result.options.simulate.asked);
  EXPECT_EQ(result.options.simulate.from, SimulateOptions::From::equilibrium);
  EXPECT_EQ(result.options.linearize.side, -1);
}

TEST(Apply, TheLastSettingCounts) { EXPECT_EQ(with({"start.rod.x=1", "start.rod.x=2"}).system.x[0].start, 2.0); }

TEST(Apply, TakesConstantsByName) {
  EXPECT_NO_THROW(with({"constants.I=2 kg.m^2", "rod.inertia==I"}));
  EXPECT_NO_THROW(with({"constants.m=5 kg"}));
  EXPECT_EQ(only_fault("rod.inertia==I").code, "unknown-constant");
}

TEST(Apply, ReconnectsPorts) {
  const Diagnostic fault = only_fault("pin.b=groud");
  EXPECT_EQ(fault.code, "unknown-component");
  EXPECT_EQ(fault.remedy, "did you mean \"ground\"?");
  EXPECT_EQ(only_fault("pin.b=rod.angle").code, "wrong-terminal");
}

TEST(Apply, FaultsAreThoseOfTheValue) {
  const auto expect = [](const std::string& setting, const std::string& code, const std::string& pointer) {
    const Diagnostic fault = only_fault(setting);
    EXPECT_EQ(fault.code, code) << setting;
    EXPECT_EQ(fault.pointer, pointer) << setting;
  };
  expect("rod.inertia=-1", "out-of-range", "/components/rod/inertia");
  expect("rod.inertia=1 kg", "wrong-unit", "/components/rod/inertia");
  expect("rod.inertia=1 kgm2", "unknown-unit", "/components/rod/inertia");
  expect("rod.inertia=inf", "number-out-of-range", "/components/rod/inertia");
  expect("rod.inertia=1e400", "number-out-of-range", "/components/rod/inertia");
  expect("rod.inertia=", "bad-number", "/components/rod/inertia");
  expect("rod.inertia=true", "wrong-kind", "/components/rod/inertia");
  expect("rod.position=1", "wrong-kind", "/components/rod/position");
  expect("rod.inerta=1", "unknown-key", "/components/rod/inerta");
  expect("rod.type=mechanics/planar_bodi", "unknown-type", "/components/rod/type");
  expect("start.rod.angel=1", "unknown-variable", "/start/rod.angel");
  expect("simulate.until=1", "unknown-key", "/simulate/until");
  expect("simulate.to_time=0", "out-of-range", "/simulate/to_time");
  expect("linearize.at=rest", "wrong-choice", "/linearize/at");
}

TEST(Apply, ManyFaultsAreReportedAtOnce) {
  EXPECT_EQ(
      faults({"rod.inertia=-1", "pin.b=nowhere", "start.rod.angel=1", "simulate.until=1", "rod.colour=red"}).size(),
      5U);
}

}  // namespace
}  // namespace bramah
