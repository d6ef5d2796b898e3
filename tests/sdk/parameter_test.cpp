// Parameters and first order in eps, against closed forms.
#include "bramah/parameter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <type_traits>

#include "bramah/describe.hpp"
#include "bramah/math.hpp"
#include "bramah/vector.hpp"

namespace bramah {
namespace {

// A tangent can only be dropped in so many words.
static_assert(!std::is_convertible_v<Parameter, double> && !std::is_constructible_v<double, Parameter>);
static_assert(std::is_convertible_v<double, Parameter> && std::is_convertible_v<int, Parameter>);
static_assert(std::is_convertible_v<Parameter, Dual<8>> && std::is_convertible_v<Parameter, Real>);
// What a law may write, and what comes out: parameters among themselves stay parameters.
static_assert(std::is_same_v<decltype(2 * Parameter() + 1.0), Parameter>);
static_assert(std::is_same_v<decltype(Parameter() * Real()), Real> &&
              std::is_same_v<decltype(Real() / Parameter()), Real>);
static_assert(std::is_same_v<decltype(Parameter() - Dual<8>()), Dual<8>>);
static_assert(std::is_same_v<decltype(Parameter() * Trace()), Trace>);
static_assert(std::is_same_v<decltype(Parameter() + Taylor<Epsilon<Real>, 2>()), Taylor<Epsilon<Real>, 2>>);
static_assert(std::is_same_v<decltype(Vec3<Parameter>() + Vec3<Dual<8>>()), Vec3<Dual<8>>>);

void expect(const Parameter& found, double value, double tangent) {
  EXPECT_DOUBLE_EQ(found.value(), value);
  EXPECT_DOUBLE_EQ(found.tangent(), tangent);
}

TEST(ParameterTest, Arithmetic) {
  const Parameter a(3.0, 0.5), b(4.0, -2.0);
  expect(a + b, 7.0, -1.5);
  expect(a - b, -1.0, 2.5);
  expect(-a, -3.0, -0.5);
  expect(a * b, 12.0, 0.5 * 4.0 - 2.0 * 3.0);
  expect(a / b, 0.75, (0.5 * 4.0 + 2.0 * 3.0) / 16.0);
  expect(2 * a + 1.0, 7.0, 1.0);
  expect(1.0 / b, 0.25, 2.0 / 16.0);
  Parameter c = a;
  c += b, c -= 1.0, c *= a, c /= 2.0;  // (a + b - 1) a / 2
  expect(c, 9.0, 0.5 * (-1.5 * 3.0 + 6.0 * 0.5));
  EXPECT_TRUE(a < b && b >= 4.0 && a == 3.0 && 2.0 < a && a != b);
}

TEST(ParameterTest, Functions) {
  const Parameter a(1.7, 0.3), n(2.5, -0.4);
  expect(pow(a, 2.5), std::pow(1.7, 2.5), 2.5 * std::pow(1.7, 1.5) * 0.3);
  expect(pow(a, n), std::pow(1.7, 2.5), 2.5 * std::pow(1.7, 1.5) * 0.3 + std::pow(1.7, 2.5) * std::log(1.7) * -0.4);
  expect(pow(Parameter(-2.0, 1.0), 3.0), -8.0, 12.0);
  expect(abs(Parameter(-2.0, 1.0)), 2.0, -1.0);
  expect(max(a, 2.0), 2.0, 0.0);
  expect(min(a, 2.0), 1.7, 0.3);
  expect(atan2(Parameter(1.0, 1.0), Parameter(2.0)), std::atan2(1.0, 2.0), 2.0 / 5.0);
}

TEST(ParameterTest, StandsStillWhereASlopeIsInfinite) {
  expect(sqrt(Parameter(0.0)), 0.0, 0.0);
  expect(pow(Parameter(0.0), 0.5), 0.0, 0.0);
  // The rotation that a body starts with, from none: e = (1, r / 2).
  const Quaternion<Parameter> e = quaternion_of(Vec3<Parameter>{Parameter(0.0, 1.0), 0.0, 0.0});
  expect(e[0], 1.0, 0.0);
  expect(e[1], 0.0, 0.5);
}

// F = k^2 sin(k x), x and k moving along eps with dx and dk.
TEST(EpsilonTest, CarriesParametersIntoSecondDerivatives) {
  const double x = 0.7, k = 1.3, dx = -0.4, dk = 0.9, s = std::sin(k * x), c = std::cos(k * x);
  const Parameter p(k, dk);
  using E = Epsilon<Dual<4>>;
  const E at(Dual<4>::seed(x, 2), Dual<4>(dx));
  const E F = p * p * sin(p * at);
  EXPECT_DOUBLE_EQ(F.v.value(), k * k * s);
  EXPECT_DOUBLE_EQ(F.v.derivative(2), k * k * k * c);
  EXPECT_DOUBLE_EQ(F.d.value(), k * k * k * c * dx + (2.0 * k * s + k * k * x * c) * dk);
  EXPECT_DOUBLE_EQ(F.d.derivative(2), -k * k * k * k * s * dx + (3.0 * k * k * c - k * k * k * x * s) * dk);
  EXPECT_EQ(F.d.derivative(0), 0.0);
  EXPECT_EQ(value(F), F.v.value());

  // The same, parameter to the right and to the left in every operation.
  const E q = (at * p + p) / p - (p - at / p) + p / at;
  EXPECT_NEAR(q.v.value(), x + 1.0 - k + x / k + k / x, 1e-15);
  EXPECT_NEAR(q.d.value(), dx - dk + dx / k - x * dk / (k * k) + dk / x - k * dx / (x * x), 1e-15);
  EXPECT_NEAR(q.d.derivative(2), -dk / (k * k) - dk / (x * x) + 2.0 * k * dx / (x * x * x), 1e-14);
}

TEST(EpsilonTest, Arithmetic) {
  using E = Epsilon<Real>;
  const E a(Real(3.0), Real(0.5)), b(Real(4.0), Real(-2.0));
  const auto near = [](const E& e, double v, double d) {
    EXPECT_DOUBLE_EQ(e.v.value(), v);
    EXPECT_DOUBLE_EQ(e.d.value(), d);
  };
  near(a + b, 7.0, -1.5);
  near(a - b, -1.0, 2.5);
  near(-a, -3.0, -0.5);
  near(a * b, 12.0, -4.0);
  near(a / b, 0.75, 0.5);
  near(a + 1.0, 4.0, 0.5);
  near(1.0 - a, -2.0, -0.5);
  near(2.0 * a, 6.0, 1.0);
  near(a / 2.0, 1.5, 0.25);
  near(2.0 / b, 0.5, 0.25);
  E c = a;
  c += b, c -= E(1.0), c *= a;
  near(c, 18.0, -1.5 * 3.0 + 6.0 * 0.5);
}

// c = sin(k x(t)), x = x0 + v t + a t^2 / 2: c, cdot, cddot and their derivatives by k.
TEST(EpsilonTest, UnderSeriesInTime) {
  using S = Taylor<Epsilon<Real>, 2>;
  const double x = 0.6, v = -0.8, a = 1.9, k = 1.4;
  S path(x);
  path.c[1] = v;
  path.c[2] = 0.5 * a;
  const S c = sin(Parameter(k, 1.0) * path);
  const double s = std::sin(k * x), o = std::cos(k * x);
  EXPECT_NEAR(value(c.c[0].d), x * o, 1e-15);
  EXPECT_NEAR(value(c.c[1].v), k * v * o, 1e-15);
  EXPECT_NEAR(value(c.c[1].d), v * o - k * v * x * s, 1e-15);
  EXPECT_NEAR(2.0 * value(c.c[2].v), k * a * o - k * k * v * v * s, 1e-15);
  EXPECT_NEAR(2.0 * value(c.c[2].d), a * o - k * a * x * s - 2.0 * k * v * v * s - k * k * v * v * x * o, 4e-15);
}

// A law with parameters and the same with plain numbers give the same bits where nothing moves.
TEST(ParameterTest, CostsWhatANumberCosts) {
  const double k = 1.1e5, x = 0.37;
  const Dual<8> at = Dual<8>::seed(x, 3), plain = k * sin(at) / k + k - at * k, with = [&] {
    const Parameter p(k, 123.0);
    return p * sin(at) / p + p - at * p;
  }();
  EXPECT_EQ(with.value(), plain.value());
  EXPECT_EQ(with.derivative(3), plain.derivative(3));
}

struct Kinds {
  Parameter number = 0.0;
  Vec2<Parameter> vector = {};
  std::vector<Parameter> list;
  double plain = 0.0;
  std::vector<double> times;
  std::string text;
  int choice = 0;
  void describe(Description& is) {
    is.called("test/kinds", "one parameter of each kind");
    is.parameter("number", number, "m");
    is.parameter("vector", vector, "m");
    is.parameter("list", list, "m");
    is.parameter("plain", plain, "m");
    is.parameter("times", times, "s");
    is.parameter("text", text);
    is.choice("choice", choice, {"a", "b"});
  }
};

TEST(ParameterTest, DescribeTellsWhatIsDifferentiable) {
  TypeTables tables;
  Description collecting(tables);
  Kinds prototype;
  prototype.describe(collecting);
  EXPECT_EQ(tables.differentiable, (std::vector<std::uint8_t>{1, 1, 1, 0, 0, 0, 0}));

  const double numbers[] = {1.0, 2.0, 3.0}, moves[] = {0.1, 0.2, 0.3};
  const auto given = [](const double* from, std::int64_t count) {
    return bramah_value{sizeof(bramah_value), from, count, ""};
  };
  const bramah_value values[] = {given(numbers, 1), given(numbers, 2), given(numbers, 3), given(numbers + 2, 1),
                                 given(numbers, 3), given(numbers, 0), given(numbers, 1)};
  const bramah_value tangents[] = {given(nullptr, 0), given(moves, 2), given(moves, 3), given(moves, 1),
                                   given(moves, 3),   given(moves, 0), given(moves, 1)};
  Kinds made;
  Description configuring(tables, values, tangents);
  made.describe(configuring);
  expect(made.number, 1.0, 0.0);
  expect(made.vector[1], 2.0, 0.2);
  ASSERT_EQ(made.list.size(), 3U);
  expect(made.list[2], 3.0, 0.3);
  EXPECT_EQ(made.plain, 3.0);
}

}  // namespace
}  // namespace bramah
