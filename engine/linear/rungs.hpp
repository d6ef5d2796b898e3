// The same eigenvalues on five rungs, from the paper's counterpart to the smallest exact Jacobian: what each costs and
// what it finds.
#pragma once

#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "linear/linearize.hpp"

namespace bramah {

using Eigenvalues = std::vector<std::complex<double>>;

enum class Rung {
  differences,         // augmented, dense central differences with the dense inverse of Eq. (97)
  sparse_differences,  // the same with sparse factors, kept where they can be
  augmented,           // exact, Eq. (99)
  pencil,              // exact, before any elimination, by shift-invert
  reduced,             // exact, Eq. (61)
};
inline constexpr Rung all_rungs[] = {Rung::differences, Rung::sparse_differences, Rung::augmented, Rung::pencil,
                                     Rung::reduced};
/// "differences", "sparse_differences", "augmented", "pencil", "reduced".
std::string_view name_of(Rung rung);

/// CPU time in s, medians; memory in MB.
struct Cost {
  double assembly = 0.0;     // evaluation of the components
  double reduction = 0.0;    // from there to the matrix whose eigenvalues are taken
  double eigenvalues = 0.0;  // without vectors
  double peak_MB = NAN;      // memory taken beyond what was there before; NAN: the system does not tell
  [[nodiscard]] double jacobian() const { return assembly + reduction; }
  [[nodiscard]] double total() const { return jacobian() + eigenvalues; }
};

/// One rung, measured and held against the exact spectrum.
struct Contender {
  Rung rung = Rung::reduced;
  double h = 0.0;       // step of differences; 0: exact
  std::string failure;  // why there is no spectrum; empty: there is one
  Eigen::Index size = 0;
  Cost cost;
  Eigenvalues eigenvalues;
  std::vector<double> errors;       // relative, of the eigenvalue nearest to each nonzero exact one, each claimed once
  long false_zeros = 0;             // eigenvalues that nothing claims, less the true zeros
  double largest_false_zero = 0.0;  // magnitude, true zeros included
  double largest_real_part = 0.0;   // of the same: above 0 they look unstable
  Eigenvalues unclaimed;
  bool looks_unstable = false;  // some real part is above 1e-9
  /// Of the errors; infinite where there is no spectrum.
  [[nodiscard]] double worst_error() const;
};

struct Measuring {
  double h = 1e-5;           // of differences: where Fig. 14 has its minimum
  double shift = 1.0;        // of the pencil, 1/s
  double budget = 0.05;      // s for the repetitions of one figure
  bool eigenvalues = true;   // false: the matrix only
  Eigen::Index columns = 0;  // of differences: so many are measured and stand for all, without eigenvalues; 0: all
};

/// Measures one rung. Throws AnalysisError where it has no result.
Contender measure(Rung rung, const System& system, const Partition& partition, const State& state,
                  const Measuring& how);

/// Fills errors and what follows: each of `nonzero` claims the nearest of the contender's eigenvalues that is left, the
/// nearest pairs first.
void hold_against(const Eigenvalues& nonzero, std::size_t true_zeros, Contender& contender);

/// Some real part is above 1e-9: what a reader without error bounds takes for unstable.
bool looks_unstable(const Eigenvalues& eigenvalues);

/// What one linearization evaluates: rows, and rows with partials.
Request linearization_rows();
Request linearization_partials();

}  // namespace bramah
