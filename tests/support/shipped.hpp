// The scenes that we ship, as cases of parameterized tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

namespace bramah::testing {

/// Files relative to the repository, sorted.
inline std::vector<std::string> shipped_scenes() {
  std::vector<std::string> files;
  const std::filesystem::path root = BRAMAH_SOURCE_DIR;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "scenes")) {
    if (entry.path().extension() == ".json") files.push_back(std::filesystem::relative(entry.path(), root).string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Name of a case.
inline std::string shipped_name(const ::testing::TestParamInfo<std::string>& scene) {
  std::string name = scene.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

}  // namespace bramah::testing
