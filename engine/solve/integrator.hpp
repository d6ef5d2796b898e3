// A method of marching in time: what `simulate` asks of it, whichever it is.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "system/analysis_error.hpp"
#include "system/options.hpp"
#include "system/system.hpp"

namespace bramah {

/// Work done by an integrator; sums over all segments.
struct IntegratorWork {
  long steps = 0;
  long evaluations = 0;        // of rows: residuals or rates
  long jacobians = 0;          // evaluations of partials
  long factorizations = 0;     // numeric
  long newton_iterations = 0;  // zero for explicit methods
  long error_test_failures = 0, convergence_failures = 0;
  long imprecise = 0;  // accelerations that were integrated with fewer than six digits
  IntegratorWork& operator+=(const IntegratorWork& other);
};

class Integrator {
 public:
  Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;
  virtual ~Integrator() = default;

  /// As the scene names it: "ida", "explicit", "implicit", "generalized_alpha".
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Starts at state.t from a complete state (x and v on the constraints, a, lambda, zdot from the KKT solve). Steps do
  /// not pass `end`, where an input breaks; inputs at `end` are those from before. Forgets all that lies behind.
  virtual void begin(const State& state, double end) = 0;

  /// One accepted step, to a state on the constraints. Returns the time reached, later than the one before. Throws
  /// AnalysisError that names the row and the component that keep it from going on.
  virtual double step() = 0;

  /// t, side, x, v, z and inputs of `state` at a time within the last step, both ends included; a, zdot and lambda are
  /// left as they are where the method does not have them.
  virtual void interpolate(double t, State& state) = 0;

  /// The variable that limited the last step: 0 .. n-1 in x, n .. 2n-1 in v, then z; -1 where none did.
  [[nodiscard]] virtual Index limiting() = 0;

  [[nodiscard]] virtual IntegratorWork work() const = 0;

  /// What the next step depends on beside t, x, v, z of the state reached; empty where the method cannot go on from it as
  /// if it had never stopped.
  [[nodiscard]] virtual Vector memory() const { return {}; }
  /// After begin(state, end) with the state and the end of that time: the steps that follow have the same bits. Throws
  /// AnalysisError where `memory` is not that of this method and system.
  virtual void recall(std::span<const double> memory) {
    if (!memory.empty())
      throw AnalysisError("simulate", "a checkpoint of another integrator than " + std::string(name()),
                          "the integrator that wrote it", "give the \"integrator\" of the first run", "/simulate");
  }
};

/// Name of variable `i` in the order of Integrator::limiting; "an unknown" beyond.
std::string variable_name(const System& system, Index i);
/// The component it belongs to, "" beyond.
std::string variable_component(const System& system, Index i);

/// The error of an integrator that cannot go on at time t: `why`, then what a component said, if any, and the variable
/// that limited the step (-1: none).
AnalysisError stalled(const System& system, double t, double step, std::string why, const std::string& trouble,
                      Index limiting);

std::unique_ptr<Integrator> make_ida(const System& system, const SimulateOptions& options, const State& start);
std::unique_ptr<Integrator> make_explicit(const System& system, const SimulateOptions& options, const State& start);
std::unique_ptr<Integrator> make_implicit(const System& system, const SimulateOptions& options, const State& start);
std::unique_ptr<Integrator> make_generalized_alpha(const System& system, const SimulateOptions& options,
                                                   const State& start);

}  // namespace bramah
