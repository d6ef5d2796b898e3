// The linearized equations of motion with the smallest possible Jacobian: Steps 1-7 of Agundez et al. (2023).
//
// States X = (x_ai, v_ai, x_ad, z): 2n - 2m - l + r + u numbers, with redundant rows not counted in m and l.
//   d(X)/dt = A X + B u,   y = C X + D u,   A = J of Eq. (61)
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solve/kkt.hpp"
#include "solve/partition.hpp"
#include "system/blocks.hpp"
#include "system/options.hpp"
#include "system/switches.hpp"

namespace bramah {

struct NamedQuantity {
  std::string name, unit;
  double nominal = 1.0;
  std::string kind = {};  // of states: "x_ai", "v_ai", "x_ad", or a first-order variable's ("pressure", "spool")
};

/// A switching function at zero: the derivatives there are one-sided.
struct KinkTaken {
  std::string component, name;
  int side = 1;
};

struct LinearModel {
  std::vector<NamedQuantity> states, inputs, outputs;
  Eigen::MatrixXd A, B, C, D;
  Eigen::VectorXd
      rounding;  // (states) of a row of A, states in nominals: what may remain where its terms cancel; empty:
                 // A is exact
  std::vector<KinkTaken> kinks;
};

/// Condition numbers (estimates, 1-norm, SI) of the matrices that give dependent coordinates and rates; 1 where there are
/// none, infinite where they are singular.
struct Conditions {
  double C_xd = 1.0, D_dd = 1.0;  // of Eqs. (42) and (31)
  [[nodiscard]] double worst() const { return C_xd > D_dd ? C_xd : D_dd; }
};

/// Linearizes one system with one partition, any number of times: patterns and factorizations are analysed once.
class Linearizer {
 public:
  Linearizer(const System& system, Partition partition, std::vector<Measured> outputs = {});

  /// `state` must satisfy Eqs. (16)-(20); AnalysisError names the worst row where it does not.
  void linearize(const State& state, LinearModel& model);
  /// Fills model.rounding, after linearize: what find_spectrum needs to tell a zero from what cancelled to one.
  void estimate_rounding(LinearModel& model);
  /// The same for the unreduced Eq. (98), X = (x, v, z), exactly: the Jacobian J of Eq. (99).
  void linearize_augmented(const State& state, LinearModel& model);

  /// Completes a direction in which consistent states move: dx_ai, dv_ai, dx_ad, dz and parameters given, the other
  /// coordinates and rates, then accelerations, multipliers and rates of first-order variables follow. Like `derivative`,
  /// after `linearize` at the same state.
  void complete(const State& state, Direction& along);
  /// dA/deps, exact, where state and parameters move along a direction that keeps Eqs. (16)-(20) satisfied.
  [[nodiscard]] Eigen::MatrixXd derivative(const State& state, const Direction& along);

  [[nodiscard]] const Partition& partition() const { return partition_; }
  /// How x, v, z, u, (2n + nz + nu), move with each state and input (columns), of the last call. Models do without this
  /// matrix and the next: they are made when first asked for.
  [[nodiscard]] const Eigen::MatrixXd& motion();
  /// The accelerations, multipliers of independent rows and rates, (n + rows + nz), that follow; columns as of motion.
  [[nodiscard]] const Eigen::MatrixXd& response();
  /// Of the last call of linearize.
  [[nodiscard]] Conditions conditions() const;
  /// T of Eq. (31), (n x independent), of the last call of linearize.
  [[nodiscard]] Eigen::MatrixXd transformation();

 private:
  /// Some columns of motion or response, side by side: few enough to stay in the cache from step to step.
  static constexpr Index block = sparse::Klu::block;
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, block, Eigen::RowMajor>;
  /// A row of the model.
  struct Row {
    Columns Linearizer::*of = nullptr;
    Index index = 0;
  };

  void evaluate(const State& state);
  void evaluate_along(const State& state, const Direction& along, const Request& request);
  void check_consistent() const;
  void move(Index first);
  void move_coordinates(Index first);
  void respond();
  void fill_model(const std::vector<Row>& states, LinearModel& model);
  void fill_columns();
  [[nodiscard]] Index columns() const;
  [[nodiscard]] Row output_row(const Measured& y) const;
  [[nodiscard]] std::vector<KinkTaken> kinks_at(const State& state);

  const System& system_;
  Partition partition_;
  std::vector<Measured> outputs_;
  std::vector<NamedQuantity> reduced_states_, augmented_states_, input_names_, output_names_;
  Blocks blocks_, moving_;  // at the state, and their derivatives along a direction
  Kkt kkt_;
  // Operators, assembled from blocks; columns (x, v, z, u) stacked.
  SparsePlan C_x_;     // independent holonomic rows, (m x n)                          Eq. (41)
  SparsePlan D_;       // independent rows, (m+l x n)                                  Eq. (14)
  SparsePlan D_rate_;  // d(D v0)/dx, (m+l x n)                                        Eqs. (24), (46), (49)
  SparsePlan loads_;   // (f; s; g) by (x, v, z, u)                                    Eqs. (23), (26), (28), (37)
  SparsePlan C_xd_, D_dd_;
  sparse::Klu lu_C_xd_, lu_D_dd_;
  SparsePlan y_motion_, y_response_;  // outputs by (x, v, z, u) and by (a, lambda, zdot)
  std::vector<Row> reduced_rows_, augmented_rows_;
  bool reduced_ = true;      // whether the columns of the last call are the reduced states and the inputs
  Columns moves_, follows_;  // of one block: x, v, z, u that a column moves; a, lambda, zdot that follow
  Columns dependent_, of_components_;
  Eigen::MatrixXd motion_;    // (2n + nz + nu) x columns, or empty until asked for
  Eigen::MatrixXd response_;  // (n + m + l + nz) x columns, likewise
  Eigen::MatrixXd work_;
  Switches switches_;
};

/// Linearizes along states that differ. A partition is kept, so that models belong to the same coordinates, and chosen
/// again where it has become singular, or its condition exceeds both `worst_condition` and ten times what it was.
class LinearizerAlong {
 public:
  static constexpr double worst_condition = 1e6;  // six of sixteen digits
  LinearizerAlong(const System& system, Prescribed prescribed, std::vector<Measured> outputs = {});

  void linearize(const State& state, LinearModel& model);
  [[nodiscard]] const Partition& partition() const { return linearizer_->partition(); }
  [[nodiscard]] Conditions conditions() const { return conditions_; }
  /// How often a partition has been chosen.
  [[nodiscard]] int choices() const { return choices_; }

 private:
  void choose(const State& state, LinearModel& model);
  const System& system_;
  Prescribed prescribed_;
  std::vector<Measured> outputs_;
  std::unique_ptr<Linearizer> linearizer_;
  Conditions conditions_;
  double when_chosen_ = 1.0;
  int choices_ = 0;
};

}  // namespace bramah
