// `bramah vary` against single runs, a closed form and itself.
#include <gmock/gmock.h>

#include <cmath>

#include "app/cli.hpp"
#include "support/numbers.hpp"

namespace bramah {
namespace {

using testing::close;
using ::testing::HasSubstr;

const std::string pendulum = "'" BRAMAH_SOURCE_DIR "/scenes/linear/pendulum.json'";

/// A mass on a spring with a damper, released at x = 1, varied as `vary` says.
std::string oscillator(const std::string& vary) {
  return R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "m": { "type": "mechanics/mass", "mass": 2 },
    "k": { "type": "mechanics/spring_damper", "to": "m", "stiffness": 8, "damping": 0 } },
  "start": { "m.x": 1 }, "outputs": ["m.x", "m.x.rate"],
  "simulate": { "to_time": 3, "output_step": 0.01 }, "vary": )" +
         vary + " }";
}

/// The value of a figure of a run.
double figure(const json& document, std::size_t run, const std::string& name) {
  for (std::size_t k = 0; k < document.at("figures").size(); ++k) {
    if (document.at("figures")[k].at("name") == name) return document.at("runs")[run].at("values").at(k);
  }
  ADD_FAILURE() << "no figure " << name;
  return NAN;
}

TEST_F(Cli, VaryDoesNotDependOnTheNumberOfThreads) {
  for (const char* threads : {"1", "2"}) {
    const Ended run = bramah("vary " + pendulum + " --quiet --out " + threads + " --threads " + threads);
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    EXPECT_THAT(run.out, HasSubstr("60 runs: 60 ok, 0 failed"));
  }
  for (const char* file : {"vary.json", "vary.csv"}) {
    EXPECT_EQ(contents(folder_ / "1" / file), contents(folder_ / "2" / file)) << file;
    EXPECT_GT(contents(folder_ / "1" / file).size(), 5000U) << file;
  }
}

TEST_F(Cli, VarySetsAsSettingsDo) {
  // Figures of a grid are those of single runs, bit by bit.
  write("o.json", oscillator(R"({ "over": { "k.damping": [0, "1 N.s/m"],
                                            "m.mass": { "from": "2 kg", "to": "5 kg", "count": 3 } } })"));
  const json d = document("vary o.json");
  ASSERT_EQ(d.at("runs").size(), 6U);
  EXPECT_EQ(d.at("runs")[4].at("at"), json({1.0, 3.5}));
  EXPECT_EQ(d.at("parameters")[1], json({{"name", "m.mass"}, {"unit", "kg"}}));
  for (std::size_t run = 0; run < 6; ++run) {
    const json& at = d.at("runs")[run].at("at");
    const Ended single =
        bramah("simulate o.json --quiet --set k.damping=" + at[0].dump() + " --set m.mass=" + at[1].dump());
    std::istringstream rows(single.out);
    std::string row;
    std::getline(rows, row);
    double t = 0.0, x = 0.0, v = 0.0, before = NAN, last = NAN, low = HUGE_VAL, high = -HUGE_VAL, area = 0.0,
           squares = 0.0;
    while (std::getline(rows, row)) {
      ASSERT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf", &t, &x, &v), 3) << row;
      if (!std::isnan(before)) {
        area += 0.5 * (t - before) * (last + x);
        squares += 0.5 * (t - before) * (last * last + x * x);
      }
      low = std::min(low, x);
      high = std::max(high, x);
      before = t;
      last = x;
    }
    EXPECT_EQ(figure(d, run, "time"), t) << run;
    EXPECT_EQ(figure(d, run, "m.x.final"), x) << run;
    EXPECT_EQ(figure(d, run, "m.x.rate.final"), v) << run;
    EXPECT_EQ(figure(d, run, "m.x.min"), low) << run;
    EXPECT_EQ(figure(d, run, "m.x.max"), high) << run;
    EXPECT_EQ(figure(d, run, "m.x.mean"), area / t) << run;
    EXPECT_EQ(figure(d, run, "m.x.rms"), std::sqrt(squares / t)) << run;
  }
}

TEST_F(Cli, VaryShowsWhatEventsHold) {
  // A push of 5 N, which turns round at 3 m/s: after m 3/5 s.
  write("o.json", R"({ "bramah": 1, "libraries": ["mechanics", "signals"], "components": {
    "u": { "type": "signals/constant", "unit": "N", "value": 5 },
    "m": { "type": "mechanics/mass", "mass": 2 },
    "push": { "type": "mechanics/coordinate_force", "on": "m.x", "force": "u" } },
  "outputs": ["m.x.rate", "m.x.acceleration", "u"],
  "simulate": { "to_time": 3, "output_step": 0.01,
                "events": { "fast": { "of": "m.x.rate", "rises_above": 3, "hold": { "u": -5 } } } },
  "vary": { "over": { "m.mass": [2, 3, 4] } } })");
  const json d = document("vary o.json");
  for (std::size_t run = 0; run < 3; ++run) {
    const double mass = 2.0 + static_cast<double>(run), turn = 0.6 * mass;
    EXPECT_EQ(figure(d, run, "u.final"), -5.0);
    EXPECT_EQ(figure(d, run, "u.min"), -5.0);
    EXPECT_EQ(figure(d, run, "u.max"), 5.0);
    EXPECT_TRUE(close(figure(d, run, "m.x.acceleration.final"), -5.0 / mass, 1e-12));
    EXPECT_TRUE(close(figure(d, run, "m.x.rate.final"), 3.0 - 5.0 / mass * (3.0 - turn), 1e-6));
    EXPECT_TRUE(close(figure(d, run, "m.x.rate.max"), 3.0, 1e-6));
  }
}

TEST_F(Cli, VaryGivesTheFiguresOfAClosedForm) {
  // x = cos w t over 3 s, rows every 10 ms: the trapezoidal rule errs by h^2 / 12 (f'(3) - f'(0)) / 3 <= 1.3e-5.
  write("o.json", oscillator(R"({ "over": { "k.stiffness": [2, 8, 18] }, "of": ["m.x"] })"));
  const json d = document("vary o.json");
  for (std::size_t run = 0; run < 3; ++run) {
    const double w = static_cast<double>(run) + 1.0;
    EXPECT_TRUE(close(figure(d, run, "m.x.final"), std::cos(3.0 * w), 1e-6, 1.0));
    EXPECT_EQ(figure(d, run, "m.x.max"), 1.0);
    EXPECT_TRUE(close(figure(d, run, "m.x.mean"), std::sin(3.0 * w) / (3.0 * w), 1.3e-5, 1.0));
    EXPECT_TRUE(close(figure(d, run, "m.x.rms"), std::sqrt(0.5 + std::sin(6.0 * w) / (12.0 * w)), 4e-5, 1.0));
  }
}

TEST_F(Cli, VaryDrawsTheSameNumbersForEveryone) {
  write("o.json",
        oscillator(R"({ "over": { "k.damping": [0, 1] }, "count": 3, "seed": 1, "figures": ["final"], "random": {
      "m.mass": { "normal": ["2 kg", "100 g"] }, "k.stiffness": { "uniform": [6, 10] },
      "start.m.x": { "log_uniform": ["10 mm", "1 m"] } } })"));
  const json d = document("vary o.json");
  ASSERT_EQ(d.at("runs").size(), 6U);
  // Philox4x32-10 and the quantiles by an independent program.
  const double expected[3][3] = {
      {2.1227907605744494, 6.109808938819731, 0.64014003247968281},
      {2.0445437714488891, 6.9269779472971655, 0.27239788134787384},
      {1.931731030796989, 7.9563387126317013, 0.14313262359603942},
  };
  for (std::size_t run = 0; run < 6; ++run) {
    EXPECT_EQ(d.at("runs")[run].at("at")[0], run < 3 ? 0.0 : 1.0);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(close(d.at("runs")[run].at("at")[k + 1], expected[run % 3][k], 1e-15)) << run << ' ' << k;
  }
  ASSERT_EQ(d.at("figures").size(), 3U);
  EXPECT_EQ(d.at("figures")[1].at("name"), "m.x.final");
  const json other = document("vary o.json --set vary.seed=2");
  EXPECT_NE(other.at("runs")[0].at("at")[1], d.at("runs")[0].at("at")[1]);
  const json longer = document("vary o.json --set vary.count=4");
  EXPECT_EQ(longer.at("runs")[2].at("at"), d.at("runs")[2].at("at"));
}

TEST_F(Cli, VaryGivesStatistics) {
  // The mass does not move, so that the final value is the start value: figures of 1, 2, ... 11.
  write("o.json", oscillator(R"({ "over": { "start.m.x": { "from": 1, "to": 11, "count": 11 } }, "of": ["m.x"],
                                  "figures": ["final"] })"));
  const json d = document("vary o.json --set k.stiffness=0");
  const json& s = d.at("figures")[1];
  EXPECT_TRUE(close(s.at("mean"), 6.0, 1e-12));
  EXPECT_TRUE(close(s.at("standard_deviation"), std::sqrt(11.0), 1e-12));
  EXPECT_TRUE(close(s.at("min"), 1.0, 1e-12));
  EXPECT_TRUE(close(s.at("max"), 11.0, 1e-12));
  EXPECT_TRUE(close(s.at("p5"), 1.5, 1e-12));
  EXPECT_TRUE(close(s.at("p50"), 6.0, 1e-12));
  EXPECT_TRUE(close(s.at("p95"), 10.5, 1e-12));
  const json one = document("vary o.json --set k.stiffness=0 --set m.mass=3");
  EXPECT_EQ(one.at("figures")[0].at("standard_deviation"), 0.0);
}

TEST_F(Cli, VaryKeepsWhatSucceeds) {
  write("o.json", oscillator(R"({ "over": { "m.mass": ["-1 kg", 1, 2] } })"));
  const json d = document("vary o.json --out some");
  EXPECT_EQ(d.at("failed"), 1);
  EXPECT_EQ(d.at("runs")[0].at("status"), "failed");
  EXPECT_THAT(d.at("runs")[0].at("message").get<std::string>(), HasSubstr("/components/m/mass: \"mass\" is -1 kg"));
  EXPECT_TRUE(d.at("runs")[0].at("values").empty());
  EXPECT_EQ(d.at("runs")[2].at("status"), "ok");
  EXPECT_THAT(
      contents(folder_ / "some" / "vary.csv"),
      HasSubstr("run,m.mass,time,m.x.final,m.x.min,m.x.max,m.x.mean,m.x.rms,m.x.rate.final,m.x.rate.min,"
                "m.x.rate.max,m.x.rate.mean,m.x.rate.rms,status,message\n1,-1,,,,,,,,,,,,failed,\"/components"));
  EXPECT_THAT(bramah("vary o.json").out, HasSubstr("Run 1 failed, m.mass -1 kg: /components/m/mass"));

  write("none.json", oscillator(R"({ "over": { "m.mass": [-2, -1] } })"));
  const json none = document("vary none.json", 1);
  EXPECT_EQ(none.at("failed"), 2);
  EXPECT_TRUE(none.at("figures")[0].at("mean").is_null());
}

TEST_F(Cli, VaryCountsAWrongEnergyAsFailure) {
  write("o.json", oscillator(R"({ "over": { "m.mass": [1] } })"));
  const std::string loose = " --set simulate.integrator=ida --set simulate.rel_tol=0.1 --set simulate.to_time=60";
  const json d = document("vary o.json" + loose, 1);
  EXPECT_EQ(d.at("failed"), 1);
  EXPECT_THAT(d.at("runs")[0].at("message").get<std::string>(), HasSubstr("came from nowhere or got lost"));
}

TEST_F(Cli, VaryKeepsWhatIsDoneWhenInterrupted) {
  write("o.json",
        oscillator(R"({ "random": { "m.mass": { "uniform": [1, 2] } }, "count": 100000, "figures": ["final"] })"));
  const std::string command = "cd '" + folder_.string() +
                              "' && timeout --foreground --preserve-status -s INT 2 '" BRAMAH_BINARY_DIR
                              "/bin/bramah' vary o.json --threads 1 --out . --quiet >out";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const json d = json::parse(contents(folder_ / "vary.json"));
  EXPECT_TRUE(d.at("interrupted").get<bool>());
  EXPECT_EQ(d.at("runs")[0].at("status"), "ok");
  EXPECT_EQ(d.at("runs")[99999].at("status"), "interrupted");
  EXPECT_THAT(contents(folder_ / "out"), HasSubstr("complete runs kept."));
}

TEST_F(Cli, VaryRefusesWhatItCannotRead) {
  write("o.json", oscillator(R"({ "over": { "m.mass": [1, 2] } })"));
  const std::vector<std::tuple<std::string, int, std::string>> cases = {
      {"vary " + scene_, 3, "a scene without \"vary\""},
      {"vary o.json --set vary.count=3", 2, "\"count\" without \"random\""},
      {"vary o.json --threads 0", 3, "--threads"},
      {"vary o.json --over m.mass=1:2", 3, "no option \"--over\""},
  };
  for (const auto& [arguments, code, expected] : cases) {
    const Ended run = bramah(arguments);
    EXPECT_EQ(run.code, code) << arguments << run.err;
    EXPECT_THAT(run.err, HasSubstr(expected)) << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
}

}  // namespace
}  // namespace bramah
