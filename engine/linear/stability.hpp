// Whether a machine stays at its equilibrium, by the exact linear model there.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "linear/spectrum.hpp"

namespace bramah {

/// An eigenvalue to the right of the imaginary axis; of a pair the one above the real axis.
struct UnstableMode {
  std::complex<double> eigenvalue;
  Eigen::VectorXd shares;  // (states) participations, of sum 1
};

struct Stability {
  enum class Verdict { stable, unstable, undecided };
  Verdict verdict = Verdict::undecided;
  Eigen::Index directions = 0;      // eigenvalues to the right of the axis, pairs counted twice
  std::vector<UnstableMode> modes;  // of these
  Eigen::Index zeros = 0;           // by rank, and those that rounding alone could explain
  Eigen::Index undamped = 0;        // pairs whose real part rounding explains
  std::string why;                  // undecided: "1 zero and 2 undamped pairs", or why there is no model
  std::vector<NamedQuantity> states;
};

/// By the spectrum of a model at an equilibrium.
Stability judge_stability(const LinearModel& model, const Spectrum& spectrum);

/// The same for an equilibrium without a model: undecided where it has more than `most` states, or no linear model.
Stability judge_stability(const System& system, const State& equilibrium, Index most);

}  // namespace bramah
