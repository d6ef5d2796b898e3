#include "solve/dropped_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

// Of the size of a row: what may be open, beside ten times what the integrator's own tolerance leaves.
constexpr double least_part = 1e-6, of_rel_tol = 10.0;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

DroppedRows::DroppedRows(const System& system, Partition partition, const State& start, double rel_tol)
    : system_(system), partition_(std::move(partition)), part_(least_part + of_rel_tol * rel_tol), start_(start.x) {
  if (partition_.redundant.empty()) return;
  const std::vector<Index> rows = selected(system.m() + system.l(), left_out_by(partition_));
  const std::vector<Index> coordinates = shifted(system.n(), 0);
  const Term term{BRAMAH_R_V, rows, coordinates, false, 0};
  D_ = SparsePlan(system, static_cast<Index>(partition_.redundant.size()), system.n(), {&term, 1});
  Blocks blocks(system);
  const bool known = blocks.evaluate(system, start, Request{}.rows("cr")).ok();
  for (const RedundantRow& r : partition_.redundant) {
    const bool holonomic = r.row < system.m();
    // A start is assembled within a tolerance of its own.
    const double open = holonomic && known ? std::abs(blocks.c[at(r.row)]) : 0.0;
    rows_.push_back(holonomic ? part_ * system.constraint(r.row).nominal + 2.0 * open : 0.0);
    rates_.push_back(part_ * system.rate_nominal(r.row) + (known ? 2.0 * std::abs(blocks.r[at(r.row)]) : 0.0));
  }
}

/// |D| |v| of the rows that were left out: fast machines leave more of their rates open. `blocks` then holds r.
Vector DroppedRows::sizes(const State& state, Blocks& blocks) {
  Vector sizes(rates_.size(), 0.0);
  if (!blocks.evaluate(system_, state, Request{}.rows("cr").blocks({BRAMAH_R_V})).ok()) return sizes;
  const double one = 1.0;
  D_.fill(blocks, {&one, 1});
  for (Index j = 0; j < D_.columns(); ++j) {
    for (Index e = D_.start()[at(j)]; e < D_.start()[at(j) + 1]; ++e)
      sizes[at(D_.row()[at(e)])] += std::abs(D_.values()[at(e)] * state.v[at(j)]);
  }
  return sizes;
}

bool DroppedRows::along_branch(const State& state, Blocks& blocks) {
  constexpr double curved = 0.05;  // of what leaving the branch would open
  double moved = 0.0;
  for (std::size_t i = 0; i < system_.x.size(); ++i)
    moved = std::max(moved, std::abs(state.x[i] - start_[i]) / system_.x[i].nominal);
  const Vector most = sizes(state, blocks);
  for (std::size_t k = 0; k < most.size(); ++k) {
    if (std::abs(blocks.r[at(partition_.redundant[k].row)]) > curved * moved * most[k]) return false;
  }
  return true;
}

std::optional<AnalysisError> DroppedRows::look(const State& state, Blocks& blocks) {
  if (!any() || !blocks.evaluate(system_, state, Request{}.rows("cr")).ok()) return std::nullopt;
  for (std::size_t k = 0; k < rates_.size(); ++k) {
    const RedundantRow& dropped = partition_.redundant[k];
    if (dropped.row < system_.m() && std::abs(blocks.c[at(dropped.row)]) > rows_[k])
      return error(state, dropped, std::abs(blocks.c[at(dropped.row)]), false);
    if (std::abs(blocks.r[at(dropped.row)]) <= rates_[k]) continue;
    rates_[k] = std::max(rates_[k], part_ * sizes(state, blocks)[k]);
    if (const double open = std::abs(blocks.r[at(dropped.row)]); open > rates_[k])
      return error(state, dropped, open, true);
  }
  return std::nullopt;
}

AnalysisError DroppedRows::error(const State& state, const RedundantRow& dropped, double open, bool rate) const {
  const Row& row = system_.constraint(dropped.row);
  std::vector<std::string> others;
  for (const auto& [other, share] : dropped.follows_from) others.push_back(system_.constraint(other).name);
  std::string unit = row.unit;  // of a nonholonomic row: that of a rate
  if (rate && dropped.row < system_.m()) unit = unit == "1" ? "1/s" : unit + "/s";
  return {
      "simulate",
      "at t = " + digits(state.t) + " s the constraint " + row.name + (rate ? " opens at " : " is open by ") +
          digits(open) + " " + unit + "; it was left out at the start, where it follows from " +
          (others.empty() ? "no other row at all" : list_of(others)) +
          ", and does not follow from them here: the start is a singular position of the mechanism, such as a change "
          "point, a dead centre or a locked structure",
      "constraints that depend on each other everywhere, or nowhere along the motion",
      "start a little away from this position, on the branch that is meant; a structure that is locked there needs no "
      "simulation, or other lengths",
      pointer("/components", system_.component_name(row.component))};
}

}  // namespace bramah
