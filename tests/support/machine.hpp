// A scene brought to life for a test: read, changed, compiled.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "linear/linearize.hpp"
#include "linear/spectrum.hpp"
#include "solve/start.hpp"
#include "system/compile.hpp"

namespace bramah::testing {

/// Plugins of the build and of tests/paper.
std::shared_ptr<Registry> registry();

struct Machine {
  Scene scene;
  Compiled compiled;
  [[nodiscard]] const System& system() const { return compiled.system; }
  [[nodiscard]] const Options& options() const { return compiled.options; }
  /// Value of a variable by name.
  [[nodiscard]] double value(const State& state, const std::string& name) const;
};

/// `file` relative to the repository, `settings` as after --set.
Machine load(const std::string& file, const std::vector<std::string>& settings = {});

/// The reduced model of the scene at `state`, with the scene's independent coordinates.
LinearModel linear_model(const Machine& machine, const State& state);

std::vector<std::complex<double>> eigenvalues(const LinearModel& model);

}  // namespace bramah::testing
