// What every verb begins and ends with: a scene compiled with its settings, and results delivered.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "app/arguments.hpp"
#include "linear/linearize.hpp"
#include "linear/stability.hpp"
#include "solve/equilibrium.hpp"
#include "solve/start.hpp"
#include "system/compile.hpp"

namespace bramah {

struct Context {
  Arguments arguments;
  Scene scene;
  Compiled compiled;
  [[nodiscard]] const System& system() const { return compiled.system; }
  [[nodiscard]] const Options& options() const { return compiled.options; }
  /// Analyses without a time of their own take the inputs of this one.
  [[nodiscard]] double start_time() const { return options().simulate.from_time; }
};

/// Reads, sets and compiles. Throws Failure.
Context load(const Arguments& arguments);

/// A linear model and where it came from.
struct Linearization {
  bool at_equilibrium = true;
  State state;
  std::optional<Equilibrium> equilibrium;  // `state`, with how it was found
  std::optional<Stability> stability;      // of the equilibrium, where it was judged
  Partition partition;
  Conditions conditions;  // of the partition
  LinearModel model;
  Eigen::MatrixXd motion, response;  // of the Linearizer
  std::vector<StartNote> notes;      // what is to be said of the start values
};
/// AnalysisError where `state` is a singular position, at which no single linear model exists.
void refuse_singular(const System& system, const State& state);
/// With coordinates of the partition prescribed; C and D of `outputs`; the equilibrium near `guess`, where given.
Linearization linearize(const Compiled& compiled, const Prescribed& prescribed, std::vector<Measured> outputs = {},
                        const State* guess = nullptr);
Linearization linearize(const Context& context);
/// With the scene's outputs. AnalysisError for one that has no rows in C and D.
Linearization linearize_outputs(const Context& context);

/// The document as FILE in the folder of --out, where one is given; on standard output the document with --json and
/// the text without.
void deliver(const Arguments& arguments, std::string_view file, const std::string& document, const std::string& text);

/// Standard output, with failures noticed at the latest by finish_printing. Both throw WriteError.
void print(std::string_view text);
void finish_printing();
/// Standard error.
void say(std::string_view text);

}  // namespace bramah
