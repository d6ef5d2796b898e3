// What every restriction between two volumes shares; `flow` of the law gives Q, m^3/s, from a to b.
#pragma once

#include <bramah/component.hpp>

namespace bramah::hydraulics {

/// Takes Q from a and gives it to b.
template <class Law>
struct Resistor {
  Pressure a, b;
  Output flow_out;

  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const T Q = static_cast<const Law*>(this)->flow(at);
    rows.inflow(a, -Q);
    rows.inflow(b, Q);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(flow_out) = static_cast<const Law*>(this)->flow(at);
  }
};

}  // namespace bramah::hydraulics
