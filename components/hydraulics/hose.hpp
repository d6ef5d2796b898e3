// A hose: adds its share of V / B_e, Eq. (2), to the balance of a volume.
//
//   K = V_h (kappa(p) + 1 / B_h)   m^3/Pa   kappa = 1 / B_oil, with air and vapour: see oil.hpp
//
//   V_h     m^3   volume of the hose
//   B_h     Pa    bulk modulus of its wall
//   B_oil   Pa    bulk modulus of the oil
//   air     1     share of free air
#pragma once

#include <bramah/component.hpp>

#include "oil.hpp"

namespace bramah::hydraulics {

struct Hose {
  Pressure volume;
  Parameter V_h = 1e-5, B_h = 1e9, B_oil = 1e9, air = 0.0;

  void describe(Description& is) {
    is.called("hydraulics/hose", "an elastic hose full of oil, Eq. (2)");
    is.port("volume", volume, "the volume it is part of", "Pa");
    is.parameter("V_h", V_h, "m^3").above(0.0).typical(1e-8, 10.0).doc("volume of the hose");
    is.parameter("B_h", B_h, "Pa").above(0.0).typical(1e6, 1e13).doc("bulk modulus of its wall");
    is.parameter("B_oil", B_oil, "Pa").above(0.0).typical(1e8, 1e10).doc("bulk modulus of the oil");
    describe_air(is, air);
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.store(volume, T(V_h * (1.0 / B_oil + 1.0 / B_h) + V_h * gas_compliance(at(volume), air)));
  }
  template <class T>
  T energy(const At<T>& at) const {
    return storage_energy(at, volume, V_h * (1.0 / B_oil + 1.0 / B_h)) + V_h * gas_energy(at(volume), air);
  }
};

}  // namespace bramah::hydraulics
