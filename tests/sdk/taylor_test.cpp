#include "bramah/taylor.hpp"

#include <gtest/gtest.h>

#include "bramah/math.hpp"

namespace bramah {
namespace {

using S = Taylor<double, 2>;

S series(double c0, double c1, double c2) {
  S s;
  s.c[0] = c0, s.c[1] = c1, s.c[2] = c2;
  return s;
}
void expect(const S& s, double c0, double c1, double c2) {
  EXPECT_NEAR(s.c[0], c0, 1e-15 * std::fabs(c0));
  EXPECT_NEAR(s.c[1], c1, 4e-15 * std::fabs(c1));
  EXPECT_NEAR(s.c[2], c2, 4e-15 * std::fabs(c2));
}

// a = 2 + 3 t + 5 t^2, b = 4 - t + t^2 / 2
const S a = series(2, 3, 5), b = series(4, -1, 0.5);

TEST(TaylorTest, Arithmetic) {
  expect(a + b, 6, 2, 5.5);
  expect(a - b, -2, 4, 4.5);
  expect(-a, -2, -3, -5);
  expect(a * b, 8, 10, 18);  // 2 * 0.5 - 3 + 20
  expect((a * b) / b, 2, 3, 5);
  expect(S(1.0) / series(1, -1, 0), 1, 1, 1);  // 1 / (1 - t)
}

TEST(TaylorTest, ArithmeticWithNumbers) {
  expect(a + 1.0, 3, 3, 5);
  expect(1.0 + a, 3, 3, 5);
  expect(a - 1.0, 1, 3, 5);
  expect(1.0 - a, -1, -3, -5);
  expect(a * 2.0, 4, 6, 10);
  expect(2.0 * a, 4, 6, 10);
  expect(a / 2.0, 1, 1.5, 2.5);
  expect(2.0 / series(1, -1, 0), 2, 2, 2);
  S s = a;
  s += b;
  s -= a;
  s *= b;
  expect(s, 16, -8, 5);
}

TEST(TaylorTest, FirstOrder) {
  Taylor<double, 1> p, q;
  p.c[0] = 2, p.c[1] = 3, q.c[0] = 4, q.c[1] = -1;
  const auto product = p * q, ratio = p / q;
  EXPECT_EQ(product.c[1], 10.0);
  EXPECT_DOUBLE_EQ(ratio.c[1], (3.0 + 0.5) / 4.0);
}

TEST(TaylorTest, OfDuals) {
  // c = x^2 y along x = x0 + v t + a t^2 / 2: cdot = 2 x v y + x^2 w, with partials by x.
  using D = Dual<8>;
  Taylor<D, 2> x, y;
  x.c[0] = D::seed(1.5, 0), x.c[1] = D(0.7), x.c[2] = D(0.5 * 0.3);
  y.c[0] = D(2.0), y.c[1] = D(-0.4), y.c[2] = D(0.5 * 1.1);
  const auto c = x * x * y;
  EXPECT_DOUBLE_EQ(c.c[0].value(), 4.5);
  EXPECT_DOUBLE_EQ(c.c[0].derivative(0), 6.0);
  EXPECT_DOUBLE_EQ(c.c[1].value(), 2 * 1.5 * 0.7 * 2.0 - 0.4 * 2.25);
  EXPECT_DOUBLE_EQ(c.c[1].derivative(0), 2 * 0.7 * 2.0 - 0.4 * 3.0);
  const double cddot = 2 * 0.49 * 2.0 + 2 * 1.5 * 0.3 * 2.0 + 4 * 1.5 * 0.7 * -0.4 + 2.25 * 1.1;
  EXPECT_DOUBLE_EQ(2.0 * c.c[2].value(), cddot);
  EXPECT_NEAR(2.0 * c.c[2].derivative(0), 2 * 0.3 * 2.0 + 4 * 0.7 * -0.4 + 3.0 * 1.1, 1e-15);
  EXPECT_EQ(value(c), 4.5);
}

}  // namespace
}  // namespace bramah
