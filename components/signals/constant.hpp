// A signal that stays what it is.
#pragma once

#include <bramah/component.hpp>
#include <string>

namespace bramah::signals {

struct Constant {
  std::string unit;
  Parameter level = 0.0;

  void describe(Description& is) {
    is.called("signals/constant", "a constant signal");
    is.parameter("unit", unit).by_default("1").doc("unit of the signal");
    is.parameter("value", level, "@unit").doc("the value");
    is.provide_signal<Input>("value", "@unit", "the value");
  }
  [[nodiscard]] Parameter signal(double, int) const { return level; }
  [[nodiscard]] double next_breakpoint(double) const { return HUGE_VAL; }
};

}  // namespace bramah::signals
