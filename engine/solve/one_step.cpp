// One-step methods of ARKODE on the index-1 form, each step projected onto the constraints: what happens at one step is
// forgotten at the next, so that a mechanism stays on its branch through singular positions, and restarts cost nothing.
//   explicit: Dormand-Prince 5(4)    implicit: ESDIRK 4(3), L-stable and stiffly accurate
#include <arkode/arkode_arkstep.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

#include "solve/integrator.hpp"
#include "solve/rates.hpp"
#include "solve/scaled_state.hpp"
#include "solve/sundials.hpp"

namespace bramah {
namespace {

using sundials::check;
using sundials::data;

/// Interpolation through the states at the ends of the last steps. On slow motions of a stiff system it is smooth where
/// slopes are not: they hold the error of a fast variable times its rate.
class EndsOfSteps {
 public:
  static constexpr std::size_t most = 5;

  void clear() { count_ = 0; }
  void add(double t, const double* y, std::size_t size) {
    std::rotate(times_.begin(), times_.end() - 1, times_.end());
    std::rotate(states_.begin(), states_.end() - 1, states_.end());
    times_[0] = t;
    states_[0].assign(y, y + size);
    count_ = std::min(count_ + 1, most);
  }
  /// Whether there are enough of them for a cubic.
  [[nodiscard]] bool enough() const { return count_ >= 4; }
  void interpolate(double t, double* y) const {
    for (std::size_t i = 0; i < states_[0].size(); ++i) y[i] = 0.0;
    for (std::size_t k = 0; k < count_; ++k) {
      double weight = 1.0;
      for (std::size_t j = 0; j < count_; ++j) {
        if (j != k) weight *= (t - times_[j]) / (times_[k] - times_[j]);
      }
      for (std::size_t i = 0; i < states_[k].size(); ++i) y[i] += weight * states_[k][i];
    }
  }

 private:
  std::size_t count_ = 0;
  std::array<double, most> times_{};  // the latest first
  std::array<Vector, most> states_;
};

class OneStep final : public Integrator {
 public:
  OneStep(const System& system, const SimulateOptions& options, const State& start, bool implicit)
      : system_(system),
        options_(options),
        implicit_(implicit),
        scaled_(system, options.rel_tol),
        rates_(system, start),
        state_(start) {
    for (sundials::Vector* v : {&y_, &weights_, &errors_}) *v = sundials::make_vector(scaled_.size(), context_);
    correction_.resize(static_cast<std::size_t>(scaled_.size()));
    if (implicit_) make_solver();
  }
  ~OneStep() override { ARKStepFree(&ark_); }

  [[nodiscard]] std::string_view name() const override { return implicit_ ? "implicit" : "explicit"; }
  void begin(const State& state, double end) override;
  double step() override;
  void interpolate(double t, State& state) override;
  [[nodiscard]] Index limiting() override;
  [[nodiscard]] IntegratorWork work() const override;

  int factor(SUNMatrix matrix);
  int solve(N_Vector x, N_Vector b);

 private:
  void make_solver();
  void create();
  void load(double t, const double* y, State& state) const;
  [[noreturn]] void fail(int flag);
  /// No exception crosses ARKODE. An AnalysisError asks for a smaller step; others wait until ARKStepEvolve has returned.
  template <class Function>
  static int guarded(void* self, Function&& function) noexcept {
    auto* method = static_cast<OneStep*>(self);
    try {
      function(*method);
      return 0;
    } catch (const AnalysisError& error) {
      method->trouble_ = error.found();
      return 1;
    } catch (...) {
      method->exception_ = std::current_exception();
      return -1;
    }
  }

  const System& system_;
  SimulateOptions options_;
  bool implicit_;
  ScaledState scaled_;
  Rates rates_;
  State state_;
  sundials::Context context_;
  sundials::Vector y_, weights_, errors_;
  sundials::Matrix matrix_;
  sundials::LinearSolver linear_solver_;
  void* ark_ = nullptr;
  double t_ = 0.0, end_ = 0.0, gamma_ = 0.0;
  Vector correction_;
  EndsOfSteps ends_;  // of the implicit method
  long jacobians_ = 0, factorizations_ = 0;
  std::string trouble_, singular_;
  std::exception_ptr exception_;
};

/// The matrix is never formed: ARKODE gets one without entries, and the solver works with Rates.
void OneStep::make_solver() {
  matrix_.reset(SUNMatNewEmpty(context_));
  matrix_->ops->getid = [](SUNMatrix) { return SUNMATRIX_CUSTOM; };
  matrix_->ops->zero = [](SUNMatrix) { return 0; };
  matrix_->ops->clone = [](SUNMatrix m) {
    SUNMatrix copy = SUNMatNewEmpty(m->sunctx);
    SUNMatCopyOps(m, copy);
    return copy;
  };
  matrix_->ops->destroy = [](SUNMatrix m) { SUNMatFreeEmpty(m); };
  linear_solver_ = sundials::make_direct_solver(this, context_);
}

int OneStep::factor(SUNMatrix) {
  ++factorizations_;
  if (rates_.factor(gamma_)) return 0;
  singular_ = rates_.singular();
  return 1;
}

int OneStep::solve(N_Vector x, N_Vector b) {
  const Vector& scale = scaled_.scale();
  for (std::size_t i = 0; i < scale.size(); ++i) correction_[i] = data(b)[i] * scale[i];
  rates_.solve(correction_);
  for (std::size_t i = 0; i < scale.size(); ++i) data(x)[i] = correction_[i] / scale[i];
  return 0;
}

void OneStep::load(double t, const double* y, State& state) const {
  state.t = t;
  state.side = t >= end_ ? -1 : 1;
  scaled_.unpack(y, state);
  apply_inputs(system_, state);
}

void OneStep::create() {
  const auto rates = [](double t, N_Vector y, N_Vector yp, void* self) {
    return guarded(self, [&](OneStep& method) {
      method.load(t, data(y), method.state_);
      method.rates_.evaluate(method.state_);
      method.scaled_.pack_rates(method.state_, data(yp));
    });
  };
  const auto project = [](double t, N_Vector y, void* self) {
    return guarded(self, [&](OneStep& method) {
      method.load(t, data(y), method.state_);
      method.rates_.project(method.state_);
      method.scaled_.pack(method.state_, data(y));
    });
  };
  const auto weigh = [](N_Vector y, N_Vector weight, void* self) {
    return guarded(self, [&](OneStep& method) { method.scaled_.weigh(data(y), data(weight)); });
  };
  ark_ = implicit_ ? ARKStepCreate(nullptr, rates, t_, y_.get(), context_)
                   : ARKStepCreate(rates, nullptr, t_, y_.get(), context_);
  if (ark_ == nullptr) throw std::bad_alloc();
  check(ARKStepSetUserData(ark_, this), "ARKStepSetUserData");
  check(ARKStepSetErrHandlerFn(ark_, sundials::keep_silent, nullptr), "ARKStepSetErrHandlerFn");
  check(ARKStepWFtolerances(ark_, weigh), "ARKStepWFtolerances");
  check(ARKStepSetPostprocessStepFn(ark_, project), "ARKStepSetPostprocessStepFn");
  check(ARKStepSetMaxNumSteps(ark_, -1), "ARKStepSetMaxNumSteps");
  if (options_.max_step > 0.0) check(ARKStepSetMaxStep(ark_, options_.max_step), "ARKStepSetMaxStep");
  if (!implicit_) {
    check(ARKStepSetTableNum(ark_, ARKODE_DIRK_NONE, ARKODE_DORMAND_PRINCE_7_4_5), "ARKStepSetTableNum");
    return;
  }
  const auto linearize = [](double t, N_Vector y, N_Vector, SUNMatrix, SUNMatrix, booleantype reuse, booleantype* fresh,
                            double gamma, void* self, N_Vector, N_Vector, N_Vector) {
    return guarded(self, [&](OneStep& method) {
      method.gamma_ = gamma;
      *fresh = reuse == SUNTRUE ? SUNFALSE : SUNTRUE;
      if (reuse == SUNTRUE) return;
      method.load(t, data(y), method.state_);
      method.rates_.linearize(method.state_);
      ++method.jacobians_;
    });
  };
  check(ARKStepSetTableNum(ark_, ARKODE_ARK436L2SA_DIRK_6_3_4, ARKODE_ERK_NONE), "ARKStepSetTableNum");
  check(ARKStepSetInterpolantDegree(ark_, 3), "ARKStepSetInterpolantDegree");
  check(ARKStepSetLinearSolver(ark_, linear_solver_.get(), matrix_.get()), "ARKStepSetLinearSolver");
  check(ARKStepSetLinSysFn(ark_, linearize), "ARKStepSetLinSysFn");
  // Partials cost less than the steps that fail with old ones.
  check(ARKStepSetJacEvalFrequency(ark_, 1), "ARKStepSetJacEvalFrequency");
  check(ARKStepSetMaxNonlinIters(ark_, 6), "ARKStepSetMaxNonlinIters");
}

void OneStep::begin(const State& state, double end) {
  state_ = state;
  t_ = state.t;
  end_ = end;
  scaled_.pack(state, data(y_));
  if (ark_ == nullptr) {
    create();
  } else {
    check(ARKStepReset(ark_, t_, y_.get()), "ARKStepReset");
  }
  check(ARKStepSetStopTime(ark_, end), "ARKStepSetStopTime");
  ends_.clear();
  if (implicit_) ends_.add(t_, data(y_), correction_.size());
}

double OneStep::step() {
  const double before = t_;
  const int flag = ARKStepEvolve(ark_, end_, y_.get(), &t_, ARK_ONE_STEP);
  if (flag < 0) fail(flag);
  if (!(t_ > before)) fail(ARK_TOO_MUCH_WORK);
  trouble_.clear();
  singular_.clear();
  if (implicit_) ends_.add(t_, data(y_), correction_.size());
  return t_;
}

void OneStep::interpolate(double t, State& state) {
  if (t == t_) {
    load(t, data(y_), state);
    return;
  }
  if (ends_.enough()) {
    ends_.interpolate(t, data(weights_));
  } else {
    check(ARKStepGetDky(ark_, t, 0, weights_.get()), "ARKStepGetDky");
  }
  load(t, data(weights_), state);
}

Index OneStep::limiting() {
  if (ARKStepGetErrWeights(ark_, weights_.get()) != ARK_SUCCESS) return -1;
  if (ARKStepGetEstLocalErrors(ark_, errors_.get()) != ARK_SUCCESS) return -1;
  return scaled_.worst(data(weights_), data(errors_));
}

IntegratorWork OneStep::work() const {
  IntegratorWork sum;
  sum.jacobians = jacobians_;
  if (ark_ == nullptr) return sum;
  long steps = 0, explicit_rates = 0, implicit_rates = 0, error_failures = 0, newton = 0, convergence = 0;
  ARKStepGetNumSteps(ark_, &steps);
  ARKStepGetNumRhsEvals(ark_, &explicit_rates, &implicit_rates);
  ARKStepGetNumErrTestFails(ark_, &error_failures);
  sum.steps = steps;
  sum.evaluations = explicit_rates + implicit_rates;
  sum.factorizations = sum.evaluations + factorizations_;  // a KKT matrix for every evaluation of rates
  sum.error_test_failures = error_failures;
  sum.imprecise = rates_.imprecise();
  if (implicit_) {
    ARKStepGetNonlinSolvStats(ark_, &newton, &convergence);
    sum.newton_iterations = newton;
    sum.convergence_failures = convergence;
  }
  return sum;
}

void OneStep::fail(int flag) {
  if (exception_) std::rethrow_exception(exception_);
  double step = 0.0;
  ARKStepGetLastStep(ark_, &step);
  std::string why = "the integrator stopped (" + std::to_string(flag) + ")";
  if (flag == ARK_ERR_FAILURE) why = "the error test failed again and again";
  if (flag == ARK_CONV_FAILURE || flag == ARK_LSETUP_FAIL) why = "Newton's method did not converge";
  if (flag == ARK_POSTPROCESS_STEP_FAIL) why = "the step could not be brought back onto the constraints";
  if (flag == ARK_TOO_MUCH_WORK) why = "the step has become too small";
  if (!singular_.empty()) why += ", the iteration matrix is singular at " + singular_;
  throw stalled(system_, t_, step, why, trouble_, limiting());
}

}  // namespace

std::unique_ptr<Integrator> make_explicit(const System& system, const SimulateOptions& options, const State& start) {
  return std::make_unique<OneStep>(system, options, start, false);
}
std::unique_ptr<Integrator> make_implicit(const System& system, const SimulateOptions& options, const State& start) {
  return std::make_unique<OneStep>(system, options, start, true);
}

}  // namespace bramah
