// How many eigenvalues are zero, told before any is computed: from ranks of the sparse, unreduced coefficients.
//
// Chains y0, y1, ... with P0 y0 = 0, P0 y1 + P1 y0 = 0, P0 y2 + P1 y1 + P2 y0 = 0, ... are the Jordan chains of s = 0
// (Gohberg, Lancaster, Rodman 1982, Sect. 1.4). Chains of length k fill the null space of
//
//         [ P0             ]
//   T_k = [ P1  P0         ]   (k blocks),   dim null T_k = sum over Jordan blocks of min(k, size).
//         [ P2  P1  P0     ]
//         [      ...       ]
#pragma once

#include <vector>

#include "linear/descriptor.hpp"

namespace bramah {

struct ZeroPrediction {
  std::vector<int> block_sizes;          // Jordan blocks of the eigenvalue 0, largest first
  double accepted = 1.0, refused = 0.0;  // pivots that decided the ranks, relative to their columns
  /// Algebraic multiplicity of zero.
  [[nodiscard]] Index count() const;
};

ZeroPrediction predict_zeros(const Descriptor& descriptor);

}  // namespace bramah
