#include "solve/integrator.hpp"

#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

const Variable* variable(const System& system, Index i) {
  const Index n = system.n();
  if (i < 0 || i >= 2 * n + system.nz()) return nullptr;
  return i < 2 * n ? &system.x[static_cast<std::size_t>(i % n)] : &system.z[static_cast<std::size_t>(i - 2 * n)];
}

}  // namespace

IntegratorWork& IntegratorWork::operator+=(const IntegratorWork& other) {
  steps += other.steps;
  evaluations += other.evaluations;
  jacobians += other.jacobians;
  factorizations += other.factorizations;
  newton_iterations += other.newton_iterations;
  error_test_failures += other.error_test_failures;
  convergence_failures += other.convergence_failures;
  imprecise += other.imprecise;
  return *this;
}

std::string variable_name(const System& system, Index i) {
  const Variable* found = variable(system, i);
  if (found == nullptr) return "an unknown";
  return i >= system.n() && i < 2 * system.n() ? found->name + ".rate" : found->name;
}

std::string variable_component(const System& system, Index i) {
  const Variable* found = variable(system, i);
  return found == nullptr ? "" : system.component_name(found->component);
}

AnalysisError stalled(const System& system, double t, double step, std::string why, const std::string& trouble,
                      Index limiting) {
  if (!trouble.empty()) why += "; " + trouble;
  if (limiting >= 0) why += "; the step was limited by " + variable_name(system, limiting);
  const std::string component = variable_component(system, limiting);
  return {
      "simulate", "at t = " + digits(t, 6) + " s with a step of " + digits(step, 6) + " s " + why,
      "a motion that can be continued",
      "look at that component just before this time; a mechanism may be passing a singular position, a volume or a length zero",
      component.empty() ? "" : pointer("/components", component)};
}

}  // namespace bramah
