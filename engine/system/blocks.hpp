// Evaluation: one pass over all instances into flat blocks, from which every consumer takes what it needs.
//
// Values of a block lie instance after instance, in the order of the block's pattern. A SparsePlan is a consumer's map
// from block entries to the entries of its own matrix, made once; afterwards values only flow.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "system/direction.hpp"
#include "system/system.hpp"

namespace bramah {

/// Which local family a block's rows and columns belong to.
enum class RowFamily { force, storage, holonomic, constraint, output };
enum class ColumnFamily { x, z, u, lambda };
RowFamily row_family(int block);
ColumnFamily column_family(int block);

/// Hears of rows one by one, before they are summed into balances.
class RowListener {
 public:
  virtual ~RowListener() = default;
  /// After each call of a type's `evaluate`, for batch.count instances of the group from `first` on: their inputs and rows.
  virtual void hear(const Group& group, Index first, const bramah_batch& batch) = 0;
};

/// What to evaluate: rows by name, partials by block.
struct Request {
  bool f = false, g = false, c = false, r = false, s = false, y = false;
  bool multiplier_forces = true;  // f contains D^T lambda (needs block R_V, which is then evaluated as well)
  std::array<bool, BRAMAH_BLOCKS> block{};
  RowListener* listener = nullptr;

  Request& rows(std::string_view letters);
  Request& blocks(std::initializer_list<int> list);
};

/// How an evaluation ended.
struct Outcome {
  enum class Status { ok, recoverable, fatal };
  Status status = Status::ok;
  std::string message;   // names the component and the row
  Index component = -1;  // whose component it is, where there is one
  [[nodiscard]] bool ok() const { return status == Status::ok; }
};

/// The values of one evaluation, and the workspace that it needs. Sized once for a system.
class Blocks {
 public:
  explicit Blocks(const System& system);

  Vector f, g, c, r, s, y;  // (n), (nz), (m), (m+l), (m+l), (ny)
  /// Entries of block `block` of group `group`.
  [[nodiscard]] std::span<const double> block(std::size_t group, int block) const {
    return partials_[group][static_cast<std::size_t>(block)];
  }

  /// Evaluates `request` at `state`. A value that is not finite is recoverable and named in the outcome.
  Outcome evaluate(const System& system, const State& state, const Request& request);

  /// Names the first partial of the last evaluation that is not finite: component, row and column.
  [[nodiscard]] Outcome check_partials(const System& system) const;

  /// The same with derivatives by eps in place of rows and partials, exactly, where the state and parameters move along
  /// `along`:  d/deps row(y + eps dy, p + eps dp),  d/deps block(y + eps dy, p + eps dp). Layout and patterns are those of
  /// `evaluate`, so that plans are filled alike. AnalysisError for a component whose type gives no derivatives and whose
  /// variables move.
  Outcome evaluate_along(const System& system, const State& state, const Direction& along, const Request& request);

 private:
  struct Inputs {  // local inputs of one chunk
    Vector x, v, a, z, zdot, u, lambda;
    void give_to(bramah_batch& batch) const;
  };
  struct Run {  // instances that are evaluated in one call
    std::size_t group;
    Index first, count;
    const void* instances;
  };
  Outcome evaluate_all(const System& system, const State& state, const Direction* along, const Request& request);
  void gather(const Group& group, const State& state, Index first, Index count, Inputs& in) const;
  int call(const System& system, const Run& run, const Direction* along, bramah_batch& batch);
  void check_still(const System& system, const Run& run) const;
  void add_reactions(const Group& group, Index count, const double* d, const Vector& lambda);
  int add_moving_reactions(const Group& group, const Run& run, bramah_batch batch);
  static Outcome failure(const System& system, const Group& group, Index instance, int status, const char* why);
  void blame(const System& system, const State& state, Outcome& outcome);
  [[nodiscard]] Outcome check_finite(const System& system, const Request& request, const char* prefix) const;

  static constexpr Index chunk = 64;  // instances in one call: their records stay in the second-level cache
  std::vector<std::array<Vector, BRAMAH_BLOCKS>> partials_;
  Inputs in_, along_;                   // along_: the direction that in_ moves in
  Vector lf_, lg_, lc_, lr_, ls_, ly_;  // local rows of one chunk
  Vector d_;                            // block R_V of one chunk, beside its derivative
};

/// One term of a consumer's matrix: a block, times a weight, at mapped rows and columns.
struct Term {
  int block = 0;
  std::span<const Index> rows;     // global row of the block -> row of the matrix, -1: left out
  std::span<const Index> columns;  // global column -> column of the matrix, -1: left out
  bool transposed = false;         // the block's rows then go to matrix columns
  std::size_t weight = 0;          // which of the weights given to fill
};

/// Entries (row + i, column + i) with a weight of their own, times scale[i] where a scale is given.
struct Diagonal {
  Index row = 0, column = 0, count = 0;
  std::size_t weight = 0;
  std::vector<double> scale = {};
};

/// A sparse matrix assembled from blocks, compressed by columns; pattern and scatter map are made once.
class SparsePlan {
 public:
  SparsePlan() = default;
  SparsePlan(const System& system, Index rows, Index columns, std::span<const Term> terms,
             std::span<const Diagonal> diagonals = {});

  /// Replaces the values: sum over terms of weight * block.
  void fill(const Blocks& blocks, std::span<const double> weights);

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index columns() const { return columns_; }
  [[nodiscard]] Index nonzeros() const { return static_cast<Index>(row_.size()); }
  [[nodiscard]] const std::vector<Index>& start() const { return start_; }
  [[nodiscard]] const std::vector<Index>& row() const { return row_; }
  [[nodiscard]] std::span<const double> values() const { return {values_.data(), row_.size()}; }

 private:
  struct Scatter {
    std::size_t group;
    int block;
    std::size_t weight;
    std::vector<Index> position;  // of each block entry in values_; entries left out go to the last, unused place
  };
  struct Fixed {
    std::size_t weight;
    std::vector<Index> position;
    std::vector<double> scale;
  };
  Index rows_ = 0, columns_ = 0;
  std::vector<Index> start_, row_;
  Vector values_;
  std::vector<Scatter> scatters_;
  std::vector<Fixed> fixed_;
};

/// Maps for terms: 0 .. count-1 shifted by `offset`.
std::vector<Index> shifted(Index count, Index offset);
/// The list's members at 0, 1, 2, ... shifted by `offset`; all others of `count` left out.
std::vector<Index> selected(Index count, std::span<const Index> list, Index offset = 0);

}  // namespace bramah
