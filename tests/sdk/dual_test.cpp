#include "bramah/dual.hpp"

#include <gtest/gtest.h>

#include "bramah/math.hpp"

namespace bramah {
namespace {

using D = Dual<8>;
const double x0 = 1.7, y0 = -0.6;
const D x = D::seed(x0, 0), y = D::seed(y0, 5);  // lanes in different vector blocks

void expect(const D& d, double value, double dx, double dy) {
  EXPECT_DOUBLE_EQ(d.value(), value);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    EXPECT_DOUBLE_EQ(d.derivative(lane), lane == 0 ? dx : lane == 5 ? dy : 0.0) << "lane " << lane;
  }
}

TEST(DualTest, CarriesASeed) {
  expect(x, x0, 1.0, 0.0);
  expect(D(3.0), 3.0, 0.0, 0.0);
  D z = x;
  z.set_derivative(5, 4.0);
  expect(z, x0, 1.0, 4.0);
}

TEST(DualTest, Arithmetic) {
  expect(x + y, x0 + y0, 1.0, 1.0);
  expect(x - y, x0 - y0, 1.0, -1.0);
  expect(x * y, x0 * y0, y0, x0);
  expect(x / y, x0 / y0, 1.0 / y0, -x0 / (y0 * y0));
  expect(-x, -x0, -1.0, 0.0);
}

TEST(DualTest, ArithmeticWithNumbers) {
  expect(x + 2.0, x0 + 2.0, 1.0, 0.0);
  expect(2.0 + x, x0 + 2.0, 1.0, 0.0);
  expect(x - 2.0, x0 - 2.0, 1.0, 0.0);
  expect(2.0 - x, 2.0 - x0, -1.0, 0.0);
  expect(x * 2.0, 2.0 * x0, 2.0, 0.0);
  expect(2.0 * x, 2.0 * x0, 2.0, 0.0);
  expect(x / 2.0, x0 / 2.0, 0.5, 0.0);
  expect(2.0 / x, 2.0 / x0, -2.0 / (x0 * x0), 0.0);
}

TEST(DualTest, InPlace) {
  D z = x;
  z += y;
  z *= x;
  z -= y;
  expect(z, (x0 + y0) * x0 - y0, 2.0 * x0 + y0, x0 - 1.0);
}

TEST(DualTest, WiderAndNarrower) {
  // Sums that hold for every width that fills whole blocks.
  const Dual<4> a = Dual<4>::seed(2.0, 3);
  const Dual<16> b = Dual<16>::seed(2.0, 13);
  EXPECT_DOUBLE_EQ((a * a * a).derivative(3), 12.0);
  EXPECT_DOUBLE_EQ((b * b * b).derivative(13), 12.0);
}

TEST(DualTest, ValueForComparisons) { EXPECT_EQ(value(x * y), x0 * y0); }

}  // namespace
}  // namespace bramah
