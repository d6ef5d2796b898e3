// Articulated steering: hydraulic, nonholonomic and moving at once.
#include "moving.hpp"

namespace bramah::testing {
namespace {

const char* const file = "scenes/articulated_vehicle/straight.json";

struct ArticulatedVehicle : ::testing::Test {
  const nlohmann::json expected = reference("articulated_vehicle.json")["straight"][0];
  const Moving vehicle{file};
};

TEST_F(ArticulatedVehicle, MovesSteadily) {
  const std::vector<std::string> x = {"front.x", "front.y",    "front.angle", "rear.x",
                                      "rear.y",  "rear.angle", "left.s",      "right.s"};
  const std::vector<double> x0 = numbers(expected["x0"]), v0 = numbers(expected["v0"]), p0 = numbers(expected["p0"]),
                            lambda0 = numbers(expected["Lambda0"]);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(close(vehicle.value(x[i]), x0[i], 1e-15, 1.0)) << x[i];
    EXPECT_TRUE(close(vehicle.value(x[i] + ".rate"), v0[i], 1e-15, 1.0)) << x[i];
    EXPECT_NEAR(vehicle.value(x[i] + ".acceleration"), 0.0, 1e-14) << x[i];
  }
  const std::vector<std::string> p = {"V1.p", "VA.p", "VB.p"};
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_TRUE(close(vehicle.value(p[i]), p0[i], 1e-15)) << p[i];
    EXPECT_NEAR(vehicle.value(p[i] + ".rate"), 0.0, 1e-3) << p[i];  // Pa/s
  }
  // The reference's rows of the cylinders are (d.d - s^2) / 2, ours |d| - s: multipliers differ by s.
  const std::vector<std::string> rows = {"pivot.lambda_x",      "pivot.lambda_y",         "left.lambda_length",
                                         "right.lambda_length", "front_axle.lambda_edge", "rear_axle.lambda_edge"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double scale = i == 2 || i == 3 ? x0[6] : 1.0;
    EXPECT_TRUE(close(vehicle.value(rows[i]), lambda0[i] * scale, 1e-12)) << rows[i];
  }
}

TEST_F(ArticulatedVehicle, PartitionA) {
  const LinearModel model = vehicle.model({"front.x", "front.angle"}, {"front.y", "rear.angle"});
  expect_matrix(model, expected["partitions"]["A"]["J"], 1e-12);
  expect_spectrum(model, pairs(expected["nonzero_eigs"]), 3, 1e-10);
}

TEST_F(ArticulatedVehicle, PartitionB) {
  const LinearModel model = vehicle.model({"front.x", "right.s"}, {"front.y", "front.angle"});
  expect_matrix(model, expected["partitions"]["B"]["J"], 1e-12);
  expect_spectrum(model, pairs(expected["nonzero_eigs"]), 3, 1e-10);
}

TEST_F(ArticulatedVehicle, PartitionOfTheScene) {
  expect_spectrum(vehicle.model(), pairs(expected["nonzero_eigs"]), 3, 1e-10);
}

}  // namespace
}  // namespace bramah::testing
