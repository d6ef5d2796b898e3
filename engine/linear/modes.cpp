#include "linear/modes.hpp"

#include "system/analysis_error.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

using Eigen::VectorXcd;
using Complex = std::complex<double>;

/// Re(w^H B v) of a block of one instance with its local vectors.
double form(const BlockPattern& pattern, const double* values, const VectorXcd& w, const VectorXcd& v) {
  double sum = 0.0;
  for (Index j = 0; j < pattern.columns; ++j) {
    const auto column = static_cast<std::size_t>(j);
    for (std::int32_t e = pattern.start[column]; e < pattern.start[column + 1]; ++e) {
      const auto row = static_cast<Eigen::Index>(pattern.row[static_cast<std::size_t>(e)]);
      sum += values[e] * (std::conj(w(row)) * v(static_cast<Eigen::Index>(j))).real();
    }
  }
  return sum;
}

/// One mode, cut into the local vectors of instances.
class Cut {
 public:
  Cut(const System& system, VectorXcd mode) : system_(system), mode_(std::move(mode)) {}

  [[nodiscard]] VectorXcd x(const Group& group, Index instance) const {
    return local(group.x, group.type->nx, instance, system_.n(), 0);
  }
  [[nodiscard]] VectorXcd v(const Group& group, Index instance) const {
    return local(group.x, group.type->nx, instance, system_.n(), system_.n());
  }
  /// Zero where a variable is no pressure.
  [[nodiscard]] VectorXcd pressures(const Group& group, Index instance) const {
    VectorXcd z = local(group.z, group.type->nz, instance, system_.nz(), 2 * system_.n());
    for (Index j = 0; j < group.type->nz; ++j) {
      const Index at = group.z[static_cast<std::size_t>(instance * group.type->nz + j)];
      if (at < system_.nz() && system_.z[static_cast<std::size_t>(at)].kind != "pressure") z(j) = 0.0;
    }
    return z;
  }

 private:
  /// Inputs and constants do not move.
  [[nodiscard]] VectorXcd local(const std::vector<std::int32_t>& map, std::int32_t slots, Index instance, Index count,
                                Index offset) const {
    VectorXcd result = VectorXcd::Zero(slots);
    for (std::int32_t j = 0; j < slots; ++j) {
      const Index at = map[static_cast<std::size_t>(instance * slots + j)];
      if (at < count) result(j) = mode_(offset + at);
    }
    return result;
  }

  const System& system_;
  VectorXcd mode_;
};

}  // namespace

ModeShapes mode_shapes(const Spectrum& spectrum, const Eigen::MatrixXd& motion, const Eigen::MatrixXd& response) {
  const Eigen::Index states = spectrum.right.rows(), inputs = motion.cols() - states;
  const Eigen::MatrixXcd modes = spectrum.right.leftCols(spectrum.left.cols());
  return {motion.topLeftCorner(motion.rows() - inputs, states) * modes, response.leftCols(states) * modes};
}

std::vector<ModalEnergies> modal_energies(const System& system, const State& state, const Spectrum& spectrum,
                                          const ModeShapes& shapes) {
  Blocks blocks(system);
  const Outcome outcome = blocks.evaluate(
      system, state, Request{}.blocks({BRAMAH_F_X, BRAMAH_F_V, BRAMAH_F_A, BRAMAH_L_X, BRAMAH_G_Z, BRAMAH_G_ZDOT}));
  if (!outcome.ok()) {
    throw AnalysisError("modes", outcome.message, "a state at which every component can be evaluated",
                        "linearize elsewhere",
                        outcome.component < 0 ? "" : pointer("/components", system.component_name(outcome.component)));
  }
  std::vector<ModalEnergies> energies;
  for (Eigen::Index k = 0; k < shapes.motion.cols(); ++k) {
    const Cut cut(system, shapes.motion.col(k));
    const double s = spectrum.modes[static_cast<std::size_t>(k)].eigenvalue.imag() != 0.0 ? 0.25 : 0.5;
    ModalEnergies mode;
    mode.components.resize(system.components.size());
    for (std::size_t g = 0; g < system.groups.size(); ++g) {
      const Group& group = system.groups[g];
      for (Index i = 0; i < group.count; ++i) {
        const VectorXcd x = cut.x(group, i), v = cut.v(group, i), p = cut.pressures(group, i);
        const auto of_block = [&](int block, const VectorXcd& vector) {
          const BlockPattern& pattern = group.patterns[static_cast<std::size_t>(block)];
          const std::size_t count = pattern.row.size();
          if (count == 0) return 0.0;
          return form(pattern, blocks.block(g, block).data() + static_cast<std::size_t>(i) * count, vector, vector);
        };
        ModalEnergy& energy = mode.components[static_cast<std::size_t>(group.component[static_cast<std::size_t>(i)])];
        energy.kinetic += s * of_block(BRAMAH_F_A, v);
        energy.potential += s * (of_block(BRAMAH_F_X, x) + of_block(BRAMAH_L_X, x));
        energy.pressure += s * of_block(BRAMAH_G_ZDOT, p);
        energy.dissipated += 2.0 * s * (of_block(BRAMAH_F_V, v) + of_block(BRAMAH_G_Z, p));
      }
    }
    for (const ModalEnergy& energy : mode.components) {
      mode.total.kinetic += energy.kinetic;
      mode.total.potential += energy.potential;
      mode.total.pressure += energy.pressure;
      mode.total.dissipated += energy.dissipated;
    }
    energies.push_back(std::move(mode));
  }
  return energies;
}

}  // namespace bramah
