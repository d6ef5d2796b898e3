// Sparse LU of a square matrix by KLU: analysed once for its pattern, factored again for every set of values.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sparse/csc.hpp"

namespace bramah::sparse {

class Klu {
 public:
  Klu();
  ~Klu();
  Klu(Klu&&) noexcept;
  Klu& operator=(Klu&&) noexcept;

  /// Analyses the pattern: COLAMD without block triangular form, whose matching is quadratic on closed loops.
  void analyze(const CscView& matrix);
  /// Factors with fresh pivots, or reuses the last pivots and falls back where they have become bad. False: singular.
  bool factor(const CscView& matrix);
  /// Column of the first zero pivot after factor returned false.
  [[nodiscard]] std::int64_t singular_column() const;
  /// Solves A X = B in place, B (n x count) column-major; at least `n` rows apart.
  void solve(std::span<double> rhs, std::int64_t count = 1) const;
  /// Solves A^T X = B in place.
  void solve_transposed(std::span<double> rhs, std::int64_t count = 1) const;
  /// Estimate of the 1-norm condition number of the last factored matrix.
  [[nodiscard]] double condition(const CscView& matrix) const;
  [[nodiscard]] bool analyzed() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace bramah::sparse
