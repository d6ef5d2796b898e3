// Away from equilibrium: phi2 = 40 deg, in motion, p1 != p2, U != 0. Three models, one Jacobian; and the Jacobian is the
// derivative of the reduced right-hand side.
#include <gtest/gtest.h>

#include "four_bar.hpp"
#include "solve/assemble.hpp"
#include "solve/kkt.hpp"
#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double rate = 0.2;  // rad/s

Machine moving(const FourBar& model) {
  std::vector<std::string> settings = {"start.V1.p=3.1e6", "start.V2.p=2.6e6", "start.V3.p=3.3e6",
                                       "start.valve.U=0.35"};
  const double angle = 40.0 * degree;
  const auto set = [&](const std::string& name, double value) {
    char text[100];
    std::snprintf(text, sizeof text, "start.%s=%.17g", name.c_str(), value);
    settings.emplace_back(text);
  };
  if (model.name == "spatial") {
    set("crank.e0", std::cos(0.5 * angle));
    set("crank.e1", std::sin(0.5 * angle));
    set("crank.e1.rate", 0.5 * rate * std::cos(0.5 * angle));
  } else {
    set(model.angle, angle);
    set(model.angle + ".rate", rate);
  }
  return load(model.scene, settings);
}

State consistent(const Machine& machine) { return consistent_start(machine.system(), machine.options(), 0.7); }

TEST(GeneralState, ThreeModelsAgree) {
  std::vector<std::vector<std::complex<double>>> spectra;
  std::vector<double> accelerations;
  for (const FourBar& model : four_bars) {
    const Machine machine = moving(model);
    const State state = consistent(machine);
    // Away from equilibria the spectrum belongs to the coordinate: the same one, the cylinder's length, in all three.
    const std::string length = model.name == "plugin" ? "machine.s" : "piston.s";
    const Index s = machine.system().find_x(length);
    Linearizer linearizer(machine.system(), choose_partition(machine.system(), state, {{s}, {}}));
    LinearModel linear;
    linearizer.linearize(state, linear);
    spectra.push_back(eigenvalues(linear));
    accelerations.push_back(machine.value(state, length + ".acceleration"));
  }
  EXPECT_TRUE(close(accelerations[1], accelerations[0], 1e-10));
  EXPECT_TRUE(close(accelerations[2], accelerations[0], 1e-10));
  double fastest = 0.0;
  for (const std::complex<double>& lambda : spectra[0]) fastest = std::max(fastest, std::abs(lambda));
  EXPECT_GT(fastest, 1e3);
  for (std::size_t k = 1; k < 3; ++k) {
    for (const std::complex<double>& expected : spectra[0]) {
      EXPECT_TRUE(take_nearest(spectra[k], expected, 1e-10)) << four_bars[k].name;
    }
  }
}

/// d(q, qdot, z)/dt of the reduced system at independent values: constraints solved exactly around a reference state.
Eigen::VectorXd reduced_rates(const Machine& machine, const Partition& partition, const State& reference,
                              const Eigen::VectorXd& X) {
  const System& system = machine.system();
  State state = reference;
  const auto k = static_cast<Index>(partition.ai.size());
  for (Index i = 0; i < k; ++i) {
    state.x[static_cast<std::size_t>(partition.ai[static_cast<std::size_t>(i)])] = X(i);
    state.v[static_cast<std::size_t>(partition.ai[static_cast<std::size_t>(i)])] = X(k + i);
  }
  for (Index i = 0; i < system.nz(); ++i) state.z[static_cast<std::size_t>(i)] = X(2 * k + i);
  assemble_positions(system, state, partition.ai);
  assemble_velocities(system, state, partition.ai);
  Blocks blocks(system);
  Kkt(system, partition.rows).complete(state, blocks);
  Eigen::VectorXd rates(X.size());
  for (Index i = 0; i < k; ++i) {
    rates(i) = state.v[static_cast<std::size_t>(partition.ai[static_cast<std::size_t>(i)])];
    rates(k + i) = state.a[static_cast<std::size_t>(partition.ai[static_cast<std::size_t>(i)])];
  }
  for (Index i = 0; i < system.nz(); ++i) rates(2 * k + i) = state.zdot[static_cast<std::size_t>(i)];
  return rates;
}

TEST(GeneralState, JacobianIsTheDerivativeOfTheReducedRates) {
  for (const FourBar& model : four_bars) {
    const Machine machine = moving(model);
    const State state = consistent(machine);
    const Partition partition = choose_partition(machine.system(), state, machine.options().linearize.prescribed);
    ASSERT_EQ(partition.ai.size(), 1U);
    const LinearModel linear = linear_model(machine, state);
    Eigen::VectorXd X(6);
    X << state.x[static_cast<std::size_t>(partition.ai[0])], state.v[static_cast<std::size_t>(partition.ai[0])],
        state.z[0], state.z[1], state.z[2], state.z[3];
    // Sixth-order central differences; steps small against each variable's curvature and large against rounding.
    const double steps[] = {3e-4, 1e-4, 3e2, 3e2, 3e2, 1e-3};
    for (int j = 0; j < 6; ++j) {
      const auto moved = [&](double times) {
        Eigen::VectorXd Y = X;
        Y(j) += times * steps[j];
        return reduced_rates(machine, partition, state, Y);
      };
      const Eigen::VectorXd column =
          ((moved(3) - moved(-3)) - 9.0 * (moved(2) - moved(-2)) + 45.0 * (moved(1) - moved(-1))) / (60.0 * steps[j]);
      for (int i = 0; i < 6; ++i) {
        // Against the largest term of the row, in steps of equal weight: rounding is relative to it.
        double scale = 0.0;
        for (int q = 0; q < 6; ++q) scale = std::max(scale, std::abs(linear.A(i, q)) * steps[q]);
        EXPECT_TRUE(close(linear.A(i, j), column(i), 3e-8, scale / steps[j]))
            << model.name << ", A(" << i << ", " << j << ")";
      }
    }
  }
}

}  // namespace
}  // namespace bramah::testing
