// Eigenvalues of a linear model, with the condition of each and the cause of every zero.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <string>
#include <vector>

#include "linear/linearize.hpp"

namespace bramah {

struct Mode {
  std::complex<double> eigenvalue;
  double condition = 1.0;  // of the eigenvalue: 1 / |cos(left, right eigenvector)| in balanced coordinates
  bool zero = false;       // zero within its own rounding: |lambda| <= c eps |A| condition
  std::string cause;       // of a zero: the states that move
};

struct Spectrum {
  std::vector<Mode> modes;             // zeros last, others by decreasing real part, then imaginary part
  Eigen::MatrixXcd right;              // (states x modes) eigenvectors in SI, largest component (in nominals) 1
  double norm = 0.0;                   // of the balanced matrix
};

/// Eigenvalues of `model.A` by LAPACK (dgeevx, balanced), after scaling the states by their nominals.
Spectrum find_spectrum(const LinearModel& model);

/// The same for a bare matrix with states of nominal 1.
Spectrum find_spectrum(const Eigen::MatrixXd& A);

}  // namespace bramah
