// All component types within reach, without a scene.
#pragma once

#include <string>
#include <vector>

#include "plugin/registry.hpp"

namespace bramah {

struct Catalogue {
  Registry registry;
  std::vector<std::string> problems;  // libraries that could not be loaded; said on standard error as well
};
Catalogue load_catalogue();

}  // namespace bramah
