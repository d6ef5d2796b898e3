// How eigenvalues move with the numbers of a scene, exactly: d(lambda) = w^H dA v for w^H v = 1, where dA counts the motion
// of the reference state as well.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <string>
#include <vector>

#include "linear/spectrum.hpp"
#include "system/options.hpp"
#include "system/scene_number.hpp"

namespace bramah {

/// What the reference state does while a number changes.
enum class Follows {
  equilibrium,  // it stays an equilibrium; held variables follow their start values
  start         // x_ai, v_ai, x_ad and z follow their start values, everything else follows from them
};

struct Sensitivity {
  SceneNumber number;
  /// d(lambda)/d(number) of each nonzero mode, in SI and in the order of Spectrum::modes. Those of equal eigenvalues are
  /// derivatives of the set, in no order; NaN where they have fewer vectors than copies and no derivative exists.
  std::vector<std::complex<double>> eigenvalues;
  /// d(mean)/d(number) of each of Spectrum::defective.
  std::vector<std::complex<double>> means;
  /// The largest change of any nonzero eigenvalue, or mean of a defective group, relative to it, per relative change of the number.
  double importance = 0.0;
};

/// After `linearizer.linearize(state, model)` and with its spectrum.
Sensitivity find_sensitivity(const System& system, const EquilibriumOptions& options, Follows follows,
                             const State& state, Linearizer& linearizer, const Spectrum& spectrum,
                             const SceneNumber& number);

}  // namespace bramah
