// `bramah sweep` and `bramah critical` against closed forms, references and themselves.
#include <gmock/gmock.h>

#include <cmath>

#include "app/cli.hpp"
#include "support/numbers.hpp"
#include "support/reference.hpp"

namespace bramah {
namespace {

using testing::close;
using ::testing::HasSubstr;

const std::string bicycle = "'" BRAMAH_SOURCE_DIR "/scenes/bicycle/benchmark.json'";
const std::string top = "'" BRAMAH_SOURCE_DIR "/scenes/linear/sleeping_top.json'";

/// A mass on a spring with a damper, swept as `sweep` says.
std::string oscillator(const std::string& sweep) {
  return R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "m": { "type": "mechanics/mass", "mass": 2 },
    "k": { "type": "mechanics/spring_damper", "to": "m", "stiffness": 8, "damping": 0 } },
  "linearize": { "at": "start" }, "sweep": )" +
         sweep + " }";
}

TEST_F(Cli, CriticalSpeedsOfTheBicycle) {
  const auto exact = testing::reference("bicycle.json")["exact"];
  const auto entry = [&](const char* matrix, std::size_t i, std::size_t j) {
    return testing::number(exact[matrix][i][j]);
  };
  // Capsize: det(g K0 + v^2 K2) = 0, with no lean column in K2.
  const double capsize =
      std::sqrt(-9.81 * (entry("K0", 0, 0) * entry("K0", 1, 1) - entry("K0", 0, 1) * entry("K0", 1, 0)) /
                (entry("K0", 0, 0) * entry("K2", 1, 1) - entry("K2", 0, 1) * entry("K0", 1, 0)));
  for (const char* range : {"0.2:9:45", "9:0.2:12", "-2:9:23"}) {
    const json d = document("sweep " + bicycle + " --over constants.v=" + range);
    ASSERT_EQ(d.at("critical").size(), 2U) << range;
    const bool ascending = range[0] != '9';
    const json &weave = d.at("critical")[ascending ? 0 : 1], &fall = d.at("critical")[ascending ? 1 : 0];
    EXPECT_TRUE(close(weave.at("at")[0], testing::number(exact["speeds"]["v_weave"]), 1e-11)) << range;
    EXPECT_TRUE(weave.at("oscillatory").get<bool>());
    EXPECT_EQ(weave.at("becomes"), ascending ? "stable" : "unstable");
    EXPECT_TRUE(close(fall.at("at")[0], capsize, 1e-11)) << range;
    EXPECT_FALSE(fall.at("oscillatory").get<bool>());
    EXPECT_EQ(fall.at("becomes"), ascending ? "unstable" : "stable");
    double nearest = HUGE_VAL;
    const double merge = testing::number(exact["speeds"]["v_double_root"]);
    for (const json& branch : d.at("branch_points")) {
      if (std::abs(branch.at("at")[0].get<double>() - merge) < std::abs(nearest - merge)) nearest = branch.at("at")[0];
    }
    EXPECT_TRUE(close(nearest, merge, 1e-11)) << range;
    EXPECT_TRUE(d.at("failures").empty());
    for (const json& point : d.at("points")) EXPECT_EQ(point.at("zeros"), 6);
  }
  EXPECT_THAT(bramah("critical " + bicycle + " --over constants.v=0.2:9:45").out, HasSubstr("4.29238253634"));
}

TEST_F(Cli, SweepDoesNotDependOnTheNumberOfThreads) {
  const std::string sweep = "sweep " + bicycle + " --quiet --over constants.v=0:10:60 --over frame.mass=80:90:3";
  for (const char* threads : {"1", "2"}) {
    const Ended run = bramah(sweep + " --out " + threads + " --threads " + threads);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }
  for (const char* file : {"sweep.json", "sweep.csv", "root_locus.svg", "real_parts.svg", "frequencies.svg"}) {
    EXPECT_EQ(contents(folder_ / "1" / file), contents(folder_ / "2" / file)) << file;
    EXPECT_GT(contents(folder_ / "1" / file).size(), 500U) << file;
  }
}

TEST_F(Cli, SweepSetsAsSettingsDo) {
  // A single point is what `modes` gives with --set, bit by bit: the partition is that of the first point.
  const json d = document("sweep " + bicycle + " --over constants.v=3,4.5,7");
  const std::string settings = "modes " + bicycle + " --set constants.v=";
  for (const json& point : d.at("points")) {
    const std::string value = point.at("at")[0].dump();
    std::vector<double> expected, found;
    const json modes = document(settings + value);
    for (const json& e : modes.at("eigenvalues")) {
      if (!e.at("zero").get<bool>()) expected.push_back(e.at("re"));
    }
    for (const json& re : point.at("re")) found.push_back(re);
    EXPECT_THAT(found, ::testing::UnorderedElementsAreArray(expected)) << value;
  }
}

TEST_F(Cli, SweepOverAGridFindsWhereDampingVanishes) {
  write("o.json", oscillator(R"({ "parameter": "k.damping", "from": -1, "to": "2 N.s/m", "count": 8,
                                  "second": { "parameter": "k.stiffness", "values": [2, 8, 18] } })"));
  const json d = document("sweep o.json --out grid");
  ASSERT_EQ(d.at("points").size(), 24U);
  ASSERT_EQ(d.at("critical").size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const json& critical = d.at("critical")[i];
    EXPECT_LT(std::abs(critical.at("at")[0].get<double>()), 1e-14);
    const auto w = static_cast<double>(i + 1);  // sqrt(k / m)
    EXPECT_EQ(critical.at("at")[1], 2.0 * w * w);
    EXPECT_TRUE(close(critical.at("rad_s"), w, 1e-12));
    EXPECT_EQ(critical.at("becomes"), "stable");
    EXPECT_THAT(critical.at("states").get<std::string>(), HasSubstr("m.x"));
  }
  EXPECT_THAT(contents(folder_ / "grid" / "sweep.csv"),
              HasSubstr("k.damping,k.stiffness,zeros,m1.re,m1.im,m2.re,m2.im\n-1,2,0,"));
  for (const json& point : d.at("points")) {
    const double c = point.at("at")[0], k = point.at("at")[1];
    EXPECT_TRUE(close(point.at("re")[0], -c / 4.0, 1e-13, 1.0));
    EXPECT_TRUE(close(point.at("im")[0], std::sqrt(k / 2.0 - c * c / 16.0), 1e-13));
  }
}

TEST_F(Cli, ModesThatLeaveTheAxisAreCritical) {
  // Without damping nothing crosses: w^2 = k / m becomes negative at k = 0, on the grid and between its points.
  for (const char* range : {"3:-1:9", "3:-1:8", "-1:3:9", "-1:3:8"}) {
    write("o.json", oscillator("{}"));
    const json d = document(std::string("critical o.json --over k.stiffness=") + range);
    ASSERT_EQ(d.at("critical").size(), 1U) << range;
    EXPECT_LT(std::abs(d.at("critical")[0].at("at")[0].get<double>()), 1e-14) << range;
    EXPECT_FALSE(d.at("critical")[0].at("oscillatory").get<bool>());
    EXPECT_EQ(d.at("critical")[0].at("becomes"), range[0] == '3' ? "unstable" : "stable");
  }
  // The sleeping top: C w = 2 sqrt(A m g h), there both precessions have the rate C w / (2 A).
  const double A = 2e-4 + 0.1 * 0.06 * 0.06 + 3e-4 + 0.5 * 0.08 * 0.08, C = 5e-4;
  const double moment = 9.81 * (0.1 * 0.06 + 0.5 * 0.08), rate = 2.0 * std::sqrt(A * moment) / C;
  const json d = document("critical " + top + " --over rotor.rate=200:40:17");
  ASSERT_EQ(d.at("critical").size(), 1U);
  EXPECT_TRUE(close(d.at("critical")[0].at("at")[0], rate, 1e-11));
  EXPECT_TRUE(close(d.at("critical")[0].at("rad_s"), C * rate / (2.0 * A), 1e-9));
  EXPECT_TRUE(d.at("critical")[0].at("oscillatory").get<bool>());
  EXPECT_EQ(d.at("critical")[0].at("becomes"), "unstable");
}

TEST_F(Cli, SweepKeepsWhatSucceeds) {
  write("o.json", oscillator(R"({ "parameter": "m.mass", "values": ["-1 kg", 0, 1, 2], "second":
                                  { "parameter": "k.stiffness", "from": 1, "to": 2, "count": 2 } })"));
  const json d = document("sweep o.json");
  ASSERT_EQ(d.at("failures").size(), 4U);
  EXPECT_EQ(d.at("failures")[0].at("at")[0], -1);
  EXPECT_THAT(d.at("failures")[0].at("message").get<std::string>(), HasSubstr("/components/m/mass"));
  EXPECT_EQ(d.at("points").size(), 8U);
  EXPECT_THAT(bramah("sweep o.json").out, HasSubstr("No answer at -1 kg, 1 N/m"));

  write("none.json", oscillator(R"({ "parameter": "m.mass", "values": [-2, -1] })"));
  const Ended none = bramah("critical none.json");
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("\"mass\" is -2 kg"));
}

TEST_F(Cli, SweepRefusesWhatItCannotRead) {
  write("o.json", oscillator("{ \"parameter\": \"m.mass\", \"from\": 1, \"to\": 2 }"));
  const std::vector<std::tuple<std::string, int, std::string>> cases = {
      {"sweep " + bicycle, 3, "--over COMPONENT.PARAMETER=1:9:41"},
      {"sweep o.json --over k.stifness=1:2", 2, "did you mean \"k.stiffness\"?"},
      {"sweep o.json --over k.stiffness", 2, "constants.v=1:9:41"},
      {"sweep o.json --over k.stiffness=1:2:3:4", 2, "give a count"},
      {"sweep o.json --over m.mass=1:2 --over m.mass=3:4", 2, "a second time"},
      {"sweep o.json --over m.mass=1:2 --over k.damping=3:4 --over k.stiffness=1:2", 2, "two for a grid"},
      {"sweep o.json --over m.mass=1,3,2", 2, "all ascending or all descending"},
      {"sweep o.json --threads 0", 3, "--threads"},
      {"modes o.json --over m.mass=1:2", 3, "no option \"--over\""},
  };
  for (const auto& [arguments, code, expected] : cases) {
    const Ended run = bramah(arguments);
    EXPECT_EQ(run.code, code) << arguments << run.err;
    EXPECT_THAT(run.err, HasSubstr(expected)) << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
}

TEST_F(Cli, RespondsInTime) {
  // A volume V behind a laminar throttle follows its supply as 1 - exp(-t / T), T from the model itself.
  write("volume.json", R"({ "bramah": 1, "libraries": ["hydraulics", "signals"], "components": {
    "supply": { "type": "signals/table", "unit": "Pa", "times": [0, 1], "values": [1.1e6, 1.1e6] },
    "V": { "type": "hydraulics/volume" },
    "hose": { "type": "hydraulics/hose", "volume": "V", "V_h": "0.1 L", "B_h": "550 MPa", "B_oil": "1.5 GPa" },
    "throttle": { "type": "hydraulics/throttle", "a": "supply", "b": "V", "C_d": 0.8, "A_t": "1 mm^2", "rho_oil": 850 } },
    "start": { "V.p": "1 MPa" }, "linearize": { "at": "start" } })");
  const json d = document("respond volume.json --step 0.2:41 --impulse \"100 ms:11\" --output V.p --out .");
  const double rate = -document("modes volume.json").at("eigenvalues")[0].at("re").get<double>();
  const json& path = d.at("paths")[0];
  ASSERT_EQ(d.at("paths").size(), 1U);
  EXPECT_EQ(path.at("unit"), "Pa per Pa");
  ASSERT_EQ(path.at("step").size(), 41U);
  EXPECT_EQ(d.at("step_times_s")[40], 0.2);
  for (std::size_t k = 0; k < 41; ++k)
    EXPECT_TRUE(close(path.at("step")[k], -std::expm1(-rate * d.at("step_times_s")[k].get<double>()), 1e-12, 1.0));
  for (std::size_t k = 0; k < 11; ++k) {
    const double t = d.at("impulse_times_s")[k];
    EXPECT_TRUE(close(path.at("impulse")[k], rate * std::exp(-rate * t), 1e-12, rate));
  }
  EXPECT_THAT(contents(folder_ / "step.csv"), HasSubstr("time,supply to V.p\n0,0\n"));
  EXPECT_THAT(contents(folder_ / "impulse.svg"), HasSubstr("impulse of supply"));
  for (const auto& [arguments, code, expected] :
       std::vector<std::tuple<std::string, int, std::string>>{{"--step -1", 3, "TO:COUNT"},
                                                              {"--step 3m", 3, "TO:COUNT"},
                                                              {"--step 1:1", 3, "TO:COUNT"},
                                                              {"--input suply", 3, "did you mean \"supply\"?"},
                                                              {"--output V.q", 2, "\"V.q\""}}) {
    const Ended run = bramah("respond volume.json " + arguments);
    EXPECT_EQ(run.code, code) << arguments << run.err;
    EXPECT_THAT(run.err, HasSubstr(expected)) << arguments;
  }
}

/// An upright rod of mass m with its centre 1 m above a pin with a torsion spring of 49.05 N m, started 0.1 rad aslant.
std::string column(const std::string& sweep) {
  return R"({ "bramah": 1, "libraries": ["mechanics"], "constants": { "m": 1 }, "components": {
    "ground": { "type": "mechanics/ground" },
    "down": { "type": "mechanics/gravity", "acceleration": [0, -9.81, 0] },
    "rod": { "type": "mechanics/planar_body", "gravity": "down", "mass": "=m", "inertia": 0.3,
             "position": [-0.09983341664682815, 0.9950041652780258], "angle": 0.1 },
    "pin": { "type": "mechanics/planar_revolute", "a": "rod", "point_a": [0, -1], "b": "ground" },
    "spring": { "type": "mechanics/torsion_spring", "to": "rod.angle", "stiffness": 49.05 } }, "sweep": )" +
         sweep + " }";
}

// Beyond m = 5 kg the start values lead to a rod that leans; the family that is followed stands upright.
TEST_F(Cli, SweepFollowsOneFamilyThroughItsLossOfStability) {
  write("column.json", column(R"({ "parameter": "constants.m", "from": 1, "to": 9.3, "count": 12 })"));
  const json d = document("sweep column.json");
  ASSERT_EQ(d.at("critical").size(), 1U);
  EXPECT_EQ(d.at("critical")[0].at("kind"), "divergence");
  EXPECT_TRUE(close(d.at("critical")[0].at("at")[0], 5.0, 1e-11));
  EXPECT_TRUE(d.at("failures").empty());
  for (const json& point : d.at("points")) {
    const double m = point.at("at")[0];
    double largest = 0.0;
    for (const json& re : point.at("re")) largest = std::max(largest, re.get<double>());
    // (m + 0.3) s^2 = m g - k
    EXPECT_TRUE(close(largest * largest, std::max(0.0, m * 9.81 - 49.05) / (m + 0.3), 1e-9, 1e-6)) << m << " kg";
  }
  EXPECT_EQ(d.at("equilibrium").at("stability").at("undamped"), 1);
  EXPECT_TRUE(close(d.at("equilibrium").at("moved").at("rod.angle").at("from"), 0.1, 1e-12));
}

/// An arch of a mass and a spring of stiffness k and free length L, a load F upon it: F(y) = k (L / l - 1) y, l = sqrt(1 + y^2)
/// is largest where l^3 = L.
std::string arch(const std::string& sweep) {
  return R"({ "bramah": 1, "libraries": ["mechanics", "signals"], "constants": { "F": 0, "k": 2000 }, "components": {
    "ground": { "type": "mechanics/ground" },
    "m": { "type": "mechanics/planar_body", "mass": 1, "inertia": 1, "position": [0, 0.3] },
    "rail": { "type": "mechanics/planar_slot", "a": "ground", "b": "m", "direction": [0, 1] },
    "upright": { "type": "mechanics/planar_slot", "a": "ground", "b": "m", "direction": [0, 1], "point_b": [0, 0.5] },
    "s": { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [-1, 0], "b": "m", "length": 1.04 },
    "spring": { "type": "mechanics/spring_damper", "to": "s.s", "stiffness": "=k", "damping": 20,
                "free_length": 1.044030650891055 },
    "load": { "type": "signals/constant", "unit": "N", "value": "=F" },
    "force": { "type": "mechanics/planar_force", "on": "m", "direction": [0, -1], "magnitude": "load" } },
  "sweep": )" +
         sweep + " }";
}

double limit_load(double k) {
  const double L = 1.044030650891055, l = std::cbrt(L);
  return k * (L / l - 1.0) * std::sqrt(l * l - 1.0);
}

TEST_F(Cli, CriticalFindsTheFoldOfAnArchFromBothSides) {
  for (const auto& [from, to, expected] :
       {std::tuple{0.0, 30.0, 1.0}, {0.0, 9.95, 1.0}, {30.0, -30.0, -1.0}, {-1.0, 1000.0, 1.0}}) {
    write("arch.json", arch("{ \"parameter\": \"constants.F\", \"from\": " + std::to_string(from) +
                            ", \"to\": " + std::to_string(to) + ", \"count\": 7 }"));
    const json d = document("critical arch.json");
    ASSERT_EQ(d.at("critical").size(), 1U) << from << " ... " << to;
    const json& fold = d.at("critical")[0];
    EXPECT_EQ(fold.at("kind"), "fold");
    EXPECT_EQ(fold.at("becomes"), "no equilibrium");
    EXPECT_THAT(fold.at("states").get<std::string>(), HasSubstr("m.y = "));
    EXPECT_TRUE(close(fold.at("at")[0], expected * limit_load(2000.0), 1e-11)) << from << " ... " << to;
    for (const json& failure : d.at("failures")) {
      EXPECT_GT(expected * failure.at("at")[0].get<double>(), limit_load(2000.0));
      EXPECT_THAT(failure.at("message").get<std::string>(), HasSubstr("turn back at"));
    }
  }
  write("arch.json", arch(R"({ "parameter": "constants.F", "from": 0, "to": 9, "count": 5 })"));
  EXPECT_TRUE(document("critical arch.json").at("critical").empty());
}

TEST_F(Cli, EachLineOfAGridHasItsOwnFold) {
  write("arch.json", arch(R"({ "parameter": "constants.F", "from": 0, "to": 30, "count": 7,
                             "second": { "parameter": "constants.k", "from": 1000, "to": 4000, "count": 4 } })"));
  const json d = document("critical arch.json");
  ASSERT_EQ(d.at("critical").size(), 4U);
  for (const json& fold : d.at("critical"))
    EXPECT_TRUE(close(fold.at("at")[0], limit_load(fold.at("at")[1]), 1e-11)) << fold.dump();
}

}  // namespace
}  // namespace bramah
