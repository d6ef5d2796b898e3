// Which coordinates depend on which, and which constraint rows are redundant: Eqs. (29)-(31).
//
// One rank-revealing LU of the scaled D^T, holonomic rows first, decides both: its pivots among the holonomic rows are
// x_d, those among the nonholonomic rows x_ad, what is left is x_ai; as many rows as have no pivot are redundant.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "system/blocks.hpp"
#include "system/options.hpp"
#include "system/system.hpp"

namespace bramah {

/// A constraint row that follows from others: grad(row) = sum of coefficient * grad(others).
struct RedundantRow {
  Index row = 0;
  std::vector<std::pair<Index, double>> follows_from;
};

struct Partition {
  std::vector<Index> ai, ad, d;  // coordinates: independent, admissible dependent, dependent (m' + l' in all: ad, d)
  std::vector<Index> rows;       // independent constraint rows of [c; b], holonomic ones first
  Index holonomic = 0;           // how many of `rows` are holonomic
  std::vector<RedundantRow> redundant;  // of rows that imply each other those declared last, in ascending order
  double smallest_pivot = 1.0;          // of accepted rows, relative to the row
  double largest_refused = 0.0;         // of redundant rows: the gap between the two decided the rank
  double growth = 1.0;                  // bound of |T| (scaled)
};

/// Chooses at `state`. Throws AnalysisError where the prescribed coordinates cannot be what they shall be.
Partition choose_partition(const System& system, const State& state, const Prescribed& prescribed = {});

/// Below this part of a row what others do not imply of it is rounding, of arithmetic or of the scene's numbers.
double rank_tolerance_of(const System& system);

/// The redundant rows, in ascending order.
std::vector<Index> left_out_by(const Partition& partition);

/// "hinge.x, hinge.y" for messages.
std::string row_names(const System& system, std::span<const Index> rows);

}  // namespace bramah
