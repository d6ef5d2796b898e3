#include "solve/rates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "system/analysis_error.hpp"
#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

// Of a row's own size: Newton's method stops there, and what it cannot bring below `refused` is a failure. Between the two
// lies the rounding of large machines.
constexpr double closed = 1e-13;
constexpr double refused = 1e-9;
constexpr double left_open = 1e-4;  // what a step may leave open where nothing can be closed
constexpr int most_corrections = 4;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// out += A in.
void add_product(const SparsePlan& A, std::span<const double> in, std::span<double> out) {
  for (Index j = 0; j < A.columns(); ++j) {
    if (in[at(j)] == 0.0) continue;
    for (Index e = A.start()[at(j)]; e < A.start()[at(j) + 1]; ++e)
      out[at(A.row()[at(e)])] += A.values()[at(e)] * in[at(j)];
  }
}

// Of D M^-1 D^T, row by row: below its root, 1e-5 of what constraints usually are, rows count as dependent.
constexpr double softness = 1e-10;

std::vector<double> softness_of(const System& system, const Partition& partition, const State& state) {
  Blocks blocks(system);
  const Outcome outcome = blocks.evaluate(system, state, Request{}.blocks({BRAMAH_F_A, BRAMAH_R_V}));
  std::vector<double> result(partition.rows.size(), 0.0);
  if (!outcome.ok()) return result;
  const Index n = system.n(), rows = static_cast<Index>(partition.rows.size());
  const std::vector<Index> x = shifted(n, 0), r = selected(system.m() + system.l(), partition.rows);
  const Term mass_terms[] = {{BRAMAH_F_A, x, x, false, 0}}, row_terms[] = {{BRAMAH_R_V, r, x, false, 0}};
  SparsePlan mass(system, n, n, mass_terms), D(system, rows, n, row_terms);
  const double one = 1.0;
  mass.fill(blocks, {&one, 1});
  D.fill(blocks, {&one, 1});
  // Euler parameters share the inertia of their body: along their norm it is zero or rounding, in any orientation.
  std::map<std::pair<Index, std::string_view>, double> inertias;
  const auto inertia_of = [&](Index j) -> double& {
    return inertias[{system.x[at(j)].component, system.x[at(j)].unit}];
  };
  for (Index j = 0; j < n; ++j) {
    double& inertia = inertia_of(j);
    for (Index e = mass.start()[at(j)]; e < mass.start()[at(j) + 1]; ++e)
      inertia = std::max(inertia, std::abs(mass.values()[at(e)]));
  }
  for (Index j = 0; j < n; ++j) {
    const double inertia = inertia_of(j);
    if (inertia == 0.0) continue;  // moved by its constraints alone
    for (Index e = D.start()[at(j)]; e < D.start()[at(j) + 1]; ++e)
      result[at(D.row()[at(e)])] += softness * D.values()[at(e)] * D.values()[at(e)] / inertia;
  }
  return result;
}

}  // namespace

Rates::Rates(const System& system, const State& start)
    : system_(system),
      partition_(choose_partition(system, start)),
      blocks_(system),
      linear_(system),
      kkt_(system, partition_.rows, softness_of(system, partition_, start)),
      n_(system.n()),
      nz_(system.nz()),
      rows_(static_cast<Index>(partition_.rows.size())) {
  const Index constraints = system.m() + system.l();
  const std::vector<Index> x = shifted(n_, 0), v = shifted(n_, n_), z = shifted(nz_, 2 * n_), f = shifted(n_, 0),
                           s = selected(constraints, partition_.rows, n_), g = shifted(nz_, n_ + rows_);
  const Term partials[] = {{BRAMAH_F_X, f, x, false, 0}, {BRAMAH_L_X, f, x, false, 0}, {BRAMAH_F_V, f, v, false, 0},
                           {BRAMAH_F_Z, f, z, false, 0}, {BRAMAH_F_U, f, z, false, 0}, {BRAMAH_S_X, s, x, false, 0},
                           {BRAMAH_S_V, s, v, false, 0}, {BRAMAH_G_X, g, x, false, 0}, {BRAMAH_G_V, g, v, false, 0},
                           {BRAMAH_G_Z, g, z, false, 0}, {BRAMAH_G_U, g, z, false, 0}};
  partials_ = SparsePlan(system, kkt_.size(), 2 * n_ + nz_, partials);
  const std::vector<Index> rate = shifted(nz_, n_);
  const Term leading[] = {
      {BRAMAH_F_A, f, x, false, 0}, {BRAMAH_R_V, s, x, false, 0}, {BRAMAH_G_ZDOT, g, rate, false, 0}};
  leading_ = SparsePlan(system, kkt_.size(), n_ + nz_, leading);

  // I - gamma J after x and a are eliminated: unknowns v, gamma lambda, z, laid out as those of the KKT matrix.
  //   [ M + gamma f_v + gamma^2 f_x   D^T   gamma f_z     ]
  //   [ D + gamma s_v + gamma^2 s_x   0     0             ]
  //   [ gamma g_v + gamma^2 g_x       0     K + gamma g_z ]
  enum : std::size_t { one, gamma, gamma_squared };
  const std::vector<Index> z_newton = shifted(nz_, n_ + rows_);
  const Term newton[] = {{BRAMAH_F_A, f, x, false, one},
                         {BRAMAH_F_V, f, x, false, gamma},
                         {BRAMAH_F_X, f, x, false, gamma_squared},
                         {BRAMAH_L_X, f, x, false, gamma_squared},
                         {BRAMAH_R_V, s, x, true, one},
                         {BRAMAH_F_Z, f, z_newton, false, gamma},
                         {BRAMAH_F_U, f, z_newton, false, gamma},
                         {BRAMAH_R_V, s, x, false, one},
                         {BRAMAH_S_V, s, x, false, gamma},
                         {BRAMAH_S_X, s, x, false, gamma_squared},
                         {BRAMAH_G_V, g, x, false, gamma},
                         {BRAMAH_G_X, g, x, false, gamma_squared},
                         {BRAMAH_G_ZDOT, g, z_newton, false, one},
                         {BRAMAH_G_Z, g, z_newton, false, gamma},
                         {BRAMAH_G_U, g, z_newton, false, gamma}};
  newton_ = SparsePlan(system, kkt_.size(), kkt_.size(), newton);
  rhs_.resize(at(kkt_.size()));
  product_.resize(at(std::max(2 * n_ + nz_, kkt_.size())));
}

void Rates::evaluate(State& state) { kkt_.complete(state, blocks_); }

/// The largest |c| and |r| over the independent rows, each over its size; `row` of [c; b].
double Rates::violation(const State& state, Index& row) {
  const Outcome outcome = blocks_.evaluate(system_, state, Request{}.rows("cr"));
  if (!outcome.ok())
    throw AnalysisError("simulate", outcome.message, "constraints that can be evaluated", "shorten \"max_step\"");
  double largest = 0.0;
  for (Index k = 0; k < rows_; ++k) {
    const Index i = partition_.rows[at(k)];
    const double open = k < partition_.holonomic ? std::abs(blocks_.c[at(i)]) : 0.0;
    const double here =
        std::max(open / system_.constraint(i).nominal, std::abs(blocks_.r[at(i)]) / system_.rate_nominal(i));
    if (here <= largest) continue;
    largest = here;
    row = i;
  }
  return largest;
}

/// Newton's method with the matrix at hand: corrections M dx + D^T mu = 0, D dx = -c, and alike for v. It moves on as
/// long as the violation shrinks; true where it ends small enough.
bool Rates::close(State& state, Index& row) {
  double before = HUGE_VAL;
  for (int k = 0;; ++k) {
    const double now = violation(state, row);
    if (now <= closed) return true;
    if (k == most_corrections || !(now < 0.5 * before)) return now < refused;
    before = now;
    for (const bool velocities : {false, true}) {
      std::fill(rhs_.begin(), rhs_.end(), 0.0);
      const Index count = velocities ? rows_ : partition_.holonomic;
      const Vector& residual = velocities ? blocks_.r : blocks_.c;
      for (Index i = 0; i < count; ++i) rhs_[at(n_ + i)] = -residual[at(partition_.rows[at(i)])];
      kkt_.solve(rhs_);
      Vector& moved = velocities ? state.v : state.x;
      for (std::size_t i = 0; i < at(n_); ++i) moved[i] += rhs_[i];
    }
  }
}

void Rates::project(State& state) {
  if (rows_ == 0) return;
  Index row = 0;
  before_.first = state.x;  // assigned in place: no step allocates
  before_.second = state.v;
  if (close(state, row)) return;
  evaluate(state);
  if (close(state, row)) return;
  // At a singular position the corrections have no bound. The step is then taken as it is, and the next ones, beyond
  // that position, close what it leaves open.
  state.x = before_.first;
  state.v = before_.second;
  if (violation(state, row) < left_open) return;
  throw AnalysisError(
      "simulate",
      "at t = " + digits(state.t, 6) + " s " + system_.constraint(row).name + " cannot be closed by a small correction",
      "a mechanism away from its singular positions",
      "look at that joint just before this time, and lower \"rel_tol\" or set \"max_step\"",
      pointer("/components", system_.component_name(system_.constraint(row).component)));
}

void Rates::linearize(State& state) {
  evaluate(state);
  const Request request =
      Request{}.blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X, BRAMAH_G_V,
                        BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_G_ZDOT, BRAMAH_R_V, BRAMAH_S_X, BRAMAH_S_V});
  const Outcome outcome = linear_.evaluate(system_, state, request);
  if (!outcome.ok())
    throw AnalysisError("simulate", outcome.message, "partial derivatives that are finite", "shorten \"max_step\"");
  const double one = 1.0;
  partials_.fill(linear_, {&one, 1});
  leading_.fill(linear_, {&one, 1});
}

void Rates::apply(std::span<const double> in, std::span<double> out) {
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  add_product(partials_, in, rhs_);
  for (double& value : rhs_) value = -value;
  kkt_.solve(rhs_);
  std::copy_n(in.begin() + n_, n_, out.begin());
  std::copy_n(rhs_.begin(), n_, out.begin() + n_);
  std::copy_n(rhs_.begin() + n_ + rows_, nz_, out.begin() + 2 * n_);
}

/// Of v, gamma lambda and z.
Vector Rates::sizes_of_unknowns() const {
  const Scales& scales = system_.scales;
  Vector sizes;
  for (const Variable& variable : system_.x) sizes.push_back(variable.nominal / scales.time);
  for (const Index row : partition_.rows) sizes.push_back(system_.multiplier_nominal(row) * scales.time);
  for (const Variable& variable : system_.z) sizes.push_back(variable.nominal);
  return sizes;
}

bool Rates::factor(double gamma) {
  gamma_ = gamma;
  const double weights[] = {1.0, gamma, gamma * gamma};
  newton_.fill(linear_, weights);
  const sparse::CscView view{newton_.rows(), newton_.columns(), newton_.start().data(), newton_.row().data(),
                             newton_.values().data()};
  if (!lu_.analyzed()) lu_.analyze(view, sizes_of_unknowns());
  if (lu_.factor(view)) return true;
  const Index i = lu_.singular_column();
  singular_ = i < n_           ? system_.x[at(i)].name
              : i < n_ + rows_ ? system_.multiplier_name(partition_.rows[at(i - n_)])
                               : system_.z[at(i - n_ - rows_)].name;
  return false;
}

void Rates::solve(std::span<double> b) {
  // With b = (bx, bv, bz) and x = bx + gamma v, gamma a = v - bv, gamma zdot = z - bz:
  //   right-hand side  [M bv; D bv; K bz] - gamma [f_x; s_x; g_x] bx
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  for (Index i = 0; i < n_; ++i) product_[at(i)] = -gamma_ * b[at(i)];
  std::fill_n(product_.begin() + n_, n_ + nz_, 0.0);
  add_product(partials_, product_, rhs_);
  add_product(leading_, b.subspan(at(n_)), rhs_);
  lu_.solve(rhs_);
  for (Index i = 0; i < n_; ++i) {
    b[at(i)] += gamma_ * rhs_[at(i)];
    b[at(n_ + i)] = rhs_[at(i)];
  }
  std::copy_n(rhs_.begin() + n_ + rows_, nz_, b.begin() + 2 * n_);
}

}  // namespace bramah
