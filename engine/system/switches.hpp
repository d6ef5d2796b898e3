// The switching functions of all components: their zeros are kinks of laws, where derivatives are one-sided and
// integrators restart.
#pragma once

#include <string>
#include <vector>

#include "system/state_functions.hpp"

namespace bramah {

class Switches {
 public:
  struct Info {
    Index component = 0;
    std::string name;      // "spool_centre"
    double nominal = 1.0;  // typical magnitude
  };
  explicit Switches(const System& system);

  [[nodiscard]] const std::vector<Info>& info() const { return info_; }
  /// Values at t, side, x, v, z and inputs of `state`, in the order of `info`; NaN where a component cannot tell.
  const Vector& evaluate(const State& state) { return functions_.evaluate(state); }

 private:
  StateFunctions<bramah_switches> functions_;
  std::vector<Info> info_;
};

}  // namespace bramah
