// Runs that do not end by themselves: interrupted, killed, on a full disk, into a folder that cannot be written. Nothing
// half-written appears under a final name, the message says what to do, and the run can be continued.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <random>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include "app/cli.hpp"
#include "support/property.hpp"

namespace bramah {
namespace {

using ::testing::HasSubstr;

/// The program in the background, with its standard error in a file.
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const fs::path& err) : child_(fork()) {
    if (child_ != 0) return;
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (std::freopen(err.c_str(), "w", stderr) == nullptr) _exit(99);
    execv(argv[0], argv.data());
    _exit(99);
  }
  ~Process() {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  /// Sends the signal and waits for the end: the exit code, or minus the signal.
  int end_by(int signal) {
    kill(child_, signal);
    int status = 0;
    waitpid(std::exchange(child_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t child_;
};

bool comes_true(const std::function<bool()>& condition) {
  for (int k = 0; k < 6000; ++k) {  // a minute
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class Kill : public Cli {
 protected:
  /// Half a century of a pendulum.
  [[nodiscard]] std::vector<std::string> endless(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {BRAMAH_BINARY_DIR "/bin/bramah",
                                          "simulate",
                                          BRAMAH_SOURCE_DIR "/scenes/linear/hanging_chain.json",
                                          "--set",
                                          "simulate.to_time=1.5e9",
                                          "--set",
                                          "start.link_1.angle.rate=1",
                                          "--set",
                                          "simulate.integrator=explicit",
                                          "--out",
                                          (folder_ / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  [[nodiscard]] static bool has(const fs::path& file, std::uintmax_t bytes) {
    std::error_code error;
    return fs::exists(file) && fs::file_size(file, error) > bytes && !error;
  }
  /// The start of the run that `out/checkpoint.json` continues.
  [[nodiscard]] Ended go_on() const {
    const json saved = json::parse(contents(folder_ / "out/checkpoint.json"));
    return bramah("simulate '" BRAMAH_SOURCE_DIR
                  "/scenes/linear/hanging_chain.json' --out more --resume out/checkpoint.json "
                  "--set simulate.to_time=" +
                  std::to_string(saved.at("time").get<double>() + 0.1));
  }
};

TEST_F(Kill, InterruptKeepsWhatThereIs) {
  const fs::path series = folder_ / "out/time_series.csv", part = folder_ / "out/time_series.csv.part";
  Process run(endless(), folder_ / "err");
  ASSERT_TRUE(comes_true([&] { return has(part, 10000); }));
  EXPECT_EQ(run.end_by(SIGINT), 130);
  EXPECT_THAT(contents(folder_ / "err"), HasSubstr("interrupted; results up to t = "));
  EXPECT_THAT(contents(series), ::testing::EndsWith("\n"));
  EXPECT_FALSE(fs::exists(part));
  const Ended rest = go_on();
  EXPECT_EQ(rest.code, 0) << rest.err;
}

TEST_F(Kill, AKilledRunLeavesNoBrokenFileAndGoesOnFromItsCheckpoint) {
  const fs::path part = folder_ / "out/time_series.csv.part", saved = folder_ / "out/checkpoint.json";
  Process run(endless({"--save-every", "0.05"}), folder_ / "err");
  ASSERT_TRUE(comes_true([&] { return has(saved, 100) && has(part, 10000); }));
  EXPECT_EQ(run.end_by(SIGKILL), -SIGKILL);
  EXPECT_FALSE(fs::exists(folder_ / "out/time_series.csv"));
  EXPECT_TRUE(json::accept(contents(saved)));
  const Ended rest = go_on();
  EXPECT_EQ(rest.code, 0) << rest.err;
}

TEST_F(Kill, ABinarySeriesCanBeReadAfterAKill) {
  const fs::path part = folder_ / "out/time_series.npy.part";
  Process run(endless({"--binary"}), folder_ / "err");
  const auto rows = [&] {
    const std::string text = contents(part), key = "'shape': (";
    const std::size_t at = text.find(key);
    return at == std::string::npos ? 0L : std::strtol(text.c_str() + at + key.size(), nullptr, 10);
  };
  ASSERT_TRUE(comes_true([&] { return has(part, 2000) && rows() > 0; }));
  EXPECT_EQ(run.end_by(SIGKILL), -SIGKILL);
  const std::string text = contents(part);
  ASSERT_EQ(text.substr(0, 8), std::string("\x93NUMPY\x03\x00", 8));
  std::size_t header = 0;
  for (std::size_t k = 0; k < 4; ++k)
    header |= static_cast<std::size_t>(static_cast<unsigned char>(text[8 + k])) << (8 * k);
  EXPECT_EQ((12 + header) % 64, 0U);
  const auto columns =
      static_cast<std::size_t>(std::count(text.begin(), text.begin() + 12 + static_cast<long>(header), '<'));
  EXPECT_GE(text.size(), 12 + header + 8 * columns * static_cast<std::size_t>(rows()));
}

// A file may not grow beyond 40 kB: what a full disk looks like to the program. It says so itself, where the signal is
// ignored and where it is not.
TEST_F(Kill, AFullDiskIsToldAndTheRunGoesOnWhenThereIsRoom) {
  const std::string scene = "'" BRAMAH_SOURCE_DIR "/scenes/four_bar/underdamped_low_friction.json'";
  const std::string settings =
      " --set simulate.output_step=1e-4 --set simulate.to_time=0.2 --set simulate.integrator=generalized_alpha --set "
      "simulate.step=1e-4";
  ASSERT_EQ(bramah("simulate " + scene + settings + " --out whole").code, 0);
  for (const char* trap : {"trap '' XFSZ; ", ""}) {
    fs::remove_all(folder_ / "out");
    const std::string command = "cd '" + folder_.string() + "' && bash -c \"" + trap +
                                "ulimit -f 80; '" BRAMAH_BINARY_DIR "/bin/bramah' simulate " + scene + settings +
                                " --save-every 1e-9 --out out\" 2>err";
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 4);
    EXPECT_THAT(contents(folder_ / "err"), HasSubstr("out/time_series.csv: error: cannot be written: File too large"));
    EXPECT_THAT(contents(folder_ / "err"), HasSubstr("rows so far are in out/time_series.csv.part"));
    EXPECT_THAT(contents(folder_ / "err"), HasSubstr("go on with --resume out/checkpoint.json"));
    EXPECT_FALSE(fs::exists(folder_ / "out/time_series.csv"));
    EXPECT_TRUE(has(folder_ / "out/time_series.csv.part", 1000));
    const Ended rest = bramah("simulate " + scene + settings + " --out out --resume out/checkpoint.json");
    EXPECT_EQ(rest.code, 0) << rest.err;
    EXPECT_EQ(contents(folder_ / "out/time_series.csv"), contents(folder_ / "whole/time_series.csv"));
  }
}

std::vector<std::vector<double>> numbers_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(std::stod(field));
  }
  return rows;
}

// Whatever ends a run, and whenever: continued into its folder until its end it has the rows of the run that nobody broke.
// The generalized-alpha method has the same bits; the others start anew where they were continued, and agree to what
// rel_tol leaves.
TEST_F(Kill, AtAnyMomentTheRunGoesOnToTheSameSeries) {
  const int count = support::property_runs(4);
  int all_breaks = 0;
  for (int k = 0; k < count; ++k) {
    std::mt19937_64 random(support::property_seed(k));
    const bool same_bits = k % 2 == 0, binary = k % 4 == 2;
    std::vector<std::string> command = {BRAMAH_BINARY_DIR "/bin/bramah",
                                        "simulate",
                                        BRAMAH_SOURCE_DIR "/scenes/four_bar/underdamped_low_friction.json",
                                        "--set",
                                        "simulate.output_step=1e-4",
                                        "--set",
                                        "simulate.to_time=0.5",
                                        "--set",
                                        std::string("simulate.integrator=") + (same_bits ? "generalized_alpha" : "ida"),
                                        "--set",
                                        "simulate.rel_tol=1e-8"};
    if (same_bits) command.insert(command.end(), {"--set", "simulate.step=2e-5"});
    if (binary) command.emplace_back("--binary");
    const std::string series = binary ? "time_series.npy" : "time_series.csv";
    const fs::path whole = folder_ / "whole", broken = folder_ / "broken";
    fs::remove_all(whole);
    fs::remove_all(broken);
    const auto run = [&](const fs::path& out, const std::vector<std::string>& more) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), {"--out", out.string()});
      arguments.insert(arguments.end(), more.begin(), more.end());
      return arguments;
    };
    ASSERT_EQ(Process(run(whole, {}), folder_ / "err").end_by(0), 0) << contents(folder_ / "err");
    int breaks = 0;
    for (int code = -1; code != 0; ++breaks) {
      ASSERT_LT(breaks, 2000);
      std::vector<std::string> more = {"--save-every", "0.005"};
      if (fs::exists(broken / "checkpoint.json"))
        more.insert(more.end(), {"--resume", (broken / "checkpoint.json").string()});
      Process process(run(broken, more), folder_ / "err");
      std::this_thread::sleep_for(
          std::chrono::milliseconds(std::uniform_int_distribution<int>(20, 150 + 5 * breaks)(random)));
      const int signals[] = {SIGKILL, SIGINT, SIGTERM, SIGHUP};
      code = process.end_by(signals[std::uniform_int_distribution<std::size_t>(0, 3)(random)]);
      ASSERT_TRUE(code == 0 || code == 130 || code < 0) << code << ": " << contents(folder_ / "err");
    }
    all_breaks += breaks;
    RecordProperty("breaks", all_breaks);
    const std::string expected = contents(whole / series), found = contents(broken / series);
    if (same_bits) {
      EXPECT_TRUE(found == expected) << series << " differs after " << breaks << " breaks";
      continue;
    }
    const auto a = numbers_of(expected), b = numbers_of(found);
    ASSERT_EQ(a.size(), b.size()) << "after " << breaks << " breaks";
    for (std::size_t row = 0; row < a.size(); ++row) {
      ASSERT_EQ(a[row][0], b[row][0]) << "row " << row;
      for (std::size_t i = 1; i < a[row].size(); ++i)
        ASSERT_NEAR(a[row][i], b[row][i], 1e-4 * (1.0 + std::abs(a[row][i]))) << "row " << row << ", column " << i;
    }
  }
}

// Studies of many points have their journal. What they find in the end has the bits of the study that nobody broke.
TEST_F(Kill, AtAnyMomentAStudyGoesOnToTheSameResults) {
  struct Study {
    const char *verb, *scene;
    std::vector<std::string> more, files;
  };
  const Study studies[] = {
      {"vary", "linear/pendulum.json", {"--set", "vary.count=20"}, {"vary.json", "vary.csv"}},
      {"sweep",
       "bicycle/benchmark.json",
       {"--over", "constants.v=0.2:9:45"},
       {"sweep.json", "sweep.csv", "root_locus.svg", "real_parts.svg"}},
      {"critical", "bicycle/benchmark.json", {"--over", "constants.v=0.2:9:45"}, {"critical.json"}},
  };
  const int count = support::property_runs(1);
  int breaks = 0;
  for (int k = 0; k < count; ++k) {
    std::mt19937_64 random(support::property_seed(k));
    for (const Study& study : studies) {
      const fs::path whole = folder_ / "whole", broken = folder_ / "broken";
      const fs::path journal = broken / (std::string(study.verb) + ".journal");
      fs::remove_all(whole);
      fs::remove_all(broken);
      const auto run = [&](const fs::path& out, bool resume) {
        std::vector<std::string> arguments = {BRAMAH_BINARY_DIR "/bin/bramah", study.verb,
                                              std::string(BRAMAH_SOURCE_DIR "/scenes/") + study.scene, "--out",
                                              out.string()};
        arguments.insert(arguments.end(), study.more.begin(), study.more.end());
        if (resume) arguments.insert(arguments.end(), {"--resume", journal.string()});
        return arguments;
      };
      ASSERT_EQ(Process(run(whole, false), folder_ / "err").end_by(0), 0) << contents(folder_ / "err");
      EXPECT_FALSE(fs::exists(whole / (std::string(study.verb) + ".journal.part")));
      const int before = breaks;
      for (int code = -1; code != 0; ++breaks) {
        ASSERT_LT(breaks - before, 2000);
        const bool resume = fs::exists(journal) || fs::exists(journal.string() + ".part");
        Process process(run(broken, resume), folder_ / "err");
        const int longest = 400 + 20 * (breaks - before);  // a slow build needs more only to start
        std::this_thread::sleep_for(std::chrono::milliseconds(std::uniform_int_distribution<int>(20, longest)(random)));
        const int signals[] = {SIGKILL, SIGINT, SIGTERM, SIGHUP};
        code = process.end_by(signals[std::uniform_int_distribution<std::size_t>(0, 3)(random)]);
        ASSERT_TRUE(code == 0 || code == 130 || code < 0) << code << ": " << contents(folder_ / "err");
        if (code == 130) {
          EXPECT_THAT(contents(folder_ / "err"), HasSubstr("--resume " + journal.string() + " goes on"));
        }
      }
      for (const std::string& file : study.files)
        EXPECT_TRUE(contents(whole / file) == contents(broken / file))
            << file << " differs after " << breaks << " breaks";
      EXPECT_FALSE(fs::exists(journal) || fs::exists(journal.string() + ".part"));
    }
  }
  RecordProperty("breaks", breaks);
}

TEST_F(Kill, AStudyOnAFullDiskGoesOnWhenThereIsRoom) {
  const std::string study = "vary '" BRAMAH_SOURCE_DIR "/scenes/linear/pendulum.json' --quiet";
  ASSERT_EQ(bramah(study + " --out whole").code, 0);
  const std::string command = "cd '" + folder_.string() +
                              "' && bash -c \"ulimit -f 16; '" BRAMAH_BINARY_DIR "/bin/bramah' " + study +
                              " --out out\" >out.txt 2>err";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 4);
  EXPECT_THAT(contents(folder_ / "err"), HasSubstr("out/vary.journal: error: cannot be written: File too large"));
  EXPECT_THAT(contents(folder_ / "err"), HasSubstr("go on with --resume out/vary.journal"));
  EXPECT_FALSE(fs::exists(folder_ / "out/vary.csv"));
  EXPECT_GT(contents(folder_ / "out/vary.journal.part").size(), 10000U);
  EXPECT_EQ(bramah(study + " --out out --resume out/vary.journal").code, 0);
  EXPECT_EQ(contents(folder_ / "out/vary.csv"), contents(folder_ / "whole/vary.csv"));
}

TEST_F(Kill, AJournalOfAnotherStudyIsRefused) {
  const std::string pendulum = "'" BRAMAH_SOURCE_DIR "/scenes/linear/pendulum.json'";
  const auto expect = [&](const std::string& arguments, const char* found) {
    const Ended run = bramah(arguments);
    EXPECT_EQ(run.code, 2) << arguments << run.err;
    EXPECT_THAT(run.err, HasSubstr(found)) << arguments;
  };
  write("vary.journal", "{\"bramah_journal\": \"vary\", \"stamp\": \"0123456789abcdef\"}\n");
  expect("vary " + pendulum + " --resume vary.journal", "vary.journal: error: the journal of another study, scene");
  expect("vary " + pendulum + " --resume none.journal", "none.journal: error: there is no such file");
  expect("vary " + pendulum + " --resume stdout.txt", "stdout.txt: error: a file that is no journal");
  // A line in the middle that nobody wrote so.
  Process slow({BRAMAH_BINARY_DIR "/bin/bramah", "vary", BRAMAH_SOURCE_DIR "/scenes/linear/pendulum.json", "--out",
                (folder_ / "out").string()},
               folder_ / "err");
  ASSERT_TRUE(comes_true([&] { return has(folder_ / "out/vary.journal.part", 2000); }));
  EXPECT_EQ(slow.end_by(SIGKILL), -SIGKILL);
  std::string text = contents(folder_ / "out/vary.journal.part");
  text.replace(text.find('\n') + 3, 5, "#####");
  write("out/vary.journal.part", text);
  expect("vary " + pendulum + " --resume out/vary.journal", "out/vary.journal.part: error: line 2 is damaged");
}

TEST_F(Kill, TwoRunsDoNotShareAFolder) {
  Process first(endless(), folder_ / "err");
  ASSERT_TRUE(comes_true([&] { return has(folder_ / "out/time_series.csv.part", 1000); }));
  const Ended second = bramah("simulate " + scene_ + " --out out");
  EXPECT_EQ(second.code, 4);
  EXPECT_THAT(second.err, HasSubstr("is in use by another run, process "));
  EXPECT_EQ(first.end_by(SIGKILL), -SIGKILL);
  EXPECT_EQ(bramah("simulate " + scene_ + " --out out").code, 0) << "the lock of a dead process does not block";
  EXPECT_FALSE(fs::exists(folder_ / "out/.bramah.lock"));
}

TEST_F(Kill, AFolderThatCannotBeMadeIsToldBeforeAnyWork) {
  write("file", "");
  const Ended run = bramah("simulate " + scene_ + " --out file/out");
  EXPECT_EQ(run.code, 4);
  EXPECT_THAT(run.err, HasSubstr("file/out: error: the folder cannot be made: "));
}

}  // namespace
}  // namespace bramah
