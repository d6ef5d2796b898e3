#include <gtest/gtest.h>

#include <cmath>

#include "components/friction/brown_mcphee.hpp"
#include "components/friction/stick_slip.hpp"
#include "components/probe.hpp"

namespace bramah::friction {
namespace {

using bramah::testing::Parameters;
using bramah::testing::Probe;

const Parameters seal = {{"F_c", 210.0}, {"F_s", 830.0}, {"v_s", 0.0125}, {"sigma_2", 330.0}};  // Table 2

Parameters with(Parameters p, const std::string& name, const Setting& setting) {
  p.insert_or_assign(name, setting);
  return p;
}

TEST(BrownMcPheeTest, Conforms) {
  const Sample::Magnitude slow = {.v = 0.0125};
  EXPECT_TRUE(conforms<BrownMcPhee>({{.parameters = seal, .v = {0.0}, .magnitude = slow},
                                     {.parameters = seal, .v = {0.004}, .magnitude = slow},
                                     {.parameters = seal, .v = {-0.0125}, .magnitude = slow},
                                     {.parameters = seal, .v = {0.7}, .magnitude = slow},
                                     {.parameters = with(seal, "viscous_factor", "tanh4"), .v = {-0.02}}}));
}

double friction(const Parameters& p, double sdot) {
  Probe<BrownMcPhee> probe(p);
  probe.v = {sdot};
  const auto rows = probe.rows();
  EXPECT_DOUBLE_EQ(rows.f[0], rows.y[0]) << "friction opposes the motion: f = M a - Q, Q = -F";
  return rows.y[0];
}

TEST(BrownMcPheeTest, IsEquationEight) {
  EXPECT_EQ(friction(seal, 0.0), 0.0);
  for (const double w : {0.3, 1.0, -1.0, 2.5, -40.0}) {
    const double sdot = 0.0125 * w;
    const double expected = 210.0 * std::tanh(4.0 * w) + 620.0 * w / std::pow(0.25 * w * w + 0.75, 2) + 330.0 * sdot;
    EXPECT_NEAR(friction(seal, sdot), expected, 1e-12 * std::fabs(expected));
  }
  // At w = 1 the static part has its peak, the whole F_s - F_c.
  EXPECT_NEAR(friction(seal, 0.0125), 210.0 * std::tanh(4.0) + 620.0 + 330.0 * 0.0125, 1e-11);
}

TEST(BrownMcPheeTest, SlopeAtRest) {
  Probe<BrownMcPhee> probe(seal);
  const double steep = 4.0 * 210.0 / 0.0125 + 620.0 / 0.0125 / (9.0 / 16.0);  // N.s/m
  EXPECT_NEAR(probe.partial(BRAMAH_F_V, 0, 0), steep + 330.0, 1e-10 * steep);
  Probe<BrownMcPhee> original(with(seal, "viscous_factor", "tanh4"));
  EXPECT_NEAR(original.partial(BRAMAH_F_V, 0, 0), steep + 330.0 * std::tanh(4.0), 1e-10 * steep);
  EXPECT_NEAR(probe.partial(BRAMAH_Y_V, 0, 0), steep + 330.0, 1e-10 * steep);
}

TEST(BrownMcPheeTest, StaysFiniteAtAnySpeed) {
  EXPECT_NEAR(friction(seal, 1e6), 210.0 + 330.0e6, 1.0);
  EXPECT_NEAR(friction(seal, -1e6), -210.0 - 330.0e6, 1.0);
}

TEST(BrownMcPheeTest, StaticFrictionIsTheGreater) {
  const auto faults = Probe<BrownMcPhee>(with(seal, "F_c", 900.0)).faults();
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0], "F_s: 830 N; expected at least F_c = 900 N");
  EXPECT_TRUE(Probe<BrownMcPhee>(with(seal, "F_c", 830.0)).faults().empty());
}

const Parameters slip = {{"F_c", 300.0}, {"F_s", 500.0}, {"v_b", 1e-3}, {"v_s", 0.02}, {"sigma_2", 100.0}};

TEST(StickSlipTest, Conforms) {
  const Sample::Magnitude slow = {.v = 0.001};
  const auto at = [&](double v, int side = 1) {
    return Sample{.parameters = slip, .v = {v}, .side = side, .magnitude = slow};
  };
  EXPECT_TRUE(conforms<StickSlip>(
      {at(0.0), at(5e-4), at(-3e-4), at(0.01), at(-0.3), at(1e-3, 1), at(1e-3, -1), at(-1e-3, 1), at(-1e-3, -1)}));
}

TEST(StickSlipTest, CreepsBreaksAwayAndFalls) {
  const auto dry = [](double v) {
    Probe<StickSlip> probe(slip);
    probe.v = {v};
    const auto rows = probe.rows();
    EXPECT_EQ(rows.f[0], rows.y[0]) << "friction opposes the motion: f = M a - Q, Q = -F";
    EXPECT_EQ(rows.switches[0], std::fabs(v) - 1e-3);
    return rows.y[0] - 100.0 * v;
  };
  EXPECT_EQ(dry(0.0), 0.0);
  EXPECT_NEAR(dry(5e-4), 250.0, 1e-11);
  EXPECT_NEAR(dry(1e-3), 500.0, 1e-11) << "the peak";
  EXPECT_NEAR(dry(-1e-3), -500.0, 1e-11);
  EXPECT_NEAR(dry(0.021), 300.0 + 200.0 * std::exp(-1.0), 1e-11);
  EXPECT_NEAR(dry(-0.021), -300.0 - 200.0 * std::exp(-1.0), 1e-11);
  EXPECT_NEAR(dry(5.0), 300.0, 1e-11);
}

TEST(StickSlipTest, TakesTheStatedSideOfBreakAway) {
  Probe<StickSlip> probe(slip);
  for (const double v : {1e-3, -1e-3}) {
    probe.v = {v};
    probe.side = -1;
    EXPECT_NEAR(probe.partial(BRAMAH_F_V, 0, 0), 500.0 / 1e-3 + 100.0, 1e-8) << "sticks";
    probe.side = 1;
    EXPECT_NEAR(probe.partial(BRAMAH_F_V, 0, 0), -200.0 / 0.02 + 100.0, 1e-8) << "slips";
  }
}

TEST(StickSlipTest, StaticFrictionIsTheLarger) {
  EXPECT_EQ(Probe<StickSlip>(with(slip, "F_s", 100.0)).faults(),
            std::vector<std::string>{"F_s: 100 N; expected at least F_c = 300 N"});
}

}  // namespace
}  // namespace bramah::friction
