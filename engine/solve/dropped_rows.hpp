// Constraint rows that were left out as redundant at the start of a run, watched for as long as it lasts.
//
// Rows that follow from others at one position need not do so elsewhere: at change points, dead centres and locked
// structures the rank of the constraints drops for this position only. What an integrator leaves out there opens.
#pragma once

#include <optional>

#include "solve/partition.hpp"
#include "system/analysis_error.hpp"

namespace bramah {

class DroppedRows {
 public:
  /// `partition`: chosen at `start`; `rel_tol`: of the integrator.
  DroppedRows(const System& system, Partition partition, const State& start, double rel_tol);

  /// The rows that are solved for, of [c; b].
  [[nodiscard]] const std::vector<Index>& kept() const { return partition_.rows; }
  [[nodiscard]] const Partition& partition() const { return partition_; }

  /// Whether rows were left out, so that there is something to watch.
  [[nodiscard]] bool any() const { return !partition_.redundant.empty(); }
  /// Why the rows cannot be left out any longer where one is open by more than its tolerance at `state`; `blocks` is
  /// workspace.
  [[nodiscard]] std::optional<AnalysisError> look(const State& state, Blocks& blocks);
  /// Whether the motion from the start to `state` keeps the rows that were left out but for what they would have curved it:
  /// it then is one along a branch. Away from all branches rows open at |D' dx v|; so do those of a locked structure.
  [[nodiscard]] bool along_branch(const State& state, Blocks& blocks);

 private:
  [[nodiscard]] Vector sizes(const State& state, Blocks& blocks);
  [[nodiscard]] AnalysisError error(const State& state, const RedundantRow& dropped, double open, bool rate) const;

  const System& system_;
  Partition partition_;
  double part_;          // of the size of a row that may be open
  Vector start_;         // x where the rows were chosen
  SparsePlan D_;         // rows that were left out by coordinates
  Vector rows_, rates_;  // how far each of them may be open; rows_: holonomic ones, zero for others
};

}  // namespace bramah
