#include "solve/choose_integrator.hpp"

#include <algorithm>
#include <cmath>

#include "solve/rates.hpp"
#include "solve/scaled_state.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

constexpr int trial_steps = 20;
constexpr int power_iterations = 30;
// Dormand and Prince's method is stable for h |s| up to about 3.3 on the negative real axis.
constexpr double stability_bound = 3.3;
// The run in steps of that length: fewer are cheap whatever bounds them, more are too many even where they are needed at
// the start.
constexpr double few_steps = 500.0, most_steps = 5'000.0;

/// Spectral radius of the rates' Jacobian at `state`, 1/s, by the power method.
double fastest(const System& system, State state) {
  Rates rates(system, state);
  rates.linearize(state);
  const Vector scale = ScaledState(system, 1.0).scale();
  Vector direction(scale.size()), image(scale.size());
  for (std::size_t i = 0; i < direction.size(); ++i) {
    // A fixed start without structure: the same choice on every run.
    direction[i] = scale[i] * (1.0 + 0.5 * std::sin(static_cast<double>(7 * i + 1)));
  }
  const auto size = [&](const Vector& y) {
    double sum = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) sum += (y[i] / scale[i]) * (y[i] / scale[i]);
    return std::sqrt(sum);
  };
  // Two steps at a time: an undamped pair of eigenvalues turns, its square does not.
  double radius = 0.0;
  for (int k = 0; k < power_iterations; ++k) {
    const double before = size(direction);
    if (before == 0.0) return radius;
    for (double& value : direction) value /= before;
    rates.apply(direction, image);
    rates.apply(image, direction);
    radius = std::sqrt(size(direction));
  }
  return radius;
}

}  // namespace

SimulateOptions::Integrator integrator_called(std::string_view name) {
  using Kind = SimulateOptions::Integrator;
  if (name == "ida") return Kind::ida;
  if (name == "explicit") return Kind::explicit_one_step;
  if (name == "implicit") return Kind::implicit_one_step;
  return name == "generalized_alpha" ? Kind::generalized_alpha : Kind::automatic;
}

ChosenIntegrator choose_integrator(const System& system, const SimulateOptions& options, const State& start) {
  using Kind = SimulateOptions::Integrator;
  switch (options.integrator) {
    case Kind::ida: return {make_ida(system, options, start), ""};
    case Kind::explicit_one_step: return {make_explicit(system, options, start), ""};
    case Kind::implicit_one_step: return {make_implicit(system, options, start), ""};
    case Kind::generalized_alpha: return {make_generalized_alpha(system, options, start), ""};
    case Kind::automatic: break;
  }
  const double speed = fastest(system, start);
  const double bound = stability_bound / std::max(speed, 1e-300);
  std::string seen = "the fastest motion has " + digits(speed) + " 1/s";
  const double steps = (options.to_time - start.t) / bound;
  if (steps > most_steps) return {make_ida(system, options, start), seen};
  try {
    auto trial = make_explicit(system, options, start);
    trial->begin(start, std::min(options.to_time, next_breakpoint(system, start.t)));
    double t = start.t, step = 0.0;
    for (int k = 0; k < trial_steps && t < options.to_time; ++k) {
      const double reached = trial->step();
      step = std::max(step, reached - t);
      t = reached;
    }
    const bool stiff = step > 0.5 * bound && steps > few_steps;
    seen += ", steps for accuracy " + digits(step) + " s";
    if (!stiff) return {make_explicit(system, options, start), seen};
  } catch (const AnalysisError&) {
    seen += ", explicit steps fail";
  }
  return {make_ida(system, options, start), seen};
}

}  // namespace bramah
