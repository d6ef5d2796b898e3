// Owners of what SUNDIALS hands out, and its linear solver interface over the engine's own factorizations.
#pragma once

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <exception>
#include <memory>
#include <new>
#include <string>

#include "system/analysis_error.hpp"
#include "system/system.hpp"

namespace bramah::sundials {

static_assert(sizeof(sunindextype) == sizeof(Index), "SUNDIALS and the engine index alike");

class Context {
 public:
  Context() {
    if (SUNContext_Create(nullptr, &context_) != 0) throw std::bad_alloc();
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  ~Context() { SUNContext_Free(&context_); }
  operator SUNContext() const { return context_; }  // NOLINT(google-explicit-constructor)

 private:
  SUNContext context_ = nullptr;
};

struct Destroy {
  void operator()(N_Vector v) const { N_VDestroy(v); }
  void operator()(SUNMatrix m) const { SUNMatDestroy(m); }
  void operator()(SUNLinearSolver s) const { SUNLinSolFree(s); }
};
using Vector = std::unique_ptr<_generic_N_Vector, Destroy>;
using Matrix = std::unique_ptr<_generic_SUNMatrix, Destroy>;
using LinearSolver = std::unique_ptr<_generic_SUNLinearSolver, Destroy>;

inline Vector make_vector(Index size, SUNContext context) { return Vector(N_VNew_Serial(size, context)); }
inline double* data(N_Vector v) { return NV_DATA_S(v); }
inline double* data(const Vector& v) { return NV_DATA_S(v.get()); }

/// A direct solver whose work `owner` does: int factor(SUNMatrix), int solve(N_Vector x, N_Vector b).
template <class Owner>
LinearSolver make_direct_solver(Owner* owner, SUNContext context) {
  LinearSolver solver(SUNLinSolNewEmpty(context));
  solver->content = owner;
  solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
  solver->ops->setup = [](SUNLinearSolver self, SUNMatrix matrix) {
    return static_cast<Owner*>(self->content)->factor(matrix);
  };
  solver->ops->solve = [](SUNLinearSolver self, SUNMatrix, N_Vector x, N_Vector b, realtype) {
    return static_cast<Owner*>(self->content)->solve(x, b);
  };
  solver->ops->free = [](SUNLinearSolver self) {
    SUNLinSolFreeEmpty(self);
    return 0;
  };
  return solver;
}

/// SUNDIALS reports through its return flags; its own printing would mix with ours.
inline void keep_silent(int, const char*, const char*, char*, void*) {}

/// A call that only a fault of the engine can make fail.
inline void check(int flag, const char* what) {
  if (flag >= 0) return;
  throw AnalysisError("simulate", std::string(what) + " failed with " + std::to_string(flag), "a working integrator",
                      "this is a fault of the engine");
}

}  // namespace bramah::sundials
