// (x, v, z) over their nominals, as integrators see them, with error weights relative to motion (ADR 0005).
#pragma once

#include <vector>

#include "system/system.hpp"

namespace bramah {

class ScaledState {
 public:
  /// Errors are weighed relative to `rel_tol`.
  ScaledState(const System& system, double rel_tol);

  [[nodiscard]] Index size() const { return 2 * n_ + nz_; }
  [[nodiscard]] const Vector& scale() const { return scale_; }  // (2n + nz)

  void pack(const State& state, double* y) const;         // x, v, z
  void pack_rates(const State& state, double* yp) const;  // v, a, zdot
  void unpack(const double* y, State& state) const;
  void unpack_rates(const double* yp, State& state) const;  // a, zdot; v is part of y

  /// Error weights at y (2n + nz each): 1 / tolerance. Remembers how far every variable has moved so far.
  void weigh(const double* y, double* weight);
  /// The variable with the largest weighted error; -1 where all are zero.
  Index worst(const double* weight, const double* error) const;

 private:
  Index n_, nz_;
  double rel_tol_;
  Vector scale_, low_, high_;
  Vector size_;                    // of each variable, over its scale
  std::vector<std::size_t> kind_;  // variables of the same family and unit are of one kind
  Vector motion_, extent_;         // of each kind: how far its variables have moved, how large they are
};

}  // namespace bramah
