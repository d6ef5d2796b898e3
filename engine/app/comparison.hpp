// The reduced Jacobian against the augmented one, exact and by differences: Sect. 4.5 of the paper, Eqs. (96)-(100); and
// against what else gives the same eigenvalues.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/context.hpp"
#include "io/tables.hpp"
#include "linear/rungs.hpp"

namespace bramah {

struct Comparison {
  std::size_t reduced_size = 0, augmented_size = 0, true_zeros = 0;
  Eigenvalues reduced;  // zeros last
  bool reduced_looks_unstable = false;
  Cost reduced_cost;
  Contender exact, pencil;
  std::vector<Contender> differences;      // one for each h
  Contender sparse_differences;            // with the best h
  [[nodiscard]] std::size_t best() const;  // of `differences`: the smallest worst error
};

/// `progress` is called before each part with its share of the work done.
Comparison compare(const Context& context, const Linearization& linear, const std::function<void(double)>& progress);

std::string comparison_document(const Comparison& comparison);
/// Errors and false zeros of every rung.
Table comparison_table(const Comparison& comparison);
/// Time and memory of every rung, differences with the best h.
Table comparison_costs(const Comparison& comparison);
std::string comparison_text(const Comparison& comparison);

}  // namespace bramah
