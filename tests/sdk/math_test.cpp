// Every function on every scalar against its closed-form first and second derivative.
#include "bramah/math.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bramah/vector.hpp"

namespace bramah {
namespace {

struct Derivatives {
  double f, df, ddf;
};

/// f on a dual, on series in time, and on series of duals (whose mixed partial is the second derivative once more).
template <class Function>
void expect_function(const Function& function, double at, const Derivatives& d) {
  const auto near = [&](double found, double expected, const char* what) {
    EXPECT_NEAR(found, expected, 2e-14 * (std::fabs(expected) + std::fabs(d.f) + std::fabs(d.df) + std::fabs(d.ddf)))
        << what << " at " << at;
  };
  near(function(at), d.f, "value");

  const auto dual = function(Dual<8>::seed(at, 3));
  near(dual.value(), d.f, "value on a dual");
  near(dual.derivative(3), d.df, "derivative");
  EXPECT_EQ(dual.derivative(2), 0.0);

  const double v = 0.7, a = -1.3;
  Taylor<double, 2> path;
  path.c[0] = at, path.c[1] = v, path.c[2] = 0.5 * a;
  const auto moved = function(path);
  near(moved.c[0], d.f, "value on a series");
  near(moved.c[1], d.df * v, "rate");
  near(2.0 * moved.c[2], d.df * a + d.ddf * v * v, "second rate");

  Taylor<Dual<8>, 1> line;
  line.c[0] = Dual<8>::seed(at, 1), line.c[1] = Dual<8>(1.0);
  const auto mixed = function(line);
  near(mixed.c[0].derivative(1), d.df, "derivative on a series of duals");
  near(mixed.c[1].value(), d.df, "rate on a series of duals");
  near(mixed.c[1].derivative(1), d.ddf, "second derivative");

  near(value(function(Real(at))), d.f, "value on a real");

  // The derivative by eps of value and derivative, where the argument itself is eps.
  const Epsilon<Dual<4>> e = function(Epsilon<Dual<4>>(Dual<4>::seed(at, 1), Dual<4>(1.0)));
  near(e.v.value(), d.f, "value on an epsilon");
  near(e.v.derivative(1), d.df, "derivative on an epsilon");
  near(e.d.value(), d.df, "derivative by eps");
  near(e.d.derivative(1), d.ddf, "derivative by eps of the derivative");

  const Parameter p = function(Parameter(at, 0.7));
  near(p.value(), d.f, "value of a parameter");
  near(p.tangent(), 0.7 * d.df, "tangent of a parameter");

  Trace::compared() = false;
  const Trace t = function(Trace::seed(at, 0));
  near(t.number(), d.f, "number on a trace");
  EXPECT_TRUE(t.depends().test(0));
}
#define EXPECT_FUNCTION(name, at, ...) \
  expect_function([](const auto& argument) { return name(argument); }, at, Derivatives __VA_ARGS__)

TEST(MathTest, Powers) {
  for (const double x : {0.2, 1.0, 7.3}) {
    EXPECT_FUNCTION(sqrt, x, {std::sqrt(x), 0.5 / std::sqrt(x), -0.25 / (x * std::sqrt(x))});
    EXPECT_FUNCTION(exp, x, {std::exp(x), std::exp(x), std::exp(x)});
    EXPECT_FUNCTION(log, x, {std::log(x), 1.0 / x, -1.0 / (x * x)});
    EXPECT_FUNCTION(square, x, {x * x, 2.0 * x, 2.0});
    expect_function([](const auto& u) { return pow(u, 2.4); }, x,
                    {std::pow(x, 2.4), 2.4 * std::pow(x, 1.4), 2.4 * 1.4 * std::pow(x, 0.4)});
    expect_function([](const auto& u) { return pow(u, -0.5); }, x,
                    {std::pow(x, -0.5), -0.5 * std::pow(x, -1.5), 0.75 * std::pow(x, -2.5)});
  }
}

TEST(MathTest, Circular) {
  for (const double x : {-2.1, -0.4, 0.0, 0.9, 3.0}) {
    const double s = std::sin(x), c = std::cos(x), t = std::tan(x);
    EXPECT_FUNCTION(sin, x, {s, c, -s});
    EXPECT_FUNCTION(cos, x, {c, -s, -c});
    EXPECT_FUNCTION(tan, x, {t, 1.0 / (c * c), 2.0 * s / (c * c * c)});
  }
}

TEST(MathTest, Inverse) {
  for (const double x : {-0.8, -0.1, 0.0, 0.5, 0.95}) {
    const double r = std::sqrt(1.0 - x * x);
    EXPECT_FUNCTION(asin, x, {std::asin(x), 1.0 / r, x / (r * r * r)});
    EXPECT_FUNCTION(acos, x, {std::acos(x), -1.0 / r, -x / (r * r * r)});
  }
  for (const double x : {-30.0, -0.8, 0.0, 2.5}) {
    const double q = 1.0 + x * x;
    EXPECT_FUNCTION(atan, x, {std::atan(x), 1.0 / q, -2.0 * x / (q * q)});
  }
}

TEST(MathTest, Hyperbolic) {
  for (const double x : {-3.0, -0.2, 0.0, 1.4}) {
    const double s = std::sinh(x), c = std::cosh(x), t = std::tanh(x);
    EXPECT_FUNCTION(sinh, x, {s, c, s});
    EXPECT_FUNCTION(cosh, x, {c, s, c});
    EXPECT_FUNCTION(tanh, x, {t, 1.0 - t * t, -2.0 * t * (1.0 - t * t)});
  }
  EXPECT_EQ(tanh(Dual<8>::seed(1e6, 0)).value(), 1.0) << "no overflow far out";
  EXPECT_EQ(tanh(Dual<8>::seed(-1e6, 0)).derivative(0), 0.0);
}

TEST(MathTest, AngleInEveryQuadrant) {
  // Along the circle (cos q, sin q) the angle is q itself; along a line its derivatives are known too.
  for (double q = -3.1; q < 3.2; q += 0.31) {
    expect_function([](const auto& u) { return atan2(2.0 * sin(u), 2.0 * cos(u)); }, q, {q, 1.0, 0.0});
    const double y = std::sin(q), x = std::cos(q);
    using S = Taylor<Dual<8>, 1>;
    S sy(0.0), sx(0.0);
    sy.c[0] = Dual<8>::seed(y, 0), sx.c[0] = Dual<8>::seed(x, 1);
    sx.c[1] = Dual<8>(1.0);
    const S angle = atan2(sy, sx);
    EXPECT_NEAR(angle.c[0].derivative(0), x, 1e-15);
    EXPECT_NEAR(angle.c[0].derivative(1), -y, 1e-15);
    EXPECT_NEAR(angle.c[1].derivative(1), 2.0 * x * y, 1e-14);
    EXPECT_NEAR(angle.c[1].derivative(0), y * y - x * x, 1e-14);
  }
  EXPECT_EQ(atan2(1.0, 0.0), std::numbers::pi / 2) << "on double, that of the standard library";
}

TEST(MathTest, Branches) {
  EXPECT_FUNCTION(abs, 2.0, {2.0, 1.0, 0.0});
  EXPECT_FUNCTION(abs, -2.0, {2.0, -1.0, 0.0});
  EXPECT_FUNCTION(abs, 0.0, {0.0, 1.0, 0.0});
  using D = Dual<8>;
  const D a = D::seed(1.0, 0), b = D::seed(2.0, 1);
  EXPECT_EQ(max(a, b).derivative(1), 1.0);
  EXPECT_EQ(min(a, b).derivative(0), 1.0);
  EXPECT_EQ(max(b, a).derivative(1), 1.0);
  EXPECT_EQ(min(b, a).derivative(0), 1.0);
}

// ---- vectors and rotations -----------------------------------------------------------------------------------------

const Quaternion<double> e = quaternion_of({0.4, -0.9, 0.3}), q = {0.3, -0.2, 0.5, 0.7};
const Vec3<double> u = {0.3, -1.1, 0.8}, w = {-0.6, 0.2, 1.5};

TEST(VectorTest, RotationKeepsLengthsAndComesBack) {
  const Vec3<double> r = rotate(e, u), back = rotate_back(e, r);
  EXPECT_NEAR(dot(r, r), dot(u, u), 1e-15);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], u[k], 1e-15);
  const double half = std::sqrt(0.5);
  const Vec3<double> turned = rotate(Quaternion<double>{half, 0, 0, half}, Vec3<double>{1, 0, 0});
  EXPECT_NEAR(turned[1], 1.0, 1e-15) << "a quarter about z takes x to y";
}

TEST(VectorTest, BodyRateAndItsTranspose) {
  const Vec3<double> L_q = body_rate(e, q);
  EXPECT_NEAR(dot(L_q, w), dot(q, body_rate_transposed(e, w)), 1e-15);
  const Vec3<double> back = body_rate(e, body_rate_transposed(e, w));  // L L^T = 1
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], w[k], 1e-15);
  EXPECT_NEAR(dot(e, body_rate_transposed(e, w)), 0.0, 1e-16);
}

TEST(VectorTest, PointForceIsTheGradient) {
  for (std::size_t k = 0; k < 4; ++k) {
    Quaternion<Dual<8>> seeded;
    for (std::size_t i = 0; i < 4; ++i) seeded[i] = i == k ? Dual<8>::seed(q[i], 0) : Dual<8>(q[i]);
    EXPECT_NEAR(point_force(q, u, w)[k], dot(rotate(seeded, u), w).derivative(0), 1e-15) << "e" << k;
  }
}

TEST(VectorTest, CrossAndDot) {
  const Vec3<double> n = cross(u, w);
  EXPECT_NEAR(dot(n, u), 0.0, 1e-15);
  EXPECT_NEAR(dot(n, n), dot(u, u) * dot(w, w) - dot(u, w) * dot(u, w), 1e-14);
  EXPECT_EQ((2.0 * u - w)[0], 1.2);
  EXPECT_EQ(quaternion_of({0, 0, 0}), (Quaternion<double>{1, 0, 0, 0}));
}

}  // namespace
}  // namespace bramah
