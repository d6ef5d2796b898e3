// Generalized-alpha with a fixed step h on the stabilized index-2 form: all balances and both levels of constraints hold
// at t_{n+1},
//
//   f(t, x, v, a, z, lambda, u) = 0      g(t, x, v, z, zdot, u) = 0      r(t, x, v) = 0      c(t, x) = 0
//
// the step itself goes with auxiliary accelerations alpha and auxiliary rates w, which lag behind a and zdot,
//
//   x_{n+1} = x_n + h v_n + h^2 ((1/2 - beta) alpha_n + beta alpha_{n+1}) - W C_x^T mu
//   v_{n+1} = v_n + h ((1 - gamma) alpha_n + gamma alpha_{n+1})
//   (1 - alpha_m) alpha_{n+1} + alpha_m alpha_n = (1 - alpha_f) a_{n+1} + alpha_f a_n
//
//   z_{n+1} = z_n + h ((1 - gamma) w_n + gamma w_{n+1})
//   (1 - alpha_m) w_{n+1} + alpha_m w_n = (1 - alpha_f) zdot_{n+1} + alpha_f zdot_n
//
// W: squares of the nominals of x. Numbers alpha_m, alpha_f, gamma of their own for x and for z, all from one rho_infinity:
// Chung and Hulbert (1993); Jansen, Whiting and Hulbert (2000); constraints as Arnold and Bruels (2007).
#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include "solve/integrator.hpp"
#include "solve/partition.hpp"
#include "sparse/klu.hpp"
#include "system/analysis_error.hpp"
#include "system/blocks.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

// Of a correction, relative to the variable or its nominal. Below `rounding`, Newton's method with a fresh matrix may
// come to rest without getting smaller: what is left is rounding.
constexpr double newton_tolerance = 1e-13, rounding = 1e-8;
constexpr double grain = 2.2e-16;        // of a number
constexpr double coarsest_grain = 1e-4;  // of a correction: what rounding may leave undecided
constexpr int most_iterations = 20;
// A fresh matrix costs about as much as so many iterations with the old one.
constexpr double worth_a_matrix = 8.0;
constexpr double tiny_remainder = 1e-9;  // of a step; what is left before the end of a segment joins the step before

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
double square(double value) { return value * value; }

/// The numbers of one family of variables, for weights of t_{n+1} that are 1 - alpha as in the equations above.
struct Weights {
  double alpha_m, alpha_f, gamma, beta;

  /// x: Chung and Hulbert (1993), Eqs. (17), (20), (25).
  static Weights second_order(double rho) {
    const double m = (2.0 * rho - 1.0) / (rho + 1.0), f = rho / (rho + 1.0), g = 0.5 - m + f;
    return {m, f, g, 0.25 * (0.5 + g) * (0.5 + g)};
  }
  /// z: Jansen, Whiting and Hulbert (2000), whose alpha are 1 - alpha here.
  static Weights first_order(double rho) {
    const double m = (3.0 * rho - 1.0) / (2.0 * (rho + 1.0)), f = rho / (rho + 1.0);
    return {m, f, 0.5 - m + f, 0.0};
  }
  /// alpha_{n+1} from a_{n+1}.
  [[nodiscard]] double lagging(double before, double rate_before, double rate) const {
    return ((1.0 - alpha_f) * rate + alpha_f * rate_before - alpha_m * before) / (1.0 - alpha_m);
  }
  /// a_{n+1} with which the velocity stays what it was; `still` is then alpha_{n+1}.
  [[nodiscard]] double rate_at_rest(double before, double rate_before, double& still) const {
    still = -(1.0 - gamma) / gamma * before;
    return ((1.0 - alpha_m) * still + alpha_m * before - alpha_f * rate_before) / (1.0 - alpha_f);
  }
  /// d rate_{n+1} / d variable_{n+1}, in 1/s.
  [[nodiscard]] double rate_by_variable(double h) const { return (1.0 - alpha_m) / (1.0 - alpha_f) / (gamma * h); }
};

class GeneralizedAlpha final : public Integrator {
 public:
  GeneralizedAlpha(const System& system, const SimulateOptions& options, const State& start);

  [[nodiscard]] std::string_view name() const override { return "generalized_alpha"; }
  void begin(const State& state, double end) override;
  double step() override;
  void interpolate(double t, State& state) override;
  [[nodiscard]] Index limiting() override { return -1; }
  [[nodiscard]] IntegratorWork work() const override { return work_; }
  [[nodiscard]] Vector memory() const override;
  void recall(std::span<const double> memory) override;

 private:
  /// Where the iteration matrix was taken.
  struct Place {
    State state;
    double h = 0.0;
  };

  void lay_out();
  void make_plans();
  enum class Guess { rates, velocities };
  void predict(Guess guess);
  [[nodiscard]] bool solve();
  [[nodiscard]] bool evaluate_rows();
  [[nodiscard]] double correct(double part);
  [[nodiscard]] double rounding_of_constraints();
  [[nodiscard]] bool form_matrix(const State& state, double h);
  [[nodiscard]] bool refresh_matrix() { return form_matrix(next_, h_); }
  [[noreturn]] void fail(const std::string& why, Index limiting = -1) const;
  [[nodiscard]] std::string unknown_name(Index i) const;
  /// Every number of the memory in turn.
  template <class Self, class Visit>
  static void visit_memory(Self& self, Visit&& visit);

  const System& system_;
  double step_;
  Weights second_, first_;
  std::vector<Index> rows_;  // independent rows of [c; b], holonomic ones first
  Index holonomic_ = 0, n_, nz_, size_ = 0;
  Blocks blocks_;
  SparsePlan matrix_, C_transposed_;
  Vector column_scale_, values_, scale_;
  sparse::Klu lu_;
  Place matrix_at_, pivots_at_;
  bool fresh_pivots_ = false;  // the matrix is the one that its pivots were chosen for

  double origin_ = 0.0, end_ = 0.0, h_ = 0.0;
  long count_ = 0;                               // steps since the origin
  State last_, next_;                            // t_n, t_{n+1}
  Vector alpha_, next_alpha_, w_, next_w_, mu_;  // (n), (n), (nz), (nz), (holonomic)
  Vector x_explicit_, weight_, rhs_;             // (n), (2n + nz), (size)
  Vector since_fresh_, noise_;                   // (size) corrections since the first fresh matrix of a step; workspace
  Index worst_ = 0;                              // unknown of the largest correction
  std::string trouble_;
  IntegratorWork work_;
  const Request row_request_ = Request{}.rows("fgcr").blocks({BRAMAH_R_V});
  const Request matrix_request_ =
      Request{}.blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X, BRAMAH_G_V,
                        BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_G_ZDOT, BRAMAH_R_X, BRAMAH_R_V, BRAMAH_C_X});
};

GeneralizedAlpha::GeneralizedAlpha(const System& system, const SimulateOptions& options, const State& start)
    : system_(system),
      step_(options.step),
      second_(Weights::second_order(options.rho_infinity)),
      first_(Weights::first_order(options.rho_infinity)),
      n_(system.n()),
      nz_(system.nz()),
      blocks_(system),
      matrix_at_{start, 0.0},
      pivots_at_{start, 0.0},
      last_(start),
      next_(start) {
  if (!(step_ > 0.0) || !(options.rho_infinity >= 0.0 && options.rho_infinity <= 1.0))
    throw AnalysisError(
        "simulate",
        "generalized_alpha with a step of " + digits(step_) + " s and rho_infinity = " + digits(options.rho_infinity),
        "a step above zero and a radius of 0 ... 1", "set \"step\" and \"rho_infinity\"", "/simulate");
  Partition partition = choose_partition(system, start);
  rows_ = std::move(partition.rows);
  holonomic_ = partition.holonomic;
  lay_out();
}

/// Everything that depends on which rows are independent.
void GeneralizedAlpha::lay_out() {
  make_plans();
  alpha_.resize(at(n_));
  next_alpha_.resize(at(n_));
  x_explicit_.resize(at(n_));
  w_.resize(at(nz_));
  next_w_.resize(at(nz_));
  mu_.resize(at(holonomic_));
  weight_.resize(at(2 * n_ + nz_));
  rhs_.resize(at(size_));
  since_fresh_.resize(at(size_));
  noise_.resize(at(size_));
  // Unknowns over their nominals; a multiplier over the force that changes the machine's own speed by itself in a step.
  scale_.assign(at(size_), 1.0);
  const double time = system_.scales.time, steps = time * second_.rate_by_variable(step_);
  for (Index i = 0; i < n_; ++i) {
    scale_[at(i)] = system_.x[at(i)].nominal;
    scale_[at(n_ + i)] = system_.x[at(i)].nominal / time;
  }
  for (Index i = 0; i < nz_; ++i) scale_[at(2 * n_ + i)] = system_.z[at(i)].nominal;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    scale_[at(2 * n_ + nz_) + k] = system_.multiplier_nominal(rows_[k]) * steps;
    if (k < at(holonomic_)) scale_[at(2 * n_ + nz_) + rows_.size() + k] = 1.0 / system_.constraint(rows_[k]).nominal;
  }
  column_scale_.resize(at(matrix_.nonzeros()));
  values_.resize(column_scale_.size());
  for (Index j = 0; j < size_; ++j) {
    for (Index e = matrix_.start()[at(j)]; e < matrix_.start()[at(j) + 1]; ++e) {
      const bool of_mu = j >= 2 * n_ + nz_ + static_cast<Index>(rows_.size());
      column_scale_[at(e)] = scale_[at(j)] * (of_mu ? square(scale_[at(matrix_.row()[at(e)])]) : 1.0);
    }
  }
  lu_.analyze({size_, size_, matrix_.start().data(), matrix_.row().data(), values_.data()});
}

/// Unknowns (x, v, z, lambda, mu), rows in the order of the step for x, f, g, r, c.
void GeneralizedAlpha::make_plans() {
  const Index count = static_cast<Index>(rows_.size()), constraints = system_.m() + system_.l();
  const Index z_first = 2 * n_, r_first = z_first + nz_, c_first = r_first + count;
  size_ = c_first + holonomic_;
  const std::span<const Index> all = rows_, first = all.first(at(holonomic_));
  const std::vector<Index> x = shifted(n_, 0), v = shifted(n_, n_), z = shifted(nz_, z_first),
                           r = selected(constraints, all, r_first), c = selected(system_.m(), first, c_first),
                           mu = selected(constraints, first, c_first);
  enum : std::size_t { one, a_by_v, zdot_by_z, minus_x_by_v };
  const Term terms[] = {
      {BRAMAH_R_V, mu, x, true, one},          {BRAMAH_F_X, v, x, false, one},    {BRAMAH_L_X, v, x, false, one},
      {BRAMAH_F_V, v, v, false, one},          {BRAMAH_F_A, v, v, false, a_by_v}, {BRAMAH_F_Z, v, z, false, one},
      {BRAMAH_F_U, v, z, false, one},          {BRAMAH_R_V, r, v, true, one},     {BRAMAH_G_X, z, x, false, one},
      {BRAMAH_G_V, z, v, false, one},          {BRAMAH_G_Z, z, z, false, one},    {BRAMAH_G_U, z, z, false, one},
      {BRAMAH_G_ZDOT, z, z, false, zdot_by_z}, {BRAMAH_R_X, r, x, false, one},    {BRAMAH_R_V, r, v, false, one},
      {BRAMAH_C_X, c, x, false, one}};
  const Diagonal diagonals[] = {{0, 0, n_, one, {}}, {0, n_, n_, minus_x_by_v, {}}};
  matrix_ = SparsePlan(system_, size_, size_, terms, diagonals);
  const std::vector<Index> C_rows = selected(constraints, first);
  const Term transposed[] = {{BRAMAH_R_V, C_rows, x, true, 0}};
  C_transposed_ = SparsePlan(system_, n_, holonomic_, transposed);
}

void GeneralizedAlpha::begin(const State& state, double end) {
  origin_ = state.t;
  end_ = end;
  count_ = 0;
  last_ = next_ = state;
  alpha_.assign(state.a.begin(), state.a.begin() + n_);
  w_.assign(state.zdot.begin(), state.zdot.begin() + nz_);
  next_alpha_ = alpha_;
  next_w_ = w_;
  lu_.forget_pivots();  // or a run continued from here would have other bits
  if (!form_matrix(last_, step_)) fail("the iteration matrix cannot be formed");
  // Room for all that steps evaluate is made now.
  if (!evaluate_rows()) fail("the rows cannot be evaluated");
}

double GeneralizedAlpha::step() {
  std::swap(last_, next_);
  std::swap(alpha_, next_alpha_);
  std::swap(w_, next_w_);
  const double planned = origin_ + static_cast<double>(count_ + 1) * step_;
  const bool ends = planned > end_ - tiny_remainder * step_;
  next_.t = ends ? end_ : planned;
  next_.side = ends ? -1 : 1;
  // Whole steps have the same h, whatever rounding does to t: the matrix stays valid.
  h_ = std::abs(planned - next_.t) <= tiny_remainder * step_ ? step_ : next_.t - last_.t;
  apply_inputs(system_, next_);
  predict(Guess::rates);
  if (!solve()) {
    ++work_.convergence_failures;
    predict(Guess::velocities);
    static_cast<void>(refresh_matrix());
    if (!solve()) fail("Newton's method did not converge; with a shorter \"step\" it may", worst_);
  }
  ++count_;
  ++work_.steps;
  return next_.t;
}

/// Where Newton's method starts: accelerations and rates go on as they are, or velocities, pressures and spools do.
void GeneralizedAlpha::predict(Guess guess) {
  const bool rates = guess == Guess::rates;
  for (std::size_t i = 0; i < at(n_); ++i) {
    if (rates) next_alpha_[i] = second_.lagging(alpha_[i], last_.a[i], last_.a[i]);
    next_.a[i] = rates ? last_.a[i] : second_.rate_at_rest(alpha_[i], last_.a[i], next_alpha_[i]);
    x_explicit_[i] = last_.x[i] + h_ * last_.v[i] + h_ * h_ * (0.5 - second_.beta) * alpha_[i];
    next_.x[i] = x_explicit_[i] + h_ * h_ * second_.beta * next_alpha_[i];
    next_.v[i] = last_.v[i] + h_ * ((1.0 - second_.gamma) * alpha_[i] + second_.gamma * next_alpha_[i]);
    weight_[i] = 1.0 / std::max(system_.x[i].nominal, std::abs(last_.x[i]));
    weight_[at(n_) + i] = 1.0 / std::max(system_.x[i].nominal / system_.scales.time, std::abs(last_.v[i]));
  }
  for (std::size_t i = 0; i < at(nz_); ++i) {
    if (rates) next_w_[i] = first_.lagging(w_[i], last_.zdot[i], last_.zdot[i]);
    next_.zdot[i] = rates ? last_.zdot[i] : first_.rate_at_rest(w_[i], last_.zdot[i], next_w_[i]);
    next_.z[i] = last_.z[i] + h_ * ((1.0 - first_.gamma) * w_[i] + first_.gamma * next_w_[i]);
    weight_[at(2 * n_) + i] = 1.0 / std::max(system_.z[i].nominal, std::abs(last_.z[i]));
  }
  next_.lambda = last_.lambda;
  std::fill(mu_.begin(), mu_.end(), 0.0);
}

/// Newton's method with an old matrix, as long as that is cheaper than a fresh one. False: not from this start.
///
/// Beside a singular position constraint rows fix x and v no better than rounding / sigma^2 does. Corrections then end on
/// that level, the higher the nearer the matrix was taken: an iterate on which a matrix from farther away had come to rest
/// is better than what a fresh one makes of it.
bool GeneralizedAlpha::solve() {
  trouble_.clear();
  bool fresh = false, contracted = false;
  double at_rest = HUGE_VAL;  // the last correction before the first fresh matrix
  if (matrix_at_.h != h_) fresh = refresh_matrix();
  double before = 0.0;
  for (int k = 0; k < most_iterations; ++k) {
    if (!evaluate_rows()) {
      // A length or volume beyond zero: half the way.
      if (k == 0) return false;
      for (double& d : rhs_) d *= 0.5;
      before = correct(-1.0);
      continue;
    }
    lu_.solve(rhs_);
    for (std::size_t i = 0; i < at(size_); ++i) rhs_[i] *= scale_[i];
    const double size = correct(1.0), contraction = k == 0 ? 1.0 : size / before;
    ++work_.newton_iterations;
    if (!std::isfinite(size)) return false;
    if (size <= newton_tolerance) return true;
    if (contraction < 1.0 && size * contraction / (1.0 - contraction) <= newton_tolerance) return true;
    if (size < rounding && contraction > 0.5 && (contracted || (fresh && k > 0))) return true;
    if (at_rest < HUGE_VAL) {
      for (std::size_t i = 0; i < at(size_); ++i) since_fresh_[i] += rhs_[i];
    }
    const bool go_back = at_rest < std::min(rounding, size);
    if (k > 0 && contraction > 0.5 && (go_back || size < coarsest_grain) && size <= rounding_of_constraints()) {
      if (!go_back) return true;
      rhs_ = since_fresh_;
      static_cast<void>(correct(-1.0));
      return true;
    }
    contracted = contraction < 0.1;
    fresh = k > 0 &&
            (contraction >= 1.0 || std::log(newton_tolerance / size) / std::log(contraction) > worth_a_matrix) &&
            refresh_matrix();
    if (fresh && at_rest == HUGE_VAL) {
      at_rest = size;
      std::fill(since_fresh_.begin(), since_fresh_.end(), 0.0);
    }
    before = size;
  }
  return false;
}

/// The correction that rounding of c and r alone can bring about, through the matrix at hand.
double GeneralizedAlpha::rounding_of_constraints() {
  const Index first_row = 2 * n_ + nz_;
  std::fill(noise_.begin(), noise_.end(), 0.0);
  for (Index j = 0; j < 2 * n_; ++j) {
    const double value = grain * std::abs(j < n_ ? next_.x[at(j)] : next_.v[at(j - n_)]);
    for (Index e = matrix_.start()[at(j)]; e < matrix_.start()[at(j) + 1]; ++e) {
      if (matrix_.row()[at(e)] >= first_row)
        noise_[at(matrix_.row()[at(e)])] += std::abs(matrix_.values()[at(e)]) * value;
    }
  }
  for (Index row = first_row; row < size_; ++row) noise_[at(row)] *= std::cos(2.0 * static_cast<double>(row));
  lu_.solve(noise_);
  double largest = 0.0;
  for (std::size_t i = 0; i < weight_.size(); ++i)
    largest = std::max(largest, std::abs(noise_[i] * scale_[i]) * weight_[i]);
  return largest;
}

/// rhs_ = -rows at next_. False: they cannot be evaluated, trouble_ says why.
bool GeneralizedAlpha::evaluate_rows() {
  ++work_.evaluations;
  const Outcome outcome = blocks_.evaluate(system_, next_, row_request_);
  if (!outcome.ok()) {
    trouble_ = outcome.message;
    if (outcome.status == Outcome::Status::fatal) fail("a component gives up");
    return false;
  }
  const double one = 1.0, h2_beta = h_ * h_ * second_.beta;
  C_transposed_.fill(blocks_, {&one, 1});
  for (std::size_t i = 0; i < at(n_); ++i) rhs_[i] = x_explicit_[i] + h2_beta * next_alpha_[i] - next_.x[i];
  for (Index k = 0; k < holonomic_; ++k) {
    for (Index e = C_transposed_.start()[at(k)]; e < C_transposed_.start()[at(k) + 1]; ++e)
      rhs_[at(C_transposed_.row()[at(e)])] -=
          C_transposed_.values()[at(e)] * square(scale_[at(C_transposed_.row()[at(e)])]) * mu_[at(k)];
  }
  double* out = rhs_.data() + n_;
  for (const double f : blocks_.f) *out++ = -f;
  for (const double g : blocks_.g) *out++ = -g;
  for (const Index row : rows_) *out++ = -blocks_.r[at(row)];
  for (Index k = 0; k < holonomic_; ++k) *out++ = -blocks_.c[at(rows_[at(k)])];
  return true;
}

/// Adds `part` of the correction in rhs_ to the next state; the largest of x, v and z, as it is weighed.
double GeneralizedAlpha::correct(double part) {
  const double alpha_by_v = part / (second_.gamma * h_), a_by_v = part * second_.rate_by_variable(h_),
               w_by_z = part / (first_.gamma * h_), zdot_by_z = part * first_.rate_by_variable(h_);
  const double* d = rhs_.data();
  for (std::size_t i = 0; i < at(n_); ++i) next_.x[i] += part * *d++;
  for (std::size_t i = 0; i < at(n_); ++i, ++d) {
    next_.v[i] += part * *d;
    next_.a[i] += a_by_v * *d;
    next_alpha_[i] += alpha_by_v * *d;
  }
  for (std::size_t i = 0; i < at(nz_); ++i, ++d) {
    next_.z[i] += part * *d;
    next_.zdot[i] += zdot_by_z * *d;
    next_w_[i] += w_by_z * *d;
  }
  for (const Index row : rows_) next_.lambda[at(row)] += part * *d++;
  for (double& mu : mu_) mu += part * *d++;
  double largest = 0.0;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const double size = std::abs(rhs_[i]) * weight_[i];
    if (size <= largest) continue;
    largest = size;
    worst_ = static_cast<Index>(i);
    if (!std::isfinite(size)) break;
  }
  return largest;
}

/// False: the partials cannot be evaluated there, and the matrix is what it was.
bool GeneralizedAlpha::form_matrix(const State& state, double h) {
  ++work_.jacobians;
  const Outcome outcome = blocks_.evaluate(system_, state, matrix_request_);
  if (!outcome.ok()) {
    trouble_ = outcome.message;
    return false;
  }
  const double weights[] = {1.0, second_.rate_by_variable(h), first_.rate_by_variable(h),
                            -second_.beta / second_.gamma * h};
  matrix_.fill(blocks_, weights);
  for (std::size_t e = 0; e < values_.size(); ++e) {
    values_[e] = matrix_.values()[e] * column_scale_[e];
    if (!std::isfinite(values_[e])) {
      trouble_ = blocks_.check_partials(system_).message;
      return false;
    }
  }
  ++work_.factorizations;
  const bool regular = lu_.factor({size_, size_, matrix_.start().data(), matrix_.row().data(), values_.data()});
  if (!regular) {
    const Index column = lu_.singular_column();
    fail("the iteration matrix is singular at " + unknown_name(column), column < 2 * n_ + nz_ ? column : -1);
  }
  matrix_at_.state = state;
  matrix_at_.h = h;
  fresh_pivots_ = lu_.fresh_pivots();
  if (lu_.fresh_pivots()) pivots_at_ = matrix_at_;
  return true;
}

void GeneralizedAlpha::interpolate(double t, State& state) {
  const double length = next_.t - last_.t;
  const double s = t >= next_.t || length <= 0.0 ? 1.0 : std::max(0.0, (t - last_.t) / length);
  const double before = (1.0 - s) * (1.0 - s), after = s * s;
  for (std::size_t i = 0; i < at(n_); ++i) {
    state.x[i] = before * ((1.0 + 2.0 * s) * last_.x[i] + s * length * last_.v[i]) +
                 after * ((3.0 - 2.0 * s) * next_.x[i] - (1.0 - s) * length * next_.v[i]);
    state.v[i] = (1.0 - s) * last_.v[i] + s * next_.v[i];
  }
  for (std::size_t i = 0; i < at(nz_); ++i) state.z[i] = (1.0 - s) * last_.z[i] + s * next_.z[i];
  state.t = t;
  state.side = t >= end_ ? -1 : 1;
  apply_inputs(system_, state);
}

template <class Self, class Visit>
void GeneralizedAlpha::visit_memory(Self& self, Visit&& visit) {
  const auto all = [&](auto& vector) {
    for (auto& number : vector) visit(number);
  };
  visit(self.origin_);
  visit(self.count_);
  visit(self.fresh_pivots_);
  for (auto* vector : {&self.next_alpha_, &self.next_w_, &self.next_.a, &self.next_.zdot, &self.next_.lambda})
    all(*vector);
  for (auto* place : {&self.matrix_at_, &self.pivots_at_}) {
    visit(place->h);
    visit(place->state.t);
    visit(place->state.side);
    for (auto* vector :
         {&place->state.x, &place->state.v, &place->state.a, &place->state.z, &place->state.zdot, &place->state.lambda})
      all(*vector);
  }
}

Vector GeneralizedAlpha::memory() const {
  Vector memory{static_cast<double>(rows_.size()), static_cast<double>(holonomic_)};
  for (const Index row : rows_) memory.push_back(static_cast<double>(row));
  visit_memory(*this, [&](const auto& number) { memory.push_back(static_cast<double>(number)); });
  return memory;
}

void GeneralizedAlpha::recall(std::span<const double> memory) {
  std::size_t next = 0;
  const auto read = [&] {
    if (next == memory.size() || !std::isfinite(memory[next]))
      throw AnalysisError("simulate", "a checkpoint that ends after " + std::to_string(next) + " numbers",
                          "one of generalized_alpha and of this scene", "start the simulation anew");
    return memory[next++];
  };
  const auto read_index = [&](Index below) {
    const double number = read();
    if (number >= 0.0 && number < static_cast<double>(below)) return static_cast<Index>(number);
    throw AnalysisError("simulate", "a checkpoint with a constraint row " + digits(number, 10),
                        "rows below " + std::to_string(below), "start the simulation anew");
  };
  const Index constraints = system_.m() + system_.l();
  rows_.resize(at(read_index(constraints + 1)));
  holonomic_ = read_index(std::min(static_cast<Index>(rows_.size()), system_.m()) + 1);
  for (Index& row : rows_) row = read_index(constraints);
  lay_out();
  visit_memory(*this, [&](auto& number) { number = static_cast<std::remove_reference_t<decltype(number)>>(read()); });
  if (next != memory.size())
    throw AnalysisError("simulate", "a checkpoint of " + std::to_string(memory.size()) + " numbers",
                        std::to_string(next) + " numbers", "it is of another scene: start the simulation anew");
  // The factors depend on the matrix and on the one for which the pivots were chosen.
  const Place matrix = matrix_at_, pivots = pivots_at_;
  const bool fresh = fresh_pivots_;
  bool formed = form_matrix(pivots.state, pivots.h);
  if (formed && !fresh) formed = form_matrix(matrix.state, matrix.h);
  if (!formed) fail("the iteration matrix cannot be formed");
}

void GeneralizedAlpha::fail(const std::string& why, Index limiting) const {
  throw stalled(system_, next_.t, h_, why, trouble_, limiting);
}

std::string GeneralizedAlpha::unknown_name(Index i) const {
  const Index k = i - 2 * n_ - nz_, count = static_cast<Index>(rows_.size());
  if (k < 0 || i >= size_) return variable_name(system_, i);
  return system_.multiplier_name(rows_[at(k < count ? k : k - count)]);
}

}  // namespace

std::unique_ptr<Integrator> make_generalized_alpha(const System& system, const SimulateOptions& options,
                                                   const State& start) {
  return std::make_unique<GeneralizedAlpha>(system, options, start);
}

}  // namespace bramah
