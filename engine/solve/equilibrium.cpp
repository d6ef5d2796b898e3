#include "solve/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/assemble.hpp"
#include "sparse/rank_lu.hpp"
#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

/// Newton's method on (x, z, lambda) without the held variables, by a rank-revealing factorization: a direction that no
/// row resists is left where it is.
class Newton {
 public:
  Newton(const System& system, const EquilibriumOptions& options, State& state)
      : system_(system), state_(state), blocks_(system) {
    const Index n = system.n(), nz = system.nz(), m = system.m(), ml = m + system.l();
    x_ = shifted(n, 0);
    for (const Index i : options.hold_x) x_[static_cast<std::size_t>(i)] = -1;
    Index next = compact(x_, 0);
    z_ = shifted(nz, 0);
    for (const Index i : options.hold_z) z_[static_cast<std::size_t>(i)] = -1;
    next = compact(z_, next);
    lambda_ = shifted(ml, next);
    unknowns_ = next + ml;
    const std::vector<Index> f = shifted(n, 0), g = shifted(nz, n), c = shifted(m, n + nz);
    equations_ = n + nz + m;
    const Term terms[] = {
        {BRAMAH_F_X, f, x_, false, 0}, {BRAMAH_L_X, f, x_, false, 0},     {BRAMAH_F_Z, f, z_, false, 0},
        {BRAMAH_F_U, f, z_, false, 0}, {BRAMAH_R_V, lambda_, f, true, 0}, {BRAMAH_G_X, g, x_, false, 0},
        {BRAMAH_G_Z, g, z_, false, 0}, {BRAMAH_G_U, g, z_, false, 0},     {BRAMAH_C_X, c, x_, false, 0}};
    plan_ = SparsePlan(system, equations_, unknowns_, terms);
    scale_.assign(static_cast<std::size_t>(unknowns_), 1.0);
    each_unknown(state_, [&](Index column, const Variable* variable, double&) {
      if (variable != nullptr) scale_[static_cast<std::size_t>(column)] = variable->nominal;
    });
    residual_.resize(static_cast<std::size_t>(equations_));
    row_scale_.resize(static_cast<std::size_t>(equations_));
    step_.resize(static_cast<std::size_t>(unknowns_));
  }

  /// Residual and matrix at the state; false where they cannot be evaluated.
  bool evaluate(bool with_matrix) {
    Request request = Request{}.rows("fgc");
    if (with_matrix) {
      request.blocks(
          {BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_R_V, BRAMAH_G_X, BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_C_X});
    }
    outcome_ = blocks_.evaluate(system_, state_, request);
    if (!outcome_.ok()) return false;
    take_rows(blocks_);
    if (!with_matrix) return true;
    // Multipliers have no nominal: the machine's forces serve, and their own size where that is larger.
    for (std::size_t i = 0; i < lambda_.size(); ++i) {
      scale_[static_cast<std::size_t>(lambda_[i])] =
          std::max(force_of(system_.constraint(static_cast<Index>(i)).unit), std::abs(state_.lambda[i]));
    }
    const double one = 1.0;
    plan_.fill(blocks_, {&one, 1});
    scaled_.assign(plan_.values().begin(), plan_.values().end());
    std::fill(row_scale_.begin(), row_scale_.end(), 0.0);
    for_entries([&](std::size_t e, std::size_t row, std::size_t column) {
      scaled_[e] *= scale_[column];
      row_scale_[row] = std::max(row_scale_[row], std::abs(scaled_[e]));
    });
    // A row that nothing enters is judged by the machine's forces.
    for (std::size_t i = 0; i < row_scale_.size(); ++i) {
      double& r = row_scale_[i];
      if (r == 0.0 && i < system_.x.size()) r = force_of(system_.x[i].unit);
      r = r > 0.0 ? 1.0 / r : 1.0;
    }
    for_entries([&](std::size_t e, std::size_t row, std::size_t) { scaled_[e] *= row_scale_[row]; });
    return true;
  }

  /// Largest residual, each row relative to its largest coefficient times one nominal.
  [[nodiscard]] double size(Index* where = nullptr) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < residual_.size(); ++i) {
      const double value = std::abs(residual_[i]) * row_scale_[i];
      if (value > largest) {
        largest = value;
        if (where != nullptr) *where = static_cast<Index>(i);
      }
    }
    return largest;
  }

  void solve() {
    const sparse::CscView matrix{equations_, unknowns_, plan_.start().data(), plan_.row().data(), scaled_.data()};
    if (order_.empty()) order_ = sparse::fill_reducing_order(matrix);  // the pattern stays
    lu_.factor(matrix, {.order = order_});
    Vector rhs(residual_.size());
    for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] = -residual_[i] * row_scale_[i];
    lu_.solve(rhs, step_);
  }
  /// Completes a direction whose parameters, inputs and held variables move: the others follow so that all rows stay zero.
  /// False where they cannot. After evaluate.
  bool follow(Direction& along) {
    constexpr double enough = 1e-8;  // what may remain of the rows
    Blocks moving(system_);
    const auto rows_along = [&] {
      outcome_ = moving.evaluate_along(system_, state_, along, Request{}.rows("fgc"));
      if (!outcome_.ok()) return false;
      take_rows(moving);
      return true;
    };
    if (!rows_along()) return false;
    const double before = size();
    solve();
    each_unknown(along.state, [&](Index column, const Variable*, double& value) {
      value = step_[static_cast<std::size_t>(column)] * scale_[static_cast<std::size_t>(column)];
    });
    double moved = 0.0;
    for (const double step : step_) moved = std::max(moved, std::abs(step));
    return rows_along() && size() <= enough * std::max(before, moved);
  }

  /// Largest component of the step, in nominals; multipliers do not count.
  [[nodiscard]] double step_size() const {
    double largest = 0.0;
    for (Index j = 0; j < unknowns_ - static_cast<Index>(lambda_.size()); ++j) {
      largest = std::max(largest, std::abs(step_[static_cast<std::size_t>(j)]));
    }
    return largest;
  }
  void move(double factor) {
    each_unknown(state_, [&](Index column, const Variable*, double& value) {
      value += factor * step_[static_cast<std::size_t>(column)] * scale_[static_cast<std::size_t>(column)];
    });
  }

  [[nodiscard]] const std::string& failure() const { return outcome_.message; }
  [[nodiscard]] std::string place_of_failure() const {
    return outcome_.component < 0 ? "" : "/components/" + system_.component_name(outcome_.component);
  }
  [[nodiscard]] std::string equation_name(Index i) const {
    const Index n = system_.n(), nz = system_.nz();
    if (i < n) return "the force balance of " + system_.x[static_cast<std::size_t>(i)].name;
    if (i < n + nz) return "the storage balance of " + system_.z[static_cast<std::size_t>(i - n)].name;
    return "the constraint " + system_.constraint(i - n - nz).name;
  }
  /// The residual with its unit, where the unit is a plain one.
  [[nodiscard]] std::string equation_residual(Index i) const {
    const Index n = system_.n(), nz = system_.nz();
    std::string unit;
    if (i < n) {
      const std::string& of = system_.x[static_cast<std::size_t>(i)].unit;
      unit = of == "m" ? " N" : of == "rad" ? " N.m" : "";
    } else if (i < n + nz) {
      unit = system_.z[static_cast<std::size_t>(i - n)].unit == "Pa" ? " m^3/s" : "";
    } else {
      const std::string& of = system_.constraint(i - n - nz).unit;
      unit = of == "1" ? "" : " " + of;
    }
    return digits(residual_[static_cast<std::size_t>(i)]) + unit;
  }
  [[nodiscard]] std::string equation_component(Index i) const {
    const Index n = system_.n(), nz = system_.nz();
    return system_.component_name(i < n        ? system_.x[static_cast<std::size_t>(i)].component
                                  : i < n + nz ? system_.z[static_cast<std::size_t>(i - n)].component
                                               : system_.constraint(i - n - nz).component);
  }
  /// The coordinate of a force balance that nothing resists at this state: it is free to move, or "".
  [[nodiscard]] std::string free_coordinate(Index i) {
    if (i >= system_.n()) return "";
    const std::string& name = system_.x[static_cast<std::size_t>(i)].name;
    for (const FreeDirection& direction : free_directions()) {
      for (const auto& [moved, share] : direction.variables) {
        if (moved == name) return name;
      }
    }
    return "";
  }

  /// Whether a column of the multipliers depends on others in the last factored matrix.
  [[nodiscard]] bool multipliers_undetermined() const {
    const Index first = unknowns_ - static_cast<Index>(lambda_.size());
    return std::any_of(lu_.dependent_columns().begin(), lu_.dependent_columns().end(),
                       [&](Index column) { return column >= first; });
  }

  /// Null vectors of the last factored matrix that move a variable; those of multipliers alone are redundant rows.
  std::vector<FreeDirection> free_directions() {
    std::vector<std::string> names(static_cast<std::size_t>(unknowns_));
    each_unknown(state_, [&](Index column, const Variable* variable, double&) {
      if (variable != nullptr) names[static_cast<std::size_t>(column)] = variable->name;
    });
    std::vector<FreeDirection> directions;
    const std::vector<sparse::Dependency> dependencies = lu_.dependencies();
    for (std::size_t k = 0; k < dependencies.size(); ++k) {
      const auto free_column = static_cast<std::size_t>(lu_.dependent_columns()[k]);
      FreeDirection direction;
      const auto add = [&](std::size_t column, double share) {
        if (names[column].empty() || std::abs(share) < 1e-9) return;
        direction.variables.emplace_back(names[column], share * scale_[column]);
      };
      add(free_column, 1.0);
      for (const auto& [column, coefficient] : dependencies[k]) add(static_cast<std::size_t>(column), -coefficient);
      if (!direction.variables.empty()) directions.push_back(std::move(direction));
    }
    return directions;
  }

 private:
  /// The machine's force, N, moment, N m, or J per unit of another coordinate or row.
  [[nodiscard]] double force_of(const std::string& unit) const {
    return unit == "m" ? system_.scales.force() : system_.scales.energy();
  }
  static Index compact(std::vector<Index>& map, Index next) {
    for (Index& column : map) {
      if (column >= 0) column = next++;
    }
    return next;
  }
  template <class Function>
  void for_entries(Function&& function) {
    for (std::size_t j = 0; j < static_cast<std::size_t>(unknowns_); ++j) {
      for (Index e = plan_.start()[j]; e < plan_.start()[j + 1]; ++e) {
        function(static_cast<std::size_t>(e), static_cast<std::size_t>(plan_.row()[static_cast<std::size_t>(e)]), j);
      }
    }
  }
  void take_rows(const Blocks& from) {
    auto it = std::copy(from.f.begin(), from.f.end(), residual_.begin());
    it = std::copy(from.g.begin(), from.g.end(), it);
    std::copy(from.c.begin(), from.c.end(), it);
  }
  template <class Function>
  void each_unknown(State& state, Function&& function) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (x_[i] >= 0) function(x_[i], &system_.x[i], state.x[i]);
    }
    for (std::size_t i = 0; i < z_.size(); ++i) {
      if (z_[i] >= 0) function(z_[i], &system_.z[i], state.z[i]);
    }
    for (std::size_t i = 0; i < lambda_.size(); ++i)
      function(lambda_[i], static_cast<const Variable*>(nullptr), state.lambda[i]);
  }

  const System& system_;
  State& state_;
  Blocks blocks_;
  std::vector<Index> x_, z_, lambda_;  // variable -> unknown, -1 where held
  Index unknowns_ = 0, equations_ = 0;
  SparsePlan plan_;
  sparse::RankLu lu_;
  std::vector<Index> order_;
  Vector scale_, row_scale_, scaled_, residual_, step_;
  Outcome outcome_;
};

}  // namespace

Equilibrium find_equilibrium(const System& system, const EquilibriumOptions& options, double t) {
  Equilibrium result;
  State& state = result.state;
  state = initial_state(system, t);
  std::fill(state.v.begin(), state.v.end(), 0.0);
  assemble_start_positions(system, state, options.hold_x);

  Newton newton(system, options, state);
  const auto evaluate = [&] {
    if (newton.evaluate(true)) return;
    throw AnalysisError("equilibrium", newton.failure(), "start values at which every component can be evaluated",
                        "move the start values", newton.place_of_failure());
  };
  evaluate();
  bool converged = false;
  double least_step = HUGE_VAL;
  for (; result.iterations < options.max_iterations && !converged; ++result.iterations) {
    const double before = newton.size();
    newton.solve();
    const double step = newton.step_size();
    // Quadratic convergence ends in rounding: the step no longer shrinks and the residual is at its floor.
    if (before <= options.tolerance && step >= 0.5 * least_step) break;
    least_step = std::min(least_step, step);
    const State origin = state;
    double factor = step > 1.0 ? 1.0 / step : 1.0;  // no variable moves by more than its nominal at once
    bool accepted = false;
    for (int half = 0; half < 30 && !accepted; ++half, factor *= 0.5) {
      state = origin;
      newton.move(factor);
      accepted = newton.evaluate(false) &&
                 (newton.size() < (1.0 - 1e-4 * factor) * before || newton.size() <= options.tolerance);
    }
    if (!accepted) {
      // Through a turning point of the merit function: a full small step is better than none, but not when at rest.
      state = origin;
      if (before <= options.tolerance) break;
      newton.move(std::min(1.0, 0.1 / std::max(step, 1e-300)));
    }
    evaluate();
    converged = newton.size() <= options.tolerance && step <= 1e-15;
  }
  Index row = 0;
  result.residual = newton.size(&row);
  if (result.residual > options.tolerance) {
    newton.solve();
    const std::string free = newton.free_coordinate(row);
    std::string held;
    for (const Index i : options.hold_x)
      held += (held.empty() ? "" : ", ") + system.x[static_cast<std::size_t>(i)].name;
    for (const Index i : options.hold_z)
      held += (held.empty() ? "" : ", ") + system.z[static_cast<std::size_t>(i)].name;
    throw AnalysisError(
        "equilibrium",
        newton.equation_name(row) + " stays at " + newton.equation_residual(row) + " after " +
            std::to_string(result.iterations) + " iterations" +
            (free.empty() ? "" : ", and nothing resists a motion of " + free),
        !free.empty()  ? std::string("something that balances this force")
        : held.empty() ? std::string("start values near an equilibrium")
                       : "an equilibrium at the start values of what is held: " + held,
        free.empty() ? std::string(held.empty() ? "" : "hold fewer variables, ") +
                           "move the start values, or check that something balances this row"
                     : "connect a joint, a spring or a support; holding " + free + " would not balance the force",
        "/components/" + newton.equation_component(row));
  }
  newton.solve();
  result.free_directions = newton.free_directions();
  if (newton.multipliers_undetermined()) {
    const Partition partition = choose_partition(system, state);
    take_minimum_norm(partition, state.lambda);
    result.redundancy = describe_redundancy(system, state, partition);
  }
  std::fill(state.a.begin(), state.a.end(), 0.0);
  std::fill(state.zdot.begin(), state.zdot.end(), 0.0);
  return result;
}

void move_equilibrium(const System& system, const EquilibriumOptions& options, const State& state, Direction& along) {
  State at = state;
  Newton newton(system, options, at);
  // Of the start values only those of held variables matter.
  const State before = along.state;
  along.add_start(system);
  const State starts = std::exchange(along.state, before);
  for (const Index i : options.hold_x)
    along.state.x[static_cast<std::size_t>(i)] = starts.x[static_cast<std::size_t>(i)];
  for (const Index i : options.hold_z)
    along.state.z[static_cast<std::size_t>(i)] = starts.z[static_cast<std::size_t>(i)];
  if (newton.evaluate(true) && newton.follow(along)) return;
  throw AnalysisError("sensitivity", newton.failure().empty() ? "no equilibrium beside this one" : newton.failure(),
                      "an equilibrium that moves with the number",
                      "hold other variables: what is held may not balance");
}

}  // namespace bramah
