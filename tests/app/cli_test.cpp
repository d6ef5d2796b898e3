// The program as scripts and people see it: what it prints, where, and with which exit code.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "app/cli.hpp"

namespace bramah {
namespace {

using testing::HasSubstr;
using testing::Not;

// ---- help and usage ----

TEST_F(Cli, HelpNamesEveryVerbAndExitCode) {
  const Ended run = bramah("--help");
  EXPECT_EQ(run.code, 0);
  for (const char* verb : {"check", "list", "describe", "equilibrium", "simulate", "linearize", "modes", "sweep",
                           "critical", "vary", "compare", "study"}) {
    EXPECT_THAT(run.out, HasSubstr(std::string("\n  ") + verb + " "));
    const Ended help = bramah(std::string(verb) + " --help");
    EXPECT_EQ(help.code, 0);
    EXPECT_THAT(help.out, HasSubstr("Example"));
    EXPECT_EQ(help.out, bramah(std::string("help ") + verb).out);
  }
  EXPECT_THAT(run.out, HasSubstr("Exit codes"));
  EXPECT_EQ(run.err, "");
}

TEST_F(Cli, VersionIsOneLine) {
  EXPECT_THAT(bramah("--version").out, testing::MatchesRegex("bramah [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(Cli, UsageErrorsSuggestAndExitWithThree) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"equilibrum x.json", "did you mean \"equilibrium\"?"},
      {"check " + scene_ + " --josn", "did you mean \"--json\"?"},
      {"scenes/x.json", "bramah study scenes/x.json"},
      {"check", "name a scene file"},
      {"describe", "bramah list"},
      {"describe hydraulics/throtle", "did you mean \"hydraulics/throttle\"?"},
      {"describe throttle", "did you mean \"hydraulics/throttle\"?"},
      {"modes " + scene_ + " seal.F_c=3", "--set"},
      {"modes " + scene_ + " --set", "bramah help modes"},
      {"help mode", "did you mean \"modes\"?"},
  };
  for (const auto& [arguments, expected] : cases) {
    const Ended run = bramah(arguments);
    EXPECT_EQ(run.code, 3) << arguments;
    EXPECT_THAT(run.err, HasSubstr(expected)) << arguments;
    EXPECT_EQ(run.out, "") << arguments;
  }
  EXPECT_EQ(bramah("").code, 3);
}

// ---- every verb's document ----

TEST_F(Cli, CheckCountsAndLists) {
  const json d = document("check " + scene_);
  EXPECT_EQ(d.at("sizes"),
            json::parse(R"({"n": 10, "m": 9, "l": 0, "r": 3, "u": 1, "redundant": 0, "reduced": 6, "augmented": 24})"));
  EXPECT_EQ(d.at("variables").size(), 14U);
  EXPECT_EQ(d.at("holonomic_rows").size(), 9U);
  EXPECT_EQ(d.at("inputs").size(), 4U);
  EXPECT_TRUE(d.at("assembled").get<bool>());
  EXPECT_THAT(bramah("check " + scene_).out, HasSubstr("crank.angle"));
}

TEST_F(Cli, ListAndDescribeNeedNoScene) {
  std::vector<std::string> types;
  const json list = document("list");
  for (const json& library : list.at("libraries")) {
    for (const json& type : library.at("types")) types.push_back(type.at("type"));
  }
  EXPECT_THAT(types, testing::IsSupersetOf(
                         {"hydraulics/throttle", "mechanics/planar_body", "friction/brown_mcphee", "signals/table"}));
  for (const std::string& type : types) {
    EXPECT_EQ(document("describe " + type).at("type"), type);
    EXPECT_THAT(bramah("describe " + type).out, HasSubstr("\"type\": \"" + type + "\""));
  }
  EXPECT_THAT(bramah("describe units").out, HasSubstr("MPa"));
  EXPECT_GT(document("describe units").at("units").size(), 10U);
}

TEST_F(Cli, EquilibriumIsThatOfThePaper) {
  const json d = document("equilibrium " + scene_);
  EXPECT_NEAR(d.at("variables").at("V1.p").get<double>(), 2820478.97095417111, 3e-5);
  EXPECT_NEAR(d.at("variables").at("crank.angle").get<double>(), std::acos(0.5), 1e-15);
  EXPECT_TRUE(d.at("variables").contains("piston.lambda_length"));
  EXPECT_EQ(d.at("inputs").at("tank"), 1e5);
  EXPECT_EQ(d.at("free_directions"), json::array());
}

TEST_F(Cli, EquilibriumReportsFreeDirections) {
  write_changed("free.json", R"("hold": ["crank.angle", "V3.p"])", R"("hold": ["crank.angle"])");
  const json directions = document("equilibrium free.json").at("free_directions");
  ASSERT_EQ(directions.size(), 1U);
  EXPECT_TRUE(directions[0].contains("V3.p"));
}

TEST_F(Cli, LinearizeAlongASimulation) {
  write_changed("along.json", R"("side": "+" })", R"("side": "+", "times": [0, 1.5, 1.502, 3] })");
  const json d = document("linearize along.json");
  ASSERT_EQ(d.at("models").size(), 4U);
  // At rest it is the model of the equilibrium; in motion it is another.
  const json rest = document("linearize " + scene_);
  EXPECT_EQ(d.at("states"), rest.at("states"));
  const auto entry = [](const json& matrix, std::size_t i, std::size_t j) { return matrix[i][j].get<double>(); };
  EXPECT_NEAR(entry(d.at("models")[0].at("A"), 1, 1), entry(rest.at("A"), 1, 1), 1e-9);
  EXPECT_EQ(d.at("models")[2].at("time"), 1.502);
  EXPECT_GT(std::abs(entry(d.at("models")[2].at("A"), 1, 1) - entry(rest.at("A"), 1, 1)), 1.0);
  write_changed("outside.json", R"("side": "+" })", R"("side": "+", "times": [4] })");
  EXPECT_THAT(bramah("linearize outside.json").err, HasSubstr("/linearize/times"));
}

// A parallelogram in line at the start: no model there, but on its branch from then on.
TEST_F(Cli, LinearizeAlongASimulationRefusesASingularPosition) {
  std::string text = contents(BRAMAH_SOURCE_DIR "/tests/cases/01-start-at-change-point/scene.json");
  const std::string simulate = "\"simulate\"";
  const std::size_t at = text.find(simulate);
  ASSERT_NE(at, std::string::npos);
  for (const bool at_start : {true, false}) {
    std::string scene = text;
    write("scene.json",
          scene.insert(at, std::string("\"linearize\": { \"times\": [") + (at_start ? "0, " : "") + "0.05, 0.1] }, "));
    const Ended run = bramah("linearize scene.json --json");
    EXPECT_EQ(run.code, at_start ? 1 : 0) << run.err;
    EXPECT_EQ(run.err.find("at t = 0 s the position is singular, a bifurcation") != std::string::npos, at_start);
  }
}

TEST_F(Cli, LinearDocumentsSayWhatIsNearlySingular) {
  const json document =
      this->document("modes '" BRAMAH_SOURCE_DIR "/tests/cases/20-almost-singular-no-word/scene.json'");
  ASSERT_EQ(document["notes"].size(), 1U);
  EXPECT_EQ(document["notes"][0]["kind"], "nearly singular");
}

TEST_F(Cli, LinearizeHasNamesAndMatrices) {
  const json d = document("linearize " + scene_);
  EXPECT_EQ(d.at("states"), json::parse(R"(["crank.angle", "crank.angle.rate", "V1.p", "V2.p", "V3.p", "valve.U"])"));
  EXPECT_EQ(d.at("sizes").at("reduced"), 6);
  const auto rows = d.at("outputs").size();
  for (const auto& [name, height, width] :
       {std::tuple("A", std::size_t{6}, std::size_t{6}), std::tuple("B", std::size_t{6}, std::size_t{4}),
        std::tuple("C", rows, std::size_t{6}), std::tuple("D", rows, std::size_t{4})}) {
    ASSERT_EQ(d.at(name).size(), height) << name;
    for (const json& row : d.at(name)) EXPECT_EQ(row.size(), width) << name;
  }
  EXPECT_EQ(d.at("units").at("V1.p"), "Pa");
  EXPECT_EQ(d.at("kinks").at(0).at("side"), "+");
  EXPECT_EQ(document("linearize " + scene_ + " --set linearize.side=-").at("kinks").at(0).at("side"), "-");
}

TEST_F(Cli, ModesNameTheCauseOfZeros) {
  const json d = document("modes " + scene_);
  std::size_t zeros = 0;
  for (const json& mode : d.at("eigenvalues")) {
    zeros += mode.at("zero").get<bool>() ? 1 : 0;
    EXPECT_EQ(mode.at("zero").get<bool>(), !mode.at("cause").get<std::string>().empty());
  }
  EXPECT_EQ(d.at("eigenvalues").size(), 6U);
  EXPECT_EQ(zeros, 2U);
  EXPECT_NEAR(d.at("eigenvalues").at(0).at("re").get<double>(), -214.391064651238277, 1e-8);
}

TEST_F(Cli, SettingsChangeTheScene) {
  const json d = document("modes " + scene_ + " --set 'seal.F_c=21 N' --set seal.F_s=83 --set seal.sigma_2=33");
  EXPECT_NEAR(d.at("eigenvalues").at(0).at("im").get<double>(), 540.252532226994528, 1e-8);
}

TEST_F(Cli, CompareFindsFalseZerosAndTheBestStep) {
  write_changed("steps.json", R"("compare": {})", R"("compare": { "steps": [1e-3, 1e-5, 1e-8] })");
  const json d = document("compare steps.json");
  EXPECT_EQ(d.at("reduced").at("size"), 6);
  EXPECT_EQ(d.at("reduced").at("zeros"), 2);
  EXPECT_FALSE(d.at("reduced").at("looks_unstable").get<bool>());
  EXPECT_EQ(d.at("augmented_exact").at("size"), 24);
  EXPECT_EQ(d.at("augmented_exact").at("false_zeros"), 18);
  for (const json& error : d.at("augmented_exact").at("errors")) EXPECT_LT(error.get<double>(), 1e-11);
  ASSERT_EQ(d.at("augmented_fd").size(), 3U);
  EXPECT_EQ(d.at("augmented_fd").at(1).at("h"), 1e-5);
  EXPECT_EQ(d.at("best_h"), 1e-5);
  EXPECT_GT(d.at("augmented_fd").at(2).at("time_s").get<double>(), 0.0);
  EXPECT_THAT(bramah("compare steps.json").out, HasSubstr("<- best h"));
}

TEST_F(Cli, SimulateStreamsCsvOrWritesAFile) {
  const Ended run = bramah("simulate " + scene_ + " --set simulate.to_time=0.02");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, testing::StartsWith("time,crank.x,crank.y,crank.angle,"));
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 6);
  EXPECT_THAT(run.err, HasSubstr("Newton iterations"));

  const json d = document("simulate " + scene_ + " --set simulate.to_time=0.02 --out series");
  EXPECT_EQ(contents(folder_ / "series/time_series.csv"), run.out);
  EXPECT_EQ(d.at("final").at("time"), 0.02);
  EXPECT_LT(d.at("summary").at("worst_position_violation").get<double>(), 1e-10);
  EXPECT_FALSE(fs::exists(folder_ / "series/time_series.csv.part"));
}

TEST_F(Cli, OutputsOfTheSceneAreTheColumns) {
  write_changed("few.json", R"("study":)", R"("outputs": ["V3.p", "crank.angle.rate", "torque"], "study":)");
  EXPECT_THAT(bramah("simulate few.json --set simulate.to_time=0.01").out,
              testing::StartsWith("time,V3.p,crank.angle.rate,torque\n0,3500000,0,0\n"));
}

TEST_F(Cli, EnergiesAreOutputsOfSimulationsOnly) {
  const std::string scene = "'" BRAMAH_SOURCE_DIR "/scenes/linear/pendulum.json'";
  const Ended run = bramah("simulate " + scene + " --output rod.energy --output energy --set simulate.to_time=0.01");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.out, testing::StartsWith("time,rod.energy,energy\n0,-14.74941537585"));  // -m g l cos(20 deg)
  const Ended refused = bramah("linearize " + scene + " --output rod.energy");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("the output rod.energy has no row in C"));
  EXPECT_THAT(refused.err, HasSubstr("--output"));
  EXPECT_EQ(bramah("modes " + scene + " --quiet").code, 0);
}

TEST_F(Cli, WrongEnergyIsToldAndTheRunKept) {
  const std::string scene = "'" BRAMAH_SOURCE_DIR "/scenes/benchmarks/pendulum.json'";
  const std::string loose = " --set simulate.integrator=ida --set simulate.rel_tol=0.01";
  const Ended run = bramah("simulate " + scene + loose + " --quiet --out loose");
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err, HasSubstr("% of the energy that was turned over, came from nowhere or got lost"));
  EXPECT_TRUE(fs::exists(folder_ / "loose/time_series.csv"));
  EXPECT_EQ(bramah("simulate " + scene + " --quiet").err, "");
}

// ---- study ----

TEST_F(Cli, StudyWritesAWholeFolder) {
  write_changed("all.json", R"("compare": {})", R"("compare": { "steps": [1e-5] })");
  const json d = document("study all.json --out results");
  for (const char* file : {"equilibrium.json", "linear_model.json", "spectrum.json", "time_series.csv",
                           "linear_response.csv", "compare.json", "report.html", "summary.json", "transient.svg",
                           "spectrum.svg", "compare_errors.svg", "compare_false_zeros.svg"}) {
    EXPECT_GT(fs::file_size(folder_ / "results" / file), 100U) << file;
    EXPECT_THAT(d.at("files").get<std::vector<std::string>>(), testing::Contains(file));
    if (fs::path(file).extension() == ".json") {
      EXPECT_TRUE(json::accept(contents(folder_ / "results" / file))) << file;
    }
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "results"))
    EXPECT_NE(entry.path().extension(), ".part");
  EXPECT_EQ(contents(folder_ / "results/equilibrium.json"), bramah("equilibrium " + scene_ + " --json").out);
  EXPECT_NEAR(d.at("overlay").at("errors").at("crank.angle").at("relative").get<double>(), 3.4246e-2, 2e-4);
  const std::string page = contents(folder_ / "results/report.html");
  EXPECT_THAT(page, HasSubstr("Hydraulic four-bar, overdamped"));
  for (const char* foreign : {"<script", "<link", "src=", "@import", "url("})
    EXPECT_THAT(page, Not(HasSubstr(foreign)));
}

TEST_F(Cli, StudyDoesOnlyWhatTheSceneAsksFor) {
  write_changed("plain.json", R"("study": { "linear_from": 1.5 },
  "compare": {})",
                R"("study": {})");
  const Ended run = bramah("study plain.json");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(fs::exists(folder_ / "results/plain/report.html"));
  EXPECT_FALSE(fs::exists(folder_ / "results/plain/linear_response.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "results/plain/compare.json"));
}

TEST_F(Cli, StudyAtTheStartNeedsNoEquilibrium) {
  write("rolling.json", R"({ "bramah": 1, "libraries": ["mechanics"],
    "components": { "sled": { "type": "mechanics/planar_body", "mass": 2, "inertia": 1, "velocity": [3, 0] } },
    "linearize": { "at": "start" }, "simulate": { "from": "start", "to_time": 1, "output_step": 0.1 } })");
  const Ended run = bramah("study rolling.json --out out");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_FALSE(fs::exists(folder_ / "out/equilibrium.json"));
  EXPECT_TRUE(fs::exists(folder_ / "out/time_series.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));
}

// ---- failures ----

TEST_F(Cli, WrongSceneTellsEverythingAndExitsWithTwo) {
  write_changed("wrong.json", R"("volume": "V2", "V_h": 3.14e-5)", R"("volum": "V2", "V_h": "3 kg")");
  const Ended run = bramah("check wrong.json");
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("did you mean \"volume\"?"));
  EXPECT_THAT(run.err, testing::ContainsRegex("wrong\\.json:[0-9]+:[0-9]+: error: "));
  const json d = document("check wrong.json", 2).at("error");
  EXPECT_GE(d.at("diagnostics").size(), 2U);
  const json& first = d.at("diagnostics").at(0);
  for (const char* key : {"file", "line", "column", "pointer", "found", "expected", "remedy"})
    EXPECT_TRUE(first.contains(key)) << key;
  EXPECT_EQ(first.at("file"), "wrong.json");
  EXPECT_GT(first.at("line").get<int>(), 1);
  EXPECT_THAT(bramah("check missing.json").err, HasSubstr("no such file"));
  EXPECT_EQ(bramah("check missing.json").code, 2);
}

TEST_F(Cli, WrongSettingIsReportedAsSuch) {
  const Ended run = bramah("modes " + scene_ + " --set seal.F_c=abc --set seal.F_x=3");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("--set seal.F_c=abc: error: "));
  EXPECT_THAT(run.err, HasSubstr("--set seal.F_x=3: error: unknown key"));
  EXPECT_EQ(bramah("modes " + scene_ + " --set sael.F_c=1").code, 2);
}

TEST_F(Cli, ImpossibleAnalysisExitsWithOne) {
  const std::string bad = "check " + scene_ + " --set 'crank.angle=60 deg' --set O2.point_b=7 --set coupler.inertia=1";
  EXPECT_EQ(bramah(bad).code, 2);  // a list is needed
  write_changed("far.json", R"("point_b": [10, 0])", R"("point_b": [100, 0])");
  const Ended run = bramah("check far.json");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("far.json:26:5: error: assembly: "));
  EXPECT_THAT(run.err, HasSubstr("expected"));
  const json d = document("equilibrium far.json", 1);
  EXPECT_EQ(d.at("error").at("kind"), "analysis");
  EXPECT_EQ(d.at("error").at("exit_code"), 1);
}

TEST_F(Cli, UnwritableFolderExitsWithFour) {
  write("file", "not a folder");
  for (const char* verb : {"equilibrium", "modes", "simulate", "study"}) {
    const Ended run = bramah(std::string(verb) + " " + scene_ + " --out file/below");
    EXPECT_EQ(run.code, 4) << verb;
    EXPECT_THAT(run.err, HasSubstr("file/below: error: ")) << verb;
  }
  EXPECT_EQ(document("equilibrium " + scene_ + " --out file", 4).at("error").at("kind"), "write");
}

TEST_F(Cli, PartsAreNotOpenedThroughLinks) {
  fs::create_directories(folder_ / "linked");
  write("victim", "precious\n");
  fs::create_symlink(folder_ / "victim", folder_ / "linked/time_series.csv.part");
  EXPECT_EQ(bramah("simulate " + scene_ + " --out linked").code, 0);
  EXPECT_EQ(contents(folder_ / "victim"), "precious\n");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(folder_ / "linked/time_series.csv")));
}

TEST_F(Cli, AFullStandardOutputIsAFailure) {
  ASSERT_TRUE(fs::exists("/dev/full"));
  EXPECT_EQ(std::system(("'" BRAMAH_BINARY_DIR "/bin/bramah' list >/dev/full 2>'" + (folder_ / "err").string() +
                         "'; test $? -eq 4")
                            .c_str()),
            0);
}

TEST_F(Cli, NumbersHaveSeventeenDigits) {
  const std::string text = bramah("equilibrium " + scene_ + " --json").out;
  EXPECT_THAT(text, HasSubstr("\"crank.angle\": 1.0471975511965976"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace bramah
