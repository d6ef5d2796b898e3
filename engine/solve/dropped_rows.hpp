// Constraint rows that were left out as redundant at the start of a run, watched for as long as it lasts.
//
// Rows that follow from others at one position need not do so elsewhere: at change points, dead centres and locked
// structures the rank of the constraints drops for this position only. What an integrator leaves out there opens.
#pragma once

#include "solve/partition.hpp"

namespace bramah {

class DroppedRows {
 public:
  /// `partition`: chosen at `start`; `rel_tol`: of the integrator.
  DroppedRows(const System& system, Partition partition, const State& start, double rel_tol);

  /// The rows that are solved for, of [c; b].
  [[nodiscard]] const std::vector<Index>& kept() const { return partition_.rows; }
  [[nodiscard]] const Partition& partition() const { return partition_; }

  /// `blocks`: c and r at `state`. Throws AnalysisError where a row that was left out is open by more than its tolerance.
  void look(const State& state, Blocks& blocks);

 private:
  void take_sizes(const State& state, Blocks& blocks);
  [[noreturn]] void refuse(const State& state, const RedundantRow& dropped, double open, bool rate) const;

  const System& system_;
  Partition partition_;
  double part_;          // of the size of a row that may be open
  SparsePlan D_;         // rows that were left out by coordinates
  Vector rows_, rates_;  // how far each of them may be open; rows_: holonomic ones, zero for others
};

}  // namespace bramah
