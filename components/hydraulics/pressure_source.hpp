// A supply or a tank: a pressure that stays what it is, whatever flows.
//
//   p   Pa
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

struct PressureSource {
  Parameter p = 1e5;

  void describe(Description& is) {
    is.called("hydraulics/pressure_source", "a constant pressure: a pump, an accumulator or a tank");
    is.parameter("p", p, "Pa").typical(1e4, 1e9).doc("the pressure");
    is.provide_signal<Pressure>("p", "Pa", "the pressure");
  }
  [[nodiscard]] Parameter signal(double, int) const { return p; }
  [[nodiscard]] double next_breakpoint(double) const { return HUGE_VAL; }
};

}  // namespace bramah::hydraulics
