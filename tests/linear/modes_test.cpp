// Mode shapes in all variables, and energies by component, against closed forms.
#include "linear/modes.hpp"

#include <gtest/gtest.h>

#include "io/read_scene.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

struct Modal {
  explicit Modal(Machine loaded) : machine(std::move(loaded)) {
    const Options& options = machine.options();
    state = reference_state(machine.system(), options, options.linearize.at == LinearizeOptions::At::equilibrium, 0.0);
    partition = choose_partition(machine.system(), state, options.linearize.prescribed);
    Linearizer linearizer(machine.system(), partition);
    LinearModel model;
    linearizer.linearize(state, model);
    spectrum = find_spectrum(model);
    shapes = mode_shapes(spectrum, linearizer.motion(), linearizer.response());
    energies = modal_energies(machine.system(), state, spectrum, shapes);
  }
  [[nodiscard]] const ModalEnergy& of(std::size_t mode, const std::string& component) const {
    const std::vector<Component>& all = machine.system().components;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].name == component) return energies[mode].components[k];
    }
    throw std::runtime_error("no component " + component);
  }
  Machine machine;
  State state;
  Partition partition;
  Spectrum spectrum;
  ModeShapes shapes;
  std::vector<ModalEnergies> energies;
};

Machine made(const std::string& components) {
  Scene scene = read_scene_text(
      R"({ "bramah": 1, "libraries": ["mechanics"], "linearize": { "at": "start" }, "components": )" + components + "}",
      "made");
  Compiled compiled = compile(scene, registry());
  return {std::move(scene), std::move(compiled)};
}

TEST(Energies, OfTwoMassesInAChain) {
  // Wall, k, m, k, m, k, wall: w^2 = k/m with both masses in step, 3 k/m against one another.
  const Modal chain(
      made(R"({ "a": { "type": "mechanics/mass", "mass": 2 }, "b": { "type": "mechanics/mass", "mass": 2 },
    "left": { "type": "mechanics/spring_damper", "to": "a", "stiffness": 50 },
    "middle": { "type": "mechanics/spring_damper", "from": "a", "to": "b", "stiffness": 50 },
    "right": { "type": "mechanics/spring_damper", "to": "b", "stiffness": 50 } })"));
  ASSERT_EQ(chain.energies.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const ModalEnergy& total = chain.energies[k].total;
    const double w = std::abs(chain.spectrum.modes[k].eigenvalue.imag());
    const bool in_step = w < 6.0;
    EXPECT_TRUE(close(w, in_step ? 5.0 : std::sqrt(75.0), 1e-13));
    EXPECT_GT(total.kinetic, 0.0);
    EXPECT_TRUE(close(total.potential, total.kinetic, 1e-12));
    for (const char* mass : {"a", "b"}) EXPECT_TRUE(close(chain.of(k, mass).kinetic, 0.5 * total.kinetic, 1e-12));
    // Stretched by 1, 0, 1 or by 1, 2, 1.
    const double outer = in_step ? 0.5 : 1.0 / 6.0;
    for (const char* spring : {"left", "right"})
      EXPECT_TRUE(close(chain.of(k, spring).potential, outer * total.potential, 1e-12));
    EXPECT_TRUE(close(chain.of(k, "middle").potential, (1.0 - 2.0 * outer) * total.potential, 1e-12, total.potential));
    EXPECT_LT(std::abs(total.dissipated), 1e-12 * w * total.kinetic);
  }
}

TEST(Energies, DissipationIsTheDecay) {
  // Power = -2 Re(lambda) energy, for a pair and for real modes, kinetic and potential energy together.
  for (const char* damping : {"0.3", "4", "30"}) {
    const Modal one(made(R"({ "m": { "type": "mechanics/mass", "mass": 2 },
      "k": { "type": "mechanics/spring_damper", "to": "m", "stiffness": 8, "damping": )" +
                         std::string(damping) + "} }"));
    for (std::size_t k = 0; k < 2; ++k) {
      const ModalEnergy& total = one.energies[k].total;
      const double rate = one.spectrum.modes[k].eigenvalue.real();
      EXPECT_TRUE(close(total.dissipated, -2.0 * rate * (total.kinetic + total.potential), 1e-12)) << damping;
      EXPECT_TRUE(close(one.of(k, "k").dissipated, total.dissipated, 1e-15));
    }
  }
}

TEST(Energies, BalanceWithPressures) {
  // Mechanical and pressure energy feed one another through the piston; what is lost is the decay of their sum.
  for (const char* scene : {"scenes/four_bar/underdamped_low_friction.json", "scenes/four_bar/spatial.json"}) {
    const Modal machine(load(scene));
    for (std::size_t k = 0; k < machine.energies.size(); ++k) {
      const ModalEnergy& total = machine.energies[k].total;
      const std::complex<double> value = machine.spectrum.modes[k].eigenvalue;
      if (value.imag() == 0.0) continue;
      const double sum = total.kinetic + total.potential + total.pressure;
      EXPECT_GT(total.pressure, 0.05 * sum);
      EXPECT_TRUE(close(total.dissipated, -2.0 * value.real() * sum, 1e-6, 1e-3 * std::abs(value) * sum)) << scene;
    }
  }
}

TEST(Shapes, SatisfyTheConstraints) {
  for (const char* scene :
       {"scenes/four_bar/overdamped.json", "scenes/four_bar/spatial.json", "scenes/linear/sleeping_top.json"}) {
    const Modal machine(load(scene));
    const System& system = machine.machine.system();
    Blocks blocks(system);
    ASSERT_TRUE(blocks.evaluate(system, machine.state, Request{}.blocks({BRAMAH_C_X, BRAMAH_R_X, BRAMAH_R_V})).ok());
    const std::vector<Index> c = shifted(system.m(), 0), x = shifted(system.n(), 0);
    const Term term{BRAMAH_C_X, c, x, false, 0};
    SparsePlan plan(system, system.m(), system.n(), {&term, 1});
    const double one = 1.0;
    plan.fill(blocks, {&one, 1});
    for (Eigen::Index k = 0; k < machine.shapes.motion.cols(); ++k) {
      const Eigen::VectorXcd shape = machine.shapes.motion.col(k).head(system.n());
      Eigen::VectorXcd rows = Eigen::VectorXcd::Zero(system.m());
      double scale = 0.0;
      for (Index j = 0; j < system.n(); ++j) {
        for (Index e = plan.start()[static_cast<std::size_t>(j)]; e < plan.start()[static_cast<std::size_t>(j) + 1];
             ++e) {
          const auto entry = static_cast<std::size_t>(e);
          rows(plan.row()[entry]) += plan.values()[entry] * shape(j);
          scale = std::max(scale, std::abs(plan.values()[entry] * shape(j)));
        }
      }
      EXPECT_LT(rows.cwiseAbs().maxCoeff(), 1e-13 * std::max(scale, 1e-300)) << scene;
      // Velocities and accelerations of all coordinates follow from the positions by the eigenvalue. Vectors are known
      // to rounding of their largest component, which is 1 in nominals and may be a pressure.
      const std::complex<double> value = machine.spectrum.modes[static_cast<std::size_t>(k)].eigenvalue;
      const Eigen::VectorXcd v = machine.shapes.motion.col(k).segment(system.n(), system.n());
      const Eigen::VectorXcd a = machine.shapes.response.col(k).head(system.n());
      EXPECT_LT((v - value * shape).norm(), 1e-9 * v.norm() + 1e-14 * std::abs(value)) << scene << " " << value;
      EXPECT_LT((a - value * v).norm(), 1e-9 * a.norm() + 1e-14 * std::norm(value)) << scene << " " << value;
    }
  }
}

}  // namespace
}  // namespace bramah::testing
