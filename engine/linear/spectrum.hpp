// Eigenvalues of a linear model with their vectors, conditions and participations, and the cause of every zero.
//
// Zeros are taken out first, by rank decisions (a staircase of null spaces), so that their Jordan blocks cannot scatter
// into the rest: a defective zero of size k moves by eps^(1/k) in any QR iteration, and to either side of the axis.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <string>
#include <vector>

#include "linear/linearize.hpp"

namespace bramah {

struct Mode {
  std::complex<double> eigenvalue;  // exactly 0 for a zero
  double condition = 1.0;           // of the eigenvalue: |w| |v| / |w^H v|, states in nominals
  double rounding = 0.0;            // what rounding may have moved it by: c eps |A| condition, or that of its group
  bool zero = false;
  bool doubtful = false;  // a nonzero value that rounding alone could explain: |lambda| <= rounding
  int group = -1;         // in Spectrum::defective, if it belongs to one
  std::string cause;      // of a zero or a doubtful value
};

/// Nonzero eigenvalues that rounding cannot tell apart, with fewer vectors than members: one eigenvalue, critically
/// damped or otherwise defective. Each scatters by a root of rounding; their mean does not.
struct DefectiveGroup {
  Eigen::Index size = 0;
  std::complex<double> mean;
  double rounding = 0.0;         // how far rounding may have moved any of its members
  Eigen::MatrixXcd right, left;  // (states x size) bases of its invariant subspaces, SI; left^H right = 1
};

/// A Jordan block of the eigenvalue 0.
struct ZeroBlock {
  int size = 1;
  std::string kind;   // "rigid-body or cyclic coordinate", "trapped oil volume", "nonholonomic drift", ...
  std::string cause;  // kind and names
  std::vector<std::pair<std::string, double>> moves;  // its eigenvector: which states drift together (SI)
};

struct Spectrum {
  std::vector<Mode> modes;       // nonzero ones by decreasing real part, then frequency; zeros last
  Eigen::MatrixXcd right, left;  // (states x modes); right: largest component in nominals is 1; left^H right = 1. Zero
                                 // modes: a basis of the invariant subspace, no left vectors
  std::vector<ZeroBlock> zeros;
  std::vector<DefectiveGroup> defective;
  /// Left null vectors: sums that keep their value (SI).
  std::vector<std::vector<std::pair<std::string, double>>> conserved;
  double norm = 0.0;                                      // of the matrix, states in nominals
  double smallest_accepted = 1.0, largest_refused = 0.0;  // pivots that decided the ranks, relative to their rows
  [[nodiscard]] Eigen::Index zero_count() const;
  /// Eigenvalues whose real part rounding does not explain, to the right of the imaginary axis.
  [[nodiscard]] Eigen::Index unstable_count() const;
};

/// The spectrum of a reduced model: zeros by rank, the others by LAPACK in balanced parts, states in nominals.
Spectrum find_spectrum(const LinearModel& model);

/// Participation of each state (row) in each nonzero mode (column): |left x right|, columns of sum 1, whatever the units.
Eigen::MatrixXd participation(const Spectrum& spectrum);

/// Eigenvalues as a QR iteration gives them, zeros scattered and all: what the comparison with augmented matrices shows.
std::vector<std::complex<double>> plain_eigenvalues(const Eigen::MatrixXd& A);
/// The same of model.A, states in nominals.
std::vector<std::complex<double>> plain_eigenvalues(const LinearModel& model);

}  // namespace bramah
