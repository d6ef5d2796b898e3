// Responses of a linear model in time, exactly: by matrix exponentials, for inputs that are linear between breakpoints.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "linear/linearize.hpp"

namespace bramah {

/// The deviation of `state` from `reference` in the states of the reduced model: (x_ai, v_ai, x_ad, z).
Eigen::VectorXd reduced_deviation(const System& system, const Partition& partition, const State& state,
                                  const State& reference);

/// States at `times` (ascending, all >= t0) of dX/dt = A X with X(t0) = X0: one column per time.
Eigen::MatrixXd free_response(const LinearModel& model, const Eigen::VectorXd& X0, double t0,
                              std::span<const double> times);

/// The same with inputs u(t) that are linear between `times`; `u` has one column per time, t0 = times[0].
Eigen::MatrixXd forced_response(const LinearModel& model, const Eigen::VectorXd& X0, std::span<const double> times,
                                const Eigen::MatrixXd& u);

}  // namespace bramah
