// Rolling and skating: nonholonomic rows, moving references, defective zeros.
#include <cmath>
#include <numbers>

#include "moving.hpp"
#include "solve/simulate.hpp"

namespace bramah::testing {
namespace {

struct Case {
  std::string name, shape, motion;
  // NOLINTNEXTLINE(readability-identifier-naming): the name that GoogleTest looks for
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};
const std::vector<Case> cases = {{"disc", "thin disc", "straight"},
                                 {"hoop", "thin hoop", "straight"},
                                 {"torus", "solid torus", "straight"},
                                 {"turning_disc", "thin disc", "steady circular turning"}};

nlohmann::json reference_case(const std::string& shape, const std::string& motion) {
  const nlohmann::json all = reference("rolling.json");
  for (const auto& c : all["cases"]) {
    if (c["model"] == "Roller" && c["shape"] == shape && c["motion"] == motion) return c;
  }
  throw std::runtime_error("no case " + shape);
}
nlohmann::json skate_case() {
  const nlohmann::json all = reference("rolling.json");
  for (const auto& c : all["cases"]) {
    if (c["model"] == "Skate") return c;
  }
  throw std::runtime_error("no skate");
}

class Rolling : public ::testing::TestWithParam<Case> {};

TEST_P(Rolling, AgainstTheReference) {
  const auto expected = reference_case(GetParam().shape, GetParam().motion);
  const Moving wheel("scenes/rolling/" + GetParam().name + ".json");
  const LinearModel model = wheel.model({"wheel.yaw", "wheel.lean", "wheel.spin"}, {"wheel.x", "wheel.y"});
  expect_matrix(model, expected["J"], 1e-12);
  expect_spectrum(model, pairs(expected["nonzero_eigs"]), expected["zeros"].get<std::size_t>(), 1e-12);
  expect_spectrum(wheel.model(), pairs(expected["nonzero_eigs"]), expected["zeros"].get<std::size_t>(), 1e-12);
}

TEST_P(Rolling, AnyHeading) {
  // The instantaneous Jacobian turns with the wheel, its eigenvalues do not.
  const auto expected = reference_case(GetParam().shape, GetParam().motion);
  for (const std::string yaw : {"0.3", "1.5707963267948966", "-2.5"}) {
    const Moving wheel("scenes/rolling/" + GetParam().name + ".json", {"wheel.yaw=" + yaw, "wheel.spin=0.7"});
    expect_spectrum(wheel.model(), pairs(expected["nonzero_eigs"]), expected["zeros"].get<std::size_t>(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Rolling, ::testing::ValuesIn(cases), [](const auto& p) { return p.param.name; });

TEST(Turning, HasTheForcesOfTheCircle) {
  const auto expected = reference_case("thin disc", "steady circular turning");
  const Moving wheel("scenes/rolling/turning_disc.json");
  const std::vector<std::string> names = {"x", "y", "z", "yaw", "lean", "spin"};
  const std::vector<double> v = numbers(expected["v0"]), a = numbers(expected["a0"]),
                            lambda = numbers(expected["Lambda0"]);
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_TRUE(close(wheel.value("wheel." + names[i] + ".rate"), v[i], 1e-14, 1.0)) << names[i];
    EXPECT_TRUE(close(wheel.value("wheel." + names[i] + ".acceleration"), a[i], 1e-13, 1.0)) << names[i];
  }
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(close(wheel.state.lambda[i], lambda[i], 1e-13, 1.0)) << "multiplier " << i;
}

TEST(Turning, ComesBackAfterACircle) {
  const Moving wheel("scenes/rolling/turning_disc.json");
  SimulateOptions options = wheel.machine.options().simulate;
  options.to_time = 0.5 * std::numbers::pi;  // yaw rate 4 rad/s
  options.rel_tol = 1e-10;                   // errors add up over the circle
  const Simulation run = simulate(wheel.system(), options, wheel.state, {});
  EXPECT_NEAR(wheel.machine.value(run.last, "wheel.yaw"), -2.0 * std::numbers::pi, 1e-8);
  EXPECT_NEAR(wheel.machine.value(run.last, "wheel.x"), 0.0, 1e-8);
  EXPECT_NEAR(wheel.machine.value(run.last, "wheel.y"), 0.0, 1e-8);
  EXPECT_NEAR(wheel.machine.value(run.last, "wheel.lean"), wheel.value("wheel.lean"), 1e-8);
  EXPECT_LT(run.statistics.worst_velocity, 1e-9);
}

TEST(Straight, TopplesBelowTheCriticalSpin) {
  // lambda^2 = (m g a - C (C + m R^2) w^2 / A) / (A + m R^2) of the torus, either side of its zero.
  constexpr double m = 2.0, g = 9.81, a = 0.25, R = 0.3, A = 0.065625, C = 0.12875;
  for (const double spin : {0.0, 1.0, 2.8, 2.9, 6.0, 40.0}) {
    const Moving wheel("scenes/rolling/torus.json", {"wheel.spin_rate=" + std::to_string(spin)});
    const std::complex<double> square = (m * g * a - C * (C + m * R * R) * spin * spin / A) / (A + m * R * R);
    const std::complex<double> lambda = std::sqrt(square);
    expect_spectrum(wheel.model(), {lambda, -lambda}, 6, 1e-12);
  }
}

TEST(Skate, AgainstTheReference) {
  const auto expected = skate_case();
  const Moving skate("scenes/rolling/skate.json");
  const LinearModel model = skate.model({"skate.x", "skate.angle"}, {"skate.y"});
  expect_matrix(model, expected["J"], 1e-14);
  expect_spectrum(model, pairs(expected["nonzero_eigs"]), 2, 1e-13);
  // The knife edge may take x or y, the spring sees both the same.
  expect_spectrum(skate.model({"skate.x", "skate.y"}, {"skate.angle"}), pairs(expected["nonzero_eigs"]), 2, 1e-12);
}

TEST(Skate, KeepsItsThirdNonzeroEigenvalue) {
  // (I + m e^2) s^3 + (c + m e v) s^2 + k (b + e)^2 s + k (b + e) v = 0: it is zero at rest only.
  constexpr double m = 50.0, I = 4.0, e = 0.4, b = 0.6, k = 200.0, c = 3.0;
  for (const double v : {0.0, 0.01, 0.5, 8.0, -1.0}) {
    const Moving skate("scenes/rolling/skate.json", {"constants.v=" + std::to_string(v)});
    Eigen::Matrix3d companion;
    const double lead = I + m * e * e;
    companion << -(c + m * e * v) / lead, -k * (b + e) * (b + e) / lead, -k * (b + e) * v / lead, 1, 0, 0, 0, 1, 0;
    Eigenvalues roots;
    const Eigen::Vector3cd all = companion.eigenvalues();
    for (const std::complex<double>& root : {all(0), all(1), all(2)}) {
      if (std::abs(root) > 1e-10) roots.push_back(root);
    }
    EXPECT_EQ(roots.size(), v == 0.0 ? 2U : 3U);
    expect_spectrum(skate.model(), roots, 5 - roots.size(), 1e-11);
  }
}

TEST(Skate, HasOneMoreZeroUnreduced) {
  const auto expected = skate_case();
  const Moving skate("scenes/rolling/skate.json");
  Linearizer linearizer(skate.system(), choose_partition(skate.system(), skate.state));
  LinearModel model;
  linearizer.linearize_augmented(skate.state, model);
  ASSERT_EQ(model.A.rows(), expected["augmented"]["size"].get<int>());
  Eigenvalues found = eigenvalues(model);
  for (const std::complex<double>& value : pairs(expected["nonzero_eigs"]))
    EXPECT_TRUE(take_nearest(found, value, 1e-11));
  ASSERT_EQ(found.size(), expected["augmented"]["zeros"].get<std::size_t>());
  for (const std::complex<double>& zero : found) EXPECT_LT(std::abs(zero), 1e-4);  // defective: eps^(1/3)
}

TEST(KnifeEdgeOnAnIncline, SwingsAcrossTheSlope) {
  constexpr double g = 4.905, w = 3.0;
  const Moving skate("scenes/rolling/knife_edge_incline.json");
  std::size_t count = 0;
  Observer observer;
  observer.output = [&](const State& state) {
    const double phase = w * state.t, size = g / (2.0 * w * w);
    EXPECT_NEAR(skate.machine.value(state, "skate.x"), size * std::pow(std::sin(phase), 2), 2e-7) << "t = " << state.t;
    EXPECT_NEAR(skate.machine.value(state, "skate.y"), size * (phase - std::sin(phase) * std::cos(phase)), 2e-7);
    // Across: m (u w + g' sin), u = g' / w sin.
    EXPECT_NEAR(skate.machine.value(state, "edge.lambda_edge"), -2.0 * 2.0 * g * std::sin(phase), 1e-5);
    ++count;
  };
  simulate(skate.system(), skate.machine.options().simulate, skate.state, observer);
  EXPECT_EQ(count, 81U);
}

}  // namespace
}  // namespace bramah::testing
