// Files and names from outside that must neither end the program nor bend its output.
#include "app/cli.hpp"

namespace bramah {
namespace {

using Hostile = Cli;

constexpr const char* oscillator = R"({
  "bramah": 1, "libraries": ["mechanics"],
  "components": {
    "a,b": { "type": "mechanics/mass", "mass": 1, "position": 0.1 },
    "k": { "type": "mechanics/spring_damper", "to": "a,b.x", "stiffness": 1 } },
  "outputs": ["a,b.x", "a,b.x.rate"],
  "simulate": { "to_time": 1, "output_step": 0.5 } })";

// A run that takes no step has integrated no accelerations, and none without digits.
TEST_F(Hostile, RunThatAJumpStopsAtOnceIsNotDoubted) {
  const auto scene = [](const char* to_time) {
    return std::string(R"({ "bramah": 1, "libraries": ["mechanics", "signals"], "components": {
      "u": { "type": "signals/table", "unit": "N", "times": [0, 1, 1, 2], "values": [0, 0, 3, 3] },
      "m": { "type": "mechanics/mass", "mass": 2 },
      "push": { "type": "mechanics/coordinate_force", "on": "m.x", "force": "u" } },
    "simulate": { "integrator": "explicit", "output_step": 0.5,
                  "events": { "jump": { "of": "u", "rises_above": 1, "stop": true } }, "to_time": )") +
           to_time + " } }";
  };
  write("first.json", scene("1"));
  write("second.json", scene("2"));
  const Ended first = bramah("simulate first.json --quiet --out first");
  ASSERT_EQ(first.code, 0) << first.err;
  const Ended second = bramah("simulate second.json --quiet --out second --resume first/checkpoint.json");
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.err, "");
}

TEST_F(Hostile, CheckpointWithEventsThatAreNoneIsRefused) {
  write("scene.json", R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "m": { "type": "mechanics/mass", "mass": 2, "velocity": 1 } },
    "simulate": { "to_time": 1, "events": { "far": { "of": "m.x", "rises_above": 5, "stop": true } } } })");
  ASSERT_EQ(bramah("simulate scene.json --quiet --out out").code, 0);
  json checkpoint = json::parse(contents(folder_ / "out" / "checkpoint.json"));
  for (const json& wrong : {json(5), json({{"far", 5}}), json({{"far", json::object()}})}) {
    checkpoint["events"] = wrong;
    write("wrong.json", checkpoint.dump());
    const Ended run = bramah("simulate scene.json --set simulate.to_time=2 --resume wrong.json");
    EXPECT_NE(run.code, 0) << wrong;
    EXPECT_NE(run.err.find("/events"), std::string::npos) << run.err;
  }
}

TEST_F(Hostile, NamesWithCommasAreQuotedInCsvFiles) {
  write("scene.json", oscillator);
  ASSERT_EQ(bramah("simulate scene.json --out out").code, 0);
  const std::string series = contents(folder_ / "out/time_series.csv");
  EXPECT_EQ(series.substr(0, series.find('\n')), R"(time,"a,b.x","a,b.x.rate")");
  ASSERT_EQ(bramah("linearize scene.json --out linear").code, 0);
  const std::string A = contents(folder_ / "linear/A.csv");
  EXPECT_EQ(A.substr(0, A.find('\n')), R"(,"a,b.x","a,b.x.rate")");
  EXPECT_NE(A.find("\n\"a,b.x.rate\","), std::string::npos) << A;
}

TEST_F(Hostile, LibrariesCutShortAreNamedAndHurtNoOthers) {
  write("scene.json", oscillator);
  const std::string whole = contents(BRAMAH_BINARY_DIR "/lib/bramah/plugins/friction.so");
  ASSERT_GT(whole.size(), 60000U);
  fs::create_directories(folder_ / "cut");
  for (const std::size_t bytes : {3, 100, 4096, 20000, 50000}) {
    write("cut/broken.so", whole.substr(0, bytes));
    setenv("BRAMAH_PLUGIN_PATH", (folder_.string() + "/cut:" BRAMAH_BINARY_DIR "/lib/bramah/plugins").c_str(), 1);
    const Ended list = bramah("list");
    EXPECT_EQ(list.code, 0) << bytes;
    EXPECT_NE(list.err.find("broken.so"), std::string::npos) << list.err;
    EXPECT_NE(list.out.find("mechanics/mass"), std::string::npos);
    EXPECT_EQ(bramah("check scene.json").code, 0) << bytes;
  }
  setenv("BRAMAH_PLUGIN_PATH", BRAMAH_BINARY_DIR "/lib/bramah/plugins", 1);
}

TEST_F(Hostile, ACheckpointBeyondTheResolutionOfTimesIsRefused) {
  write("scene.json", oscillator);
  ASSERT_EQ(bramah("simulate scene.json --out out").code, 0);
  std::string text = contents(folder_ / "out/checkpoint.json");
  const std::size_t at = text.find("\"time\":"), end = text.find(',', at);
  write("huge.json", text.replace(at, end - at, "\"time\": 1e16"));
  const Ended before = bramah("simulate scene.json --resume huge.json");
  EXPECT_EQ(before.code, 1);
  EXPECT_NE(before.err.find("a to_time after the checkpoint"), std::string::npos) << before.err;
  const Ended after = bramah("simulate scene.json --resume huge.json --set simulate.to_time=1.0001e16");
  EXPECT_EQ(after.code, 1);
  EXPECT_NE(after.err.find("2 s apart"), std::string::npos) << after.err;
}

TEST_F(Hostile, WorkThatCanBeToldIsBounded) {
  write("scene.json", oscillator);
  for (const char* setting : {"simulate.output_step=1e-12", "simulate.max_step=1e-15", "simulate.output_step=1e-300"}) {
    const Ended run = bramah(std::string("simulate scene.json --set ") + setting);
    EXPECT_EQ(run.code, 1) << setting;
    EXPECT_NE(run.err.find("allow more by \"most_rows\""), std::string::npos) << run.err;
  }
  EXPECT_EQ(bramah("simulate scene.json --set simulate.output_step=0.01 --set simulate.most_rows=2").code, 1);
}

TEST_F(Hostile, OfThousandsOfFaultsAHundredArePrintedAndAllAreCounted) {
  std::string scene = R"({"bramah": 1, "libraries": ["mechanics"], "components": {)";
  for (int k = 0; k < 3000; ++k)
    scene += (k == 0 ? "\"m" : ",\n\"m") + std::to_string(k) + R"(": {"type": "mechanics/mass", "mas": 1})";
  write("scene.json", scene + "}}");
  const Ended check = bramah("check scene.json");
  EXPECT_EQ(check.code, 2);
  std::size_t printed = 0;
  for (std::size_t at = check.err.find(": error: "); at != std::string::npos; at = check.err.find(": error: ", at + 1))
    ++printed;
  EXPECT_EQ(printed, 100U);
  EXPECT_NE(check.err.find("faults more"), std::string::npos);
  const json document = json::parse(bramah("check scene.json --json").out);
  EXPECT_GE(document["error"]["diagnostics"].size(), 3000U);
  EXPECT_EQ(document["error"]["diagnostics"].back()["line"], 3000);
}

}  // namespace
}  // namespace bramah
