// The program run from a folder of its own: what every test of the command line begins with.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace bramah {

namespace fs = std::filesystem;
using nlohmann::json;

inline std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

struct Ended {
  int code = -1;
  std::string out, err;
};

/// A test with a folder of its own, from which the program is run.
class Cli : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / ("bramah_cli_" + std::to_string(getpid()) + "_" + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// `arguments` as a shell would read them.
  [[nodiscard]] Ended bramah(const std::string& arguments) const {
    const fs::path out = folder_ / "stdout.txt", err = folder_ / "stderr.txt";
    const std::string command = "cd '" + folder_.string() + "' && '" BRAMAH_BINARY_DIR "/bin/bramah' " + arguments +
                                " >'" + out.string() + "' 2>'" + err.string() + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
  }
  /// One JSON document and nothing else on standard output.
  [[nodiscard]] json document(const std::string& arguments, int code = 0) const {
    const Ended run = bramah(arguments + " --json");
    EXPECT_EQ(run.code, code) << run.err;
    return json::parse(run.out);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  /// The overdamped scene with one text replaced by another.
  void write_changed(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = contents(BRAMAH_SOURCE_DIR "/scenes/four_bar/overdamped.json");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    write(name, text.replace(at, from.size(), to));
  }

  fs::path folder_;
  const std::string scene_ = "'" BRAMAH_SOURCE_DIR "/scenes/four_bar/overdamped.json'";
};

}  // namespace bramah
