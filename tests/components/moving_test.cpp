// Wheels, edges, springs and traction: what moving and nonholonomic machines are made of.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "components/mechanics/knife_edge.hpp"
#include "components/mechanics/mass.hpp"
#include "components/mechanics/planar_bushing.hpp"
#include "components/mechanics/planar_traction.hpp"
#include "components/mechanics/rigid_body.hpp"
#include "components/mechanics/rolling_disc.hpp"
#include "components/mechanics/rolling_wheel.hpp"
#include "components/mechanics/spring_damper.hpp"
#include "components/mechanics/torsion_spring.hpp"
#include "components/mechanics/universal.hpp"
#include "components/mechanics/wheel.hpp"
#include "components/probe.hpp"

namespace bramah::mechanics {
namespace {

using bramah::testing::Parameters;
using bramah::testing::Probe;
using Vector = Vec3<double>;
using Rotation = Quaternion<double>;

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "component " << k;
}

/// A body's local values; w and alpha in body axes.
struct Pose {
  Vector r;
  Rotation e;
  Vector rdot, w, rddot, alpha;
  [[nodiscard]] std::vector<double> x() const { return {r[0], r[1], r[2], e[0], e[1], e[2], e[3]}; }
  [[nodiscard]] std::vector<double> v() const {
    const Rotation q = body_rate_transposed(e, 0.5 * w);
    return {rdot[0], rdot[1], rdot[2], q[0], q[1], q[2], q[3]};
  }
  [[nodiscard]] std::vector<double> a() const {
    const Rotation q = body_rate_transposed(e, 0.5 * alpha) - 0.25 * dot(w, w) * e;
    return {rddot[0], rddot[1], rddot[2], q[0], q[1], q[2], q[3]};
  }
};
std::vector<double> with(std::vector<double> list, double last) {
  list.push_back(last);
  return list;
}
/// Of the rows of a frame from `first` on: the torque in body axes.
Vector torque(const std::vector<double>& f, const Rotation& e, std::size_t first = 3) {
  return 0.5 * body_rate(e, Rotation{f[first], f[first + 1], f[first + 2], f[first + 3]});
}
const Pose pose = {{0.3, -0.2, 1.1}, quaternion_of({0.4, -0.9, 0.3}),
                   {1.0, 2.0, -0.5}, {0.7, -1.3, 0.4},
                   {0.2, -0.6, 0.9}, {-0.8, 0.5, 1.7}};

// ---- wheels --------------------------------------------------------------------------------------------------------

const Parameters rotor = {{"mass", 3.0}, {"A", 0.4}, {"C", 0.7}, {"axle", {0, 1, 0}}};

TEST(WheelTest, Conforms) {
  const Parameters eccentric = {
      {"mass", 3.0}, {"A", 0.4}, {"C", 0.7}, {"axle", {1, 2, -2}}, {"point", {0.3, -0.4, 0.5}}};
  EXPECT_TRUE(conforms<Wheel>({{.parameters = rotor},
                               {.parameters = eccentric},
                               {.parameters = eccentric, .x = with(pose.x(), 0.3), .v = with(pose.v(), 40.0)}}));
}

TEST(WheelTest, LockedIsARigidBody) {
  Probe<Wheel> wheel(rotor);
  Probe<RigidBody> body({{"mass", 3.0}, {"inertia", {0.4, 0.7, 0.4}}});
  wheel.x = with(pose.x(), 0.0);
  wheel.v = with(pose.v(), 0.0);
  wheel.a = with(pose.a(), 0.0);
  body.x = pose.x(), body.v = pose.v(), body.a = pose.a();
  wheel.u = body.u = {0.5, -0.3, -9.81};
  std::vector<double> f = wheel.rows().f;
  EXPECT_NEAR(f.back(), 0.7 * pose.alpha[1], 1e-14) << "the bearing holds the spin: C alpha.d";
  f.pop_back();
  expect_near(f, body.rows().f, 1e-13);
}

TEST(WheelTest, OffCentreTakesItsWeightAlong) {
  // About the centre of the carrier: m (a + alpha x r + w x (w x r)) and its moment.
  const Vector point = {0.3, -0.4, 0.5};
  Parameters p = rotor;
  p.insert({{"point", {point[0], point[1], point[2]}}});
  Probe<Wheel> wheel(p), centred(rotor);
  for (Probe<Wheel>* w : {&wheel, &centred}) {
    w->x = with(pose.x(), 0.2);
    w->v = with(pose.v(), 5.0);
    w->a = with(pose.a(), -3.0);
  }
  const Vector swing = cross(pose.alpha, point) + cross(pose.w, cross(pose.w, point));
  const Vector force = 3.0 * (pose.rddot + rotate(pose.e, swing));
  const std::vector<double> f = wheel.rows().f, f0 = centred.rows().f;
  const Vector more = torque(f, pose.e) - torque(f0, pose.e), expected = cross(point, rotate_back(pose.e, force));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(f[k], force[k], 1e-13);
    EXPECT_NEAR(more[k], expected[k], 1e-13);
  }
  EXPECT_NEAR(f[7], f0[7], 1e-14);
}

TEST(WheelTest, PrecessesUnderItsGyroscopicMoment) {
  // Turned about z at W with spin n about y: the carrier must hold h' = W e_z x C n e_y = -C n W e_x.
  Probe<Wheel> wheel(rotor);
  const Pose turning = {{0, 0, 0}, {1, 0, 0, 0}, {0, 0, 0}, {0, 0, 2.0}, {0, 0, 0}, {0, 0, 0}};
  wheel.x = with(turning.x(), 0.0);
  wheel.v = with(turning.v(), 50.0);
  wheel.a = with(turning.a(), 0.0);
  const std::vector<double> f = wheel.rows().f;
  const Vector M = torque(f, turning.e);
  EXPECT_NEAR(M[0], -0.7 * 50.0 * 2.0, 1e-13);
  EXPECT_NEAR(M[1], 0.0, 1e-14);
  EXPECT_NEAR(M[2], 0.0, 1e-14);
  EXPECT_EQ(f[7], 0.0);
}

TEST(WheelTest, StartsAndRefuses) {
  Parameters p = rotor;
  p.insert({{"angle", 0.1}, {"rate", 20.0}});
  EXPECT_EQ(Probe<Wheel>(p).start(), (std::vector<double>{0.1, 20.0}));
  const Probe<Wheel> heavy({{"mass", 3.0}, {"A", 0.4}, {"C", 0.81}, {"axle", {0, 0, 0}}});
  EXPECT_EQ(heavy.faults(),
            (std::vector<std::string>{"axle: (0, 0, 0); expected a direction: at least one number other than zero",
                                      "C: 0.81 kg.m^2; expected at most 2 A = 0.8 kg.m^2, that of a plate"}));
}

const Parameters disc = {{"mass", 3.0}, {"A", 0.4}, {"C", 0.7}, {"a", 0.25}, {"rho", 0.05}};

TEST(RollingDiscTest, Conforms) {
  EXPECT_TRUE(conforms<RollingDisc>({{.parameters = disc},
                                     {.parameters = {{"mass", 2.0}, {"A", 0.045}, {"C", 0.09}, {"a", 0.3}}},
                                     {.parameters = disc, .magnitude = {.v = 20.0}}}));
}

TEST(RollingDiscTest, StartsRolling) {
  Parameters p = disc;
  p.insert({{"position", {1.0, 2.0}}, {"yaw", 0.6}, {"lean", -0.4}, {"spin", 0.3}});
  p.insert({{"yaw_rate", -2.0}, {"lean_rate", 0.7}, {"spin_rate", 5.0}});
  Probe<RollingDisc> probe(p);
  const std::vector<double> start = probe.start();
  probe.x.assign(start.begin(), start.begin() + 6);
  probe.v.assign(start.begin() + 6, start.end());
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.c[0], 0.0, 1e-16);
  for (const double r : rows.r) EXPECT_NEAR(r, 0.0, 1e-15);
  EXPECT_NEAR(
      std::hypot(probe.v[0], probe.v[1]),
      std::hypot(0.25 * (5.0 + 2.0 * std::sin(0.4)) + 0.05 * 5.0 * std::cos(0.4), 0.7 * (0.25 * std::cos(0.4) + 0.05)),
      1e-15);
}

/// A disc in its own angles and the same as a wheel on a carrier R_z(yaw) R_x(lean).
struct Twins {
  const double yaw = 0.6, lean = -0.4, spin = 0.3, yaw1 = -2.0, lean1 = 0.7, spin1 = 5.0, yaw2 = 1.1, lean2 = -0.6,
               spin2 = 3.0;
  const double s = std::sin(lean), c = std::cos(lean);
  const Vector r = {1.0, 2.0, 0.31}, rdot = {0.4, -0.7, 0.2}, rddot = {-1.0, 0.3, 0.8};
  Pose carrier() const {
    const Rotation z = quaternion_of({0, 0, yaw}), x = quaternion_of({lean, 0, 0});
    const Rotation e = {z[0] * x[0], z[0] * x[1], z[3] * x[1], z[3] * x[0]};
    return {r,     e,
            rdot,  {lean1, yaw1 * s, yaw1 * c},
            rddot, {lean2, yaw2 * s + yaw1 * lean1 * c, yaw2 * c - yaw1 * lean1 * s}};
  }
  void set(Probe<RollingDisc>& p) const {
    p.x = {r[0], r[1], r[2], yaw, lean, spin};
    p.v = {rdot[0], rdot[1], rdot[2], yaw1, lean1, spin1};
    p.a = {rddot[0], rddot[1], rddot[2], yaw2, lean2, spin2};
  }
  template <class C>
  void set(Probe<C>& p) const {
    p.x = with(carrier().x(), spin);
    p.v = with(carrier().v(), spin1);
    p.a = with(carrier().a(), spin2);
  }
};

TEST(RollingDiscTest, IsAWheelOnACarrierOfTwoAngles) {
  const Twins twins;
  Probe<RollingDisc> own(disc);
  Probe<Wheel> wheel({{"mass", 3.0}, {"A", 0.4}, {"C", 0.7}});
  twins.set(own);
  twins.set(wheel);
  own.u = wheel.u = {0.5, -0.3, -9.81};
  const std::vector<double> f = own.rows().f, g = wheel.rows().f;
  const Vector M = torque(g, twins.carrier().e);
  expect_near({f[0], f[1], f[2]}, {g[0], g[1], g[2]}, 1e-13);
  EXPECT_NEAR(f[3], M[1] * twins.s + M[2] * twins.c, 1e-13);  // yaw turns about e_z
  EXPECT_NEAR(f[4], M[0], 1e-13);
  EXPECT_NEAR(f[5], g[7], 1e-13);
}

TEST(RollingDiscTest, RollsAsAWheelOnACarrierOfTwoAngles) {
  const Twins twins;
  Probe<RollingDisc> own(disc);
  Probe<RollingWheel> contact({{"a", 0.25}, {"rho", 0.05}});
  twins.set(own);
  twins.set(contact);
  const auto mine = own.rows();
  const auto other = contact.rows();
  expect_near(mine.c, other.c, 1e-15);
  expect_near(mine.r, other.r, 1e-14);
  expect_near(mine.s, other.s, 1e-13);
}

TEST(RollingWheelTest, Conforms) {
  const Parameters p = {{"a", 0.25}, {"rho", 0.05}, {"point", {0.1, 0.2, -0.3}}, {"axle", {0.1, 2.0, 0.3}}};
  EXPECT_TRUE(conforms<RollingWheel>({{.parameters = {{"a", 0.3}}, .x = with(pose.x(), 0.4), .v = with(pose.v(), 5.0)},
                                      {.parameters = p, .x = with(pose.x(), 0.4), .v = with(pose.v(), 5.0)},
                                      {.parameters = p, .x = {0, 0, 0.3, 1, 0, 0, 0, 0}}}));
}

TEST(RollingWheelTest, UprightRollsOnItsOuterRadius) {
  Probe<RollingWheel> probe({{"a", 0.25}, {"rho", 0.05}});
  const double yaw = 0.7, rate = 4.0;
  const Rotation e = quaternion_of({0, 0, yaw});
  probe.x = {5.0, 6.0, 0.3, e[0], e[1], e[2], e[3], 1.0};
  probe.v = {1.2 * std::cos(yaw), 1.2 * std::sin(yaw), 0, 0, 0, 0, 0, rate};  // (0.25 + 0.05) 4
  auto rows = probe.rows();
  EXPECT_NEAR(rows.c[0], 0.0, 1e-16);
  for (const double r : rows.r) EXPECT_NEAR(r, 0.0, 1e-15);
  // A body that turns itself rolls just as well.
  const Rotation q = body_rate_transposed(e, Vector{0, 0.5 * rate, 0});
  for (std::size_t k = 0; k < 4; ++k) probe.v[3 + k] = q[k];
  probe.v[7] = 0.0;
  for (const double r : probe.rows().r) EXPECT_NEAR(r, 0.0, 1e-15);
}

// ---- joints and edges ----------------------------------------------------------------------------------------------

TEST(UniversalTest, Conforms) {
  const Parameters p = {{"point_a", {0.1, 0.5, -0.2}}, {"point_b", {-0.7, 0.2, 0.3}}, {"axis_a", {1, 2, -2}}};
  EXPECT_TRUE(conforms<Universal>({{}, {.parameters = p}}));
}

TEST(UniversalTest, LetsBothArmsTurn) {
  Probe<Universal> probe;
  for (const double angle : {0.0, 0.5, 1.4}) {  // b turns about the arm of a, then about its own
    const Rotation x = quaternion_of({angle, 0, 0}), y = quaternion_of({0, 0.3, 0});
    const Rotation e = {x[0] * y[0], x[1] * y[0], x[0] * y[2], x[1] * y[2]};
    probe.x = {1, 2, 3, 1, 0, 0, 0, 1, 2, 3, e[0], e[1], e[2], e[3]};
    for (const double c : probe.rows().c) EXPECT_NEAR(c, 0.0, 1e-15);
  }
  const Rotation z = quaternion_of({0, 0, 0.3});
  probe.x = {1, 2, 3, 1, 0, 0, 0, 1.5, 2, 3, z[0], z[1], z[2], z[3]};
  expect_near(probe.rows().c, {-0.5, 0.0, 0.0, -std::sin(0.3)}, 1e-15);
}

TEST(KnifeEdgeTest, Conforms) {
  EXPECT_TRUE(conforms<KnifeEdge>({{}, {.parameters = {{"point", {-0.4, 0.1}}, {"direction", {3.0, 1.0}}}}}));
}

TEST(KnifeEdgeTest, SlidesAlongOnly) {
  Probe<KnifeEdge> probe({{"point", {-0.4, 0.0}}});
  const double angle = 0.3, along = 2.0, turn = 0.5;
  probe.x = {1.0, 1.0, angle};
  // -x' sin + y' cos - e angle'
  probe.v = {along * std::cos(angle) - 0.4 * turn * std::sin(angle),
             along * std::sin(angle) + 0.4 * turn * std::cos(angle), turn};
  EXPECT_NEAR(probe.rows().r[0], 0.0, 1e-16);
  probe.v = {-0.1 * std::sin(angle), 0.1 * std::cos(angle), 0.0};
  EXPECT_NEAR(probe.rows().r[0], 0.1, 1e-16);
}

// ---- springs and forces --------------------------------------------------------------------------------------------

TEST(MassTest, Conforms) { EXPECT_TRUE(conforms<Mass>({{.parameters = {{"mass", 2.0}}}})); }
TEST(MassTest, IsInert) {
  Probe<Mass> probe({{"mass", 2.0}, {"position", 0.3}, {"velocity", -4.0}});
  probe.a = {5.0};
  EXPECT_EQ(probe.rows().f, std::vector<double>{10.0});
  EXPECT_EQ(probe.start(), (std::vector<double>{0.3, -4.0}));
}

TEST(SpringDamperTest, Conforms) {
  EXPECT_TRUE(conforms<SpringDamper>({{.parameters = {{"stiffness", 3.0}, {"damping", 0.5}, {"free_length", 0.2}}}}));
}
TEST(SpringDamperTest, PullsItsEndsTogether) {
  Probe<SpringDamper> probe({{"stiffness", 100.0}, {"damping", 5.0}, {"free_length", 0.5}});
  probe.x = {1.75, 1.0};  // to, from
  probe.v = {3.0, 1.0};
  const auto rows = probe.rows();
  EXPECT_EQ(rows.y[0], 35.0);
  EXPECT_EQ(rows.f, (std::vector<double>{35.0, -35.0}));  // f = M a - Q
}

TEST(TorsionSpringTest, Conforms) {
  EXPECT_TRUE(conforms<TorsionSpring>({{.parameters = {{"stiffness", 3.0}, {"damping", 0.5}, {"free_angle", 0.2}}}}));
}
TEST(TorsionSpringTest, TurnsItsEndsTogether) {
  Probe<TorsionSpring> probe({{"stiffness", 100.0}, {"damping", 5.0}, {"free_angle", 0.5}});
  probe.x = {1.75, 1.0};
  probe.v = {3.0, 1.0};
  const auto rows = probe.rows();
  EXPECT_EQ(rows.y[0], 35.0);
  EXPECT_EQ(rows.f, (std::vector<double>{35.0, -35.0}));
}

const Parameters bushing = {
    {"point_a", {0.1, -0.2}}, {"point_b", {0.5, 0.3}}, {"stiffness", {200.0, 30.0}}, {"damping", {4.0, 7.0}}};

TEST(PlanarBushingTest, Conforms) { EXPECT_TRUE(conforms<PlanarBushing>({{.parameters = bushing}, {}})); }

TEST(PlanarBushingTest, IsASpringToALine) {
  Probe<PlanarBushing> probe({{"point_b", {0.6, 0.0}}, {"stiffness", {0.0, 200.0}}});
  probe.x = {0, 0, 0, 7.0, 0.5, 0.25};
  const auto rows = probe.rows();
  const double F = 200.0 * (0.5 + 0.6 * std::sin(0.25));
  EXPECT_NEAR(rows.f[3], 0.0, 1e-13);
  EXPECT_NEAR(rows.f[4], F, 1e-13);
  EXPECT_NEAR(rows.f[5], F * 0.6 * std::cos(0.25), 1e-13);
  EXPECT_NEAR(rows.y[1], F, 1e-13);
}

TEST(PlanarBushingTest, KeepsMomentumAndDissipates) {
  Probe<PlanarBushing> probe(bushing);
  probe.x = {0.3, -0.4, 0.7, 1.1, 0.6, -0.9};
  probe.v = {0.5, 1.5, -2.0, -0.3, 0.8, 1.2};
  const auto rows = probe.rows();
  const auto& f = rows.f;
  EXPECT_NEAR(f[0] + f[3], 0.0, 1e-12);
  EXPECT_NEAR(f[1] + f[4], 0.0, 1e-12);
  EXPECT_NEAR(f[2] + f[5] + 0.3 * f[1] + 0.4 * f[0] + 1.1 * f[4] - 0.6 * f[3], 0.0, 1e-12) << "moment about the origin";
  // Turning and drifting together strains nothing.
  const double w = 0.8;
  probe.v = {0.4 * w, 0.3 * w, w, -0.6 * w, 1.1 * w, w};
  const auto together = probe.rows();
  probe.v.assign(6, 0.0);
  expect_near(together.y, probe.rows().y, 1e-13);
}

const Parameters load = {{"X_0", 20000.0}, {"c_d", 600.0}, {"point", {0.0, -0.35}}, {"direction", {2.0, 0.0}}};

TEST(PlanarTractionTest, Conforms) {
  EXPECT_TRUE(conforms<PlanarTraction>({{.parameters = load}, {.parameters = {{"direction", {1.0, -2.0}}}}}));
}
TEST(PlanarTractionTest, PushesAhead) {
  Probe<PlanarTraction> probe(load);
  probe.x = {0, 0, std::numbers::pi / 2};
  probe.v = {0.0, 6.0, 2.0};  // the point is 0.35 m right of the centre, where turning left goes ahead
  probe.u = {30000.0};
  const double F = 30000.0 - 20000.0 - 600.0 * (6.0 + 0.7);
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.y[0], F, 1e-10);
  expect_near(rows.f, {0.0, -F, -0.35 * F}, 1e-9);
}

}  // namespace
}  // namespace bramah::mechanics
