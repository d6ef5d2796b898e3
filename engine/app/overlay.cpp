#include "app/overlay.hpp"

#include <algorithm>
#include <cmath>

#include "linear/respond.hpp"
#include "system/measure.hpp"

namespace bramah {

void Recording::take(const System& system, const State& state, const Vector& outputs, double linear_from) {
  // Of two states at one time the second is that after the jump. Rounding of output times is no reason to miss it.
  const double nearly = linear_from - 1e-12 * std::max(1.0, std::abs(linear_from));
  const bool is_first = from.empty() && state.t >= nearly;
  if (linear_from >= 0.0 && (is_first || (!from.empty() && state.t == from.front().t && from_index + 1 == times.size()))) {
    from.assign(1, state);
    from_index = times.size();
  }
  times.push_back(state.t);
  values.push_back(outputs);
  const auto first_input = state.z.begin() + system.nz();
  inputs.emplace_back(first_input, first_input + system.nu());
}

Overlay overlay_linear(const Context& context, const Linearization& linear, const Recording& recording) {
  const System& system = context.system();
  const LinearModel& model = linear.model;
  const std::vector<Measured>& outputs = context.options().outputs;
  Overlay overlay;
  overlay.first = recording.from_index;
  overlay.from = recording.times[overlay.first];
  Blocks blocks(system);
  measure(system, linear.state, outputs, blocks, overlay.reference);

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
