// Every integrator, for tests that run with each of them.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "system/options.hpp"

namespace bramah::support {

struct Method {
  SimulateOptions::Integrator kind;
  const char* name;
  double step;  // of the fixed-step method
};

inline constexpr Method methods[] = {{SimulateOptions::Integrator::ida, "ida", 0.0},
                                     {SimulateOptions::Integrator::explicit_one_step, "explicit", 0.0},
                                     {SimulateOptions::Integrator::implicit_one_step, "implicit", 0.0},
                                     {SimulateOptions::Integrator::generalized_alpha, "generalized_alpha", 1e-3}};
inline constexpr Method automatic = {SimulateOptions::Integrator::automatic, "auto", 0.0};

inline std::string name_of(const ::testing::TestParamInfo<Method>& info) { return info.param.name; }

inline SimulateOptions with(SimulateOptions options, const Method& method) {
  options.integrator = method.kind;
  options.step = method.step;
  return options;
}

}  // namespace bramah::support
