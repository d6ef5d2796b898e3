// Sparse LU of a square matrix by KLU: analysed once for its pattern, factored again for every set of values.
#pragma once

#include <complex>
#include <concepts>
#include <memory>
#include <span>
#include <vector>

#include "sparse/csc.hpp"

namespace bramah::sparse {

/// Scalar is double or std::complex<double>.
template <class Scalar>
class BasicKlu {
 public:
  using View = BasicCscView<Scalar>;

  BasicKlu();
  ~BasicKlu();
  BasicKlu(BasicKlu&&) noexcept;
  BasicKlu& operator=(BasicKlu&&) noexcept;

  /// Analyses the pattern: COLAMD without block triangular form, whose matching is quadratic on closed loops. Where unknowns
  /// have `sizes` (columns), pivots are chosen, and singularity is judged, with unknowns in these: rows are then compared by
  /// what they say, whatever the units. Where rows have `row_sizes` too, `condition` is that of the rows in these.
  void analyze(const View& matrix, std::vector<double> sizes = {}, const std::vector<double>& row_sizes = {});
  /// Factors with fresh pivots, or reuses the last pivots and falls back where they have become bad. False: singular.
  bool factor(const View& matrix);
  /// The next factor chooses its pivots anew, whatever was factored before: its bits depend on its matrix alone.
  void forget_pivots();
  /// Whether the last factor chose its pivots anew: they then depend on that matrix alone.
  [[nodiscard]] bool fresh_pivots() const;
  /// Column of the first zero pivot after factor returned false.
  [[nodiscard]] std::int64_t singular_column() const;
  /// Solves A X = B in place, B (n x count) column-major; at least `n` rows apart.
  void solve(std::span<Scalar> rhs, std::int64_t count = 1) const;
  /// Right-hand sides of solve_block.
  static constexpr int block = 8;
  /// Solves A X = B in place, B (n x block) row-major: right-hand sides side by side use one pass over the factors.
  void solve_block(std::span<Scalar> rhs) const requires std::same_as<Scalar, double>;
  /// Solves A^T X = B in place.
  void solve_transposed(std::span<Scalar> rhs, std::int64_t count = 1) const;
  /// Estimate of the 1-norm condition number of the last factored matrix, unknowns and rows in their sizes.
  [[nodiscard]] double condition(const View& matrix) const;
  /// det A / |det A| of the last factored matrix.
  [[nodiscard]] Scalar determinant_phase() const;
  [[nodiscard]] bool analyzed() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

using Klu = BasicKlu<double>;
using ComplexKlu = BasicKlu<std::complex<double>>;

extern template class BasicKlu<double>;
extern template class BasicKlu<std::complex<double>>;

}  // namespace bramah::sparse
