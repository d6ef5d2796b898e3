// Reads the #include lines of engine/ and components/ and reports those that point up, or through a wall.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace bramah::layers {

/// One folder of engine/: where it stands and which lower folders it may see.
struct Floor {
  int number;
  std::set<std::string> sees;
};
/// The floors, by folder name.
const std::map<std::string, Floor>& floors();

/// One message per forbidden include, `file:line: what is wrong`, in the tree rooted at `root`; empty for a sound tree.
std::vector<std::string> violations(const std::filesystem::path& root);

/// The number of source files below `root` that `violations` reads.
std::size_t files_read(const std::filesystem::path& root);

}  // namespace bramah::layers
