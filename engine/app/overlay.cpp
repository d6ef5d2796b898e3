#include "app/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "linear/respond.hpp"
#include "system/measure.hpp"

namespace bramah {

void Recording::take(const System& system, const State& state, const Vector& outputs, double linear_from) {
  // Of two states at one time the second is that after the jump. Rounding of output times is no reason to miss it.
  const double nearly = linear_from - 1e-12 * std::max(1.0, std::abs(linear_from));
  const bool is_first = from.empty() && state.t >= nearly;
  if (linear_from >= 0.0 &&
      (is_first || (!from.empty() && state.t == from.front().t && from_index + 1 == times.size()))) {
    from.assign(1, state);
    from_index = times.size();
  }
  times.push_back(state.t);
  values.push_back(outputs);
  const auto first_input = state.z.begin() + system.nz();
  inputs.emplace_back(first_input, first_input + system.nu());
}

double settling_time(const Spectrum& spectrum) {
  double slowest = HUGE_VAL;
  for (const Mode& mode : spectrum.modes) {
    if (!mode.zero && mode.eigenvalue.real() < 0.0) slowest = std::min(slowest, -mode.eigenvalue.real());
  }
  return std::isfinite(slowest) ? std::log(100.0) / slowest : HUGE_VAL;
}

std::vector<double> overlay_times(const Spectrum& spectrum, double from, double to) {
  constexpr double least = 300, most = 3000, per_period = 24;  // points
  const double length = std::min(1.2 * settling_time(spectrum), to - from);
  double count = least;
  for (const Mode& mode : spectrum.modes) {
    const double periods = std::abs(mode.eigenvalue.imag()) * length / (2.0 * std::numbers::pi);
    const bool well_damped = -mode.eigenvalue.real() > std::abs(mode.eigenvalue.imag());
    if (!mode.zero && !well_damped) count = std::max(count, per_period * periods);
  }
  count = std::round(std::min(count, most));
  std::vector<double> times;
  for (double k = 1; k <= count && from + k * length / count < to; ++k) times.push_back(from + k * length / count);
  return times;
}

Overlay overlay_linear(const Context& context, const Linearization& linear, const Recording& recording) {
  const System& system = context.system();
  const LinearModel& model = linear.model;
  const std::vector<Measured>& outputs = context.options().outputs;
  Overlay overlay;
  overlay.first = recording.from_index;
  overlay.from = recording.times[overlay.first];
  overlay.reference = Meter(system, outputs).read(linear.state);

  const auto count = static_cast<Eigen::Index>(recording.times.size() - overlay.first);
  Eigen::MatrixXd u(system.nu(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Index i = 0; i < system.nu(); ++i) {
      u(i, k) = recording.inputs[overlay.first + static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] -
                linear.state.z[static_cast<std::size_t>(system.nz() + i)];
    }
  }
  const std::span<const double> times(recording.times.data() + overlay.first, static_cast<std::size_t>(count));
  const Eigen::VectorXd X0 = reduced_deviation(system, linear.partition, recording.from.front(), linear.state);
  const Eigen::MatrixXd X = forced_response(model, X0, times, u);
  const Eigen::MatrixXd y = model.C * X + model.D * u;

  for (const Measured& output : outputs) overlay.errors.push_back({output.name, output.unit});
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vector& nonlinear = recording.values[overlay.first + static_cast<std::size_t>(k)];
    Vector& values = overlay.linear.emplace_back(outputs.size());
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      values[i] = overlay.reference[i] + y(static_cast<Eigen::Index>(i), k);
      if (k == 0) overlay.errors[i].deviation = nonlinear[i] - overlay.reference[i];
      overlay.errors[i].peak = std::max(overlay.errors[i].peak, std::abs(nonlinear[i] - overlay.reference[i]));
      overlay.errors[i].largest = std::max(overlay.errors[i].largest, std::abs(values[i] - nonlinear[i]));
    }
  }
  return overlay;
}

}  // namespace bramah
