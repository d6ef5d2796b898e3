#include "linear/descriptor.hpp"

#include <algorithm>
#include <cmath>

#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

constexpr double moving =
    1e-9;  // change of a coefficient in the machine's time, of the largest in its row: below, none

}  // namespace

Descriptor::Descriptor(const System& system, std::span<const Index> rows)
    : system_(system), rows_(rows.begin(), rows.end()), time_(system.scales.time), blocks_(system) {
  const Index n = system.n(), nz = system.nz(), count = static_cast<Index>(rows_.size()), m = system.m(),
              all = n + count + nz;
  holonomic_ = std::count_if(rows_.begin(), rows_.end(), [&](Index row) { return row < m; });
  states_ = 2 * n - holonomic_ - count + nz;

  const std::vector<Index> x = shifted(n, 0), z = shifted(nz, n + count);
  const std::vector<Index> constraints = selected(m + system.l(), rows_, n);
  const std::vector<Index> c(constraints.begin(), constraints.begin() + m);
  std::vector<Index> b(constraints.size(), -1);  // nonholonomic rows alone
  std::copy(constraints.begin() + m, constraints.end(), b.begin() + m);
  std::vector<Index> zu(static_cast<std::size_t>(nz + system.nu()), -1);  // inputs stand still
  std::copy(z.begin(), z.end(), zu.begin());
  const Term terms[] = {
      {BRAMAH_F_X, x, x, false, 0},          {BRAMAH_L_X, x, x, false, 0},  {BRAMAH_F_V, x, x, false, 1},
      {BRAMAH_F_A, x, x, false, 2},          {BRAMAH_F_Z, x, zu, false, 0}, {BRAMAH_F_U, x, zu, false, 0},
      {BRAMAH_C_X, c, x, false, 0},          {BRAMAH_R_X, b, x, false, 0},  {BRAMAH_R_V, b, x, false, 1},
      {BRAMAH_R_V, constraints, x, true, 0}, {BRAMAH_G_X, z, x, false, 0},  {BRAMAH_G_V, z, x, false, 1},
      {BRAMAH_G_Z, z, zu, false, 0},         {BRAMAH_G_U, z, zu, false, 0}, {BRAMAH_G_ZDOT, z, z, false, 1}};
  plan_ = SparsePlan(system, all, all, terms);
}

namespace {

Request needed_blocks() {
  return Request{}.blocks({BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_L_X, BRAMAH_G_X,
                           BRAMAH_G_V, BRAMAH_G_Z, BRAMAH_G_ZDOT, BRAMAH_G_U, BRAMAH_C_X, BRAMAH_R_X, BRAMAH_R_V});
}

}  // namespace

/// Along the reference motion every coefficient must keep its value; and C_x, which stands for d2/dt2 (C_x x), also its
/// rate: where a machine starts to fall from rest, that alone tells that it does.
void Descriptor::find_changes(const State& state) {
  changing_.clear();
  const auto moves = [](const Vector& rates) {
    return std::any_of(rates.begin(), rates.end(), [](double rate) { return rate != 0.0; });
  };
  bool falls = false;  // accelerations of an equilibrium are rounding
  for (std::size_t i = 0; i < system_.x.size(); ++i)
    falls = falls || std::abs(state.a[i]) * time_ * time_ > moving * system_.x[i].nominal;
  const bool in_motion = moves(state.v) || moves(state.zdot);
  if (!in_motion && !falls) return;
  if (in_motion) find_rates(state);
  if (changing_.empty()) find_second_rates(state);
  if (changing_.empty() && !in_motion) find_rates(state);
}

/// Changes of coefficients along d(x, v, z)/dt = (v, a, zdot).
void Descriptor::find_rates(const State& state) {
  Direction motion(system_);
  motion.state.x = state.v;
  motion.state.v = state.a;
  motion.state.z = state.zdot;
  motion.state.z.resize(state.z.size(), 0.0);
  Blocks blocks(system_);
  try {
    const Outcome outcome = blocks.evaluate_along(system_, state, motion, needed_blocks());
    if (!outcome.ok()) changing_ = outcome.message;
  } catch (const AnalysisError& error) {  // a component without second derivatives
    changing_ = error.what();
  }
  if (!changing_.empty()) return;
  SparsePlan rates = plan_;
  for (std::size_t power = 0; power < 3 && changing_.empty(); ++power) {
    double weights[3] = {};
    weights[power] = 1.0;
    rates.fill(blocks, weights);
    name_change(rates, std::pow(time_, 1.0 - static_cast<double>(power)), " per second");
  }
}

/// d2/dt2 C_x is what the second derivative of the row has for its partials by x.
void Descriptor::find_second_rates(const State& state) {
  if (second_rates_.columns() == 0) {
    const std::span<const Index> holonomic = std::span(rows_).first(static_cast<std::size_t>(holonomic_));
    const std::vector<Index> x = shifted(n(), 0), c = selected(system_.m() + system_.l(), holonomic, n());
    const Term term{BRAMAH_S_X, c, x, false, 0};
    second_rates_ = SparsePlan(system_, size(), size(), {&term, 1});
  }
  if (!blocks_.evaluate(system_, state, Request{}.blocks({BRAMAH_S_X})).ok()) return;
  const double one = 1.0;
  second_rates_.fill(blocks_, {&one, 1});
  name_change(second_rates_, time_ * time_, " per second squared");
}

/// Of the coefficients' rates of change, the first that is not zero in the machine's time; `factor` makes of one with its
/// unknown in nominals what largest_ has.
void Descriptor::name_change(const SparsePlan& rates, double factor, const char* unit) {
  for (Index j = 0; j < rates.columns(); ++j) {
    for (Index e = rates.start()[static_cast<std::size_t>(j)]; e < rates.start()[static_cast<std::size_t>(j) + 1];
         ++e) {
      const Index row = rates.row()[static_cast<std::size_t>(e)];
      const double rate = rates.values()[static_cast<std::size_t>(e)];
      if (std::abs(rate) * factor * nominal_[static_cast<std::size_t>(j)] <=
          moving * largest_[static_cast<std::size_t>(row)])
        continue;
      changing_ =
          "a coefficient of " + row_name(row) + " changes along the reference motion, by " + digits(rate) + unit;
      return;
    }
  }
}

std::string Descriptor::row_name(Index row) const {
  if (row < n()) return "the force balance of " + system_.x[static_cast<std::size_t>(row)].name;
  if (row < n() + row_count())
    return "the constraint " + system_.constraint(rows_[static_cast<std::size_t>(row - n())]).name;
  return "the storage balance of " + system_.z[static_cast<std::size_t>(row - n() - row_count())].name;
}

void Descriptor::evaluate(const State& state) {
  const Outcome outcome = blocks_.evaluate(system_, state, needed_blocks());
  if (!outcome.ok())
    throw AnalysisError("linearize", outcome.message, "a state at which every component can be evaluated",
                        "linearize elsewhere");
  for (std::size_t power = 0; power < 3; ++power) {
    double weights[3] = {};
    weights[power] = 1.0;
    plan_.fill(blocks_, weights);
    coefficient_[power].assign(plan_.values().begin(), plan_.values().end());
  }
  find_nominals();
  find_changes(state);
}

/// Of the unknowns, and of what each row says with these in the machine's time.
void Descriptor::find_nominals() {
  nominal_.assign(static_cast<std::size_t>(size()), 0.0);
  for (std::size_t i = 0; i < system_.x.size(); ++i) nominal_[i] = system_.x[i].nominal;
  for (std::size_t i = 0; i < system_.z.size(); ++i)
    nominal_[static_cast<std::size_t>(n() + row_count()) + i] = system_.z[i].nominal;
  // A multiplier as large as it takes to move a row's largest inertia, damping or stiffness.
  Vector force(static_cast<std::size_t>(n()), 0.0);
  const auto each = [&](auto&& visit) {
    for (Index j = 0; j < size(); ++j) {
      for (Index e = plan_.start()[static_cast<std::size_t>(j)]; e < plan_.start()[static_cast<std::size_t>(j) + 1];
           ++e)
        visit(static_cast<std::size_t>(plan_.row()[static_cast<std::size_t>(e)]), static_cast<std::size_t>(j),
              static_cast<std::size_t>(e));
    }
  };
  const auto entry = [&](std::size_t e) {
    return std::max({std::abs(coefficient_[0][e]), std::abs(coefficient_[1][e]) / time_,
                     std::abs(coefficient_[2][e]) / (time_ * time_)});
  };
  const auto first_row = static_cast<std::size_t>(n()), last_row = first_row + rows_.size();
  each([&](std::size_t row, std::size_t column, std::size_t e) {
    if (row < first_row && (column < first_row || column >= last_row))
      force[row] = std::max(force[row], entry(e) * nominal_[column]);
  });
  Vector coefficient(static_cast<std::size_t>(size()), 0.0);
  each([&](std::size_t row, std::size_t column, std::size_t e) {
    if (row >= first_row || column < first_row || column >= last_row) return;
    const double c = std::abs(coefficient_[0][e]) * nominal_[row];
    nominal_[column] = std::max(nominal_[column], force[row] * nominal_[row] * c);
    coefficient[column] = std::max(coefficient[column], c);
  });
  // Never rounding beside the forces of others: a thin rod has no inertia about its own axis.
  constexpr double least = 1e-6;
  double largest = 0.0;
  for (std::size_t i = first_row; i < last_row; ++i) {
    if (coefficient[i] > 0.0) nominal_[i] /= coefficient[i] * coefficient[i];
    largest = std::max(largest, nominal_[i]);
  }
  for (std::size_t i = first_row; i < last_row; ++i)
    nominal_[i] = largest > 0.0 ? std::max(nominal_[i], least * largest) : 1.0;

  largest_.assign(static_cast<std::size_t>(size()), 0.0);
  each([&](std::size_t row, std::size_t column, std::size_t e) {
    largest_[row] = std::max(largest_[row], entry(e) * nominal_[column]);
  });
}

void Descriptor::require_constant() const {
  if (changing_.empty()) return;
  throw AnalysisError(
      "linearize", changing_,
      "an equilibrium, or a steady motion along which all coefficients are constant, for the sparse form",
      "use the reduced model, which is exact at every state");
}

sparse::CscView Descriptor::coefficient(int power) const { return view(coefficient_[power]); }

void Descriptor::at(double s, std::vector<double>& values) const {
  values.resize(coefficient_[0].size());
  for (std::size_t e = 0; e < values.size(); ++e)
    values[e] = coefficient_[0][e] + s * (coefficient_[1][e] + s * coefficient_[2][e]);
}
void Descriptor::at(std::complex<double> s, std::vector<std::complex<double>>& values) const {
  values.resize(coefficient_[0].size());
  for (std::size_t e = 0; e < values.size(); ++e)
    values[e] = coefficient_[0][e] + s * (coefficient_[1][e] + s * coefficient_[2][e]);
}

std::string Descriptor::unknown_name(Index i) const {
  if (i < n()) return system_.x[static_cast<std::size_t>(i)].name;
  if (i < n() + row_count()) return system_.multiplier_name(rows_[static_cast<std::size_t>(i - n())]);
  return system_.z[static_cast<std::size_t>(i - n() - row_count())].name;
}

FirstOrderForm first_order_form(const Descriptor& descriptor) {
  const Index n = descriptor.n();
  FirstOrderForm matrices;
  for (Index i = 0; i < n; ++i) {  // dx/dt = v
    matrices.E.push_back({i, i, 1.0});
    matrices.A.push_back({i, n + i, 1.0});
  }
  const sparse::CscView P[3] = {descriptor.coefficient(0), descriptor.coefficient(1), descriptor.coefficient(2)};
  for (Index j = 0; j < descriptor.size(); ++j) {
    for (Index e = P[0].start[j]; e < P[0].start[j + 1]; ++e) {
      const Index row = n + P[0].row[e];
      const bool coordinate = j < n;
      const auto add = [&](std::vector<Entry>& to, Index column, double value) {
        if (value != 0.0) to.push_back({row, column, value});
      };
      add(matrices.A, coordinate ? j : n + j, -P[0].value[e]);
      if (coordinate) {
        add(matrices.A, n + j, -P[1].value[e]);
        add(matrices.E, n + j, P[2].value[e]);
      } else {
        add(matrices.E, n + j, P[1].value[e]);
      }
    }
  }
  for (Index i = 0; i < n; ++i) matrices.states.push_back(descriptor.unknown_name(i));
  for (Index i = 0; i < n; ++i) matrices.states.push_back(descriptor.unknown_name(i) + ".rate");
  for (Index i = n; i < descriptor.size(); ++i) matrices.states.push_back(descriptor.unknown_name(i));
  return matrices;
}

}  // namespace bramah
