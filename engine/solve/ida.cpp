// IDA on the stabilized index-2 form of Gear, Gupta and Leimkuhler, with the exact sparse Jacobian.
//
//   xdot - v + W C_x^T mu = 0    f(t, x, v, vdot, z, lambda, u) = 0      g(t, x, v, z, zdot, u) = 0
//   r(t, x, v) = 0               c(t, x) = 0
//
// Positions and velocities both satisfy their constraints at every step; mu is zero on the exact solution. W: squares of the
// coordinates' nominals, which make metres and radians comparable.
#include <ida/ida.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "solve/integrator.hpp"
#include "solve/partition.hpp"
#include "solve/scaled_state.hpp"
#include "solve/sundials.hpp"
#include "sparse/klu.hpp"
#include "system/blocks.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

using sundials::check;
using sundials::data;

// Multipliers take no part in the error test, and must not stall Newton's method either: they follow from the rest.
constexpr double multiplier_slack = 1e6;
constexpr double first_step =
    1e-6;  // of the machine's time, after every start; IDA's own guess is too bold for index 2

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
double square(double value) { return value * value; }

/// Unknowns y = (x, v, z, lambda, mu), each over its nominal, and rows in the order of the equations above.
class Ida final : public Integrator {
 public:
  Ida(const System& system, const SimulateOptions& options, const State& start)
      : system_(system),
        options_(options),
        partition_(choose_partition(system, start)),
        scaled_(system, options.rel_tol),
        blocks_(system),
        state_(start),
        n_(system.n()),
        nz_(system.nz()),
        rows_(static_cast<Index>(partition_.rows.size())),
        holonomic_(partition_.holonomic) {
    make_plans();
    make_scales();
    make_solver();
  }
  ~Ida() override { IDAFree(&ida_); }

  [[nodiscard]] std::string_view name() const override { return "ida"; }
  void begin(const State& state, double end) override;
  double step() override;
  void interpolate(double t, State& state) override;
  [[nodiscard]] Index limiting() override;
  [[nodiscard]] IntegratorWork work() const override;

  int factor(SUNMatrix matrix);
  int solve(N_Vector x, N_Vector b);

 private:
  void make_plans();
  void make_scales();
  void make_solver();
  void create();
  void load(double t, const double* y, const double* yp, State& state) const;
  int residual(double t, const double* y, const double* yp, double* out);
  int jacobian(double t, double cj, const double* y, const double* yp, SUNMatrix matrix);
  void error_weights(const double* y, double* weight);
  [[noreturn]] void fail(int flag);
  [[nodiscard]] std::string unknown_name(Index i) const;
  /// No exception crosses SUNDIALS: it waits until IDASolve has returned.
  template <class Function>
  static int guarded(void* self, Function&& function) noexcept {
    auto* ida = static_cast<Ida*>(self);
    try {
      return function(*ida);
    } catch (...) {
      ida->exception_ = std::current_exception();
      return -1;
    }
  }

  const System& system_;
  SimulateOptions options_;
  Partition partition_;
  ScaledState scaled_;
  Blocks blocks_;
  State state_;
  Index n_, nz_, rows_, holonomic_, size_ = 0;
  SparsePlan jacobian_, C_transposed_;
  Vector scale_, column_scale_;
  sparse::Klu lu_;
  const Request residual_request_ = Request{}.rows("fgcr").blocks({BRAMAH_R_V});
  const Request jacobian_request_ =
      Request{}.blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X, BRAMAH_G_V,
                        BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_G_ZDOT, BRAMAH_R_X, BRAMAH_R_V, BRAMAH_C_X});
  sundials::Context context_;
  sundials::Vector y_, yp_, id_, weights_, errors_;
  sundials::Matrix matrix_;
  sundials::LinearSolver linear_solver_;
  void* ida_ = nullptr;
  double t_ = 0.0, end_ = 0.0;
  IntegratorWork past_;  // of segments that are over
  long factorizations_ = 0;
  std::string trouble_, singular_;
  std::exception_ptr exception_;
};

void Ida::make_plans() {
  const Index n = n_, f_row = n, g_row = 2 * n, r_row = 2 * n + nz_, c_row = r_row + rows_;
  const Index v_col = n, z_col = 2 * n, lambda_col = 2 * n + nz_, mu_col = lambda_col + rows_;
  size_ = mu_col + holonomic_;
  const std::span<const Index> all = partition_.rows, first = all.first(at(holonomic_));
  const Index constraints = system_.m() + system_.l();
  const std::vector<Index> x = shifted(n, 0), v = shifted(n, v_col), z = shifted(nz_, z_col), f = shifted(n, f_row),
                           g = shifted(nz_, g_row), r = selected(constraints, all, r_row),
                           c = selected(system_.m(), first, c_row), lambda = selected(constraints, all, lambda_col),
                           mu = selected(constraints, first, mu_col);
  enum : std::size_t { one, cj, minus };
  const Term terms[] = {
      {BRAMAH_R_V, mu, x, true, one},   {BRAMAH_F_X, f, x, false, one},     {BRAMAH_L_X, f, x, false, one},
      {BRAMAH_F_V, f, v, false, one},   {BRAMAH_F_A, f, v, false, cj},      {BRAMAH_F_Z, f, z, false, one},
      {BRAMAH_F_U, f, z, false, one},   {BRAMAH_R_V, lambda, f, true, one}, {BRAMAH_G_X, g, x, false, one},
      {BRAMAH_G_V, g, v, false, one},   {BRAMAH_G_Z, g, z, false, one},     {BRAMAH_G_U, g, z, false, one},
      {BRAMAH_G_ZDOT, g, z, false, cj}, {BRAMAH_R_X, r, x, false, one},     {BRAMAH_R_V, r, v, false, one},
      {BRAMAH_C_X, c, x, false, one}};
  const Diagonal diagonals[] = {{0, 0, n, cj, {}}, {0, v_col, n, minus, {}}};
  jacobian_ = SparsePlan(system_, size_, size_, terms, diagonals);
  const std::vector<Index> C_rows = selected(constraints, first);
  const Term transposed[] = {{BRAMAH_R_V, C_rows, x, true, 0}};
  C_transposed_ = SparsePlan(system_, n, holonomic_, transposed);
}

void Ida::make_scales() {
  scale_ = scaled_.scale();
  scale_.resize(at(size_), 1.0);
  for (Index i = 0; i < rows_; ++i) {
    const Index row = partition_.rows[at(i)];
    scale_[at(2 * n_ + nz_ + i)] = std::max(system_.multiplier_nominal(row), std::abs(state_.lambda[at(row)]));
    if (i < holonomic_)
      scale_[at(2 * n_ + nz_ + rows_ + i)] = 1.0 / (system_.constraint(row).nominal * system_.scales.time);
  }
  const Index mu = 2 * n_ + nz_ + rows_;
  column_scale_.resize(at(jacobian_.nonzeros()));
  for (Index j = 0; j < size_; ++j) {
    for (Index e = jacobian_.start()[at(j)]; e < jacobian_.start()[at(j) + 1]; ++e)
      column_scale_[at(e)] = scale_[at(j)] * (j < mu ? 1.0 : square(scale_[at(jacobian_.row()[at(e)])]));
  }
}

void Ida::make_solver() {
  for (sundials::Vector* v : {&y_, &yp_, &id_, &weights_, &errors_}) *v = sundials::make_vector(size_, context_);
  for (Index i = 0; i < size_; ++i) data(id_)[i] = i < scaled_.size() ? 1.0 : 0.0;
  matrix_.reset(SUNSparseMatrix(size_, size_, std::max<Index>(jacobian_.nonzeros(), 1), CSC_MAT, context_));
  linear_solver_ = sundials::make_direct_solver(this, context_);
}

int Ida::factor(SUNMatrix matrix) {
  const sparse::CscView view{size_, size_, jacobian_.start().data(), jacobian_.row().data(), SM_DATA_S(matrix)};
  if (!lu_.analyzed()) lu_.analyze(view);
  ++factorizations_;
  if (lu_.factor(view)) return 0;
  singular_ = unknown_name(lu_.singular_column());
  return 1;  // recoverable: IDA tries a smaller step
}

int Ida::solve(N_Vector x, N_Vector b) {
  std::copy_n(data(b), size_, data(x));
  lu_.solve({data(x), at(size_)});
  return 0;
}

/// `state` from y and ydot.
void Ida::load(double t, const double* y, const double* yp, State& state) const {
  state.t = t;
  state.side = t >= end_ ? -1 : 1;
  scaled_.unpack(y, state);
  scaled_.unpack_rates(yp, state);
  for (Index i = 0; i < rows_; ++i)
    state.lambda[at(partition_.rows[at(i)])] = y[scaled_.size() + i] * scale_[at(scaled_.size() + i)];
  apply_inputs(system_, state);
}

int Ida::residual(double t, const double* y, const double* yp, double* out) {
  load(t, y, yp, state_);
  // mu multiplies the holonomic rows of D, which are evaluated for the reactions anyway.
  const Outcome outcome = blocks_.evaluate(system_, state_, residual_request_);
  if (!outcome.ok()) {
    trouble_ = outcome.message;
    return outcome.status == Outcome::Status::recoverable ? 1 : -1;
  }
  const double one = 1.0;
  C_transposed_.fill(blocks_, {&one, 1});
  for (Index i = 0; i < n_; ++i) out[i] = yp[i] * scale_[at(i)] - y[n_ + i] * scale_[at(n_ + i)];
  const double* mu = y + 2 * n_ + nz_ + rows_;
  for (Index k = 0; k < holonomic_; ++k) {
    for (Index e = C_transposed_.start()[at(k)]; e < C_transposed_.start()[at(k) + 1]; ++e)
      out[C_transposed_.row()[at(e)]] += C_transposed_.values()[at(e)] *
                                         square(scale_[at(C_transposed_.row()[at(e)])]) *
                                         scale_[at(2 * n_ + nz_ + rows_ + k)] * mu[k];
  }
  std::copy_n(blocks_.f.begin(), n_, out + n_);
  std::copy_n(blocks_.g.begin(), nz_, out + 2 * n_);
  for (Index k = 0; k < rows_; ++k) out[2 * n_ + nz_ + k] = blocks_.r[at(partition_.rows[at(k)])];
  for (Index k = 0; k < holonomic_; ++k) out[2 * n_ + nz_ + rows_ + k] = blocks_.c[at(partition_.rows[at(k)])];
  return 0;
}

int Ida::jacobian(double t, double cj, const double* y, const double* yp, SUNMatrix matrix) {
  load(t, y, yp, state_);
  const Outcome outcome = blocks_.evaluate(system_, state_, jacobian_request_);
  if (!outcome.ok()) {
    trouble_ = outcome.message;
    return 1;
  }
  const double weights[] = {1.0, cj, -1.0};
  jacobian_.fill(blocks_, weights);
  std::copy(jacobian_.start().begin(), jacobian_.start().end(), SM_INDEXPTRS_S(matrix));
  std::copy(jacobian_.row().begin(), jacobian_.row().end(), SM_INDEXVALS_S(matrix));
  double* values = SM_DATA_S(matrix);
  for (Index e = 0; e < jacobian_.nonzeros(); ++e) {
    values[e] = jacobian_.values()[at(e)] * column_scale_[at(e)];
    if (!std::isfinite(values[e])) {
      trouble_ = blocks_.check_partials(system_).message;
      return 1;
    }
  }
  return 0;
}

void Ida::error_weights(const double* y, double* weight) {
  scaled_.weigh(y, weight);
  for (Index i = scaled_.size(); i < size_; ++i)
    weight[i] = 1.0 / (options_.rel_tol * multiplier_slack * (1.0 + std::abs(y[i])));
}

std::string Ida::unknown_name(Index i) const {
  if (i < scaled_.size() || i >= size_) return variable_name(system_, i < size_ ? i : -1);
  const Index k = i - scaled_.size();
  return system_.multiplier_name(partition_.rows[at(k < rows_ ? k : k - rows_)]);
}

void Ida::create() {
  ida_ = IDACreate(context_);
  if (ida_ == nullptr) throw std::bad_alloc();
  const auto residual = [](double time, N_Vector y, N_Vector yp, N_Vector out, void* self) {
    return guarded(self, [&](Ida& ida) { return ida.residual(time, data(y), data(yp), data(out)); });
  };
  const auto weigh = [](N_Vector y, N_Vector weight, void* self) {
    return guarded(self, [&](Ida& ida) {
      ida.error_weights(data(y), data(weight));
      return 0;
    });
  };
  const auto jacobian = [](double time, double cj, N_Vector y, N_Vector yp, N_Vector, SUNMatrix J, void* self, N_Vector,
                           N_Vector, N_Vector) {
    return guarded(self, [&](Ida& ida) { return ida.jacobian(time, cj, data(y), data(yp), J); });
  };
  check(IDAInit(ida_, residual, t_, y_.get(), yp_.get()), "IDAInit");
  check(IDASetUserData(ida_, this), "IDASetUserData");
  check(IDASetErrHandlerFn(ida_, sundials::keep_silent, nullptr), "IDASetErrHandlerFn");
  check(IDAWFtolerances(ida_, weigh), "IDAWFtolerances");
  check(IDASetId(ida_, id_.get()), "IDASetId");
  check(IDASetSuppressAlg(ida_, SUNTRUE), "IDASetSuppressAlg");
  check(IDASetLinearSolver(ida_, linear_solver_.get(), matrix_.get()), "IDASetLinearSolver");
  check(IDASetJacFn(ida_, jacobian), "IDASetJacFn");
  if (options_.max_step > 0.0) check(IDASetMaxStep(ida_, options_.max_step), "IDASetMaxStep");
}

void Ida::begin(const State& state, double end) {
  state_ = state;
  t_ = state.t;
  end_ = end;
  N_VConst(0.0, y_.get());
  N_VConst(0.0, yp_.get());
  scaled_.pack(state, data(y_));
  scaled_.pack_rates(state, data(yp_));
  for (Index i = 0; i < rows_; ++i)
    data(y_)[scaled_.size() + i] = state.lambda[at(partition_.rows[at(i)])] / scale_[at(scaled_.size() + i)];
  if (ida_ == nullptr) {
    create();
  } else {
    past_ = work();
    check(IDAReInit(ida_, t_, y_.get(), yp_.get()), "IDAReInit");
  }
  check(IDASetInitStep(ida_, std::min(first_step * system_.sizes.time, 1e-3 * (end - t_))), "IDASetInitStep");
  check(IDASetStopTime(ida_, end), "IDASetStopTime");
}

double Ida::step() {
  const double before = t_;
  const int flag = IDASolve(ida_, end_, &t_, y_.get(), yp_.get(), IDA_ONE_STEP);
  if (flag < 0) fail(flag);
  if (!(t_ > before)) fail(IDA_TOO_MUCH_WORK);
  trouble_.clear();
  singular_.clear();
  return t_;
}

void Ida::interpolate(double t, State& state) {
  // weights_ and errors_ serve as workspace between the steps.
  check(IDAGetDky(ida_, t, 0, weights_.get()), "IDAGetDky");
  check(IDAGetDky(ida_, t, 1, errors_.get()), "IDAGetDky");
  load(t, data(weights_), data(errors_), state);
}

Index Ida::limiting() {
  if (IDAGetErrWeights(ida_, weights_.get()) != IDA_SUCCESS) return -1;
  if (IDAGetEstLocalErrors(ida_, errors_.get()) != IDA_SUCCESS) return -1;
  return scaled_.worst(data(weights_), data(errors_));
}

IntegratorWork Ida::work() const {
  IntegratorWork sum = past_;
  sum.factorizations = factorizations_;
  if (ida_ == nullptr) return sum;
  long steps = 0, residuals = 0, setups = 0, error_failures = 0, newton = 0, convergence = 0, jacobians = 0;
  int last_order = 0, order = 0;
  double first = 0.0, last = 0.0, current = 0.0, time = 0.0;
  IDAGetIntegratorStats(ida_, &steps, &residuals, &setups, &error_failures, &last_order, &order, &first, &last,
                        &current, &time);
  IDAGetNonlinSolvStats(ida_, &newton, &convergence);
  IDAGetNumJacEvals(ida_, &jacobians);
  sum.steps += steps;
  sum.evaluations += residuals;
  sum.error_test_failures += error_failures;
  sum.newton_iterations += newton;
  sum.convergence_failures += convergence;
  sum.jacobians += jacobians;
  return sum;
}

void Ida::fail(int flag) {
  if (exception_) std::rethrow_exception(exception_);
  double step = 0.0;
  IDAGetLastStep(ida_, &step);
  std::string why = "the integrator stopped (" + std::to_string(flag) + ")";
  if (flag == IDA_TOO_MUCH_WORK) why = "the step has become too small";
  if (flag == IDA_ERR_FAIL) why = "the error test failed again and again";
  if (flag == IDA_CONV_FAIL || flag == IDA_NLS_SETUP_FAIL || flag == IDA_LSETUP_FAIL)
    why = "Newton's method did not converge";
  if (flag == IDA_LSOLVE_FAIL || !singular_.empty()) why += ", the iteration matrix is singular at " + singular_;
  throw stalled(system_, t_, step, why, trouble_, limiting());
}

}  // namespace

std::unique_ptr<Integrator> make_ida(const System& system, const SimulateOptions& options, const State& start) {
  return std::make_unique<Ida>(system, options, start);
}

}  // namespace bramah
