#include "solve/simulate.hpp"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>

#include "solve/assemble.hpp"
#include "solve/kkt.hpp"
#include "sparse/klu.hpp"
#include "system/analysis_error.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

static_assert(sizeof(sunindextype) == sizeof(Index), "SUNDIALS and the engine index alike");

// Errors are relative to how far a variable has moved, but never to less than this part of its nominal: below it lies
// rounding.
constexpr double least_motion = 1e-5;
constexpr double least_tolerance = 1e-13;
// Multipliers take no part in the error test, and must not stall Newton's method either: they follow from the rest.
constexpr double multiplier_slack = 1e6;
constexpr double first_step = 1e-6;  // s, after every start; IDA's own guess is too bold for index 2
constexpr long most_steps_between_outputs = 5'000'000;

/// Unknowns y = (x, v, z, lambda, mu), each over its nominal, and rows in the order of the header comment.
class Integration {
 public:
  Integration(const System& system, SimulateOptions options, State start)
      : system_(system),
        options_(std::move(options)),
        partition_(choose_partition(system, start)),
        blocks_(system),
        kkt_(system, partition_.rows),
        state_(std::move(start)),
        n_(system.n()),
        nz_(system.nz()),
        rows_(static_cast<Index>(partition_.rows.size())),
        holonomic_(partition_.holonomic) {
    make_plans();
    make_scales();
    make_solver();
  }
  ~Integration() {
    IDAFree(&ida_);
    if (linear_solver_ != nullptr) SUNLinSolFree(linear_solver_);
    if (matrix_ != nullptr) SUNMatDestroy(matrix_);
    for (N_Vector v : {y_, yp_, id_, weights_, errors_, shown_y_, shown_yp_}) {
      if (v != nullptr) N_VDestroy(v);
    }
    SUNContext_Free(&context_);
  }
  Integration(const Integration&) = delete;
  Integration& operator=(const Integration&) = delete;

  Simulation run(const Observer& observer);

 private:
  void make_plans() {
    const Index n = n_, f_row = n, g_row = 2 * n, r_row = 2 * n + nz_, c_row = r_row + rows_;
    const Index v_col = n, z_col = 2 * n, lambda_col = 2 * n + nz_, mu_col = lambda_col + rows_;
    size_ = mu_col + holonomic_;
    const std::span<const Index> all = partition_.rows, first = all.first(static_cast<std::size_t>(holonomic_));
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

  void make_scales() {
    scale_.assign(static_cast<std::size_t>(size_), 1.0);
    for (Index i = 0; i < n_; ++i) scale_[at(i)] = scale_[at(n_ + i)] = system_.x[at(i)].nominal;
    for (Index i = 0; i < nz_; ++i) scale_[at(2 * n_ + i)] = system_.z[at(i)].nominal;
    for (Index i = 0; i < rows_; ++i) {
      scale_[at(2 * n_ + nz_ + i)] = std::max(1.0, std::abs(state_.lambda[at(partition_.rows[at(i)])]));
    }
    column_scale_.resize(at(jacobian_.nonzeros()));
    for (Index j = 0; j < size_; ++j) {
      for (Index e = jacobian_.start()[at(j)]; e < jacobian_.start()[at(j) + 1]; ++e)
        column_scale_[at(e)] = scale_[at(j)];
    }
    low_.assign(at(2 * n_ + nz_), HUGE_VAL);
    high_.assign(at(2 * n_ + nz_), -HUGE_VAL);
  }

  void make_solver() {
    if (SUNContext_Create(nullptr, &context_) != 0) throw std::bad_alloc();
    y_ = N_VNew_Serial(size_, context_);
    yp_ = N_VClone(y_);
    id_ = N_VClone(y_);
    weights_ = N_VClone(y_);
    errors_ = N_VClone(y_);
    shown_y_ = N_VClone(y_);
    shown_yp_ = N_VClone(y_);
    for (Index i = 0; i < size_; ++i) data(id_)[i] = i < 2 * n_ + nz_ ? 1.0 : 0.0;
    matrix_ = SUNSparseMatrix(size_, size_, std::max<Index>(jacobian_.nonzeros(), 1), CSC_MAT, context_);
    linear_solver_ = SUNLinSolNewEmpty(context_);
    linear_solver_->content = this;
    linear_solver_->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
    linear_solver_->ops->setup = [](SUNLinearSolver self, SUNMatrix matrix) { return of(self).factor(matrix); };
    linear_solver_->ops->solve = [](SUNLinearSolver self, SUNMatrix, N_Vector x, N_Vector b, realtype) {
      return of(self).solve(x, b);
    };
    linear_solver_->ops->free = [](SUNLinearSolver self) {
      SUNLinSolFreeEmpty(self);
      return 0;
    };
  }
  static Integration& of(SUNLinearSolver self) { return *static_cast<Integration*>(self->content); }
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  static double* data(N_Vector v) { return NV_DATA_S(v); }

  int factor(SUNMatrix matrix) {
    const sparse::CscView view{size_, size_, jacobian_.start().data(), jacobian_.row().data(), SM_DATA_S(matrix)};
    if (!lu_.analyzed()) lu_.analyze(view);
    if (lu_.factor(view)) return 0;
    singular_ = unknown_name(lu_.singular_column());
    return 1;  // recoverable: IDA tries a smaller step
  }
  int solve(N_Vector x, N_Vector b) {
    std::copy_n(data(b), size_, data(x));
    lu_.solve({data(x), at(size_)});
    return 0;
  }

  /// state_ from y and ydot.
  void load(double t, const double* y, const double* yp) {
    state_.t = t;
    state_.side = t >= segment_end_ ? -1 : 1;
    for (Index i = 0; i < n_; ++i) {
      state_.x[at(i)] = y[i] * scale_[at(i)];
      state_.v[at(i)] = y[n_ + i] * scale_[at(n_ + i)];
      state_.a[at(i)] = yp[n_ + i] * scale_[at(n_ + i)];
    }
    for (Index i = 0; i < nz_; ++i) {
      state_.z[at(i)] = y[2 * n_ + i] * scale_[at(2 * n_ + i)];
      state_.zdot[at(i)] = yp[2 * n_ + i] * scale_[at(2 * n_ + i)];
    }
    for (Index i = 0; i < rows_; ++i)
      state_.lambda[at(partition_.rows[at(i)])] = y[2 * n_ + nz_ + i] * scale_[at(2 * n_ + nz_ + i)];
    apply_inputs(system_, state_);
  }

  int residual(double t, const double* y, const double* yp, double* out) {
    load(t, y, yp);
    // mu multiplies the holonomic rows of D, which are evaluated for the reactions anyway.
    const Outcome outcome = blocks_.evaluate(system_, state_, residual_request_);
    if (!outcome.ok()) {
      trouble_ = outcome.message;
      return outcome.status == Outcome::Status::recoverable ? 1 : -1;
    }
    const double one = 1.0;
    C_transposed_.fill(blocks_, {&one, 1});
    for (Index i = 0; i < n_; ++i) out[i] = (yp[i] - y[n_ + i]) * scale_[at(i)];
    const double* mu = y + 2 * n_ + nz_ + rows_;
    for (Index k = 0; k < holonomic_; ++k) {
      for (Index e = C_transposed_.start()[at(k)]; e < C_transposed_.start()[at(k) + 1]; ++e) {
        out[C_transposed_.row()[at(e)]] += C_transposed_.values()[at(e)] * mu[k];
      }
    }
    std::copy_n(blocks_.f.begin(), n_, out + n_);
    std::copy_n(blocks_.g.begin(), nz_, out + 2 * n_);
    for (Index k = 0; k < rows_; ++k) out[2 * n_ + nz_ + k] = blocks_.r[at(partition_.rows[at(k)])];
    for (Index k = 0; k < holonomic_; ++k) out[2 * n_ + nz_ + rows_ + k] = blocks_.c[at(partition_.rows[at(k)])];
    return 0;
  }

  int jacobian(double t, double cj, const double* y, const double* yp, SUNMatrix matrix) {
    load(t, y, yp);
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
        trouble_ = "a partial derivative is not finite";
        return 1;
      }
    }
    return 0;
  }

  void error_weights(const double* y, double* weight) {
    const double tolerance = options_.rel_tol;
    for (Index i = 0; i < size_; ++i) {
      if (i < 2 * n_ + nz_) {
        low_[at(i)] = std::min(low_[at(i)], y[i]);
        high_[at(i)] = std::max(high_[at(i)], y[i]);
        const double motion = std::max(high_[at(i)] - low_[at(i)], least_motion);
        weight[i] = 1.0 / std::max(tolerance * motion, least_tolerance * std::max(1.0, std::abs(y[i])));
      } else {
        weight[i] = 1.0 / (tolerance * multiplier_slack * (1.0 + std::abs(y[i])));
      }
    }
  }

  void begin_segment(double t);
  void step();
  void emit(double t, const Observer& observer);
  void count_statistics();
  [[noreturn]] void fail(int flag);
  [[nodiscard]] std::string unknown_name(Index i) const;
  static void check(int flag, const char* what) {
    if (flag < 0)
      throw AnalysisError("simulate", std::string(what) + " failed with " + std::to_string(flag),
                          "a working integrator", "this is a fault of the engine");
  }
  template <class Function>
  static int guarded(void* self, Function&& function) noexcept {
    auto* integration = static_cast<Integration*>(self);
    try {
      return function(*integration);
    } catch (...) {
      integration->exception_ = std::current_exception();
      return -1;
    }
  }

  const System& system_;
  SimulateOptions options_;
  Partition partition_;
  Blocks blocks_;
  Kkt kkt_;
  State state_;
  Index n_, nz_, rows_, holonomic_, size_ = 0;
  SparsePlan jacobian_, C_transposed_;
  Vector scale_, column_scale_, low_, high_;
  sparse::Klu lu_;
  const Request residual_request_ = Request{}.rows("fgcr").blocks({BRAMAH_R_V});
  const Request jacobian_request_ =
      Request{}.blocks({BRAMAH_F_X, BRAMAH_L_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_F_Z, BRAMAH_F_U, BRAMAH_G_X, BRAMAH_G_V,
                        BRAMAH_G_Z, BRAMAH_G_U, BRAMAH_G_ZDOT, BRAMAH_R_X, BRAMAH_R_V, BRAMAH_C_X});
  SUNContext context_ = nullptr;
  void* ida_ = nullptr;
  N_Vector y_ = nullptr, yp_ = nullptr, id_ = nullptr, weights_ = nullptr, errors_ = nullptr, shown_y_ = nullptr,
           shown_yp_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  double t_ = 0.0, segment_end_ = 0.0;
  SimulationStatistics statistics_;
  std::string trouble_, singular_;
  std::exception_ptr exception_;
};

std::string Integration::unknown_name(Index i) const {
  if (i < 0 || i >= size_) return "an unknown";
  if (i < n_) return system_.x[at(i)].name;
  if (i < 2 * n_) return system_.x[at(i - n_)].name + ".rate";
  if (i < 2 * n_ + nz_) return system_.z[at(i - 2 * n_)].name;
  const Index k = i - 2 * n_ - nz_;
  return system_.multiplier_name(partition_.rows[at(k < rows_ ? k : k - rows_)]);
}

/// Consistent accelerations, multipliers and rates at t_, then IDA from there.
void Integration::begin_segment(double t) {
  state_.t = t;
  state_.side = 1;
  apply_inputs(system_, state_);
  kkt_.complete(state_, blocks_);
  double *y = data(y_), *yp = data(yp_);
  N_VConst(0.0, y_);
  N_VConst(0.0, yp_);
  for (Index i = 0; i < n_; ++i) {
    y[i] = state_.x[at(i)] / scale_[at(i)];
    y[n_ + i] = state_.v[at(i)] / scale_[at(n_ + i)];
    yp[i] = y[n_ + i];
    yp[n_ + i] = state_.a[at(i)] / scale_[at(n_ + i)];
  }
  for (Index i = 0; i < nz_; ++i) {
    y[2 * n_ + i] = state_.z[at(i)] / scale_[at(2 * n_ + i)];
    yp[2 * n_ + i] = state_.zdot[at(i)] / scale_[at(2 * n_ + i)];
  }
  for (Index i = 0; i < rows_; ++i)
    y[2 * n_ + nz_ + i] = state_.lambda[at(partition_.rows[at(i)])] / scale_[at(2 * n_ + nz_ + i)];

  if (ida_ == nullptr) {
    ida_ = IDACreate(context_);
    if (ida_ == nullptr) throw std::bad_alloc();
    const auto residual = [](double time, N_Vector yy, N_Vector yyp, N_Vector out, void* self) {
      return guarded(self, [&](Integration& s) { return s.residual(time, data(yy), data(yyp), data(out)); });
    };
    check(IDAInit(ida_, residual, t, y_, yp_), "IDAInit");
    check(IDASetUserData(ida_, this), "IDASetUserData");
    // IDA reports through its return flags; its own printing would mix with ours.
    const auto silent = [](int, const char*, const char*, char*, void*) {};
    check(IDASetErrHandlerFn(ida_, silent, nullptr), "IDASetErrHandlerFn");
    const auto weigh = [](N_Vector yy, N_Vector weight, void* self) {
      return guarded(self, [&](Integration& s) {
        s.error_weights(data(yy), data(weight));
        return 0;
      });
    };
    check(IDAWFtolerances(ida_, weigh), "IDAWFtolerances");
    check(IDASetId(ida_, id_), "IDASetId");
    check(IDASetSuppressAlg(ida_, SUNTRUE), "IDASetSuppressAlg");
    check(IDASetLinearSolver(ida_, linear_solver_, matrix_), "IDASetLinearSolver");
    const auto jacobian = [](double time, double cj, N_Vector yy, N_Vector yyp, N_Vector, SUNMatrix J, void* self,
                             N_Vector, N_Vector, N_Vector) {
      return guarded(self, [&](Integration& s) { return s.jacobian(time, cj, data(yy), data(yyp), J); });
    };
    check(IDASetJacFn(ida_, jacobian), "IDASetJacFn");
    if (options_.max_step > 0.0) check(IDASetMaxStep(ida_, options_.max_step), "IDASetMaxStep");
  } else {
    count_statistics();
    check(IDAReInit(ida_, t, y_, yp_), "IDAReInit");
    ++statistics_.restarts;
  }
  check(IDASetInitStep(ida_, std::min(first_step, 1e-3 * (segment_end_ - t))), "IDASetInitStep");
  check(IDASetStopTime(ida_, segment_end_), "IDASetStopTime");
}

void Integration::count_statistics() {
  long steps = 0, residuals = 0, setups = 0, error_failures = 0, newton = 0, convergence = 0, jacobians = 0;
  int last_order = 0, order = 0;
  double first = 0.0, last = 0.0, current = 0.0, time = 0.0;
  IDAGetIntegratorStats(ida_, &steps, &residuals, &setups, &error_failures, &last_order, &order, &first, &last,
                        &current, &time);
  IDAGetNonlinSolvStats(ida_, &newton, &convergence);
  IDAGetNumJacEvals(ida_, &jacobians);
  statistics_.steps += steps;
  statistics_.residuals += residuals;
  statistics_.error_test_failures += error_failures;
  statistics_.newton_iterations += newton;
  statistics_.convergence_failures += convergence;
  statistics_.jacobians += jacobians;
}

void Integration::fail(int flag) {
  if (exception_) std::rethrow_exception(exception_);
  double step = 0.0;
  IDAGetLastStep(ida_, &step);
  std::string limiting;
  if (IDAGetErrWeights(ida_, weights_) == IDA_SUCCESS && IDAGetEstLocalErrors(ida_, errors_) == IDA_SUCCESS) {
    Index worst = 0;
    double largest = -1.0;
    for (Index i = 0; i < 2 * n_ + nz_; ++i) {
      const double size = std::abs(data(weights_)[i] * data(errors_)[i]);
      if (size > largest) {
        largest = size;
        worst = i;
      }
    }
    limiting = "; the step was limited by " + unknown_name(worst);
  }
  std::string why = "the integrator stopped (" + std::to_string(flag) + ")";
  if (flag == IDA_ERR_FAIL) why = "the error test failed again and again";
  if (flag == IDA_CONV_FAIL || flag == IDA_NLS_SETUP_FAIL || flag == IDA_LSETUP_FAIL)
    why = "Newton's method did not converge";
  if (flag == IDA_LSOLVE_FAIL || !singular_.empty()) why += ", the iteration matrix is singular at " + singular_;
  if (!trouble_.empty()) why += "; " + trouble_;
  throw AnalysisError(
      "simulate", "at t = " + digits(t_, 6) + " s with a step of " + digits(step, 6) + " s " + why + limiting,
      "a motion that can be continued",
      "look at that component just before this time; a mechanism may be passing a singular position, a volume or a length zero");
}

/// Output at t within the last step: interpolated, on the constraints, completed.
void Integration::emit(double t, const Observer& observer) {
  if (!observer.output) return;
  check(IDAGetDky(ida_, t, 0, shown_y_), "IDAGetDky");
  check(IDAGetDky(ida_, t, 1, shown_yp_), "IDAGetDky");
  load(t, data(shown_y_), data(shown_yp_));
  kkt_.complete(state_, blocks_);
  observer.output(state_);
}

Simulation Integration::run(const Observer& observer) {
  const auto clock = std::chrono::steady_clock::now();
  Simulation result;
  t_ = options_.from_time;
  const double end = options_.to_time;
  std::size_t next_listed = 0;
  long next_grid = 1;
  const auto& listed = options_.output_times;
  while (next_listed < listed.size() && listed[next_listed] <= t_) ++next_listed;
  const auto next_output = [&] {
    double next = next_listed < listed.size() ? listed[next_listed] : HUGE_VAL;
    if (options_.output_step > 0.0)
      next = std::min(next, options_.from_time + static_cast<double>(next_grid) * options_.output_step);
    return next;
  };
  const auto pass_output = [&](double t) {
    while (next_listed < listed.size() && listed[next_listed] <= t) ++next_listed;
    while (options_.output_step > 0.0 &&
           options_.from_time + static_cast<double>(next_grid) * options_.output_step <= t)
      ++next_grid;
  };
  const bool every_step = options_.output_step == 0.0 && listed.empty();

  bool running = true;
  while (t_ < end && running) {
    segment_end_ = std::min(end, next_breakpoint(system_, t_));
    begin_segment(t_);
    if (observer.output) observer.output(state_);  // the start, and the far side of every jump
    long steps = 0;
    while (t_ < segment_end_ && running) {
      const double before = t_;
      const int flag = IDASolve(ida_, segment_end_, &t_, y_, yp_, IDA_ONE_STEP);
      if (flag < 0) fail(flag);
      double step = 0.0;
      IDAGetLastStep(ida_, &step);
      if (!(t_ > before) || ++steps > most_steps_between_outputs) fail(IDA_TOO_MUCH_WORK);
      trouble_.clear();
      singular_.clear();
      load(t_, data(y_), data(yp_));
      const Violation violation = constraint_violation(system_, state_, blocks_);
      if (violation.position > statistics_.worst_position) {
        statistics_.worst_position = violation.position;
        statistics_.worst_position_row = system_.constraint(violation.position_row).name;
      }
      if (violation.velocity > statistics_.worst_velocity) {
        statistics_.worst_velocity = violation.velocity;
        statistics_.worst_velocity_row = system_.constraint(violation.velocity_row).name;
      }
      while (next_output() <= t_) {
        const double t = next_output();
        if (t < segment_end_) emit(t, observer);
        pass_output(t);
      }
      if (every_step && t_ < segment_end_) emit(t_, observer);
      if (t_ >= segment_end_) emit(t_, observer);
      running = !observer.progress || observer.progress(t_, step);
    }
    load(t_, data(y_), data(yp_));
  }
  count_statistics();
  statistics_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  result.statistics = statistics_;
  result.stopped = !running;
  kkt_.complete(state_, blocks_);
  result.last = state_;
  return result;
}

}  // namespace

Simulation simulate(const System& system, const SimulateOptions& options, const State& start,
                    const Observer& observer) {
  if (system.n() + system.nz() == 0)
    throw AnalysisError("simulate", "a scene without variables", "something that moves or stores", "add components");
  return Integration(system, options, start).run(observer);
}

}  // namespace bramah
