#include "solve/settling.hpp"

#include <algorithm>
#include <cmath>

#include "solve/assemble.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

constexpr double added_mass = 1e-3;  // of the largest inertia, in nominals
constexpr double first_move = 0.05;  // nominals
constexpr double local_error = 0.1;  // nominals that a step may err by
constexpr double corrected = 1e-6;   // nominals: a Newton correction that ends a step
constexpr int most_corrections = 10;
constexpr double fastest = 5.0, cautious = 1.2;  // growth of a step; after one that could not be closed
constexpr int most_steps = 2000;
constexpr double away = 1e6;          // nominals: it does not come back
constexpr double slow = 1e-3;         // nominals in a step: worth looking for the point of rest nearby
constexpr double nearby = 0.05;       // nominals to it
constexpr double still = 1e-10;       // nominals in a step: it has come to rest
constexpr double disturbance = 1e-3;  // nominals
constexpr int most_disturbances = 12;

// The weights of terms, in the order of `fill`.
enum Weight : std::size_t { statics, always, rates, creep };

}  // namespace

Settling::Settling(const System& system, const EquilibriumOptions& options, const State& start)
    : system_(system),
      options_(options),
      unknowns_(system, options),
      blocks_(system),
      curvature_(system, options),
      creep_x_(system.x.size(), 0.0),
      creep_z_(system.z.size(), 0.0) {
  const Index n = system.n(), m = system.m(), l = system.l();
  const std::vector<Index> all = shifted(n, 0);
  const Term inertia[] = {{BRAMAH_F_A, all, all, false, 0}};
  inertia_ = SparsePlan(system, n, n, inertia);
  choose_masses(start);
  // Rows have the numbers of the columns: those of what is held are left out.
  const auto& [x, z, lambda, count] = unknowns_;
  std::vector<Index> c(static_cast<std::size_t>(m)), b(static_cast<std::size_t>(m + l), -1);
  std::copy_n(lambda.begin(), m, c.begin());
  std::copy_n(lambda.begin() + m, l, b.begin() + m);
  const Term terms[] = {
      {BRAMAH_F_X, x, x, false, statics}, {BRAMAH_L_X, x, x, false, statics},  {BRAMAH_F_Z, x, z, false, statics},
      {BRAMAH_F_U, x, z, false, statics}, {BRAMAH_F_A, x, x, false, creep},    {BRAMAH_R_V, lambda, x, true, always},
      {BRAMAH_G_X, z, x, false, statics}, {BRAMAH_G_Z, z, z, false, statics},  {BRAMAH_G_U, z, z, false, statics},
      {BRAMAH_G_V, z, x, false, rates},   {BRAMAH_G_ZDOT, z, z, false, rates}, {BRAMAH_C_X, c, x, false, always},
      {BRAMAH_R_V, b, x, false, rates},   {BRAMAH_R_X, b, x, false, statics}};
  Vector masses;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] < 0) continue;
    masses.push_back(mass_[i]);
    nominal_.push_back(system.x[i].nominal);
  }
  const auto free = static_cast<Index>(masses.size());
  const Diagonal diagonals[] = {{0, 0, free, creep, masses}};
  matrix_ = ScaledMatrix(SparsePlan(system, count, count, terms, diagonals));
  residual_.assign(static_cast<std::size_t>(count), 0.0);
  step_ = residual_;
  terms_.assign(masses.size(), 0.0);
  scale_.assign(static_cast<std::size_t>(count), 1.0);
  State unused = start;
  unknowns_.each(system_, unused, [&](Index column, const Variable* variable, double&) {
    if (variable != nullptr) scale_[static_cast<std::size_t>(column)] = variable->nominal;
  });
}

void Settling::choose_masses(const State& start) {
  State at = start;
  double largest = 0.0;
  if (blocks_.evaluate(system_, at, Request{}.blocks({BRAMAH_F_A, BRAMAH_F_X})).ok()) {
    const double one = 1.0;
    inertia_.fill(blocks_, {&one, 1});
    for (Index j = 0; j < system_.n(); ++j) {
      const double nominal = system_.x[static_cast<std::size_t>(j)].nominal;
      for (Index e = inertia_.start()[static_cast<std::size_t>(j)];
           e < inertia_.start()[static_cast<std::size_t>(j) + 1]; ++e) {
        if (inertia_.row()[static_cast<std::size_t>(e)] == j)
          largest = std::max(largest, inertia_.values()[static_cast<std::size_t>(e)] * nominal * nominal);
      }
    }
  }
  if (largest == 0.0) largest = system_.scales.mass * system_.scales.length * system_.scales.length;
  for (const Variable& x : system_.x) mass_.push_back(added_mass * largest / (x.nominal * x.nominal));
}

bool Settling::evaluate(const State& from, State& state, double h) {
  const auto n = system_.x.size(), nz = system_.z.size(), m = system_.holonomic.size();
  std::fill_n(state.v.begin(), n, 0.0);
  std::fill_n(state.a.begin(), n, 0.0);
  std::fill_n(state.zdot.begin(), nz, 0.0);
  const Request forces =
      Request{}.rows("fc").blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_F_A, BRAMAH_R_V, BRAMAH_C_X});
  if (!blocks_.evaluate(system_, state, forces).ok()) return false;
  for (std::size_t i = 0; i < n; ++i) state.v[i] = (state.x[i] - from.x[i]) / h;
  for (std::size_t i = 0; i < nz; ++i) state.zdot[i] = (state.z[i] - from.z[i]) / h;
  const Request flows = Request{}.rows("gr").blocks(
      {BRAMAH_G_X, BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_G_V, BRAMAH_G_ZDOT, BRAMAH_R_V, BRAMAH_R_X});
  if (nz + system_.nonholonomic.size() > 0 && !blocks_.evaluate(system_, state, flows).ok()) return false;

  const double one = 1.0;
  inertia_.fill(blocks_, {&one, 1});
  Vector drag(n);
  for (std::size_t j = 0; j < n; ++j) {
    drag[j] += mass_[j] * state.v[j];
    for (Index e = inertia_.start()[j]; e < inertia_.start()[j + 1]; ++e) {
      const auto at = static_cast<std::size_t>(e);
      drag[static_cast<std::size_t>(inertia_.row()[at])] += inertia_.values()[at] * state.v[j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (unknowns_.x[i] < 0) continue;
    const auto row = static_cast<std::size_t>(unknowns_.x[i]);
    residual_[row] = blocks_.f[i] + drag[i] / system_.scales.time;
    terms_[row] = std::abs(blocks_.f[i]);
  }
  for (std::size_t i = 0; i < nz; ++i) {
    if (unknowns_.z[i] >= 0) residual_[static_cast<std::size_t>(unknowns_.z[i])] = blocks_.g[i];
  }
  for (std::size_t i = 0; i < unknowns_.lambda.size(); ++i)
    residual_[static_cast<std::size_t>(unknowns_.lambda[i])] = i < m ? blocks_.c[i] : blocks_.r[i];
  return true;
}

void Settling::scale_matrix(const State& state, double weight_of_statics, double h) {
  const double weights[] = {weight_of_statics, 1.0, 1.0 / h, 1.0 / (h * system_.scales.time)};
  matrix_.fill(blocks_, weights);
  size_multipliers(matrix_, nominal_, terms_, state.lambda, system_.scales.force(), scale_);
  matrix_.scale(scale_);
  matrix_.factor();
  matrix_.solve(residual_, step_);
}

bool Settling::find_multipliers(State& state) {
  State at = state;
  if (!evaluate(state, at, 1.0)) return false;
  for (const Index row : unknowns_.lambda)
    residual_[static_cast<std::size_t>(row)] = 0.0;  // motions along the constraints
  scale_matrix(state, 0.0, 1.0);
  State velocity = state;
  unknowns_.each(system_, velocity, [&](Index column, const Variable*, double& value) {
    value = step_[static_cast<std::size_t>(column)] * scale_[static_cast<std::size_t>(column)];
  });
  for (std::size_t i = 0; i < system_.x.size(); ++i) creep_x_[i] = unknowns_.x[i] >= 0 ? velocity.x[i] : 0.0;
  for (std::size_t i = 0; i < system_.z.size(); ++i) creep_z_[i] = unknowns_.z[i] >= 0 ? velocity.z[i] : 0.0;
  for (std::size_t i = 0; i < state.lambda.size(); ++i) state.lambda[i] += velocity.lambda[i];
  return std::all_of(step_.begin(), step_.end(), [](double s) { return std::isfinite(s); });
}

bool Settling::close_step(const State& from, State& state, double h) {
  const std::size_t variables = scale_.size() - unknowns_.lambda.size();
  double before = HUGE_VAL;
  for (int k = 0; k < most_corrections; ++k) {
    if (!evaluate(from, state, h)) return false;
    scale_matrix(state, 1.0, h);
    double size = 0.0;
    for (std::size_t j = 0; j < variables; ++j) size = std::max(size, std::abs(step_[j]));
    if (!(size <= std::max(2.0 * before, corrected))) return false;
    unknowns_.each(system_, state, [&](Index column, const Variable*, double& value) {
      value += step_[static_cast<std::size_t>(column)] * scale_[static_cast<std::size_t>(column)];
    });
    if (size <= corrected) return true;
    before = size;
  }
  return false;
}

State Settling::predicted(const State& from, double h) {
  State state = from;
  for (std::size_t i = 0; i < system_.x.size(); ++i) state.x[i] += h * creep_x_[i];
  for (std::size_t i = 0; i < system_.z.size(); ++i) state.z[i] += h * creep_z_[i];
  return state;
}

double Settling::distance(const State& a, const State& b) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < system_.x.size(); ++i)
    largest = std::max(largest, std::abs(a.x[i] - b.x[i]) / system_.x[i].nominal);
  for (std::size_t i = 0; i < system_.z.size(); ++i)
    largest = std::max(largest, std::abs(a.z[i] - b.z[i]) / system_.z[i].nominal);
  return largest;
}

Index Settling::far_away(const State& start, const State& state) const {
  for (std::size_t i = 0; i < system_.x.size(); ++i) {
    if (std::abs(state.x[i] - start.x[i]) > away * system_.x[i].nominal) return static_cast<Index>(i);
  }
  for (std::size_t i = 0; i < system_.z.size(); ++i) {
    if (std::abs(state.z[i] - start.z[i]) > away * system_.z[i].nominal) return system_.n() + static_cast<Index>(i);
  }
  return -1;
}

bool Settling::polish(State& state, double within) const {
  State found = state;
  std::fill(found.v.begin(), found.v.end(), 0.0);
  std::fill(found.zdot.begin(), found.zdot.end(), 0.0);
  if (!Balance(system_, options_, found).run() || distance(found, state) > within) return false;
  state = found;
  return true;
}

bool Settling::is_minimum(const State& state) { return !curvature_.evaluate(state) || curvature_.minimum(); }

/// Off a point of rest that is no minimum, in a direction that is fixed: all coordinates at once, each by another share.
bool Settling::disturb(State& state, int time) const {
  const State rest = state;
  for (std::size_t i = 0; i < system_.x.size(); ++i) {
    if (unknowns_.x[i] >= 0)
      state.x[i] += disturbance * system_.x[i].nominal * std::sin(1.0 + 2.4 * static_cast<double>(i) + time);
  }
  try {
    assemble_positions(system_, state, options_.hold_x);
  } catch (const AnalysisError&) {
    state = rest;
    return false;
  }
  return true;
}

Settling::Result Settling::run(State& state) {
  Result result;
  const State start = state;
  State here = state, saddle;
  const auto set_out = [&] {
    if (!find_multipliers(here)) return 0.0;
    double speed = 0.0;
    for (std::size_t i = 0; i < system_.x.size(); ++i)
      speed = std::max(speed, std::abs(creep_x_[i]) / system_.x[i].nominal);
    for (std::size_t i = 0; i < system_.z.size(); ++i)
      speed = std::max(speed, std::abs(creep_z_[i]) / system_.z[i].nominal);
    return speed > 0.0 ? first_move / speed : system_.scales.time;
  };
  double h = set_out(), least = 1e-12 * h, next_try = 0.0;
  double growth = fastest;
  int disturbances = 0, idle = 0;
  bool leaving = false;
  for (; h > least && result.steps < most_steps; ++result.steps) {
    const State guess = predicted(here, h);
    State next = guess;
    if (!close_step(here, next, h)) {
      h *= 0.25;
      growth = cautious;
      continue;
    }
    const double error = 0.5 * distance(next, guess);
    if (error > 2.0 * local_error) {
      h *= std::max(0.1, 0.8 * std::sqrt(local_error / error));
      continue;
    }
    if (curvature_.evaluate(next) && !curvature_.definite(1.0 / (h * system_.scales.time), mass_)) {
      h *= 0.5;
      continue;
    }
    const double moved = distance(next, here);
    for (std::size_t i = 0; i < creep_x_.size(); ++i) creep_x_[i] = (next.x[i] - here.x[i]) / h;
    for (std::size_t i = 0; i < creep_z_.size(); ++i) creep_z_[i] = (next.z[i] - here.z[i]) / h;
    here = std::move(next);
    result.away = far_away(start, here);
    if (result.away >= 0) {
      result.end = End::runs_away;
      break;
    }
    leaving = leaving && distance(here, saddle) < 20.0 * disturbance && ++idle < 200;
    bool rests = !leaving && moved <= still;
    if (!leaving && moved <= slow && h >= next_try) {
      rests = polish(here, nearby) || rests;
      if (!rests) next_try = 8.0 * h;
    }
    if (rests) {
      if (is_minimum(here) || disturbances == most_disturbances) {
        result.end = End::rest;
        break;
      }
      saddle = here;
      if (!disturb(here, disturbances++)) continue;
      leaving = true;
      idle = 0;
      next_try = 0.0;
      h = set_out();
      continue;
    }
    h *= std::clamp(0.9 * std::sqrt(local_error / std::max(error, 1e-300)), 0.3, growth);
    growth = std::min(fastest, growth * growth);
  }
  std::fill(here.v.begin(), here.v.end(), 0.0);
  std::fill(here.zdot.begin(), here.zdot.end(), 0.0);
  state = here;
  return result;
}

}  // namespace bramah
