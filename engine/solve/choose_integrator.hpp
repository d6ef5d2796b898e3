// Which integrator marches: the one that the scene names, or the one that suits the stiffness seen at the start.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "solve/integrator.hpp"

namespace bramah {

struct ChosenIntegrator {
  std::unique_ptr<Integrator> integrator;
  std::string reason;  // empty where the scene names it
};

/// With "auto": the explicit method marches a little way from `start`; where its steps are bounded by stability rather
/// than by accuracy, the problem is stiff for it, and IDA takes over.
ChosenIntegrator choose_integrator(const System& system, const SimulateOptions& options, const State& start);

/// The method of this name; automatic for an unknown one.
SimulateOptions::Integrator integrator_called(std::string_view name);

}  // namespace bramah
