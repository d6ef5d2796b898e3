// The reduced Jacobian against the augmented one, exact and by differences: Sect. 4.5 of the paper, Eqs. (96)-(100).
#pragma once

#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "app/context.hpp"
#include "io/tables.hpp"

namespace bramah {

using Eigenvalues = std::vector<std::complex<double>>;

/// A spectrum held against the reduced one.
struct Contender {
  double h = 0.0;       // step of differences; 0: exact
  std::string failure;  // why there is no spectrum; empty: there is one
  Eigenvalues eigenvalues;
  std::vector<double> errors;  // relative, of the eigenvalue nearest to each nonzero reduced one, each claimed once
  long false_zeros = 0;        // eigenvalues that nothing claims, less the true zeros
  double largest_false_zero = 0.0;  // magnitude
  double largest_real_part = 0.0;   // of false zeros: above 0 they look unstable
  Eigenvalues unclaimed;
  bool looks_unstable = false;  // some real part is above 1e-9
  double seconds = 0.0;         // Jacobian and eigenvalues
  [[nodiscard]] double worst_error() const;
};

struct Comparison {
  std::size_t reduced_size = 0, augmented_size = 0, true_zeros = 0;
  Eigenvalues reduced;  // zeros last
  bool reduced_looks_unstable = false;
  double reduced_seconds = 0.0;
  Contender exact;
  std::vector<Contender> differences;
  [[nodiscard]] std::size_t best() const;  // of `differences`: the smallest worst error
};

/// `progress` is called before each part with its share of the work done.
Comparison compare(const Context& context, const Linearization& linear, const std::function<void(double)>& progress);

std::string comparison_document(const Comparison& comparison);
Table comparison_table(const Comparison& comparison);
std::string comparison_text(const Comparison& comparison);

}  // namespace bramah
