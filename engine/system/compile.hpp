// From a scene to a system: types looked up, ports connected, parameters converted and checked, variables and rows
// numbered, patterns made once. Every fault of the scene is reported at once.
#pragma once

#include <memory>
#include <vector>

#include "plugin/registry.hpp"
#include "system/diagnostic.hpp"
#include "system/options.hpp"
#include "system/scene.hpp"
#include "system/system.hpp"

namespace bramah {

struct Compiled {
  System system;
  Options options;
  std::vector<Diagnostic> warnings;  // what is allowed and rarely meant
};

/// Loads the scene's libraries into `registry` and compiles. Throws SceneError with every fault of the scene, after the
/// `earlier` ones that reading it has found.
Compiled compile(const Scene& scene, std::shared_ptr<Registry> registry, std::vector<Diagnostic> earlier = {});

}  // namespace bramah
