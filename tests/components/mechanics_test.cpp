#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "components/mechanics/coordinate_force.hpp"
#include "components/mechanics/cylindrical.hpp"
#include "components/mechanics/end_stop.hpp"
#include "components/mechanics/force.hpp"
#include "components/mechanics/gravity.hpp"
#include "components/mechanics/ground.hpp"
#include "components/mechanics/planar_body.hpp"
#include "components/mechanics/planar_force.hpp"
#include "components/mechanics/planar_revolute.hpp"
#include "components/mechanics/planar_shaker.hpp"
#include "components/mechanics/planar_slot.hpp"
#include "components/mechanics/planar_stroke.hpp"
#include "components/mechanics/planar_torque.hpp"
#include "components/mechanics/prismatic.hpp"
#include "components/mechanics/revolute.hpp"
#include "components/mechanics/rigid_body.hpp"
#include "components/mechanics/spherical.hpp"
#include "components/mechanics/stroke.hpp"
#include "components/mechanics/torque.hpp"
#include "components/probe.hpp"

namespace bramah::mechanics {
namespace {

using bramah::testing::Parameters;
using bramah::testing::Probe;
using Vector = Vec3<double>;
using Rotation = Quaternion<double>;

Rotation product(const Rotation& p, const Rotation& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3], p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1]};
}
template <std::size_t N>
void expect_near(const std::array<double, N>& a, const std::array<double, N>& b, double tolerance) {
  for (std::size_t k = 0; k < N; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "component " << k;
}
void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "component " << k;
}
double power(const std::vector<double>& f, const std::vector<double>& v) {
  double sum = 0.0;
  for (std::size_t k = 0; k < f.size(); ++k) sum += f[k] * v[k];
  return sum;
}

/// A body's local values as an author thinks of them; w in body axes.
struct Pose {
  Vector r;
  Rotation e;
  Vector rdot, w;
  [[nodiscard]] std::vector<double> x() const { return {r[0], r[1], r[2], e[0], e[1], e[2], e[3]}; }
  [[nodiscard]] std::vector<double> v() const {
    const Rotation q = body_rate_transposed(e, 0.5 * w);
    return {rdot[0], rdot[1], rdot[2], q[0], q[1], q[2], q[3]};
  }
  [[nodiscard]] Vector point(const Vector& u) const { return r + rotate(e, u); }
  [[nodiscard]] Vector turned(const Vector& u) const {
    return cross(rotate(e, w), rotate(e, u));
  }  // w x u, ground axes
};
std::vector<double> joined(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
const Pose pose_a = {{0.3, -0.2, 1.1}, quaternion_of({0.4, -0.9, 0.3}), {1.0, 2.0, -0.5}, {0.7, -1.3, 0.4}};

TEST(AxesTest, NormalsMakeATriad) {
  for (const Vector& given : {Vector{0, 0, 1}, Vector{1, 0, 0}, Vector{-2, 2, 1}, Vector{1e-9, -3, 1e-9}}) {
    const Vector axis = unit(given);
    const auto [t1, t2] = normals(axis);
    EXPECT_NEAR(dot(t1, t1), 1.0, 1e-15);
    EXPECT_NEAR(dot(t2, t2), 1.0, 1e-15);
    EXPECT_NEAR(dot(t1, axis), 0.0, 1e-16);
    EXPECT_NEAR(dot(t2, axis), 0.0, 1e-16);
    expect_near(cross(t1, t2), axis, 1e-15);
  }
}

TEST(GroundTest, Conforms) { EXPECT_TRUE(conforms<Ground>()); }
TEST(GroundTest, IsUnmovedAndUnturned) {
  EXPECT_EQ(Probe<Ground>().constants(), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 0, 0, 0}));
}

TEST(GravityTest, Conforms) {
  EXPECT_TRUE(conforms<UniformGravity>({{}, {.parameters = {{"acceleration", {0, -9.81, 0}}}}}));
}
TEST(GravityTest, PointsDownUnlessTold) {
  EXPECT_EQ(Probe<UniformGravity>().constants(), (std::vector<double>{0, 0, -9.81}));
  EXPECT_EQ(Probe<UniformGravity>({{"acceleration", {0, -1.62, 0}}}).constants(), (std::vector<double>{0, -1.62, 0}));
}

// ---- bodies --------------------------------------------------------------------------------------------------------

const Parameters brick = {{"mass", 3.0}, {"inertia", {2.0, 2.5, 3.0}}, {"products", {0.1, -0.2, 0.3}}};

TEST(RigidBodyTest, Conforms) {
  const Parameters rod = {{"mass", 2.0}, {"inertia", {0.667, 0.0, 0.667}}};
  EXPECT_TRUE(conforms<RigidBody>({{.parameters = brick},
                                   {.parameters = brick, .x = pose_a.x(), .v = pose_a.v()},
                                   {.parameters = rod, .x = {0, 0, 0, 1, 0, 0, 0}, .v = {0, 0, 0, 0, 0, 0, 0}},
                                   {.parameters = rod, .magnitude = {.v = 50.0}}}));
}

TEST(RigidBodyTest, FallsFreely) {
  Probe<RigidBody> probe(brick);
  probe.x = {1, 2, 3, 1, 0, 0, 0};
  probe.u = {0.5, 0.0, -9.81};
  probe.a = {0.5, 0.0, -9.81, 0, 0, 0, 0};
  for (const double f : probe.rows().f) EXPECT_NEAR(f, 0.0, 1e-14);  // fused multiply-add leaves a rounding
  probe.a.assign(7, 0.0);
  const auto held = probe.rows().f;
  EXPECT_DOUBLE_EQ(held[0], -1.5);
  EXPECT_DOUBLE_EQ(held[2], 29.43);
  EXPECT_EQ(held[4], 0.0);
}

TEST(RigidBodyTest, ObeysEuler) {
  // f_e = 2 L^T n with n = I alpha + w x I w, so that n = L f_e / 2.
  const Vector alpha = {0.9, 0.1, -2.0}, &w = pose_a.w;
  const double I[3][3] = {{2.0, 0.1, -0.2}, {0.1, 2.5, 0.3}, {-0.2, 0.3, 3.0}};
  const auto times = [&](const Vector& u) {
    Vector product = {};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) product[i] += I[i][j] * u[j];
    }
    return product;
  };
  Probe<RigidBody> probe(brick);
  probe.x = pose_a.x();
  probe.v = pose_a.v();
  const Rotation swing = body_rate_transposed(pose_a.e, 0.5 * alpha);
  probe.a = {0, 0, 0};
  for (std::size_t k = 0; k < 4; ++k) probe.a.push_back(swing[k] - 0.25 * dot(w, w) * pose_a.e[k]);
  const auto rows = probe.rows();
  const Rotation f_e = {rows.f[3], rows.f[4], rows.f[5], rows.f[6]};
  expect_near(0.5 * body_rate(pose_a.e, f_e), times(alpha) + cross(w, times(w)), 1e-14);
  EXPECT_NEAR(rows.c[0], 0.0, 1e-16);
  EXPECT_NEAR(rows.r[0], 0.0, 1e-16);
  EXPECT_NEAR(rows.s[0], 0.0, 1e-15) << "e.eddot = -edot.edot";
}

TEST(RigidBodyTest, SymmetricTopPrecessesWithoutTorque) {
  const double A = 2.0, C = 3.5, w3 = 4.0, tilt = 0.6, rate = (C - A) / A * w3;
  Probe<RigidBody> probe({{"mass", 1.0}, {"inertia", {A, A, C}}});
  for (const double t : {0.0, 0.3, 1.7}) {
    const Vector w = {tilt * std::cos(rate * t), tilt * std::sin(rate * t), w3},
                 alpha = {-rate * w[1], rate * w[0], 0.0};
    const Pose top = {{0, 0, 0}, pose_a.e, {0, 0, 0}, w};
    probe.x = top.x();
    probe.v = top.v();
    const Rotation swing = body_rate_transposed(top.e, 0.5 * alpha);
    probe.a = {0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) probe.a.push_back(swing[k] - 0.25 * dot(w, w) * top.e[k]);
    for (const double f : probe.rows().f) EXPECT_NEAR(f, 0.0, 1e-14);
  }
}

TEST(RigidBodyTest, NormRow) {
  Probe<RigidBody> probe(brick);
  probe.x = {0, 0, 0, 2, 1, 0, 0};
  probe.v = {0, 0, 0, 0.5, 0, 3, 0};
  probe.a = {0, 0, 0, 0, 1, 0, 0};
  const auto rows = probe.rows();
  EXPECT_EQ(rows.c[0], 2.0);         // (5 - 1) / 2
  EXPECT_EQ(rows.r[0], 1.0);         // e.edot
  EXPECT_EQ(rows.s[0], 9.25 + 1.0);  // edot.edot + e.eddot
}

TEST(RigidBodyTest, StartsWhereTheSceneSays) {
  Parameters p = brick;
  p.insert({{"position", {1, 2, 3}}, {"rotation", {0, 0, std::numbers::pi / 2}}, {"velocity", {4, 5, 6}}});
  p.insert({{"angular_velocity", {0.1, 0.2, 0.3}}});
  const std::vector<double> s = Probe<RigidBody>(p).start();
  const Rotation e = {s[3], s[4], s[5], s[6]}, edot = {s[10], s[11], s[12], s[13]};
  expect_near(Vector{s[0], s[1], s[2]}, {1, 2, 3}, 0.0);
  expect_near(Vector{s[7], s[8], s[9]}, {4, 5, 6}, 0.0);
  expect_near(e, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}, 1e-15);
  expect_near(rotate(e, Vector{1, 0, 0}), {0, 1, 0}, 1e-15);
  expect_near(2.0 * body_rate(e, edot), {0.1, 0.2, 0.3}, 1e-15);
  EXPECT_NEAR(dot(e, edot), 0.0, 1e-16);
  EXPECT_EQ(Probe<RigidBody>(brick).start(), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(RigidBodyTest, RefusesImpossibleInertia) {
  const auto faults = [](const Vector& inertia, const Vector& products) {
    return Probe<RigidBody>({{"mass", 1.0},
                             {"inertia", {inertia[0], inertia[1], inertia[2]}},
                             {"products", {products[0], products[1], products[2]}}})
        .faults();
  };
  using List = std::vector<std::string>;
  EXPECT_EQ(faults({2, 2.5, 3}, {0.1, -0.2, 0.3}), List{});
  EXPECT_EQ(faults({0.667, 0, 0.667}, {0, 0, 0}), List{}) << "a slender rod";
  EXPECT_EQ(faults({0, 0, 0}, {0, 0, 0}), List{}) << "a point";
  EXPECT_EQ(faults({2.0 / 3, 2.0 / 3, 2.0 / 3}, {-1.0 / 3, -1.0 / 3, -1.0 / 3}), List{}) << "a rod along (1, 1, 1)";
  EXPECT_EQ(faults({1, 1, 2}, {0, 0, 0}), List{}) << "a plate";
  EXPECT_EQ(faults({1, 1, 2.1}, {0, 0, 0}), List{"inertia: (1, 1, 2.1) with products (0, 0, 0); expected no principal "
                                                 "moment greater than the sum of the other two"});
  EXPECT_EQ(faults({1, 1, 1}, {1.5, 0, 0}),
            List{"inertia: (1, 1, 1) with products (1.5, 0, 0); expected a positive semidefinite inertia matrix"});
  EXPECT_EQ(faults({1, 1, 1}, {0.9, -0.9, 0.9}).size(), 1U) << "every 2 x 2 minor is positive, the determinant is not";
  EXPECT_EQ(faults({0.6, 0.6, 0.6}, {-0.39, -0.39, -0.39}).size(), 1U) << "thinner than a rod";
}

TEST(PlanarBodyTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarBody>({{.parameters = {{"mass", 2.0}, {"inertia", 0.7}}}}));
}

TEST(PlanarBodyTest, FallsInItsPlane) {
  Probe<PlanarBody> probe({{"mass", 2.0},
                           {"inertia", 0.5},
                           {"position", {1, 2}},
                           {"angle", 0.3},
                           {"velocity", {4, 5}},
                           {"angular_velocity", 6.0}});
  probe.u = {1.0, -9.0, 77.0};
  probe.a = {0.0, 0.0, 4.0};
  EXPECT_EQ(probe.rows().f, (std::vector<double>{-2.0, 18.0, 2.0}));
  EXPECT_EQ(probe.start(), (std::vector<double>{1, 2, 0.3, 4, 5, 6}));
}

// ---- joints --------------------------------------------------------------------------------------------------------

const Vector hinge_a = {0.1, 0.5, -0.2}, hinge_b = {-0.7, 0.2, 0.3}, axis_a = {1, 2, -2}, axis_b = {0, 0.6, 0.8};
const Parameters hinge = {
    {"point_a", {0.1, 0.5, -0.2}}, {"point_b", {-0.7, 0.2, 0.3}}, {"axis_a", {1, 2, -2}}, {"axis_b", {0, 3, 4}}};

/// The other body of the hinge, turned by `angle` about its axis.
Pose assembled(double angle) {
  const Vector n = rotate(pose_a.e, unit(axis_a)), turn = cross(axis_b, n);
  Rotation e = {1.0 + dot(axis_b, n), turn[0], turn[1], turn[2]};  // the shortest turn of axis_b to n
  e = (1.0 / std::sqrt(dot(e, e))) * e;
  Pose b = {{}, product(e, quaternion_of(angle * axis_b)), {0.2, -0.1, 0.6}, {-0.5, 0.8, 1.9}};
  b.r = pose_a.point(hinge_a) - rotate(b.e, hinge_b);
  return b;
}

TEST(RevoluteTest, Conforms) {
  const Pose b = assembled(0.8);
  EXPECT_TRUE(conforms<Revolute>({{.parameters = hinge},
                                  {},  // all by default: points at the origins, axes along z
                                  {.parameters = hinge,
                                   .x = joined(pose_a.x(), b.x()),
                                   .v = joined(pose_a.v(), b.v()),
                                   .magnitude = {.lambda = 1e4}}}));
}

TEST(RevoluteTest, RowsVanishWhereAssembled) {
  Probe<Revolute> probe(hinge);
  for (const double angle : {0.0, 0.8, -2.5, std::numbers::pi}) {
    probe.x = joined(pose_a.x(), assembled(angle).x());
    for (const double c : probe.rows().c) EXPECT_NEAR(c, 0.0, 1e-15);
  }
}

TEST(RevoluteTest, RatesAreThoseOfRigidBodies) {
  Probe<Revolute> probe(hinge);
  const Pose& a = pose_a;
  Pose b = assembled(0.8);
  b.r = {2.0, 0.1, -1.0};  // rates hold anywhere
  b.e = quaternion_of({-0.2, 1.4, 0.8});
  probe.x = joined(a.x(), b.x());
  probe.v = joined(a.v(), b.v());
  const auto rows = probe.rows();
  const Vector gap = a.point(hinge_a) - b.point(hinge_b),
               rate = a.rdot + a.turned(hinge_a) - b.rdot - b.turned(hinge_b);
  expect_near(Vector{rows.c[0], rows.c[1], rows.c[2]}, gap, 1e-15);
  expect_near(Vector{rows.r[0], rows.r[1], rows.r[2]}, rate, 1e-14);
  const auto t = normals(unit(axis_a));
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector tilt = rotate(a.e, t[k]), n = rotate(b.e, axis_b);
    EXPECT_NEAR(rows.c[3 + k], dot(tilt, n), 1e-15);
    EXPECT_NEAR(rows.r[3 + k], dot(a.turned(t[k]), n) + dot(tilt, b.turned(axis_b)), 1e-14);
  }
}

TEST(RevoluteTest, LeavesOneTurnFree) {
  // Turning b about the axis through the hinge violates no row.
  Probe<Revolute> probe(hinge);
  Pose a = pose_a, b = assembled(0.8);
  a.rdot = a.w = {};
  b.w = 2.0 * axis_b;
  b.rdot = -1.0 * b.turned(hinge_b);
  probe.x = joined(a.x(), b.x());
  probe.v = joined(a.v(), b.v());
  for (const double r : probe.rows().r) EXPECT_NEAR(r, 0.0, 1e-15);
}

TEST(RevoluteTest, NeedsAnAxis) {
  Parameters p = hinge;
  p.insert_or_assign("axis_b", Setting{0.0, 0.0, 0.0});
  EXPECT_EQ(Probe<Revolute>(p).faults(),
            std::vector<std::string>{"axis_b: (0, 0, 0); expected a direction: at least one number other than zero"});
}

const Parameters ball = {{"point_a", {0.1, 0.5, -0.2}}, {"point_b", {-0.7, 0.2, 0.3}}};

TEST(SphericalTest, Conforms) { EXPECT_TRUE(conforms<Spherical>({{.parameters = ball}, {}})); }

TEST(SphericalTest, HoldsAPointOnly) {
  Probe<Spherical> probe(ball);
  Pose b = {{}, quaternion_of({0.3, -1.1, 2.0}), {}, {0.4, 1.5, -0.3}};
  b.r = pose_a.point(hinge_a) - rotate(b.e, hinge_b);
  b.rdot = pose_a.rdot + pose_a.turned(hinge_a) - b.turned(hinge_b);
  probe.x = joined(pose_a.x(), b.x());
  probe.v = joined(pose_a.v(), b.v());
  for (const double c : probe.rows().c) EXPECT_NEAR(c, 0.0, 1e-15);
  for (const double r : probe.rows().r) EXPECT_NEAR(r, 0.0, 1e-14);
  b.r[1] += 0.25;
  probe.x = joined(pose_a.x(), b.x());
  expect_near(probe.rows().c, std::vector<double>{0.0, -0.25, 0.0}, 1e-15);
}

/// The other body of the hinge, turned by `angle` and slid by `way`.
Pose slid(double angle, double way) {
  Pose b = assembled(angle);
  b.r = b.r + way * rotate(pose_a.e, unit(axis_a));
  return b;
}

TEST(CylindricalTest, Conforms) {
  const Pose b = slid(0.8, 0.4);
  EXPECT_TRUE(
      conforms<Cylindrical>({{.parameters = hinge},
                             {},
                             {.parameters = hinge, .x = joined(pose_a.x(), b.x()), .v = joined(pose_a.v(), b.v())}}));
}

TEST(CylindricalTest, SlidesAndTurns) {
  Probe<Cylindrical> probe(hinge);
  for (const double way : {0.0, 0.4, -1.3}) {
    probe.x = joined(pose_a.x(), slid(1.7 * way, way).x());
    for (const double c : probe.rows().c) EXPECT_NEAR(c, 0.0, 1e-15);
  }
  const auto t = normals(unit(axis_a));
  Pose beside = slid(0.3, 0.4);
  beside.r = beside.r + 0.2 * rotate(pose_a.e, t[1]);
  probe.x = joined(pose_a.x(), beside.x());
  expect_near(probe.rows().c, std::vector<double>{0.0, 0.2, 0.0, 0.0}, 1e-15);
}

/// The hinge with normals that agree in assembled(0.8).
Parameters guide() {
  const Vector normal_b = {1.0, 0.4, 0.0};
  const Rotation &e = pose_a.e, back = {e[0], -e[1], -e[2], -e[3]};
  const Vector normal_a = rotate(back, rotate(assembled(0.8).e, normal_b));
  Parameters p = hinge;
  p.insert_or_assign("normal_a", Setting{normal_a[0], normal_a[1], normal_a[2]});
  p.insert_or_assign("normal_b", Setting{normal_b[0], normal_b[1], normal_b[2]});
  return p;
}

TEST(PrismaticTest, Conforms) {
  const Pose b = slid(0.8, 0.4);
  EXPECT_TRUE(conforms<Prismatic>({{.parameters = guide()},
                                   {},
                                   {.parameters = guide(),
                                    .x = joined(pose_a.x(), b.x()),
                                    .v = joined(pose_a.v(), b.v()),
                                    .magnitude = {.lambda = 1e3}}}));
}

TEST(PrismaticTest, SlidesWithoutTurning) {
  Probe<Prismatic> probe(guide());
  for (const double way : {0.0, 0.4, -1.3}) {
    probe.x = joined(pose_a.x(), slid(0.8, way).x());
    for (const double c : probe.rows().c) EXPECT_NEAR(c, 0.0, 1e-15);
  }
  probe.x = joined(pose_a.x(), slid(0.8 + 0.3, 0.4).x());
  expect_near(probe.rows().c, std::vector<double>{0.0, 0.0, 0.0, 0.0, -std::sin(0.3)}, 1e-15);
}

TEST(PrismaticTest, NeedsNormalsAcrossItsAxis) {
  Parameters p = hinge;
  p.insert_or_assign("normal_b", Setting{0.0, -6.0, -8.0});
  EXPECT_EQ(
      Probe<Prismatic>(p).faults(),
      std::vector<std::string>{"normal_b: (0, -6, -8); expected a direction that is not along the axis (0, 0.6, 0.8)"});
}

TEST(PlanarRevoluteTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarRevolute>({{.parameters = {{"point_a", {0.3, -0.4}}, {"point_b", {0.1, 0.9}}}}, {}}));
}

TEST(PlanarRevoluteTest, IsThePinOfTwoBodies) {
  Probe<PlanarRevolute> probe({{"point_a", {2.0, 0.0}}, {"point_b", {0.0, 1.0}}});
  const double quarter = std::numbers::pi / 2;
  probe.x = {1.0, 1.0, quarter, 2.0, 3.0, quarter};  // a's pin at (1, 3); b's at (2 - 1, 3)
  probe.v = {0.5, 0.0, 3.0, 0.0, 0.25, -4.0};
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.c[0], 0.0, 1e-15);
  EXPECT_NEAR(rows.c[1], 0.0, 1e-15);
  EXPECT_NEAR(rows.r[0], 0.5 - 3.0 * 2.0, 1e-14);
  EXPECT_NEAR(rows.r[1], -0.25 - 4.0, 1e-14);
  EXPECT_NEAR(rows.s[0], -(-16.0 * -1.0), 1e-13) << "a turns about y only; b: -w^2 d";
  EXPECT_NEAR(rows.s[1], -9.0 * 2.0, 1e-13);
}

TEST(PlanarSlotTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarSlot>(
      {{}, {.parameters = {{"point_a", {0.3, -0.4}}, {"direction", {-3.0, 4.0}}, {"point_b", {0.1, 0.9}}}}}));
}

TEST(PlanarSlotTest, HoldsThePinOnItsLine) {
  // The slot of a runs up from (2, 0), a turned by a quarter: along -x of the ground through (1, 3).
  Probe<PlanarSlot> probe({{"point_a", {2.0, 0.0}}, {"direction", {0.0, 5.0}}, {"point_b", {0.0, 1.0}}});
  const double quarter = std::numbers::pi / 2;
  probe.x = {1.0, 1.0, quarter, 0.5, 2.0, 0.0};  // the pin at (0.5, 3)
  EXPECT_NEAR(probe.rows().c[0], 0.0, 1e-15);
  probe.x[4] = 1.8;
  EXPECT_NEAR(probe.rows().c[0], 0.2, 1e-15) << "left of the slot, which runs towards -x, is -y";
  // Off the line by sliding along, nothing; by turning a, w times the distance along the slot from a's centre.
  probe.x[4] = 2.0;
  probe.v = {0.0, 0.0, 0.0, 7.0, 0.0, 0.0};
  EXPECT_NEAR(probe.rows().r[0], 0.0, 1e-14);
  probe.v = {0.0, 0.0, 3.0, 0.0, 0.0, 0.0};
  EXPECT_NEAR(probe.rows().r[0], -3.0 * 0.5, 1e-14);
  EXPECT_EQ(Probe<PlanarSlot>({{"direction", {0.0, 0.0}}}).faults(),
            (std::vector<std::string>{"direction: (0, 0); expected a direction: at least one number other than zero"}));
}

const Parameters shaker = {{"point", {0.5, 0.2}}, {"direction", {3.0, 4.0}},
                           {"amplitude", 0.1},    {"omega", 10.0},
                           {"phase", 0.3},        {"offset", 0.7}};

TEST(PlanarShakerTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarShaker>(
      {{.parameters = shaker}, {.parameters = {{"direction", {0, 1}}, {"amplitude", 0.0}, {"omega", 0.0}}}}));
}

TEST(PlanarShakerTest, MovesThePointAsASineOfTime) {
  Probe<PlanarShaker> probe(shaker);
  probe.time = 0.04;
  const double phase = 0.7, along = 0.7 + 0.1 * std::sin(phase);
  probe.x = {0.6 * along - 0.5, 0.8 * along - 0.2, 0.0};
  probe.v = {0.6 * std::cos(phase), 0.8 * std::cos(phase), 0.0};  // amplitude omega = 1 m/s
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.c[0], 0.0, 1e-15);
  EXPECT_NEAR(rows.r[0], 0.0, 1e-15);
  EXPECT_NEAR(rows.s[0], 10.0 * std::sin(phase), 1e-14) << "cddot without a: amplitude omega^2 sin";
  EXPECT_EQ(Probe<PlanarShaker>({{"direction", {0, 0}}, {"amplitude", 1.0}, {"omega", 1.0}}).faults(),
            (std::vector<std::string>{"direction: (0, 0); expected a direction: at least one number other than zero"}));
}

TEST(StrokeTest, Conforms) {
  EXPECT_TRUE(conforms<Stroke>({{.parameters = {{"point_a", {0.1, 0.2, 0.3}}, {"point_b", {-0.4, 0.5, 0.6}}}}, {}}));
}

TEST(StrokeTest, IsADistance) {
  Probe<Stroke> probe({{"point_b", {0.0, 1.0, 0.0}}, {"length", 5.0}});
  probe.x = {1, 1, 1, 1, 0, 0, 0, 1, 3, 5, 1, 0, 0, 0, 5.0};  // from (1, 1, 1) to (1, 4, 5)
  auto rows = probe.rows();
  EXPECT_EQ(rows.c[0], 0.0);
  EXPECT_EQ(probe.start(), (std::vector<double>{5.0, 0.0}));
  probe.v.assign(15, 0.0);
  probe.v[0] = 7.0;   // across: no rate, but 49 / 5 in the second
  probe.v[8] = 10.0;  // 3/5 of it along, 8 across
  probe.v[14] = 1.0;
  probe.a[9] = 2.0;  // 4/5 of it along
  rows = probe.rows();
  EXPECT_NEAR(rows.r[0], 6.0 - 1.0, 1e-14);
  EXPECT_NEAR(rows.s[0], (49.0 + 64.0) / 5.0 + 1.6, 1e-13);
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_R_V, 0, 8), 0.6);
  EXPECT_EQ(probe.partial(BRAMAH_R_V, 0, 14), -1.0);
}

TEST(PlanarStrokeTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarStroke>({{.parameters = {{"point_a", {0.1, 0.2}}, {"point_b", {-0.4, 0.5}}}}, {}}));
}

TEST(PlanarStrokeTest, IsADistance) {
  Probe<PlanarStroke> probe({{"point_b", {1.0, 0.0}}});
  probe.x = {0, 0, 0.4, 3, 3, std::numbers::pi / 2, 5.0};
  probe.v = {0, 0, 1.0, 0, 0, 2.0, 0};  // b's point moves with (-2, 0)
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.c[0], 0.0, 1e-15);
  EXPECT_NEAR(rows.r[0], -1.2, 1e-14);
  EXPECT_EQ(probe.start(), (std::vector<double>{1.0, 0.0}));
}

// ---- forces --------------------------------------------------------------------------------------------------------

TEST(CoordinateForceTest, Conforms) { EXPECT_TRUE(conforms<CoordinateForce>()); }
TEST(CoordinateForceTest, AddsItsSignal) {
  Probe<CoordinateForce> probe;
  probe.u = {250.0};
  EXPECT_EQ(probe.rows().f, std::vector<double>{-250.0});
}

TEST(ForceTest, Conforms) {
  EXPECT_TRUE(conforms<Force>({{.parameters = {{"direction", {1, 2, 3}}, {"point", {0.1, -0.2, 0.3}}}},
                               {.parameters = {{"direction", {0, 0, -1}}}}}));
}
TEST(ForceTest, DoesTheWorkOfItsPoint) {
  Probe<Force> probe({{"direction", {0, 3, 4}}, {"point", {0.1, -0.2, 0.3}}});
  probe.x = pose_a.x();
  probe.v = pose_a.v();
  probe.u = {20.0};
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.f[1], -12.0, 1e-14);
  EXPECT_NEAR(rows.f[2], -16.0, 1e-14);
  EXPECT_NEAR(power(rows.f, probe.v), -dot(Vector{0, 12, 16}, pose_a.rdot + pose_a.turned({0.1, -0.2, 0.3})), 1e-13);
}
TEST(ForceTest, NeedsADirection) { EXPECT_EQ(Probe<Force>({{"direction", {0, 0, 0}}}).faults().size(), 1U); }

TEST(TorqueTest, Conforms) { EXPECT_TRUE(conforms<Torque>({{}, {.parameters = {{"axis", {1, -2, 3}}}}})); }
TEST(TorqueTest, DoesTheWorkOfItsAxis) {
  Probe<Torque> probe({{"axis", {3, 0, 4}}});
  probe.x = pose_a.x();
  probe.v = pose_a.v();
  probe.u = {5.0};
  EXPECT_NEAR(power(probe.rows().f, probe.v), -(3.0 * pose_a.w[0] + 4.0 * pose_a.w[2]), 1e-14);
}
TEST(TorqueTest, NeedsAnAxis) { EXPECT_EQ(Probe<Torque>({{"axis", {0, 0, 0}}}).faults().size(), 1U); }

TEST(PlanarForceTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarForce>({{.parameters = {{"direction", {1, 2}}, {"point", {0.1, -0.2}}}}}));
}
TEST(PlanarForceTest, HasItsArm) {
  Probe<PlanarForce> probe({{"direction", {0, 2}}, {"point", {0.5, 0.0}}});
  probe.x = {0, 0, std::numbers::pi};
  probe.u = {20.0};
  const auto f = probe.rows().f;
  EXPECT_EQ(f[0], 0.0);
  EXPECT_EQ(f[1], -20.0);
  EXPECT_NEAR(f[2], 10.0, 1e-14) << "the arm points to -x";
}
TEST(PlanarForceTest, NeedsADirection) { EXPECT_EQ(Probe<PlanarForce>({{"direction", {0, 0}}}).faults().size(), 1U); }

TEST(PlanarTorqueTest, Conforms) { EXPECT_TRUE(conforms<PlanarTorque>()); }
TEST(PlanarTorqueTest, AddsItsSignal) {
  Probe<PlanarTorque> probe;
  probe.u = {4.0};
  EXPECT_EQ(probe.rows().f, (std::vector<double>{0, 0, -4.0}));
}

const Parameters stop = {{"lower", 0.2}, {"upper", 1.4}, {"stiffness", 5e6}, {"damping", 2.0}};

TEST(EndStopTest, Conforms) {
  const auto at = [](double s, double v, int side = 1) {
    return Sample{.parameters = stop, .x = {s}, .v = {v}, .side = side};
  };
  EXPECT_TRUE(conforms<EndStop>({at(0.7, 0.1), at(0.19, -0.1), at(0.19, 0.1), at(1.41, 0.1), at(1.41, -0.1),
                                 at(0.1, 0.9), at(1.5, -0.9), at(0.2, -0.1, 1), at(0.2, -0.1, -1), at(1.4, 0.1, 1),
                                 at(1.4, 0.1, -1), at(0.15, 0.5, 1), at(0.15, 0.5, -1)}));
}

TEST(EndStopTest, PushesOnly) {
  Probe<EndStop> probe(stop);
  const auto force = [&](double s, double v) {
    probe.x = {s};
    probe.v = {v};
    const auto rows = probe.rows();
    EXPECT_EQ(rows.f[0], -rows.y[0]);
    EXPECT_NEAR(rows.switches[0], s - 0.2, 1e-15);
    EXPECT_NEAR(rows.switches[1], 1.4 - s, 1e-15);
    EXPECT_EQ(rows.switches[2], 1.0 - 2.0 * v);
    EXPECT_EQ(rows.switches[3], 1.0 + 2.0 * v);
    // What the end takes from the motion is stored or dissipated: -F v = d(k d^2 / 2)/dt - P.
    const double depth = s < 0.2 ? 0.2 - s : s > 1.4 ? s - 1.4 : 0.0, approach = s < 0.7 ? -v : v;
    EXPECT_NEAR(rows.y[1], depth, 1e-15);
    const auto stored = probe.stored();
    EXPECT_NEAR(stored.energy, 2.5e6 * depth * depth, 1e-9);
    EXPECT_NEAR(stored.rate, 5e6 * depth * approach, 1e-9);
    EXPECT_GE(-rows.y[0] * v - stored.rate, -1e-9) << "it brings in no power";
    return rows.y[0];
  };
  EXPECT_EQ(force(0.5, -9.0), 0.0);
  EXPECT_EQ(force(1.39, 9.0), 0.0);
  EXPECT_NEAR(force(0.19, 0.0), 5e4, 1e-9);
  EXPECT_NEAR(force(0.19, -0.1), 5e4 * 1.2, 1e-9);
  EXPECT_NEAR(force(0.19, 0.1), 5e4 * 0.8, 1e-9);
  EXPECT_EQ(force(0.19, 0.6), 0.0) << "a spring that is left faster than it follows does not pull";
  EXPECT_NEAR(force(1.41, 0.1), -5e4 * 1.2, 1e-9);
  EXPECT_EQ(force(1.41, -0.6), 0.0);
  EXPECT_NEAR(force(std::nextafter(0.2, 0.0), -3.0), 0.0, 1e-8) << "continuous where it begins, at any speed";
}

TEST(EndStopTest, HasTwoEnds) {
  Parameters p = stop;
  p.insert_or_assign("upper", 0.1);
  EXPECT_EQ(Probe<EndStop>(p).faults(), std::vector<std::string>{"lower: 0.2 m; expected less than upper = 0.1 m"});
}

}  // namespace
}  // namespace bramah::mechanics
