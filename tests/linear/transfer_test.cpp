// Transfer functions of a model with closed forms: an oscillator driven by a force, measured by position and velocity.
#include "linear/transfer.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

using Complex = std::complex<double>;

constexpr double mass = 2.0, damping = 0.6, stiffness = 50.0;

/// Two decoupled parts: the oscillator, and a state that neither input reaches nor output sees.
LinearModel oscillator() {
  LinearModel model;
  model.states = {{"x", "m", 0.01, "x_ai"}, {"x.rate", "m/s", 0.1, "v_ai"}, {"hidden", "1", 1.0, "state"}};
  model.inputs = {{"force", "N"}};
  model.outputs = {{"x", "m"}, {"x.rate", "m/s"}, {"sum", "m"}};
  model.A.resize(3, 3);
  model.A << 0, 1, 0, -stiffness / mass, -damping / mass, 0, 0, 0, -7.0;
  model.B.resize(3, 1);
  model.B << 0, 1 / mass, 0;
  model.C.resize(3, 3);
  model.C << 1, 0, 0, 0, 1, 0, 3, 1, 0;  // sum = 3 x + xdot: a zero at -3
  model.D = Eigen::MatrixXd::Zero(3, 1);
  return model;
}

TEST(Transfer, FrequencyResponseIsTheClosedForm) {
  const std::vector<double> frequencies = {0.0, 0.5, 4.9, 5.0, 5.1, 80.0};
  const auto response = frequency_response(oscillator(), frequencies);
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    const Complex s(0.0, frequencies[k]);
    const Complex G = 1.0 / (mass * s * s + damping * s + stiffness);
    EXPECT_LT(std::abs(response[k](0, 0) - G), 1e-13 * std::abs(G));
    EXPECT_LT(std::abs(response[k](1, 0) - s * G), 1e-13 * std::abs(G) * (1.0 + frequencies[k]));
  }
}

TEST(Transfer, Zeros) {
  const LinearModel model = oscillator();
  const auto has = [](const std::vector<Complex>& list, double value) {
    return std::any_of(list.begin(), list.end(), [&](Complex z) { return std::abs(z - value) < 1e-10; });
  };
  // The hidden state is a zero of every path (it cancels its own pole); the velocity has one at 0, the sum at -3.
  const std::vector<Complex> position = transfer_zeros(model, 0, 0), velocity = transfer_zeros(model, 0, 1),
                             sum = transfer_zeros(model, 0, 2);
  EXPECT_EQ(position.size(), 1U);
  EXPECT_TRUE(has(position, -7.0));
  EXPECT_EQ(velocity.size(), 2U);
  EXPECT_TRUE(has(velocity, 0.0));
  EXPECT_EQ(sum.size(), 2U);
  EXPECT_TRUE(has(sum, -3.0));
}

TEST(Transfer, StepAndImpulse) {
  const LinearModel model = oscillator();
  const std::vector<double> times = {0.0, 0.1, 0.25, 1.0, 3.0};
  const Eigen::MatrixXd step = step_response(model, 0, times), impulse = impulse_response(model, 0, times);
  const double delta = damping / (2 * mass), w = std::sqrt(stiffness / mass - delta * delta);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k], decay = std::exp(-delta * t);
    EXPECT_TRUE(close(step(0, static_cast<Eigen::Index>(k)),
                      (1 - decay * (std::cos(w * t) + delta / w * std::sin(w * t))) / stiffness, 1e-12, 1 / stiffness));
    EXPECT_TRUE(
        close(impulse(0, static_cast<Eigen::Index>(k)), decay * std::sin(w * t) / (mass * w), 1e-12, 1 / (mass * w)));
  }
}

TEST(Transfer, ReachAndSight) {
  const LinearModel model = oscillator();
  const Spectrum spectrum = find_spectrum(model);
  const ModalAccess access = modal_access(model, spectrum);
  for (std::size_t k = 0; k < 3; ++k) {
    const bool hidden = std::abs(spectrum.modes[k].eigenvalue + 7.0) < 1e-9;
    const auto row = static_cast<Eigen::Index>(k);
    if (hidden) {
      EXPECT_LT(access.controllability(row, 0), 1e-14);
      EXPECT_LT(access.observability.row(row).maxCoeff(), 1e-14);
    } else {
      EXPECT_GT(access.controllability(row, 0), 0.1);
      EXPECT_GT(access.observability(row, 0), 0.1);
    }
  }
}

}  // namespace
}  // namespace bramah::testing
