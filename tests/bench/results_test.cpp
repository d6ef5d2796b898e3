// What the bench makes of its results: goals, and changes beyond noise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "bench/goals.hpp"
#include "bench/regression.hpp"
#include "bench/results.hpp"
#include "support/numbers.hpp"

namespace bramah::bench {
namespace {

using testing::close;
using ::testing::ElementsAre;

class Files : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("bramah_bench_") + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  /// Results whose lines are these.
  Results results(const std::string& lines) {
    file("r.workloads.jsonl", lines);
    file("r.json", R"({"context": {"commit": "abc"}, "benchmarks": []})");
    file("r.compare.json", "{}");
    return Results((folder_ / "r").string());
  }
  std::vector<Goal> goals(const std::string& text, const std::string& lines) {
    return read_goals(file("goals.json", R"({"goals": [)" + text + "]}"), results(lines));
  }

 private:
  std::filesystem::path folder_;
};
using Goals = Files;
using Regress = Files;

const std::string lines = R"({"workload": "work", "N": 10, "time_s": 2e-5}
{"workload": "work", "N": 100, "time_s": 3e-4}
{"workload": "work", "N": 100, "rung": "slow", "columns": 1, "time_s": 0.3}
{"workload": "run", "N": 4, "tolerance": 1e-3, "time_s": 0.1, "error": 0.5, "steps": 10}
{"workload": "run", "N": 4, "tolerance": 1e-5, "time_s": 0.3, "error": 1e-4, "steps": 30}
{"workload": "run", "N": 4, "tolerance": 1e-7, "time_s": 0.9, "error": 1e-6, "steps": 90}
)";

TEST_F(Goals, TakeOneFigure) {
  const auto found = goals(R"({"goal": "a", "at_most": 1e-5, "take": {"workload": "work", "N": 10, "key": "time_s"},
                              "missed": "for a reason"})",
                           lines);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].measured, 2e-5);
  EXPECT_FALSE(found[0].met());
  EXPECT_EQ(found[0].note, "for a reason");
  EXPECT_EQ(found[0].unit, "s");
}

TEST_F(Goals, TakeTheWorstOfSizesPerBodyAndHowFlatTheyAre) {
  const std::string take = R"("take": {"workload": "work", "key": "time_s", "per_body": true}, "sizes": [10, 100])";
  const auto found = goals(R"({"goal": "a", "at_most": 4e-6, )" + take + R"(},
                              {"goal": "b", "at_most": 1.4, "flat": true, )" +
                               take + R"(, "missed": "not flat"})",
                           lines);
  EXPECT_TRUE(close(found[0].measured, 3e-6, 1e-14));
  EXPECT_TRUE(found[0].met());
  EXPECT_EQ(found[0].note, "");
  EXPECT_TRUE(close(found[1].measured, 1.5, 1e-14));
  EXPECT_FALSE(found[1].met());
  EXPECT_EQ(found[1].note, "not flat");
}

TEST_F(Goals, CompareWithARivalOfTheSameRun) {
  const auto found = goals(R"({"goal": "a", "at_least": 999, "over": "slow",
                              "take": {"workload": "work", "N": 100, "key": "time_s"}})",
                           lines);
  EXPECT_TRUE(close(found[0].measured, 1000.0, 1e-14));
  EXPECT_TRUE(found[0].met());
  EXPECT_EQ(found[0].note, "one column of the rival measured, times their number");
}

TEST_F(Goals, TakeTheFastestRunThatIsExactEnough) {
  const std::string take = R"("take": {"workload": "run", "N": 4, "key": "time_s"})";
  const auto found = goals(R"({"goal": "a", "at_most": 0.5, "error": 1e-3, )" + take + R"(},
                              {"goal": "b", "at_most": 0.5, "error": 1e-9, )" +
                               take + "}",
                           lines);
  EXPECT_EQ(found[0].measured, 0.3);
  EXPECT_EQ(found[0].note, "tolerance 1e-05, error 0.0001, 30 steps");
  EXPECT_TRUE(std::isnan(found[1].measured));
  EXPECT_FALSE(found[1].met());
  EXPECT_EQ(found[1].note, "no tolerance that was tried has a smaller error than 1e-06");
}

TEST_F(Goals, SayWhatIsNotMeasuredAndWhatIsNoGoal) {
  EXPECT_TRUE(std::isnan(
      goals(R"({"goal": "a", "at_most": 1, "take": {"workload": "work", "N": 11, "key": "time_s"}})", lines)[0]
          .measured));
  try {
    goals(R"({"goal": "a", "take": {}})", lines);
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                ::testing::EndsWith(": goal 1 needs \"goal\", \"take\", and \"at_most\" or \"at_least\""));
  }
}

TEST_F(Goals, SayWhereAResultIsBroken) {
  try {
    results("{\"workload\": \"a\", \"N\": 1}\n{\"workload\": \n");
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("r.workloads.jsonl, result 2:1:"));
  }
}

TEST_F(Goals, OfTheRepositoryCanBeRead) {
  const auto found = read_goals(BRAMAH_SOURCE_DIR "/bench/goals.json", results(lines));
  EXPECT_GT(found.size(), 20U);
}

TEST_F(Regress, NamesWorkloadsThatChangedBeyondNoise) {
  // Two single runs vary by 10 % each: 3 sqrt(2) 10 % = 42 %.
  const std::string before = file("old.jsonl", R"({"workload": "a", "N": 1, "x_s": 1.0, "y_s": 1.0, "z_s": 1.0}
{"workload": "b", "N": 1, "x_s": 1.0}
)");
  const std::string after = file("new.jsonl", R"({"workload": "a", "N": 1, "x_s": 1.4, "y_s": 1.5, "z_s": 0.6}
{"workload": "c", "N": 1, "x_s": 1.0}
)");
  const Regression found = changes_between(before, after);
  ASSERT_EQ(found.changes.size(), 2U);
  EXPECT_EQ(found.changes[0].name, "a/1 y");
  EXPECT_TRUE(found.changes[0].slower());
  EXPECT_EQ(found.changes[1].name, "a/1 z");
  EXPECT_FALSE(found.changes[1].slower());
  EXPECT_TRUE(found.slower());
  EXPECT_EQ(found.within_noise, 1U);
  EXPECT_THAT(found.only_before, ElementsAre("b/1 x"));
  EXPECT_THAT(found.only_after, ElementsAre("c/1 x"));
}

TEST_F(Regress, MeasuresNoiseByTheVariationOfMicroBenchmarks) {
  const auto micro = [&](const std::string& name, double steady, double shaky) {
    const auto entry = [](const std::string& work, double median, double variation) {
      return R"({"run_name": ")" + work + R"(", "aggregate_name": "median", "cpu_time": )" + std::to_string(median) +
             R"(, "time_unit": "us"}, {"run_name": ")" + work + R"(", "aggregate_name": "cv", "cpu_time": )" +
             std::to_string(variation) + R"(, "time_unit": "us"})";
    };
    return file(name, R"({"benchmarks": [)" + entry("steady", steady, 0.01) + ", " + entry("shaky", shaky, 0.1) + "]}");
  };
  const Regression found = changes_between(micro("old.json", 10.0, 10.0), micro("new.json", 12.0, 12.0));
  ASSERT_EQ(found.changes.size(), 1U);
  EXPECT_EQ(found.changes[0].name, "steady");
  EXPECT_TRUE(close(found.changes[0].ratio(), 1.2, 1e-12));
  EXPECT_TRUE(close(found.changes[0].noise, 0.15, 1e-12));
  EXPECT_EQ(found.within_noise, 1U);
}

}  // namespace
}  // namespace bramah::bench
