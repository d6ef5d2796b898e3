// Numbers of a scene by name, as derivatives are taken with respect to them, and what each of them drives.
//
//   component.parameter      a parameter that is one number
//   component.parameter.k    element k of a vector or list, from 0
//   constants.name           every parameter and start value that is written "=name"
//   start.variable           a start value that the scene gives; start.variable.rate that of a rate
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "system/system.hpp"

namespace bramah {

struct SceneNumber {
  std::string name;
  double value = 0.0;                    // SI
  std::string unit;                      // of what it drives
  std::vector<ParameterRef> parameters;  // all exactly differentiable
  std::vector<StartRef> starts;
};

/// The number called `name`. AnalysisError where there is none, where it is a text or a choice, where it drives nothing,
/// and where a type keeps it in something else than a bramah::Parameter.
SceneNumber find_number(const System& system, std::string_view name);

/// All that find_number finds: constants, parameters in the order of the scene, start values that the scene gives. What is
/// written "=name" counts once, as its constant.
std::vector<SceneNumber> differentiable_numbers(const System& system);

}  // namespace bramah
