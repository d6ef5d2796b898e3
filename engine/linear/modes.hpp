// Modes of a reduced model in all variables of the machine, and where their energy is.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "linear/spectrum.hpp"

namespace bramah {

/// Nonzero modes, one column each, scaled as Spectrum::right. They satisfy all linearized equations: C_x x = 0, and
/// dx/dt = lambda x for coordinates.
struct ModeShapes {
  Eigen::MatrixXcd motion;    // (2n + nz x modes): x, v, z
  Eigen::MatrixXcd response;  // (n + rows + nz x modes): accelerations, multipliers of independent rows, rates
};
/// `motion` and `response` are those of the Linearizer.
ModeShapes mode_shapes(const Spectrum& spectrum, const Eigen::MatrixXd& motion, const Eigen::MatrixXd& response);

/// Energies in J and powers in W of one mode, means over a period where it oscillates, initial values where it does not:
/// each a sum over the blocks of a component. With s = 1/4 for a pair and 1/2 for a real mode
///
///   kinetic     s v^H f_a v                      f_a = M
///   potential   s x^H (f_x + l_x) x              with the geometric stiffness of constraint forces
///   pressure    s p^H g_zdot p                   first-order variables of kind "pressure"
///   dissipated  2 s (v^H f_v v + p^H g_z p)      W
///
/// Real parts are taken: what gyroscopic and circulatory terms carry from one half of a period to the other is no energy.
struct ModalEnergy {
  double kinetic = 0.0, potential = 0.0, pressure = 0.0, dissipated = 0.0;
};
struct ModalEnergies {
  std::vector<ModalEnergy> components;  // in the order of System::components
  ModalEnergy total;
};
/// One entry for each mode of `shapes`. `state` is the reference state of the model. Throws AnalysisError where a
/// component cannot be evaluated there.
std::vector<ModalEnergies> modal_energies(const System& system, const State& state, const Spectrum& spectrum,
                                          const ModeShapes& shapes);

}  // namespace bramah
