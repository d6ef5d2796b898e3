#include "linear/linearize.hpp"

#include <Eigen/SparseCore>
#include <cmath>
#include <limits>

#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

using Eigen::MatrixXd;
using Sparse = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::ColMajor, Index>>;

Sparse matrix(const SparsePlan& plan) {
  return {plan.rows(), plan.columns(), plan.nonzeros(), plan.start().data(), plan.row().data(), plan.values().data()};
}
sparse::CscView view(const SparsePlan& plan) {
  return {plan.rows(), plan.columns(), plan.start().data(), plan.row().data(), plan.values().data()};
}
void fill(SparsePlan& plan, const Blocks& blocks) {
  const double one = 1.0;
  plan.fill(blocks, {&one, 1});
}
std::span<double> entries(auto& columns) { return {columns.data(), static_cast<std::size_t>(columns.size())}; }
void factor(sparse::Klu& lu, const SparsePlan& plan, const char* what) {
  if (lu.factor(view(plan))) return;
  throw AnalysisError("linearize", std::string(what) + " is singular at this state", "a partition that holds here",
                      "choose the independent coordinates anew at this state, or prescribe others");
}
std::string per_second(const std::string& unit) { return unit == "1" ? "1/s" : unit + "/s"; }

constexpr double consistency = 1e-6;  // of a row against its largest terms: well above rounding, well below any physics
constexpr double kink_width = 1e-9;   // of a switching function, in its nominal

}  // namespace

Linearizer::Linearizer(const System& system, Partition partition, std::vector<Measured> outputs)
    : system_(system),
      partition_(std::move(partition)),
      outputs_(std::move(outputs)),
      blocks_(system),
      moving_(system),
      kkt_(system, partition_.rows),
      switches_(system) {
  const Index n = system.n(), nz = system.nz(), nu = system.nu(), zu = nz + nu;
  const Index rows = static_cast<Index>(partition_.rows.size()), m = partition_.holonomic;
  const std::span<const Index> all_rows = partition_.rows;
  const std::vector<Index> x = shifted(n, 0), v = shifted(n, n), zu_columns = shifted(zu, 2 * n);
  const auto nominals_of = [&](const std::vector<Index>& coordinates) {
    Vector sizes;
    for (const Index i : coordinates) sizes.push_back(system.x[static_cast<std::size_t>(i)].nominal);
    return sizes;
  };
  // A coordinate's nominal moves a row by about its size, a rate's likewise in the machine's time.
  const auto row_sizes = [&](Index count, bool rates) {
    Vector sizes;
    for (const Index row : all_rows.first(static_cast<std::size_t>(count)))
      sizes.push_back(rates ? system.rate_nominal(row) * system.scales.time : system.constraint(row).nominal);
    return sizes;
  };
  const std::vector<Index> c = selected(system.m(), all_rows.first(static_cast<std::size_t>(m))),
                           r = selected(system.m() + system.l(), all_rows);
  {
    const Term terms[] = {{BRAMAH_C_X, c, x, false, 0}};
    C_x_ = SparsePlan(system, m, n, terms);
  }
  {
    const Term terms[] = {{BRAMAH_R_V, r, x, false, 0}};
    D_ = SparsePlan(system, rows, n, terms);
  }
  {
    const Term terms[] = {{BRAMAH_R_X, r, x, false, 0}};
    D_rate_ = SparsePlan(system, rows, n, terms);
  }
  {
    const std::vector<Index> f = shifted(n, 0), s = selected(system.m() + system.l(), all_rows, n),
                             g = shifted(nz, n + rows);
    const Term terms[] = {
        {BRAMAH_F_X, f, x, false, 0},          {BRAMAH_L_X, f, x, false, 0},          {BRAMAH_F_V, f, v, false, 0},
        {BRAMAH_F_Z, f, zu_columns, false, 0}, {BRAMAH_F_U, f, zu_columns, false, 0}, {BRAMAH_S_X, s, x, false, 0},
        {BRAMAH_S_V, s, v, false, 0},          {BRAMAH_G_X, g, x, false, 0},          {BRAMAH_G_V, g, v, false, 0},
        {BRAMAH_G_Z, g, zu_columns, false, 0}, {BRAMAH_G_U, g, zu_columns, false, 0}};
    loads_ = SparsePlan(system, n + rows + nz, 2 * n + zu, terms);
  }
  {
    const std::vector<Index> d = selected(n, partition_.d);
    const Term terms[] = {{BRAMAH_C_X, c, d, false, 0}};
    C_xd_ = SparsePlan(system, m, m, terms);
    lu_C_xd_.analyze(view(C_xd_), nominals_of(partition_.d), row_sizes(m, false));
  }
  {
    std::vector<Index> dd_list = partition_.d;
    dd_list.insert(dd_list.end(), partition_.ad.begin(), partition_.ad.end());
    const std::vector<Index> dd = selected(n, dd_list);
    const Term terms[] = {{BRAMAH_R_V, r, dd, false, 0}};
    D_dd_ = SparsePlan(system, rows, rows, terms);
    lu_D_dd_.analyze(view(D_dd_), nominals_of(dd_list), row_sizes(rows, true));
  }
  {
    // Component outputs only; variables are picked directly.
    const std::vector<Index> y = shifted(system.ny(), 0), a = shifted(n, 0),
                             lambda = selected(system.m() + system.l(), all_rows, n);
    const Term motion[] = {{BRAMAH_Y_X, y, x, false, 0},
                           {BRAMAH_Y_V, y, v, false, 0},
                           {BRAMAH_Y_Z, y, zu_columns, false, 0},
                           {BRAMAH_Y_U, y, zu_columns, false, 0}};
    y_motion_ = SparsePlan(system, system.ny(), 2 * n + zu, motion);
    const Term response[] = {{BRAMAH_Y_A, y, a, false, 0}, {BRAMAH_Y_LAMBDA, y, lambda, false, 0}};
    y_response_ = SparsePlan(system, system.ny(), n + rows + nz, response);
  }

  const auto add = [&](std::vector<NamedQuantity>& list, const Variable& q, const char* kind) {
    const bool rate = kind[0] == 'v';
    list.push_back({q.name + (rate ? ".rate" : ""), rate ? per_second(q.unit) : q.unit,
                    rate ? q.nominal / system.scales.time : q.nominal, kind});
  };
  for (const Index i : partition_.ai) add(reduced_states_, system.x[static_cast<std::size_t>(i)], "x_ai");
  for (const Index i : partition_.ai) add(reduced_states_, system.x[static_cast<std::size_t>(i)], "v_ai");
  for (const Index i : partition_.ad) add(reduced_states_, system.x[static_cast<std::size_t>(i)], "x_ad");
  for (const Variable& q : system.x) add(augmented_states_, q, "x");
  for (const Variable& q : system.x) add(augmented_states_, q, "v");
  for (const Variable& q : system.z) {
    reduced_states_.push_back({q.name, q.unit, q.nominal, q.kind});
    augmented_states_.push_back({q.name, q.unit, q.nominal, q.kind});
  }
  for (const InputSignal& input : system.inputs)
    input_names_.push_back({input.name, input.unit, system.scales.of(input.unit)});
  for (const Measured& y : outputs_) output_names_.push_back({y.name, y.unit});

  for (const Index i : partition_.ai) reduced_rows_.push_back({&Linearizer::moves_, n + i});
  for (const Index i : partition_.ai) reduced_rows_.push_back({&Linearizer::follows_, i});
  for (const Index i : partition_.ad) reduced_rows_.push_back({&Linearizer::moves_, n + i});
  for (Index i = 0; i < n; ++i) augmented_rows_.push_back({&Linearizer::moves_, n + i});
  for (Index i = 0; i < n; ++i) augmented_rows_.push_back({&Linearizer::follows_, i});
  for (Index i = 0; i < nz; ++i) {
    reduced_rows_.push_back({&Linearizer::follows_, n + rows + i});
    augmented_rows_.push_back({&Linearizer::follows_, n + rows + i});
  }
}

namespace {

Request model_blocks() {
  return Request{}.blocks({BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X, BRAMAH_G_V,
                           BRAMAH_G_Z, BRAMAH_G_ZDOT, BRAMAH_G_U, BRAMAH_C_X, BRAMAH_R_X, BRAMAH_R_V, BRAMAH_S_X,
                           BRAMAH_S_V, BRAMAH_L_X});
}

[[noreturn]] void cannot_evaluate(const Outcome& outcome) {
  throw AnalysisError("linearize", outcome.message, "a state at which every component can be evaluated",
                      "linearize elsewhere");
}

}  // namespace

void Linearizer::evaluate(const State& state) {
  Request request = model_blocks().rows("fgcrs");
  if (!outputs_.empty()) request.blocks({BRAMAH_Y_X, BRAMAH_Y_V, BRAMAH_Y_A, BRAMAH_Y_Z, BRAMAH_Y_U, BRAMAH_Y_LAMBDA});
  const Outcome outcome = blocks_.evaluate(system_, state, request);
  if (!outcome.ok()) cannot_evaluate(outcome);
  if (const Outcome partials = blocks_.check_partials(system_); !partials.ok()) cannot_evaluate(partials);
  fill(loads_, blocks_);
  check_consistent();
  kkt_.factor(blocks_);
}

void Linearizer::evaluate_along(const State& state, const Direction& along, const Request& request) {
  const Outcome outcome = moving_.evaluate_along(system_, state, along, request);
  if (!outcome.ok()) cannot_evaluate(outcome);
}

/// Eqs. (16)-(20) and the acceleration rows: each row against the size of the terms that it balances.
void Linearizer::check_consistent() const {
  const auto n = static_cast<std::size_t>(system_.n());
  double worst = consistency;
  std::string name, remedy;
  double found = 0.0;
  const auto look = [&](double residual, double scale, const char* what, const auto& whose, const char* mend) {
    if (!(std::abs(residual) > worst * scale)) return;
    worst = std::abs(residual) / scale;
    found = residual;
    name = what + whose.name;
    remedy = mend;
  };
  const Scales& scales = system_.scales;
  // What a change of one nominal in any variable does to a row is the size of its terms.
  Vector scale(static_cast<std::size_t>(loads_.rows()), 0.0);
  for (Index j = 0; j < loads_.columns(); ++j) {
    const auto column = static_cast<std::size_t>(j);
    const std::size_t z = 2 * n, u = z + system_.z.size();
    const double nominal = column < n   ? system_.x[column].nominal
                           : column < z ? system_.x[column - n].nominal / scales.time
                           : column < u ? system_.z[column - z].nominal
                                        : input_names_[column - u].nominal;
    for (Index e = loads_.start()[column]; e < loads_.start()[column + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      double& row = scale[static_cast<std::size_t>(loads_.row()[entry])];
      row = std::max(row, std::abs(loads_.values()[entry]) * nominal);
    }
  }
  constexpr double nothing = 1e-300;
  const std::size_t rows = partition_.rows.size();
  for (std::size_t i = 0; i < n; ++i)
    look(blocks_.f[i], std::max(scale[i], scales.energy() / system_.x[i].nominal), "Eq. (16), the force balance of ",
         system_.x[i], "complete the accelerations and multipliers first, or find the equilibrium");
  for (std::size_t i = 0; i < system_.z.size(); ++i)
    look(blocks_.g[i], scale[n + rows + i] + nothing, "Eq. (19), the storage balance of ", system_.z[i],
         "complete the rates of first-order variables first");
  for (std::size_t i = 0; i < system_.holonomic.size(); ++i)
    look(blocks_.c[i], system_.holonomic[i].nominal, "Eq. (17), the constraint ", system_.holonomic[i],
         "assemble the positions first");
  for (std::size_t i = 0; i < rows; ++i) {
    const Index row = partition_.rows[i];
    const double rate = system_.rate_nominal(row);
    look(blocks_.r[static_cast<std::size_t>(row)], rate, "Eq. (18), the rate of constraint ", system_.constraint(row),
         "assemble the velocities first");
    look(blocks_.s[static_cast<std::size_t>(row)], std::max(rate / scales.time, scale[n + i]),
         "the acceleration of constraint ", system_.constraint(row), "complete the accelerations first");
  }
  if (name.empty()) return;
  throw AnalysisError("linearize", name + " is violated by " + digits(found),
                      "a state that satisfies Eqs. (16)-(20) to " + digits(consistency) + " of their terms", remedy);
}

Index Linearizer::columns() const {
  const Index coordinates =
      reduced_ ? 2 * static_cast<Index>(partition_.ai.size()) + static_cast<Index>(partition_.ad.size())
               : 2 * system_.n();
  return coordinates + system_.nz() + system_.nu();
}

/// Motion: what the states and inputs `first`, first + 1, ... move; columns beyond the last are zero.
void Linearizer::move(Index first) {
  const Index n = system_.n(), all = columns(), coordinates = all - system_.nz() - system_.nu();
  moves_.setZero(2 * n + system_.nz() + system_.nu(), block);
  for (Index j = std::max(first, coordinates); j < std::min(first + block, all); ++j)
    moves_(2 * n + j - coordinates, j - first) = 1.0;
  if (first >= coordinates) return;
  if (reduced_) return move_coordinates(first);
  for (Index j = first; j < std::min(first + block, coordinates); ++j) moves_(j, j - first) = 1.0;
}

/// Steps 2 and 4: positions and velocities that move with x_ai, v_ai and x_ad.
void Linearizer::move_coordinates(Index first) {
  const Index n = system_.n();
  const auto k = static_cast<Index>(partition_.ai.size()), l = static_cast<Index>(partition_.ad.size()),
             m = static_cast<Index>(partition_.d.size());
  const Index count = std::min(block, 2 * k + l - first);
  const auto ai = [&](Index i) { return partition_.ai[static_cast<std::size_t>(i)]; };
  const auto ad = [&](Index i) { return partition_.ad[static_cast<std::size_t>(i)]; };
  const auto d = [&](Index i) { return partition_.d[static_cast<std::size_t>(i)]; };
  auto x = moves_.topRows(n), v = moves_.middleRows(n, n);

  // Step 4, Eqs. (41)-(44): x = Vh_ai x_ai + Vh_ad x_ad.
  for (Index c = 0; c < count; ++c) {
    const Index j = first + c;
    if (j < k) x(ai(j), c) = 1.0;
    if (j >= k && j < 2 * k) v(ai(j - k), c) = 1.0;
    if (j >= 2 * k) x(ad(j - 2 * k), c) = 1.0;
  }
  const bool velocities_only = first >= k && first + count <= 2 * k;
  if (m > 0 && !velocities_only) {
    dependent_.setZero(m, block);
    dependent_.noalias() -= matrix(C_x_) * x;
    lu_C_xd_.solve_block(entries(dependent_));
    for (Index i = 0; i < m; ++i) x.row(d(i)).head(count) = dependent_.row(i).head(count);
  }
  // Step 2, Eqs. (33)-(35): v = T v_ai + V_rate x. Its x_ad rows are Eq. (51), the result of Steps 5 and 6.
  if (m + l == 0) return;
  dependent_.setZero(m + l, block);
  dependent_.noalias() -= matrix(D_) * v;
  if (!velocities_only) dependent_.noalias() -= matrix(D_rate_) * x;
  lu_D_dd_.solve_block(entries(dependent_));
  for (Index i = 0; i < m; ++i) v.row(d(i)).head(count) = dependent_.row(i).head(count);
  for (Index i = 0; i < l; ++i) v.row(ad(i)).head(count) = dependent_.row(m + i).head(count);
}

/// Accelerations, multipliers and rates that follow, by Eqs. (23), (26), (28), (37) solved together. Eliminating the
/// multipliers with T^T as in Steps 1, 3 and 7 gives the same accelerations; here they stay, for outputs.
void Linearizer::respond() {
  follows_.setZero(kkt_.size(), block);
  follows_.noalias() -= matrix(loads_) * moves_;
  kkt_.solve_block(entries(follows_));
}

void Linearizer::linearize(const State& state, LinearModel& model) {
  evaluate(state);
  fill(C_x_, blocks_);
  fill(D_, blocks_);
  fill(D_rate_, blocks_);
  fill(C_xd_, blocks_);
  fill(D_dd_, blocks_);
  factor(lu_C_xd_, C_xd_, "the matrix C_xd of Eq. (42)");
  factor(lu_D_dd_, D_dd_, "the matrix D_dd of Eq. (31)");
  reduced_ = true;
  model.states = reduced_states_;
  fill_model(reduced_rows_, model);  // Steps 1, 3 and 7, Eqs. (32), (37), (53)-(61)
  model.kinks = kinks_at(state);
}

void Linearizer::fill_columns() {
  if (motion_.cols() > 0) return;
  const Index all = columns();
  motion_.resize(2 * system_.n() + system_.nz() + system_.nu(), all);
  response_.resize(kkt_.size(), all);
  for (Index first = 0; first < all; first += block) {
    const Index count = std::min(block, all - first);
    move(first);
    respond();
    motion_.middleCols(first, count) = moves_.leftCols(count);
    response_.middleCols(first, count) = follows_.leftCols(count);
  }
}
const MatrixXd& Linearizer::motion() {
  fill_columns();
  return motion_;
}
const MatrixXd& Linearizer::response() {
  fill_columns();
  return response_;
}

/// The terms of which the rows of A are sums, without their signs, go the way of the sums. Of the signs that rounding may
/// have, a few stand for all.
void Linearizer::estimate_rounding(LinearModel& model) {
  using Eigen::VectorXd;
  const Index states = model.A.rows();
  const Index n = system_.n(), rows = static_cast<Index>(partition_.rows.size());
  const auto k = static_cast<Index>(partition_.ai.size()), m = static_cast<Index>(partition_.d.size()),
             l = static_cast<Index>(partition_.ad.size());
  /// What comes out of `solve` where terms of these sizes go in.
  const auto solved = [](const VectorXd& sizes, const auto& solve) {
    constexpr Index patterns = 4;
    VectorXd largest = VectorXd::Zero(sizes.size()), x;
    for (Index pattern = 1; pattern <= patterns && sizes.size() > 0; ++pattern) {
      x = sizes;
      for (Index i = 0; i < x.size(); ++i) x(i) *= (i / pattern) % 2 == 0 ? 1.0 : -1.0;
      solve(std::span<double>(x.data(), static_cast<std::size_t>(x.size())));
      largest = largest.cwiseMax(x.cwiseAbs());
    }
    return largest;
  };
  VectorXd nominal(states);
  for (Index j = 0; j < states; ++j) nominal(j) = reduced_states_[static_cast<std::size_t>(j)].nominal;
  VectorXd moved = VectorXd::Zero(2 * n + system_.nz() + system_.nu());
  for (Index first = 0; first < states; first += block) {
    const Index count = std::min(block, states - first);
    move(first);
    moved = moved.cwiseMax(
        (moves_.leftCols(count).cwiseAbs() * nominal.segment(first, count).asDiagonal()).rowwise().maxCoeff());
  }
  // Dependent coordinates and rates, as large as the terms that they are solved from would let them be.
  const auto raise = [&](const std::vector<Index>& coordinates, Index offset, const auto& sizes) {
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      moved(offset + coordinates[i]) = std::max(moved(offset + coordinates[i]), sizes(static_cast<Index>(i)));
  };
  raise(partition_.d, 0, solved(matrix(C_x_).cwiseAbs() * moved.head(n), [&](auto x) { lu_C_xd_.solve(x, 1); }));
  const VectorXd rates = matrix(D_).cwiseAbs() * moved.segment(n, n) + matrix(D_rate_).cwiseAbs() * moved.head(n);
  const VectorXd drift = solved(rates, [&](auto x) { lu_D_dd_.solve(x, 1); });
  raise(partition_.d, n, drift.head(m));
  raise(partition_.ad, n, drift.tail(rows - m));
  const VectorXd response = solved(matrix(loads_).cwiseAbs() * moved, [&](auto x) { kkt_.solve(x); });

  VectorXd rounding = VectorXd::Zero(states);
  for (Index i = 0; i < k; ++i) rounding(k + i) = response(partition_.ai[static_cast<std::size_t>(i)]);
  rounding.segment(2 * k, l) = drift.tail(l);
  rounding.tail(system_.nz()) = response.tail(system_.nz());
  model.rounding = std::numeric_limits<double>::epsilon() * rounding.cwiseQuotient(nominal);
}

void Linearizer::linearize_augmented(const State& state, LinearModel& model) {
  evaluate(state);
  reduced_ = false;
  model.states = augmented_states_;
  fill_model(augmented_rows_, model);
  model.kinks = kinks_at(state);
}

/// A, B, C and D, some columns at a time: what a block of columns moves and what follows is read while it is in the cache.
void Linearizer::fill_model(const std::vector<Row>& states, LinearModel& model) {
  motion_.resize(0, 0);
  response_.resize(0, 0);
  const auto count = static_cast<Index>(states.size()), measured = static_cast<Index>(outputs_.size());
  model.A.resize(count, count);
  model.B.resize(count, system_.nu());
  model.C.resize(measured, count);
  model.D.resize(measured, system_.nu());
  model.inputs = input_names_;
  model.outputs = output_names_;
  model.rounding.resize(0);
  std::vector<Row> outputs;
  for (const Measured& y : outputs_) outputs.push_back(output_row(y));
  const bool any_of_components =
      std::any_of(outputs_.begin(), outputs_.end(), [](const Measured& y) { return y.kind == Measured::Kind::y; });
  if (any_of_components) {
    fill(y_motion_, blocks_);
    fill(y_response_, blocks_);
  }

  const auto show = [&](const std::vector<Row>& rows, Index first, MatrixXd& by_states, MatrixXd& by_inputs) {
    for (Index j = first; j < std::min(first + block, columns()); ++j) {
      auto column = j < count ? by_states.col(j) : by_inputs.col(j - count);
      for (std::size_t i = 0; i < rows.size(); ++i)
        column(static_cast<Index>(i)) = (this->*rows[i].of)(rows[i].index, j - first);
    }
  };
  for (Index first = 0; first < columns(); first += block) {
    move(first);
    respond();
    if (any_of_components) {
      of_components_.noalias() = matrix(y_motion_) * moves_;
      of_components_.noalias() += matrix(y_response_) * follows_;
    }
    show(states, first, model.A, model.B);
    show(outputs, first, model.C, model.D);
  }
}

/// Where an output is read from.
Linearizer::Row Linearizer::output_row(const Measured& y) const {
  const Index n = system_.n(), nz = system_.nz(), rows = static_cast<Index>(partition_.rows.size());
  switch (y.kind) {
    case Measured::Kind::x: return {&Linearizer::moves_, y.index};
    case Measured::Kind::v: return {&Linearizer::moves_, n + y.index};
    case Measured::Kind::a: return {&Linearizer::follows_, y.index};
    case Measured::Kind::z: return {&Linearizer::moves_, 2 * n + y.index};
    case Measured::Kind::zdot: return {&Linearizer::follows_, n + rows + y.index};
    case Measured::Kind::input: return {&Linearizer::moves_, 2 * n + nz + y.index};
    case Measured::Kind::y: return {&Linearizer::of_components_, y.index};
    case Measured::Kind::energy:
    case Measured::Kind::power:
      throw AnalysisError(
          "linearize", "the output " + y.name + " has no row in C", "variables, multipliers and outputs of components",
          "take it out of the scene's outputs, or choose others with --output; `simulate` and `vary` have it",
          "/outputs");
    case Measured::Kind::lambda: break;
  }
  const auto undetermined = [&](const RedundantRow& redundant) {
    const auto& others = redundant.follows_from;
    return redundant.row == y.index ||
           std::any_of(others.begin(), others.end(), [&](const auto& other) { return other.first == y.index; });
  };
  if (std::any_of(partition_.redundant.begin(), partition_.redundant.end(), undetermined)) {
    throw AnalysisError("linearize", "the multiplier " + y.name + " belongs to a redundant set and is not determined",
                        "outputs that the model determines",
                        "take it out of the scene's outputs, or remove the redundant joint");
  }
  const auto at = std::find(partition_.rows.begin(), partition_.rows.end(), y.index);
  return {&Linearizer::follows_, n + (at - partition_.rows.begin())};
}

std::vector<KinkTaken> Linearizer::kinks_at(const State& state) {
  std::vector<KinkTaken> kinks;
  const Vector& values = switches_.evaluate(state);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Switches::Info& info = switches_.info()[k];
    if (std::isnan(values[k]) || std::abs(values[k]) > kink_width * info.nominal) continue;
    kinks.push_back({system_.component_name(info.component), info.name, state.side});
  }
  return kinks;
}

Conditions Linearizer::conditions() const {
  const auto of = [](const sparse::Klu& lu, const SparsePlan& plan) {
    return plan.rows() == 0 ? 1.0 : lu.condition(view(plan));
  };
  return {of(lu_C_xd_, C_xd_), of(lu_D_dd_, D_dd_)};
}

LinearizerAlong::LinearizerAlong(const System& system, Prescribed prescribed, std::vector<Measured> outputs)
    : system_(system), prescribed_(std::move(prescribed)), outputs_(std::move(outputs)) {}

void LinearizerAlong::linearize(const State& state, LinearModel& model) {
  if (linearizer_ == nullptr) return choose(state, model);
  try {
    linearizer_->linearize(state, model);
  } catch (const AnalysisError&) {  // whether the partition is to blame or the state, a new one shows
    return choose(state, model);
  }
  conditions_ = linearizer_->conditions();
  if (conditions_.worst() > std::max(worst_condition, 10.0 * when_chosen_)) return choose(state, model);
  linearizer_->estimate_rounding(model);
}

void LinearizerAlong::choose(const State& state, LinearModel& model) {
  linearizer_ = std::make_unique<Linearizer>(system_, choose_partition(system_, state, prescribed_), outputs_);
  linearizer_->linearize(state, model);
  linearizer_->estimate_rounding(model);
  conditions_ = linearizer_->conditions();
  when_chosen_ = conditions_.worst();
  ++choices_;
}

void Linearizer::complete(const State& state, Direction& along) {
  const auto n = static_cast<std::size_t>(system_.n()), nz = static_cast<std::size_t>(system_.nz());
  const std::size_t rows = partition_.rows.size(), m = partition_.d.size();
  State& moves = along.state;
  const auto coordinate = [&](std::size_t i) {  // in the order of D_dd's columns: x_d, then x_ad
    return static_cast<std::size_t>(i < m ? partition_.d[i] : partition_.ad[i - m]);
  };
  // C_xd dx_d = -(dc with dx_d = 0), and so on level by level.
  Vector right(rows);
  for (std::size_t i = 0; i < m; ++i) moves.x[coordinate(i)] = 0.0;
  evaluate_along(state, along, Request{}.rows("c"));
  for (std::size_t i = 0; i < m; ++i) right[i] = -moving_.c[static_cast<std::size_t>(partition_.rows[i])];
  lu_C_xd_.solve({right.data(), m});
  for (std::size_t i = 0; i < m; ++i) moves.x[coordinate(i)] = right[i];

  for (std::size_t i = 0; i < rows; ++i) moves.v[coordinate(i)] = 0.0;
  evaluate_along(state, along, Request{}.rows("r"));
  for (std::size_t i = 0; i < rows; ++i) right[i] = -moving_.r[static_cast<std::size_t>(partition_.rows[i])];
  lu_D_dd_.solve(right);
  for (std::size_t i = 0; i < rows; ++i) moves.v[coordinate(i)] = right[i];

  std::fill_n(moves.a.begin(), n, 0.0);
  std::fill_n(moves.zdot.begin(), nz, 0.0);
  std::fill(moves.lambda.begin(), moves.lambda.end(), 0.0);
  evaluate_along(state, along, Request{}.rows("fgs"));
  Vector follows(n + rows + nz);
  for (std::size_t i = 0; i < n; ++i) follows[i] = -moving_.f[i];
  for (std::size_t i = 0; i < rows; ++i) follows[n + i] = -moving_.s[static_cast<std::size_t>(partition_.rows[i])];
  for (std::size_t i = 0; i < nz; ++i) follows[n + rows + i] = -moving_.g[i];
  kkt_.solve(follows);
  std::copy_n(follows.begin(), n, moves.a.begin());
  for (std::size_t i = 0; i < rows; ++i) moves.lambda[static_cast<std::size_t>(partition_.rows[i])] = follows[n + i];
  std::copy_n(follows.begin() + static_cast<std::ptrdiff_t>(n + rows), nz, moves.zdot.begin());
}

/// Every step of `linearize`, differentiated by the product rule; what x_ai, v_ai, x_ad, z and u move stays 1.
MatrixXd Linearizer::derivative(const State& state, const Direction& along) {
  fill_columns();
  evaluate_along(state, along, model_blocks());
  const auto moved = [&](const SparsePlan& of) {
    SparsePlan plan = of;
    fill(plan, moving_);
    return plan;
  };
  const SparsePlan dC_x = moved(C_x_), dD = moved(D_), dD_rate = moved(D_rate_), dloads = moved(loads_),
                   dkkt = moved(kkt_.matrix());
  const Index n = system_.n(), nz = system_.nz();
  const auto k = static_cast<Index>(partition_.ai.size()), l = static_cast<Index>(partition_.ad.size()),
             m = static_cast<Index>(partition_.d.size());
  const Index states = 2 * k + l + nz, moving_columns = 2 * k + l;
  const auto place = [](const std::vector<Index>& list, Index i) { return list[static_cast<std::size_t>(i)]; };

  MatrixXd dmotion = MatrixXd::Zero(motion_.rows(), states);
  auto dx = dmotion.topRows(n), dv = dmotion.middleRows(n, n);
  const auto x = motion_.topRows(n).leftCols(moving_columns), v = motion_.middleRows(n, n).leftCols(moving_columns);
  if (m > 0) {  // C_xd dx_d = -dC_x x
    work_.noalias() = -(matrix(dC_x) * x);
    lu_C_xd_.solve({work_.data(), static_cast<std::size_t>(work_.size())}, work_.cols());
    for (Index i = 0; i < m; ++i) dx.row(place(partition_.d, i)).head(moving_columns) = work_.row(i);
  }
  if (m + l > 0) {  // D_dd dv_(d, ad) = -(dD v + dD_rate x + D_rate dx)
    work_.noalias() = -(matrix(dD) * v);
    work_.noalias() -= matrix(dD_rate) * x;
    work_.noalias() -= matrix(D_rate_) * dx.leftCols(moving_columns);
    lu_D_dd_.solve({work_.data(), static_cast<std::size_t>(work_.size())}, work_.cols());
    for (Index i = 0; i < m; ++i) dv.row(place(partition_.d, i)).head(moving_columns) = work_.row(i);
    for (Index i = 0; i < l; ++i) dv.row(place(partition_.ad, i)).head(moving_columns) = work_.row(m + i);
  }
  // KKT dresponse = -(dloads motion + loads dmotion + dKKT response)
  MatrixXd dresponse = -(matrix(dloads) * motion_.leftCols(states));
  dresponse.noalias() -= matrix(loads_) * dmotion;
  dresponse.noalias() -= matrix(dkkt) * response_.leftCols(states);
  kkt_.solve({dresponse.data(), static_cast<std::size_t>(dresponse.size())}, dresponse.cols());

  MatrixXd dA = MatrixXd::Zero(states, states);
  for (Index i = 0; i < k; ++i) dA.row(k + i) = dresponse.row(place(partition_.ai, i));
  for (Index i = 0; i < l; ++i) dA.row(2 * k + i) = dv.row(place(partition_.ad, i));
  dA.bottomRows(nz) = dresponse.bottomRows(nz);
  return dA;
}

MatrixXd Linearizer::transformation() {
  const Index n = system_.n(), k = static_cast<Index>(partition_.ai.size());
  return motion().middleRows(n, n).middleCols(k, k);
}

}  // namespace bramah
