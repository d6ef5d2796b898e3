#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "components/hydraulics/centre_path.hpp"
#include "components/hydraulics/check_valve.hpp"
#include "components/hydraulics/cylinder.hpp"
#include "components/hydraulics/directional_valve.hpp"
#include "components/hydraulics/hose.hpp"
#include "components/hydraulics/leakage.hpp"
#include "components/hydraulics/pipe.hpp"
#include "components/hydraulics/pressure_source.hpp"
#include "components/hydraulics/pump.hpp"
#include "components/hydraulics/relief_valve.hpp"
#include "components/hydraulics/throttle.hpp"
#include "components/hydraulics/volume.hpp"
#include "components/probe.hpp"

namespace bramah::hydraulics {
namespace {

using bramah::testing::Parameters;
using bramah::testing::Probe;

// Table 2.
const Parameters hose = {{"V_h", 3.14e-5}, {"B_h", 5.5e8}, {"B_oil", 1.5e9}};
const Parameters throttle = {{"C_d", 0.8}, {"A_t", 2.83e-5}, {"rho_oil", 850.0}};
const Parameters valve = {{"C_v", 2.138e-8}, {"tau", 0.0045}};
const Parameters cylinder = {{"D_2", 0.08}, {"D_3", 0.035},   {"l", 0.9},      {"c_1", 0.43},
                             {"c_2", 1.0},  {"B_oil", 1.5e9}, {"B_c", 3.15e10}};

TEST(VolumeTest, Conforms) { EXPECT_TRUE(conforms<Volume>()); }

TEST(VolumeTest, StoresNothingByItself) {
  Probe<Volume> probe;
  probe.zdot = {1e9};
  EXPECT_EQ(probe.rows().g, std::vector<double>{0.0});
  EXPECT_EQ(probe.start(), std::vector<double>{1e5});
  EXPECT_EQ(probe.type.variables[0].nominal, 1e6);
}

TEST(HoseTest, Conforms) { EXPECT_TRUE(conforms<Hose>({{.parameters = hose}})); }

TEST(HoseTest, AddsItsShareOfTheStorage) {
  Probe<Hose> probe(hose);
  probe.zdot = {1e6};
  const double K = 3.14e-5 * (1.0 / 1.5e9 + 1.0 / 5.5e8);
  EXPECT_DOUBLE_EQ(probe.rows().g[0], 1e6 * K);
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_ZDOT, 0, 0), K);
}

TEST(HoseTest, FillsWithVapourWhereTheOilIsPulled) {
  Probe<Hose> probe(hose);
  probe.zdot = {1e5};
  probe.z = {-2e4};
  const double vapour = 3.14e-5 * 4e8 / 1e12;  // V_h w^2 / p_w^3
  const double K = 3.14e-5 * (1.0 / 1.5e9 + 1.0 / 5.5e8) + vapour;
  EXPECT_NEAR(probe.rows().g[0], 1e5 * K, 1e-14 * 1e5 * K);
  EXPECT_NEAR(probe.partial(BRAMAH_G_Z, 0, 0), 1e5 * 3.14e-5 * -2.0 * 2e4 / 1e12, 1e-15);
  for (const double p : {0.0, 1.0, 1e5, 1e8}) {
    probe.z = {p};
    EXPECT_EQ(probe.rows().g[0], 1e5 * (3.14e-5 * (1.0 / 1.5e9 + 1.0 / 5.5e8))) << p << " Pa: to the last bit";
    EXPECT_EQ(probe.partial(BRAMAH_G_Z, 0, 0), 0.0);
  }
}

TEST(HoseTest, FreeAirIsIsothermalFarAboveTheTearing) {
  Parameters with_air = hose;
  with_air.emplace("air", 0.01);
  Probe<Hose> probe(with_air);
  probe.zdot = {1e5};
  for (const double p : {1e6, 1e7}) {
    probe.z = {p};
    const double K = 3.14e-5 * (1.0 / 1.5e9 + 1.0 / 5.5e8 + 0.01 * 101325.0 / (p * p));
    EXPECT_NEAR(probe.rows().g[0], 1e5 * K, 3.0 * std::pow(1e4 / p, 2) * 1e5 * K) << p << " Pa";
  }
}

TEST(CylinderTest, Conforms) {
  EXPECT_TRUE(conforms<Cylinder>({{.parameters = cylinder, .x = {1.73}, .v = {0.1}},
                                  {.parameters = cylinder, .x = {1.45}, .v = {0.0}, .z = {1e5, 1e5}},
                                  {.parameters = cylinder, .x = {2.3}, .v = {-2.0}, .z = {5e6, 1e5}}}));
}

TEST(CylinderTest, ForceAndStorage) {
  Probe<Cylinder> probe(cylinder);
  const double A_2 = std::numbers::pi * 0.0016, A_3 = A_2 - std::numbers::pi * 0.035 * 0.035 / 4.0;
  const double compliance = 1.0 / 1.5e9 + 1.0 / 3.15e10;
  probe.x = {1.73};
  probe.v = {0.2};
  probe.z = {2.8e6, 3.5e6};
  probe.zdot = {1e8, -3e8};
  const auto rows = probe.rows();
  const double force = A_2 * 2.8e6 - A_3 * 3.5e6;
  EXPECT_NEAR(rows.y[0], force, 1e-9);
  EXPECT_NEAR(rows.f[0], -force, 1e-9) << "f = M a - Q";
  EXPECT_NEAR(rows.y[1], 0.3, 1e-15);
  EXPECT_NEAR(rows.y[2], 0.6, 1e-15);
  EXPECT_NEAR(rows.g[0], A_2 * 0.3 * compliance * 1e8 + A_2 * 0.2, 1e-17);
  EXPECT_NEAR(rows.g[1], -A_3 * 0.6 * compliance * 3e8 - A_3 * 0.2, 1e-17);
  EXPECT_NEAR(probe.partial(BRAMAH_G_ZDOT, 0, 0), A_2 * 0.3 * compliance, 1e-25);
  EXPECT_NEAR(probe.partial(BRAMAH_G_ZDOT, 1, 1), A_3 * 0.6 * compliance, 1e-25);
}

TEST(CylinderTest, HoldsThePaperAtItsEquilibrium) {
  // paper-notes.md: with c1 = sqrt(3) - 1.3 the lengths are 0.3 and 0.6 m and the oil presses with -48.2506109 N.
  Parameters p = cylinder;
  p.insert_or_assign("c_1", std::sqrt(3.0) - 1.3);
  Probe<Cylinder> probe(p);
  probe.x = {std::sqrt(3.0)};
  probe.z = {2820478.97095417111, 3.5e6};
  const auto rows = probe.rows();
  EXPECT_NEAR(rows.y[0], -48.2506109296844382, 1e-8);
  EXPECT_NEAR(rows.y[1], 0.3, 1e-15);
}

TEST(CylinderTest, RodFitsThePiston) {
  Parameters p = cylinder;
  p.insert_or_assign("D_3", 0.08);
  EXPECT_EQ(Probe<Cylinder>(p).faults(),
            std::vector<std::string>{"D_3: 0.08 m; expected less than the piston's D_2 = 0.08 m"});
  EXPECT_TRUE(Probe<Cylinder>(cylinder).faults().empty());
}

TEST(ThrottleTest, Conforms) {
  EXPECT_TRUE(conforms<Throttle>({{.parameters = throttle, .z = {3e6, 2e6}},
                                  {.parameters = throttle, .z = {2e6, 3e6}},
                                  {.parameters = throttle, .z = {1.1e6, 1e6}},
                                  {.parameters = throttle, .z = {1e6, 1.15e6}},
                                  {.parameters = throttle, .z = {1e6, 1e6}},
                                  {.parameters = throttle, .z = {1.2e6, 1e6}, .side = 1},
                                  {.parameters = throttle, .z = {1.2e6, 1e6}, .side = -1},
                                  {.parameters = throttle, .z = {1e6, 1.2e6}, .side = 1},
                                  {.parameters = throttle, .z = {1e6, 1.2e6}, .side = -1}}));
}

/// Flow from a to b at the drop dp, and its slope.
std::array<double, 2> flow(double dp, int side = 1) {
  Probe<Throttle> probe(throttle);
  probe.z = {dp, 0.0};
  probe.side = side;
  const auto rows = probe.rows();
  EXPECT_EQ(rows.g[0], rows.y[0]) << "what leaves a";
  EXPECT_EQ(rows.g[1], -rows.y[0]) << "enters b";
  EXPECT_EQ(rows.switches[0], std::fabs(dp) - 2e5);
  return {rows.y[0], probe.partial(BRAMAH_Y_Z, 0, 0)};
}

TEST(ThrottleTest, IsEquationsFiveAndSix) {
  const double C_vt = 0.8 * 2.83e-5 * std::sqrt(2.0 / 850.0);
  EXPECT_EQ(flow(0.0)[0], 0.0);
  EXPECT_DOUBLE_EQ(flow(0.0)[1], C_vt / std::sqrt(2e5));
  EXPECT_DOUBLE_EQ(flow(1e5)[0], C_vt * 1e5 / std::sqrt(2e5));
  EXPECT_DOUBLE_EQ(flow(4e6)[0], C_vt * 2000.0);
  EXPECT_DOUBLE_EQ(flow(4e6)[1], C_vt / 4000.0);
  EXPECT_DOUBLE_EQ(flow(-4e6)[0], -C_vt * 2000.0) << "|dp| is tested, not dp";
  EXPECT_DOUBLE_EQ(flow(-4e6)[1], C_vt / 4000.0);
}

TEST(ThrottleTest, IsContinuousAtTheLimitWithHalfTheSlope) {
  for (const double sign : {1.0, -1.0}) {
    const double limit = sign * 2e5;
    const auto laminar = flow(limit, -1), turbulent = flow(limit, +1);
    EXPECT_DOUBLE_EQ(laminar[0], turbulent[0]);
    EXPECT_DOUBLE_EQ(laminar[1], 2.0 * turbulent[1]);
    EXPECT_NEAR(flow(std::nextafter(limit, 0.0))[0], flow(limit)[0], 1e-15 * std::fabs(laminar[0]));
    EXPECT_NEAR(flow(std::nextafter(limit, 2.0 * limit))[0], flow(limit)[0], 1e-15 * std::fabs(laminar[0]));
  }
}

TEST(DirectionalValveTest, Conforms) {
  const auto at = [](std::vector<double> z, int side = 1) {
    return Sample{.parameters = valve, .z = std::move(z), .side = side};
  };
  EXPECT_TRUE(conforms<DirectionalValve>(
      {at({7.6e6, 1e5, 2.8e6, 3.5e6, 0.5}), at({7.6e6, 1e5, 2.8e6, 3.5e6, -0.5}),
       at({7.6e6, 1e5, 2.8e6, 3.5e6, 0.0}, 1),                                    // the centre, from either side
       at({7.6e6, 1e5, 2.8e6, 3.5e6, 0.0}, -1), at({3e6, 1e5, 2.9e6, 2e5, 0.3}),  // laminar
       at({3e6, 1e5, 3.1e6, 0.5e5, 0.3}),                                         // laminar, backwards
       at({3e6, 1e5, 6e6, 0.0, -0.3}), at({1e5, 1e5, 1e5, 1e5, 0.0}, 1),          // no drop, no opening
       at({3e6, 1e5, 2.8e6, 3e5, 0.3}, 1),                                        // at both laminar limits
       at({3e6, 1e5, 2.8e6, 3e5, 0.3}, -1)}));
}

TEST(DirectionalValveTest, OpensThePathsOfItsSide) {
  const double C_v = 2.138e-8;
  Probe<DirectionalValve> probe(valve);
  probe.z = {7.6e6, 1e5, 2.8e6, 3.5e6, 0.5};
  const double in = 0.5 * C_v * std::sqrt(4.8e6), out = 0.5 * C_v * std::sqrt(3.4e6);
  auto rows = probe.rows();
  EXPECT_DOUBLE_EQ(rows.y[0], in);
  EXPECT_DOUBLE_EQ(rows.y[1], -out);
  EXPECT_DOUBLE_EQ(rows.g[0], in) << "from the pump";
  EXPECT_DOUBLE_EQ(rows.g[1], -out) << "into the tank";
  EXPECT_DOUBLE_EQ(rows.g[2], -in);
  EXPECT_DOUBLE_EQ(rows.g[3], out);

  probe.z[4] = -0.25;
  const double a_out = 0.25 * C_v * std::sqrt(2.7e6), b_in = 0.25 * C_v * std::sqrt(4.1e6);
  rows = probe.rows();
  EXPECT_DOUBLE_EQ(rows.y[0], -a_out);
  EXPECT_DOUBLE_EQ(rows.y[1], b_in);
  EXPECT_DOUBLE_EQ(rows.g[0], b_in);
  EXPECT_DOUBLE_EQ(rows.g[1], -a_out);
}

TEST(DirectionalValveTest, TakesTheStatedSideOfTheCentre) {
  // paper-notes.md, item 4: the column that Eq. (88) prints as zero.
  const double C_v = 2.138e-8;
  Probe<DirectionalValve> probe(valve);
  probe.z = {7.6e6, 1e5, 2.8e6, 3.5e6, 0.0};
  EXPECT_EQ(probe.rows().y, (std::vector<double>{0.0, -0.0}));
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_Z, 2, 4), -C_v * std::sqrt(4.8e6));
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_Z, 3, 4), C_v * std::sqrt(3.4e6));
  probe.side = -1;
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_Z, 2, 4), -C_v * std::sqrt(2.7e6));
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_Z, 3, 4), C_v * std::sqrt(4.1e6));
}

TEST(DirectionalValveTest, SpoolLagsItsReference) {
  Probe<DirectionalValve> probe(valve);
  probe.z[4] = 0.25;
  probe.zdot[4] = 10.0;
  probe.u = {1.0};
  EXPECT_DOUBLE_EQ(probe.rows().g[4], 0.0045 * 10.0 - (1.0 - 0.25));  // Eq. (4)
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_ZDOT, 4, 4), 0.0045);
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_Z, 4, 4), 1.0);
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_G_U, 4, 0), -1.0);
}

TEST(LeakageTest, Conforms) { EXPECT_TRUE(conforms<Leakage>({{.parameters = {{"C_L", 1e-11}}}})); }

TEST(LeakageTest, IsLaminarAtAnyDrop) {
  Probe<Leakage> probe({{"C_L", 1e-11}});
  for (const double drop : {2e7, 1e3, -5e6}) {
    probe.z = {3e6 + drop, 3e6};
    const auto rows = probe.rows();
    EXPECT_DOUBLE_EQ(rows.y[0], 1e-11 * drop);
    EXPECT_EQ(rows.g, (std::vector<double>{rows.y[0], -rows.y[0]}));  // g = K zdot - h
  }
}

TEST(ReliefValveTest, Conforms) {
  const Parameters relief = {{"p_crack", 2.8e7}, {"G_v", 2e-9}};
  EXPECT_TRUE(conforms<ReliefValve>({{.parameters = relief, .z = {3e7, 1e5}},
                                     {.parameters = relief, .z = {1e7, 1e5}},
                                     {.parameters = relief, .z = {2.81e7, 1e5}, .side = 1},
                                     {.parameters = relief, .z = {2.81e7, 1e5}, .side = -1}}));
}

TEST(ReliefValveTest, PassesWhatExceedsItsPressure) {
  Probe<ReliefValve> probe({{"p_crack", 2.8e7}, {"G_v", 2e-9}});
  const auto flow = [&](double p) {
    probe.z = {p, 1e5};
    const auto rows = probe.rows();
    EXPECT_EQ(rows.g, (std::vector<double>{rows.y[0], -rows.y[0]}));
    EXPECT_EQ(rows.switches[0], p - 1e5 - 2.8e7);
    return rows.y[0];
  };
  EXPECT_EQ(flow(2.8e7), 0.0);
  EXPECT_EQ(flow(2.81e7), 0.0) << "at the edge";
  EXPECT_DOUBLE_EQ(flow(2.91e7), 2e-3);
  EXPECT_EQ(flow(-1e7), 0.0) << "shut against the flow";
  probe.z = {2.81e7, 1e5};
  EXPECT_EQ(probe.partial(BRAMAH_Y_Z, 0, 0), 2e-9);
  probe.side = -1;
  EXPECT_EQ(probe.partial(BRAMAH_Y_Z, 0, 0), 0.0);
}

TEST(CheckValveTest, Conforms) {
  const Parameters check = {{"p_crack", 3e4}, {"C_v", 2e-6}};
  EXPECT_TRUE(conforms<CheckValve>({{.parameters = check, .z = {3e6, 1e5}},
                                    {.parameters = check, .z = {2e5, 1e5}},
                                    {.parameters = check, .z = {1e5, 3e6}},
                                    {.parameters = check, .z = {1.3e5, 1e5}, .side = 1},
                                    {.parameters = check, .z = {1.3e5, 1e5}, .side = -1},
                                    {.parameters = check, .z = {3.3e5, 1e5}, .side = 1},
                                    {.parameters = check, .z = {3.3e5, 1e5}, .side = -1}}));
}

TEST(CheckValveTest, LetsOilPassOneWay) {
  Probe<CheckValve> probe({{"p_crack", 3e4}, {"C_v", 2e-6}});
  const auto flow = [&](double drop) {
    probe.z = {1e5 + drop, 1e5};
    const auto rows = probe.rows();
    EXPECT_EQ(rows.g, (std::vector<double>{rows.y[0], -rows.y[0]}));
    EXPECT_DOUBLE_EQ(rows.switches[0], drop - 3e4);
    EXPECT_DOUBLE_EQ(rows.switches[1], drop - 2.3e5);
    return rows.y[0];
  };
  EXPECT_EQ(flow(-5e6), 0.0);
  EXPECT_EQ(flow(3e4), 0.0);
  EXPECT_DOUBLE_EQ(flow(1.3e5), 2e-6 * 1e5 / std::sqrt(2e5));
  EXPECT_DOUBLE_EQ(flow(2.3e5), 2e-6 * std::sqrt(2e5)) << "continuous at the laminar limit";
  EXPECT_DOUBLE_EQ(flow(4.03e6), 2e-6 * 2000.0);
}

TEST(CentrePathTest, Conforms) {
  const Parameters centre = {{"C_v", 7e-6}, {"U_shut", 0.6}};
  const auto at = [&](std::vector<double> z, int side = 1) {
    return Sample{.parameters = centre, .z = std::move(z), .side = side};
  };
  EXPECT_TRUE(conforms<CentrePath>({at({3e6, 1e6, 0.2}), at({3e6, 1e6, -0.3}), at({3e6, 1e6, 0.8}),
                                    at({3e6, 1e6, -0.9}), at({1.1e6, 1e6, 0.2}), at({1e6, 3e6, 0.2}),
                                    at({3e6, 1e6, 0.0}, 1), at({3e6, 1e6, 0.0}, -1), at({3e6, 1e6, 0.6}, 1),
                                    at({3e6, 1e6, -0.6}, -1), at({1.2e6, 1e6, 0.3}, 1), at({1.2e6, 1e6, 0.3}, -1)}));
}

TEST(CentrePathTest, ClosesEitherWay) {
  Probe<CentrePath> probe({{"C_v", 7e-6}, {"U_shut", 0.5}});
  const auto flow = [&](double U, double drop = 1e6) {
    probe.z = {1e6 + drop, 1e6, U};
    const auto rows = probe.rows();
    EXPECT_EQ(rows.g, (std::vector<double>{rows.y[0], -rows.y[0], 0.0})) << "the spool feels nothing";
    EXPECT_EQ(rows.switches, (std::vector<double>{U, 1.0 - std::fabs(U) / 0.5, std::fabs(drop) - 2e5}));
    return rows.y[0];
  };
  EXPECT_DOUBLE_EQ(flow(0.0), 7e-3);
  EXPECT_DOUBLE_EQ(flow(0.125), 0.75 * 7e-3);
  EXPECT_DOUBLE_EQ(flow(-0.375), 0.25 * 7e-3);
  EXPECT_EQ(flow(0.5), 0.0);
  EXPECT_EQ(flow(0.9), 0.0);
  EXPECT_EQ(flow(-1.0), 0.0);
  EXPECT_DOUBLE_EQ(flow(0.25, -1e6), -0.5 * 7e-3);
  probe.z = {2e6, 1e6, 0.0};
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_Y_Z, 0, 2), -7e-3 / 0.5);
  probe.side = -1;
  EXPECT_DOUBLE_EQ(probe.partial(BRAMAH_Y_Z, 0, 2), 7e-3 / 0.5);
}

const Parameters pump = {{"q", 3.2e-5}, {"p_set", 2e6}, {"p_band", 5e5}, {"alpha_min", 0.1}, {"tau", 0.08}};

TEST(PumpTest, Conforms) {
  // Variables: inlet, outlet, sense, alpha.
  const auto at = [](double outlet, int side = 1) {
    return Sample{.parameters = pump, .z = {1e5, outlet, 1e7, 0.7}, .u = {188.5}, .side = side};
  };
  EXPECT_TRUE(conforms<Pump>(
      {at(1.19e7), at(1.1e7), at(1.3e7), at(1.15e7, 1), at(1.15e7, -1), at(1.195e7, 1), at(1.195e7, -1)}));
}

TEST(PumpTest, DeliversItsDisplacement) {
  Probe<Pump> probe(pump);
  probe.z = {1e5, 1.19e7, 1e7, 0.7};
  probe.u = {188.5};
  const auto rows = probe.rows();
  const double Q = 3.2e-5 * 0.7 * 188.5;
  EXPECT_DOUBLE_EQ(rows.y[0], Q);
  EXPECT_DOUBLE_EQ(rows.g[0], Q) << "out of the tank";
  EXPECT_DOUBLE_EQ(rows.g[1], -Q);
  EXPECT_EQ(rows.g[2], 0.0) << "sensing takes no oil";
}

TEST(PumpTest, KeepsItsMarginAboveTheLoad) {
  Probe<Pump> probe(pump);
  probe.u = {188.5};
  const auto alpha_ref = [&](double outlet) {
    probe.z = {1e5, outlet, 1e7, 0.7};
    probe.zdot = {0.0, 0.0, 0.0, 2.0};
    return 0.08 * 2.0 - probe.rows().g[3] + 0.7;
  };
  EXPECT_NEAR(alpha_ref(1.1e7), 1.0, 1e-15) << "far below: all it has";
  EXPECT_NEAR(alpha_ref(1.15e7), 1.0, 1e-15);
  EXPECT_NEAR(alpha_ref(1.18e7), 0.4, 1e-14);
  EXPECT_NEAR(alpha_ref(1.195e7), 0.1, 1e-14);
  EXPECT_NEAR(alpha_ref(2.0e7), 0.1, 1e-15) << "far above: the least";
  probe.z = {1e5, 1.18e7, 1e7, 0.7};
  EXPECT_DOUBLE_EQ(probe.rows().switches[0], 2e5 - 0.1 * 5e5);
  EXPECT_DOUBLE_EQ(probe.rows().switches[1], 2e5 - 5e5);
  EXPECT_EQ(probe.start(), std::vector<double>{1.0});
}

const Parameters pipe = {{"d", 0.025}, {"l", 4.0}, {"rho_oil", 870.0}, {"mu", 0.03}};

TEST(PipeTest, Conforms) { EXPECT_TRUE(conforms<Pipe>({{.parameters = pipe, .z = {3e6, 1e6, 2e-3}}})); }

TEST(PipeTest, AcceleratesOilAgainstItsFriction) {
  Probe<Pipe> probe(pipe);
  const double area = std::numbers::pi * 0.025 * 0.025 / 4.0, L = 870.0 * 4.0 / area;
  const double R = 128.0 * 0.03 * 4.0 / (std::numbers::pi * std::pow(0.025, 4));  // Hagen and Poiseuille
  probe.z = {3e6, 1e6, 2e-3};
  probe.zdot = {0.0, 0.0, 0.5};
  const auto rows = probe.rows();
  EXPECT_EQ(rows.g[0], 2e-3);
  EXPECT_EQ(rows.g[1], -2e-3);
  EXPECT_NEAR(rows.g[2], L * 0.5 - (2e6 - R * 2e-3), 1e-14 * 2e6);
  const auto stored = probe.stored();
  EXPECT_NEAR(stored.energy, 0.5 * 870.0 * area * 4.0 * std::pow(2e-3 / area, 2), 1e-12) << "m v^2 / 2";
  const double taken = rows.g[0] * 3e6 + rows.g[1] * 1e6 + rows.g[2] * 2e-3;
  EXPECT_NEAR(taken - stored.rate, R * 4e-6, 1e-12 * taken) << "the rest is friction";
}

TEST(PressureSourceTest, Conforms) { EXPECT_TRUE(conforms<PressureSource>({{.parameters = {{"p", 7.6e6}}}})); }

TEST(PressureSourceTest, StaysWhatItIs) {
  const Probe<PressureSource> probe({{"p", 7.6e6}});
  EXPECT_EQ(probe.signal(3.0, -1), 7.6e6);
  EXPECT_EQ(probe.next_breakpoint(0.0), HUGE_VAL);
  EXPECT_STREQ(probe.type.terminals[0].kind, "pressure");
  EXPECT_EQ(probe.type.terminals[0].source, BRAMAH_SIGNAL);
}

}  // namespace
}  // namespace bramah::hydraulics
