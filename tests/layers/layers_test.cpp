// A folder is a floor and arrows point down; a heavy library has one door; a component sees the SDK alone.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "layers/includes.hpp"

namespace bramah::layers {
namespace {

namespace fs = std::filesystem;

TEST(Layers, TableItselfPointsDown) {
  for (const auto& [folder, floor] : floors()) {
    for (const std::string& seen : floor.sees) {
      EXPECT_LT(floors().at(seen).number, floor.number) << folder << " sees " << seen;
    }
  }
}

TEST(Layers, SourcesKeepToTheTable) {
  const fs::path root = BRAMAH_SOURCE_DIR;
  ASSERT_GT(files_read(root), 0U);
  for (const std::string& violation : violations(root)) ADD_FAILURE() << violation;
}

/// A small tree in a directory of its own, sound until a line is added to it.
class MadeUpTree : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    write("engine/abi/bramah/abi.h", "#include <stdint.h>");
    write("engine/sdk/bramah/component.hpp", "#include <utility>\n#include \"bramah/abi.h\"");
    write("engine/plugin/library.hpp", "#include <bramah/abi.h>\n#include <dlfcn.h>");
    write("engine/system/state.hpp", "#include \"plugin/library.hpp\"\n#include <vector>");
    write("engine/sparse/lu.hpp", "#include <klu.h>\n#include <Eigen/SparseCore>");
    write("engine/solve/simulate.cpp", "#include \"system/state.hpp\"\n#include <ida/ida.h>");
    write("engine/linear/reduce.hpp", "#include \"sparse/lu.hpp\"\n#include <Eigen/Dense>");
    write("engine/io/report.cpp", "#include <nlohmann/json.hpp>\n#include \"linear/reduce.hpp\"");
    write("engine/app/main.cpp", "#include <CLI/CLI.hpp>\n  #  include \"io/report.hpp\"");
    write("components/hydraulics/volume.hpp", "#include <bramah/component.hpp>\n#include <cmath>");
    write("components/hydraulics/library.cpp", "#include \"volume.hpp\"");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const fs::path& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file, std::ios::app) << text << '\n';
  }

  const fs::path root_ = fs::path(testing::TempDir()) /
                         (std::string("layers_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(MadeUpTree, IsSound) { EXPECT_EQ(violations(root_), std::vector<std::string>{}); }

TEST_F(MadeUpTree, ReportsAnUpwardArrow) {
  write("engine/system/state.hpp", "#include \"linear/reduce.hpp\"");
  EXPECT_EQ(violations(root_), std::vector<std::string>{"engine/system/state.hpp:3: includes linear/reduce.hpp: "
                                                        "system/ must not see linear/"});
}

TEST_F(MadeUpTree, ReportsANeighbourOnTheSameFloor) {
  write("engine/system/state.hpp", "#include \"sparse/lu.hpp\"");
  EXPECT_EQ(violations(root_).size(), 1U);
}

TEST_F(MadeUpTree, ReportsSdkInTheEngineBelowItsReach) {
  write("engine/plugin/library.hpp", "#include <bramah/component.hpp>");
  EXPECT_EQ(violations(root_).size(), 1U);
}

TEST_F(MadeUpTree, ReportsAPathThatClimbs) {
  write("engine/sparse/lu.hpp", "#include \"../linear/reduce.hpp\"");
  EXPECT_EQ(violations(root_).size(), 1U);
}

TEST_F(MadeUpTree, ReportsAFolderWithoutAFloor) {
  write("engine/attic/old.cpp", "#include <vector>");
  EXPECT_EQ(violations(root_).size(), 1U);
}

TEST_F(MadeUpTree, ReportsHeavyLibrariesOutsideTheirDoor) {
  const std::vector<std::string> headers = {"Eigen/Dense",
                                            "unsupported/Eigen/MatrixFunctions",
                                            "klu.h",
                                            "suitesparse/cholmod.h",
                                            "colamd.h",
                                            "amd.h",
                                            "sundials/types.h",
                                            "nvector/nvector_serial.h",
                                            "ida/ida.h",
                                            "lapacke.h",
                                            "nlohmann/json.hpp",
                                            "CLI/CLI.hpp",
                                            "dlfcn.h"};
  for (const std::string& header : headers) write("engine/system/state.hpp", "#include <" + header + ">");
  EXPECT_EQ(violations(root_).size(), headers.size());
}

TEST_F(MadeUpTree, ReportsAComponentThatSeesMoreThanTheSdk) {
  for (const char* header : {"system/state.hpp", "Eigen/Dense", "../friction/law.hpp", "unistd.h"}) {
    write("components/hydraulics/library.cpp", std::string("#include \"") + header + "\"");
  }
  EXPECT_EQ(violations(root_).size(), 4U);
}

TEST_F(MadeUpTree, ReportsAnSdkThatNeedsALibrary) {
  write("engine/sdk/bramah/component.hpp", "#include <boost/optional.hpp>");
  EXPECT_EQ(violations(root_).size(), 1U);
}

}  // namespace
}  // namespace bramah::layers
