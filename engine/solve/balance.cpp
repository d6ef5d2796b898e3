#include "solve/balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/assemble.hpp"
#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
// Of the rounding of all terms of a row: what its sum may keep.
constexpr double rounding_terms = 64.0;
// Nominals that a step may still move where the residual is small: more, and a small residual says nothing.
constexpr double settled = 1e-6;
// Iterations without progress before Newton's method gives up.
constexpr int patience = 25;

Index compact(std::vector<Index>& map, const std::vector<Index>& held, Index next) {
  for (const Index i : held) map[static_cast<std::size_t>(i)] = -1;
  for (Index& column : map) {
    if (column >= 0) column = next++;
  }
  return next;
}

}  // namespace

Unknowns::Unknowns(const System& system, const EquilibriumOptions& options)
    : x(shifted(system.n(), 0)), z(shifted(system.nz(), 0)) {
  count = compact(z, options.hold_z, compact(x, options.hold_x, 0));
  lambda = shifted(system.m() + system.l(), count);
  count += static_cast<Index>(lambda.size());
}

/// Sums the sizes of what components add to the force and storage balances.
class Balance::Terms : public RowListener {
 public:
  Terms(const System& system, Vector& terms) : n_(system.n()), nz_(system.nz()), terms_(terms) {
    std::fill(terms.begin(), terms.end(), 0.0);
  }
  void hear(const Group& group, Index first, const bramah_batch& batch) override {
    add(group.x, group.type->nx, first, batch.count, batch.f, n_, 0);
    add(group.z, group.type->nz, first, batch.count, batch.g, nz_, n_);
  }

 private:
  void add(const std::vector<std::int32_t>& place, Index width, Index first, Index count, const double* rows,
           Index most, Index offset) {
    if (rows == nullptr) return;
    for (Index k = 0; k < count * width; ++k) {
      const Index row = place[static_cast<std::size_t>(first * width + k)];
      if (row < most) terms_[static_cast<std::size_t>(row + offset)] += std::abs(rows[k]);
    }
  }
  Index n_, nz_;
  Vector& terms_;
};

Balance::Balance(const System& system, const EquilibriumOptions& options, State& state)
    : system_(system), options_(options), state_(state), unknowns_(system, options), blocks_(system) {
  const Index n = system.n(), nz = system.nz(), m = system.m(), equations = n + nz + m;
  const std::vector<Index> f = shifted(n, 0), g = shifted(nz, n), c = shifted(m, n + nz);
  const auto& [x, z, lambda, count] = unknowns_;
  const Term terms[] = {{BRAMAH_F_X, f, x, false, 0}, {BRAMAH_L_X, f, x, false, 0},     {BRAMAH_F_Z, f, z, false, 0},
                        {BRAMAH_F_U, f, z, false, 0}, {BRAMAH_R_V, lambda, f, true, 0}, {BRAMAH_G_X, g, x, false, 0},
                        {BRAMAH_G_Z, g, z, false, 0}, {BRAMAH_G_U, g, z, false, 0},     {BRAMAH_C_X, c, x, false, 0}};
  matrix_ = ScaledMatrix(SparsePlan(system, equations, count, terms));
  for (Vector* rows : {&residual_, &terms_, &rounding_, &noise_, &row_size_})
    rows->assign(static_cast<std::size_t>(equations), 0.0);
  for (const Variable& variable : system.x) nominal_.push_back(variable.nominal);
  scale_.assign(static_cast<std::size_t>(count), 1.0);
  step_.assign(static_cast<std::size_t>(count), 0.0);
  unknowns_.each(system_, state_, [&](Index column, const Variable* variable, double&) {
    if (variable != nullptr) scale_[static_cast<std::size_t>(column)] = variable->nominal;
  });
  take_assembly();
}

/// Rows that repeat each other and disagree by rounding cannot all be closed better than they are at the assembled start.
void Balance::take_assembly() {
  rounded_ = system_.m() > 0 && blocks_.evaluate(system_, state_, Request{}.rows("c")).ok() &&
             leaves_rounding(system_, state_, blocks_.c);
}

bool Balance::evaluate(bool with_matrix) {
  Request request = Request{}.rows("fgc");
  if (with_matrix) {
    request.blocks(
        {BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_R_V, BRAMAH_G_X, BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_C_X});
  }
  Terms listener(system_, terms_);
  request.listener = with_matrix ? &listener : nullptr;
  outcome_ = blocks_.evaluate(system_, state_, request);
  if (!outcome_.ok()) return false;
  take_rows(blocks_);
  if (with_matrix) take_sizes();
  return true;
}

void Balance::take_sizes() {
  const double one = 1.0;
  matrix_.fill(blocks_, {&one, 1});
  size_multipliers(matrix_, nominal_, terms_, state_.lambda, system_.scales.force(), scale_);
  matrix_.scale(scale_);

  Vector value(scale_.size());
  unknowns_.each(system_, state_, [&](Index column, const Variable*, double& of) {
    value[static_cast<std::size_t>(column)] = std::abs(of);
  });
  // Multipliers are solved for together: each has the rounding of the largest.
  const std::size_t first = scale_.size() - unknowns_.lambda.size();
  const double largest = first == scale_.size()
                             ? 0.0
                             : *std::max_element(scale_.begin() + static_cast<std::ptrdiff_t>(first), scale_.end());
  std::fill(rounding_.begin(), rounding_.end(), 0.0);
  std::fill(noise_.begin(), noise_.end(), 0.0);
  matrix_.each_entry([&](std::size_t row, std::size_t column, double entry) {
    rounding_[row] += std::abs(entry) * value[column];
    if (column >= first) noise_[row] += std::abs(entry) * largest;
  });
  const std::size_t balances = system_.x.size() + system_.z.size();
  for (std::size_t i = 0; i < rounding_.size(); ++i) {
    rounding_[i] = rounding_terms * epsilon * (rounding_[i] + terms_[i]);
    const double coefficient = matrix_.row_scale()[i] > 0.0 ? 1.0 / matrix_.row_scale()[i] : 0.0;
    noise_[i] = std::max(rounding_[i], rounding_terms * epsilon * noise_[i]);
    row_size_[i] = std::max({coefficient, terms_[i], noise_[i] / options_.tolerance});
    if (row_size_[i] > 0.0) continue;
    // Without terms and coefficients: a balance is zero then, a constraint may stay open.
    row_size_[i] = i < balances ? 1.0 : system_.holonomic[i - balances].nominal;
  }
  for (std::size_t i = balances; rounded_ && i < row_size_.size(); ++i) {
    const double tolerated = system_.assembly_tolerance_of(system_.holonomic[i - balances]);
    row_size_[i] = std::max(row_size_[i], tolerated / options_.tolerance);
  }
}

double Balance::size(Index* where) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const double value = std::abs(residual_[i]) / row_size_[i];
    if (value > largest) {
      largest = value;
      if (where != nullptr) *where = static_cast<Index>(i);
    }
  }
  return largest;
}

void Balance::solve() {
  matrix_.factor(rounded_ ? rank_tolerance_of(system_) : sparse::RankLuOptions{}.rank_tolerance);
  matrix_.solve(residual_, step_);
}

double Balance::step_size() const {
  double largest = 0.0;
  for (std::size_t j = 0; j < step_.size() - unknowns_.lambda.size(); ++j)
    largest = std::max(largest, std::abs(step_[j]));
  return largest;
}

void Balance::move(double factor) {
  unknowns_.each(system_, state_, [&](Index column, const Variable*, double& value) {
    value += factor * step_[static_cast<std::size_t>(column)] * scale_[static_cast<std::size_t>(column)];
  });
}

bool Balance::improves(const State& origin, double before, double factor) {
  for (int half = 0; half < 30; ++half, factor *= 0.5) {
    state_ = origin;
    move(factor);
    if (evaluate(false) && (size() < (1.0 - 1e-4 * factor) * before || size() <= options_.tolerance)) return true;
  }
  return false;
}

bool Balance::run(double largest_step) {
  iterations_ = 0;
  if (!evaluate(true)) return false;
  double least_step = HUGE_VAL, least_size = size();
  int idle = 0;
  for (; iterations_ < options_.max_iterations && idle < patience; ++iterations_) {
    const double before = size();
    solve();
    const double step = step_size();
    if (!std::isfinite(step) || step > largest_step) return false;
    // Quadratic convergence ends in rounding: the step no longer shrinks and the residual is at its floor.
    const double slowest = step <= settled ? 0.5 : 0.95;
    if (before <= options_.tolerance && step >= slowest * least_step) break;
    least_step = std::min(least_step, step);
    const State origin = state_;
    if (!improves(origin, before,
                  step > 1.0 ? 1.0 / step : 1.0)) {  // no variable moves by more than its nominal at once
      // Through a turning point of the merit function: a full small step is better than none, but not when at rest.
      state_ = origin;
      if (before <= options_.tolerance) {
        if (!evaluate(true)) return false;
        break;
      }
      move(std::min(1.0, 0.1 / std::max(step, 1e-300)));
    }
    if (!evaluate(true)) return false;
    idle = size() < 0.9 * least_size ? 0 : idle + 1;
    least_size = std::min(least_size, size());
    if (size() <= options_.tolerance && step <= 1e-15) {
      ++iterations_;
      break;
    }
  }
  solve();
  Index row = 0;
  return balanced(row);
}

bool Balance::balanced(Index& row) const {
  if (size(&row) > options_.tolerance) return false;
  // Where nothing loads the machine, multipliers and their rounding go to zero together.
  const auto rounds = [&] {
    for (std::size_t i = 0; i < residual_.size(); ++i) {
      if (std::abs(residual_[i]) > std::max(rounding_[i], epsilon * options_.tolerance * row_size_[i])) return false;
    }
    return true;
  };
  if (step_size() > settled && !rounds()) return false;
  const Index load = unresisted_load();
  if (load >= 0) row = load;
  return load < 0;
}

/// A combination of rows without a coefficient, w = e_i - sum of y_k e_k: what is left of it is no residual but a load that
/// nothing can balance, unless it is small beside its terms. The row i, or -1.
Index Balance::unresisted_load() const {
  const sparse::RankLu& lu = matrix_.lu();
  std::vector<bool> is_pivot(residual_.size(), false);
  for (const std::int64_t row : lu.pivot_rows()) is_pivot[static_cast<std::size_t>(row)] = true;
  const std::size_t forces = system_.x.size() + system_.z.size();
  const sparse::CscView a = matrix_.view();
  Vector c(scale_.size()), y(residual_.size());
  for (std::size_t i = 0; i < forces; ++i) {
    if (is_pivot[i] || std::abs(residual_[i]) <= noise_[i]) continue;
    std::fill(c.begin(), c.end(), 0.0);
    for (std::int64_t j = 0; j < a.columns; ++j) {
      for (std::int64_t e = a.start[j]; e < a.start[j + 1]; ++e) {
        if (static_cast<std::size_t>(a.row[e]) == i) c[static_cast<std::size_t>(j)] = a.value[e];
      }
    }
    lu.solve_transposed(c, y);
    const double own = matrix_.row_scale()[i] > 0.0 ? matrix_.row_scale()[i] : 1.0;
    double load = residual_[i] * own, terms = terms_[i] * own, noise = noise_[i] * own;
    for (std::size_t k = 0; k < y.size(); ++k) {
      if (y[k] == 0.0) continue;
      load -= y[k] * residual_[k] * matrix_.row_scale()[k];
      terms += std::abs(y[k]) * terms_[k] * matrix_.row_scale()[k];
      noise += std::abs(y[k]) * noise_[k] * matrix_.row_scale()[k];
    }
    if (std::abs(load) > options_.tolerance * terms + noise) return static_cast<Index>(i);
  }
  return -1;
}

bool Balance::follow(Direction& along) {
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
  unknowns_.each(system_, along.state, [&](Index column, const Variable*, double& value) {
    value = step_[static_cast<std::size_t>(column)] * scale_[static_cast<std::size_t>(column)];
  });
  double moved = 0.0;
  for (const double step : step_) moved = std::max(moved, std::abs(step));
  return rows_along() && size() <= enough * std::max(before, moved);
}

std::string Balance::place_of_failure() const {
  return outcome_.component < 0 ? "" : pointer("/components", system_.component_name(outcome_.component));
}

std::string Balance::equation_name(Index i) const {
  const Index n = system_.n(), nz = system_.nz();
  if (i < n) return "the force balance of " + system_.x[static_cast<std::size_t>(i)].name;
  if (i < n + nz) return "the storage balance of " + system_.z[static_cast<std::size_t>(i - n)].name;
  return "the constraint " + system_.constraint(i - n - nz).name;
}

std::string Balance::equation_residual(Index i) const {
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

std::string Balance::equation_component(Index i) const {
  const Index n = system_.n(), nz = system_.nz();
  return system_.component_name(i < n        ? system_.x[static_cast<std::size_t>(i)].component
                                : i < n + nz ? system_.z[static_cast<std::size_t>(i - n)].component
                                             : system_.constraint(i - n - nz).component);
}

bool Balance::multipliers_undetermined() const {
  const Index first = unknowns_.count - static_cast<Index>(unknowns_.lambda.size());
  const auto& dependent = matrix_.lu().dependent_columns();
  return std::any_of(dependent.begin(), dependent.end(), [&](Index column) { return column >= first; });
}

std::vector<FreeDirection> Balance::free_directions() {
  std::vector<std::string> names(scale_.size());
  unknowns_.each(system_, state_, [&](Index column, const Variable* variable, double&) {
    if (variable != nullptr) names[static_cast<std::size_t>(column)] = variable->name;
  });
  std::vector<FreeDirection> directions;
  const std::vector<sparse::Dependency> dependencies = matrix_.lu().dependencies();
  for (std::size_t k = 0; k < dependencies.size(); ++k) {
    const auto free_column = static_cast<std::size_t>(matrix_.lu().dependent_columns()[k]);
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

void Balance::take_rows(const Blocks& from) {
  auto it = std::copy(from.f.begin(), from.f.end(), residual_.begin());
  it = std::copy(from.g.begin(), from.g.end(), it);
  std::copy(from.c.begin(), from.c.end(), it);
}

}  // namespace bramah
