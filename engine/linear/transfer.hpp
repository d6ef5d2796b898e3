// From inputs to outputs: frequency response, transfer zeros, and how well each mode is reached and seen.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <span>
#include <vector>

#include "linear/spectrum.hpp"

namespace bramah {

/// G(i w) = C (i w - A)^-1 B + D at each frequency (rad/s): one matrix (outputs x inputs) per frequency.
std::vector<Eigen::MatrixXcd> frequency_response(const LinearModel& model, std::span<const double> frequencies);

/// Finite zeros of the transfer function from one input to one output: eigenvalues of the pencil
/// [A B; C D] - s [I 0; 0 0], by LAPACK (dggev) on scaled states.
std::vector<std::complex<double>> transfer_zeros(const LinearModel& model, Eigen::Index input, Eigen::Index output);

/// Reach and sight of each nonzero mode, between 0 and 1: |w^H b| / (|w| |b|) for every input (modes x inputs) and
/// |c v| / (|c| |v|) for every output (modes x outputs), states in nominals. 0: the mode cannot be moved or seen.
struct ModalAccess {
  Eigen::MatrixXd controllability, observability;
};
ModalAccess modal_access(const LinearModel& model, const Spectrum& spectrum);

/// Responses to a unit step or a unit impulse of one input from rest: outputs by column at `times`, the first of them 0.
Eigen::MatrixXd step_response(const LinearModel& model, Eigen::Index input, std::span<const double> times);
Eigen::MatrixXd impulse_response(const LinearModel& model, Eigen::Index input, std::span<const double> times);

}  // namespace bramah
