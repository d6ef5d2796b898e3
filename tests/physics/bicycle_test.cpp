// The Carvallo-Whipple bicycle from bodies, joints and rolling wheels.
#include <cmath>
#include <numbers>

#include "moving.hpp"

namespace bramah::testing {
namespace {

const char* const file = "scenes/bicycle/benchmark.json";

std::string at_speed(const std::string& speed) { return "constants.v=" + speed; }

TEST(Bicycle, AgainstTheReference) {
  const auto exact = reference("bicycle.json")["exact"]["eigenvalues"];
  for (const char* speed : {"0", "5"}) {
    const Moving bicycle(file, {at_speed(speed)});
    EXPECT_EQ(bicycle.system().n(), 16);
    EXPECT_EQ(bicycle.system().m(), 9);
    EXPECT_EQ(bicycle.system().l(), 4);
    expect_spectrum(bicycle.model(), pairs(exact[speed]), 6, 1e-11);
  }
}

TEST(Bicycle, AgainstItsLinearEquations) {
  // M qddot + v C1 qdot + (g K0 + v^2 K2) q = 0 in lean and steer.
  const auto exact = reference("bicycle.json")["exact"];
  const auto matrix = [&](const char* name) {
    Eigen::Matrix2d result;
    for (int i = 0; i < 2; ++i) {
      const std::vector<double> row = numbers(exact[name][static_cast<std::size_t>(i)]);
      result.row(i) << row[0], row[1];
    }
    return result;
  };
  const Eigen::Matrix2d M = matrix("M"), C1 = matrix("C1"), K0 = matrix("K0"), K2 = matrix("K2"), inverse = M.inverse();
  for (const double v : {0.3, 1.0, 3.0, 4.6, 8.0, 10.0, 30.0}) {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    A.topRightCorner(2, 2).setIdentity();
    A.bottomLeftCorner(2, 2) = -inverse * (9.81 * K0 + v * v * K2);
    A.bottomRightCorner(2, 2) = -inverse * (v * C1);
    const Eigen::Vector4cd all = A.eigenvalues();
    const Moving bicycle(file, {at_speed(std::to_string(v))});
    expect_spectrum(bicycle.model(), {all(0), all(1), all(2), all(3)}, 6, 1e-10);
  }
}

TEST(Bicycle, WeavesAtTheCriticalSpeed) {
  const auto speeds = reference("bicycle.json")["exact"]["speeds"];
  const Moving bicycle(file, {at_speed(speeds["v_weave"].get<std::string>())});
  bool weave = false;
  for (const std::complex<double>& value : eigenvalues(bicycle.model())) {
    if (value.imag() < 1.0) continue;
    weave = true;
    EXPECT_LT(std::abs(value.real()), 1e-12);
  }
  EXPECT_TRUE(weave);
}

TEST(Bicycle, StandsOnItsWheels) {
  // Moments about the contacts, w = 1.02 m apart: m_B x_B + m_H x_H + m_F w in front.
  const Moving bicycle(file);
  const double front = 9.81 * (85.0 * 0.3 + 4.0 * 0.9 + 3.0 * 1.02) / 1.02, weight = 9.81 * 94.0;
  EXPECT_TRUE(close(bicycle.value("front_contact.lambda_contact"), -front, 1e-13));
  EXPECT_TRUE(close(bicycle.value("rear_contact.lambda_contact"), front - weight, 1e-13));
  EXPECT_TRUE(close(bicycle.value("rear.spin.rate"), 5.0 / 0.3, 1e-14));
  EXPECT_TRUE(close(bicycle.value("front.spin.rate"), 5.0 / 0.35, 1e-14));
}

TEST(Bicycle, AnyHeading) {
  // Turned by 90 degrees the contact rows, Euler parameters and partition are others.
  const auto exact = reference("bicycle.json")["exact"]["eigenvalues"];
  const auto list = [](std::initializer_list<double> numbers) {
    Value::List values;
    for (const double value : numbers) values.emplace_back(value);
    return values;
  };
  Machine machine = load(file);
  Value& root = machine.scene.root;
  Value& components = *root.find("components");
  components.find("frame")->set("rotation", list({0, 0, 0.5 * std::numbers::pi}));
  components.find("frame")->set("position", list({0, 0.3, 0.9}));
  components.find("fork")->set("rotation", list({0, 0, 0.5 * std::numbers::pi}));
  components.find("fork")->set("position", list({0, 0.9, 0.7}));
  Value::List hold;
  hold.emplace_back("frame.y");
  root.set("hold", std::move(hold));
  root.set("start", Value::Object{{"frame.y.rate", 5.0}});
  root.set("constants", Value::Object{});
  root.find("linearize")->set("independent", Value::List{});
  machine.compiled = compile(machine.scene, registry());
  const Moving bicycle(std::move(machine));
  expect_spectrum(bicycle.model(), pairs(exact["5"]), 6, 1e-11);
}

}  // namespace
}  // namespace bramah::testing
