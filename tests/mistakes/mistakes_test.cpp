// Mistakes that authors of plugins make, and where each is caught: by the compiler, when the library is loaded or its
// component set up, or at run time; with the library, the type, the instance and the reason in the message.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "app/cli.hpp"

namespace bramah {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

const std::string libraries = BRAMAH_BINARY_DIR "/tests/mistakes/libraries";

class Mistake : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    const char* before = std::getenv("BRAMAH_PLUGIN_PATH");
    setenv("BRAMAH_PLUGIN_PATH", (libraries + (before == nullptr ? "" : ":" + std::string(before))).c_str(), 1);
  }
  /// A mass on the spring of probe_M, pushed by its pulse.
  [[nodiscard]] Ended run(int mistake, const std::string& verb) const {
    const std::string probe = "probe_" + std::to_string(mistake);
    write("probe.json", R"({ "bramah": 1, "libraries": ["mechanics", ")" + probe + R"("],
  "components": {
    "m": { "type": "mechanics/mass", "mass": 1, "position": 0.4 },
    "s": { "type": ")" + probe +
                            R"(/spring", "along": "m.x", "k": 100, "c": 2 },
    "p": { "type": ")" + probe +
                            R"(/pulse" },
    "f": { "type": "mechanics/coordinate_force", "on": "m.x", "force": "p" } },
  "outputs": ["m.x", "s.force"], "linearize": { "at": "start" },
  "simulate": { "to_time": 1, "output_step": 0.25 } })");
    return bramah(verb + " probe.json");
  }
  /// Two springs of by_hand_M on one mass.
  [[nodiscard]] Ended run_by_hand(int mistake, const std::string& verb) const {
    const std::string library = "by_hand_" + std::to_string(mistake), type = library + "/spring";
    write("by_hand.json", R"({ "bramah": 1, "libraries": ["mechanics", ")" + library + R"("], "components": {
    "m": { "type": "mechanics/mass", "mass": 1, "position": 0.4 },
    "s": { "type": ")" + type +
                              R"(", "along": "m.x", "k": 100, "c": 2 },
    "s2": { "type": ")" + type +
                              R"(", "along": "m.x", "k": 50, "c": 1 } },
  "outputs": ["m.x"], "linearize": { "at": "start" }, "simulate": { "to_time": 1, "output_step": 0.25 } })");
    return bramah(verb + " by_hand.json");
  }
  /// What the compiler says first of probe.cpp with the mistake; "" where it compiles.
  [[nodiscard]] std::string compiler(int mistake, const std::string& standard = "c++20") const {
    const std::string log = (folder_ / "compiler.txt").string();
    const std::string command = std::string("c++ -std=") + standard + " -fsyntax-only -DM=" + std::to_string(mistake) +
                                " -I" BRAMAH_SOURCE_DIR "/engine/sdk -I" BRAMAH_SOURCE_DIR
                                "/engine/abi " BRAMAH_SOURCE_DIR "/tests/mistakes/libraries/probe.cpp >" +
                                log + " 2>&1";
    if (std::system(command.c_str()) == 0) return "";
    std::istringstream lines(contents(log));
    for (std::string line; std::getline(lines, line);)
      if (line.find("error:") != std::string::npos) return line;
    return "no line with an error";
  }
};

TEST_F(Mistake, NoneRuns) {
  const Ended run = this->run(0, "simulate");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("\n1,-0.12966"));
  EXPECT_EQ(compiler(0), "");
}

// ---- the compiler ----
TEST_F(Mistake, LawMisspeltOrNotConst) {
  EXPECT_THAT(compiler(1), HasSubstr("no law that stores it: is `balance` misspelt?"));
  EXPECT_THAT(compiler(2), AllOf(HasSubstr("the law `balance` does not fit"), HasSubstr("rows) const")));
}
TEST_F(Mistake, BreakpointOfAWrongType) {
  EXPECT_THAT(compiler(26), HasSubstr("double next_breakpoint(double t) const"));
}
TEST_F(Mistake, ADoubleWhereTEnters) {
  // The first error is at the author's own line and names the scalar.
  EXPECT_THAT(compiler(24),
              MatchesRegex(".*libraries/probe.cpp:[0-9]+:.*cannot convert .*bramah::Trace.* to .*double.*"));
  EXPECT_THAT(compiler(25), MatchesRegex(".*libraries/probe.cpp:[0-9]+:.*no matching function for call to .*fabs.*"));
}
TEST_F(Mistake, OldStandard) { EXPECT_THAT(compiler(0, "c++17"), HasSubstr("Bramah components need C++20")); }

// ---- loading and setting up ----
TEST_F(Mistake, HandlesThatNobodyDeclared) {
  const char* reason = "a law uses a port, variable or row that describe does not declare";
  EXPECT_THAT(run(4, "check").err, AllOf(HasSubstr("probe_4/spring cannot be used"), HasSubstr(reason)));
  EXPECT_THAT(run(20, "check").err, AllOf(HasSubstr("probe_20/spring cannot be used"), HasSubstr(reason)));
}
TEST_F(Mistake, UnitThatDoesNotExist) {
  EXPECT_THAT(run(3, "check").err, HasSubstr("N/furlong"));
  EXPECT_NE(run(3, "check").code, 0);
}
TEST_F(Mistake, DeclaredAndNeverGiven) {
  EXPECT_THAT(run(5, "check").err, HasSubstr("the output \"force\" is declared and never given a value"));
  EXPECT_THAT(run(13, "check").err, HasSubstr("the holonomic row \"tie\" is declared and never given a value"));
  EXPECT_THAT(run(6, "check").err, HasSubstr("declares switching functions and has no method `switches`"));
}
TEST_F(Mistake, DescribeSaysMoreTheSecondTime) {
  EXPECT_THAT(run(21, "check").err, HasSubstr("describe says something else than when the library was loaded"));
}
TEST_F(Mistake, ExceptionInDescribe) {
  EXPECT_THAT(run(22, "check").err, HasSubstr("gave no table: the table of materials is missing"));
}
TEST_F(Mistake, BadLibraryHurtsNoOther) {
  const Ended list = bramah("list --json");
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_THAT(list.out, AllOf(HasSubstr("probe_0/spring"), HasSubstr("mechanics/mass"),
                              HasSubstr("the table of materials is missing")));
}
TEST_F(Mistake, DescribeThatNeverEnds) {
  write("endless.json", R"({ "bramah": 1, "libraries": ["probe_16"], "components": {} })");
  const std::string command = "cd '" + folder_.string() +
                              "' && BRAMAH_PLUGIN_PATH=" BRAMAH_BINARY_DIR
                              "/tests/mistakes/endless timeout --preserve-status -s INT 1 " BRAMAH_BINARY_DIR
                              "/bin/bramah check endless.json 2>err";
  const int status = std::system(command.c_str());
  EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_THAT(contents(folder_ / "err"), AllOf(HasSubstr("SIGINT in "), HasSubstr("probe_16.so")));
}
TEST_F(Mistake, PathsThatLeadNowhere) {
  fs::create_directories(folder_ / "more");
  fs::create_symlink("nowhere.so", folder_ / "more" / "gone.so");
  write("gone.json", R"({ "bramah": 1, "libraries": ["gone"], "components": {} })");
  const std::string before = std::getenv("BRAMAH_PLUGIN_PATH");
  setenv("BRAMAH_PLUGIN_PATH", (before + ":" + (folder_ / "more").string()).c_str(), 1);
  EXPECT_THAT(bramah("check gone.json").err, HasSubstr("gone.so is a link to nowhere.so, which does not exist"));
  setenv("BRAMAH_PLUGIN_PATH", (before + ":" + libraries + "/probe_0.so").c_str(), 1);
  EXPECT_THAT(bramah("check gone.json").err, HasSubstr("probe_0.so in BRAMAH_PLUGIN_PATH is a file"));
}

// ---- tables filled by hand ----
TEST_F(Mistake, NoneByHand) {
  const Ended run = run_by_hand(0, "simulate");
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, ::testing::Not(HasSubstr("warning")));
}
TEST_F(Mistake, PartialsThatAreNotThoseOfTheRows) {
  // Forgotten in structure; wrong by a factor; marked and not written.
  const std::pair<int, const char*> mistakes[] = {{1, "evaluate wrote behind the end of a record"},
                                                  {2, "F_X: d(force on along)/d(along) is 200; differences give 100"},
                                                  {3, "a partial of block F_V was not written, or is not finite"}};
  for (const auto& [mistake, reason] : mistakes) {
    const std::string type = "by_hand_" + std::to_string(mistake) + "/spring";
    for (const char* verb : {"check", "modes", "linearize", "simulate"}) {
      const Ended run = run_by_hand(mistake, verb);
      EXPECT_THAT(run.err, AllOf(HasSubstr("s does not keep what its table promises: " + type), HasSubstr(reason),
                                 HasSubstr("by_hand_" + std::to_string(mistake) + ".so")))
          << verb;
    }
    const Ended strict = run_by_hand(mistake, "modes --strict");
    EXPECT_EQ(strict.code, 2) << mistake;
    EXPECT_THAT(strict.err, HasSubstr(reason));
  }
}
TEST_F(Mistake, WritesBeyondItsMemory) {
  EXPECT_THAT(run_by_hand(7, "check").err, HasSubstr("by_hand_7/spring writes behind the 8 bytes of its instance"));
  EXPECT_EQ(run_by_hand(7, "check").code, 2);
}
TEST_F(Mistake, CountsBeyondTheirLists) {
  const Ended types = run_by_hand(5, "check"), parameters = run_by_hand(6, "check");
  EXPECT_EQ(types.code, 2);
  EXPECT_THAT(types.err, AllOf(HasSubstr(" of 9 in "), HasSubstr("by_hand_5.so is no description of a type")));
  EXPECT_EQ(parameters.code, 2);
  EXPECT_THAT(parameters.err, AllOf(HasSubstr("type by_hand_6/spring of "), HasSubstr("is the count right?")));
}
TEST_F(Mistake, StatusWithoutAMessage) {
  const Ended run = run_by_hand(8, "simulate");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("s (by_hand_8/spring) cannot be evaluated: it gave status 1 without a message"));
}

// ---- at run time ----
TEST_F(Mistake, CrashInALaw) {
  const Ended abort = run(14, "simulate"), fault = run(15, "simulate");
  EXPECT_EQ(abort.code, 128 + 6) << "SIGABRT";
  EXPECT_THAT(abort.err,
              AllOf(HasSubstr("SIGABRT in "), HasSubstr(" of s (probe_14/spring), "), HasSubstr("probe_14.so")));
  EXPECT_EQ(fault.code, 128 + 11) << "SIGSEGV";
  EXPECT_THAT(fault.err, AllOf(HasSubstr("SIGSEGV in "), HasSubstr(" of s (probe_15/spring), ")));
}
TEST_F(Mistake, SignalsThatDoNotGoOn) {
  EXPECT_THAT(run(17, "simulate").err, AllOf(HasSubstr("the signal p"), HasSubstr("(probe_17/pulse)"),
                                             HasSubstr("a next breakpoint after this time")));
  EXPECT_THAT(run(18, "simulate").err, AllOf(HasSubstr("(probe_18/pulse)"), HasSubstr("no value beyond 0.1 s")));
  EXPECT_THAT(run(19, "simulate").err, AllOf(HasSubstr("(probe_19/pulse)"), HasSubstr("no breakpoints here")));
  EXPECT_THAT(run(23, "simulate").err, AllOf(HasSubstr("the signal p"), HasSubstr("gives nan at t = ")));
  for (const int mistake : {17, 18, 19, 23}) EXPECT_EQ(run(mistake, "simulate").code, 1) << mistake;
}
TEST_F(Mistake, PartialsThatAreNotFinite) {
  write("root.json", R"({ "bramah": 1, "libraries": ["mechanics", "rootlaw"], "components": {
    "m": { "type": "mechanics/mass", "mass": 1 }, "r": { "type": "rootlaw/root", "along": "m.x" } },
    "linearize": { "at": "start" } })");
  const Ended modes = bramah("modes root.json");
  EXPECT_EQ(modes.code, 1);
  EXPECT_THAT(modes.err, HasSubstr("r (rootlaw/root) has a partial derivative that is not finite: of the force balance "
                                   "of m.x by m.x"));
}

// ---- sound, at the edge ----
// A ball on a table that turns at 3 rad/s: r'' = (2/7) omega z x r', with I = 2/5 m a^2 a circle at 6/7 rad/s.
TEST_F(Mistake, AffineRowsAreNone) {
  write("table.json", R"({ "bramah": 1, "libraries": ["mechanics", "turntable"], "components": {
    "ball": { "type": "mechanics/rigid_body", "mass": 1, "inertia": [0.004, 0.004, 0.004], "position": [0.5, 0, 0.1],
              "velocity": [0.2, 0.3, 0], "angular_velocity": [12, 2, 0] },
    "table": { "type": "turntable/ball", "ball": "ball", "a": 0.1, "omega": 3 } },
    "outputs": ["ball.x", "ball.y", "ball.x.rate", "ball.y.rate"],
    "linearize": { "at": "start", "admissible_dependent": ["ball.e1", "ball.e2"] },
    "simulate": { "to_time": 10, "rel_tol": 1e-9 } })");
  const json model = document("linearize table.json");
  const auto& states = model["states"];
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(std::find(states.begin(), states.end(), name) - states.begin());
  };
  for (std::size_t j = 0; j < states.size(); ++j) {
    const double expected = j == at("ball.y.rate") ? -6.0 / 7.0 : 0.0;
    EXPECT_NEAR(model["A"][at("ball.x.rate")][j].get<double>(), expected, 1e-9) << states[j];
  }
  const json run = document("simulate table.json");
  // From r and r' at the start: r'' turns r', the centre of the circle is r + (6/7)^-1 z x r'.
  const double w = 6.0 / 7.0, x = 0.5, vx = 0.2, vy = 0.3, c = std::cos(10.0 * w), s = std::sin(10.0 * w);
  EXPECT_NEAR(run["final"]["ball.x"].get<double>(), x + (vx * s - vy * (1.0 - c)) / w, 1e-6);
  EXPECT_NEAR(run["final"]["ball.y"].get<double>(), (vy * s + vx * (1.0 - c)) / w, 1e-6);
}

}  // namespace
}  // namespace bramah
