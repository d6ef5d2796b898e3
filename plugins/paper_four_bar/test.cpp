#include <gtest/gtest.h>
#include <bramah/conformance.hpp>

#include "paper.cpp"

TEST(FourBar, ConformsInAndOutOfItsPlane) {
  const std::vector<double> plane = {0.0, 0.5, 0.87, 0.0, 0.0, 1.05, 5.62, 4.65, 1.73, 0.52};
  const std::vector<double> space = {0.1, 0.4, 0.90, 0.3, -0.2, 1.20, 5.50, 4.80, 1.60, 0.60};
  EXPECT_TRUE(bramah::conforms<FourBar>({{.x = plane}, {.x = space}}));
}
