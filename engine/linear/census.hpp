// How many eigenvalues are zero, told before any is computed: from the rank of the sparse, unreduced P0 and of small dense
// matrices. Where P0 = P(0) has a null space Z, a left one W and an inverse G between what is left of rows and columns,
//
//   P(s) ~ diag(I, s F(s)),   F(s) = W^T (P1 + s P2) (I + G (s P1 + s^2 P2))^-1 Z
//
// so that the zeros of P at 0 are those of F, each with one more: dim Z Jordan blocks have size 1 or more, dim null F(0)
// size 2 or more, and so on with F in the place of P (Gohberg, Lancaster, Rodman 1982, Sect. 1.4 and S1.5). Only what is
// singular at 0 gets into F, so that slow eigenvalues do not blur the decision, as they do, like s^k, in the ranks of
// Toeplitz matrices of P0, P1, P2.
#pragma once

#include <vector>

#include "linear/descriptor.hpp"
#include "linear/spectrum.hpp"

namespace bramah {

struct ZeroPrediction {
  std::vector<int> block_sizes;          // Jordan blocks of the eigenvalue 0, largest first
  double accepted = 1.0, refused = 0.0;  // pivots that decided the ranks, relative to their columns
  /// Algebraic multiplicity of zero.
  [[nodiscard]] Index count() const;
};

/// AnalysisError where det P(s) is zero at every s.
ZeroPrediction predict_zeros(const Descriptor& descriptor);

/// Takes doubtful modes for the zeros that are foretold and missing, where they are as many: rounding explains them, and
/// ranks of the unreduced coefficients want them. Otherwise changes nothing.
void settle_doubtful(const LinearModel& model, const ZeroPrediction& predicted, Spectrum& spectrum);

}  // namespace bramah
