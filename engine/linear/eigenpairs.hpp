// Selected eigenvalues of systems too large for a dense Jacobian, by shift-invert Arnoldi on the sparse descriptor form,
// and how many there are inside a contour, by the argument principle.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <vector>

#include "linear/descriptor.hpp"

namespace bramah {

struct Eigenpair {
  std::complex<double> eigenvalue;  // of a conjugate pair the one with positive imaginary part
  Eigen::VectorXcd vector;          // (size of P): x, lambda, z; largest entry in nominals is 1
  double residual = 0.0;            // |P(s) y| / ((|s|^2 |P2| + |s| |P1| + |P0|) |y|), in nominals: backward error
};

/// |s - centre| < radius.
struct Disk {
  std::complex<double> centre;
  double radius = 0.0;
  [[nodiscard]] bool contains(std::complex<double> s) const { return std::abs(s - centre) < radius; }
};

struct Eigenpairs {
  std::vector<Eigenpair> pairs;  // by distance from the shift
  std::complex<double> shift;    // the one used
  Disk disk;                     // all eigenvalues in here are among the pairs, or their conjugates, or zeros
  Eigen::Index zeros = 0;        // multiplicity of the eigenvalue 0, where it lies in the disk; pairs hold none of it
  bool proven = false;           // by the argument principle; see count_unknown
  int solves = 0, factorizations = 0;
};

enum class Proof { skip, wanted };

/// The `count` eigenvalues nearest to a real shift above zero (1/s), which no stable system has as an eigenvalue; a
/// conjugate pair counts once. shift 0: chosen from the size of the slowest motions. `zeros`, from predict_zeros, are
/// told apart from slow eigenvalues. AnalysisError where the iteration does not converge or the proof fails.
Eigenpairs find_nearest(const Descriptor& descriptor, Eigen::Index count, double shift, Eigen::Index zeros,
                        Proof proof);

/// All eigenvalues in the disk.
Eigenpairs find_inside(const Descriptor& descriptor, const Disk& disk, Eigen::Index zeros, Proof proof);

/// How many eigenvalues beside `known` (conjugates understood) lie inside: turns of det P(s) / prod(s - known) along the
/// circle. 0 tells that none was missed, as surely as steps that are halved until neighbours differ by less than an eighth
/// of a turn can tell. AnalysisError where an unknown eigenvalue lies on the circle.
Eigen::Index count_unknown(const Descriptor& descriptor, const Disk& disk, std::span<const std::complex<double>> known);

}  // namespace bramah
