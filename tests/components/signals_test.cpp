#include <gtest/gtest.h>

#include <cmath>

#include "components/probe.hpp"
#include "components/signals/constant.hpp"
#include "components/signals/table.hpp"

namespace bramah::signals {
namespace {

using bramah::testing::Parameters;
using bramah::testing::Probe;

// The torque of Eq. (92).
const Parameters pulse = {{"unit", "N.m"}, {"times", {0.0, 1.0, 1.5, 1.5}}, {"values", {0.0, 250.0, 250.0, 0.0}}};

TEST(ConstantTest, Conforms) {
  EXPECT_TRUE(
      conforms<Constant>({{.parameters = {{"value", -3.0}}}, {.parameters = {{"value", 2.0}, {"unit", "bar"}}}}));
}

TEST(ConstantTest, StaysWhatItIs) {
  const Probe<Constant> probe({{"value", -3.0}});
  for (const double t : {-1e9, 0.0, 7.5}) {
    EXPECT_EQ(probe.signal(t, -1), -3.0);
    EXPECT_EQ(probe.signal(t, +1), -3.0);
    EXPECT_EQ(probe.next_breakpoint(t), HUGE_VAL);
  }
  EXPECT_STREQ(probe.type.terminals[0].unit, "@unit");
}

TEST(TableTest, Conforms) {
  EXPECT_TRUE(conforms<Table>({{.parameters = pulse},
                               {.parameters = {{"times", {2.0}}, {"values", {5.0}}}},
                               {.parameters = {{"times", {0.0, 0.0}}, {"values", {1.0, 2.0}}}}}));
}

TEST(TableTest, IsEquationNinetyTwo) {
  const Probe<Table> probe(pulse);
  EXPECT_EQ(probe.signal(-1.0, 1), 0.0);
  EXPECT_EQ(probe.signal(0.0, 1), 0.0);
  EXPECT_DOUBLE_EQ(probe.signal(0.3, 1), 75.0);
  EXPECT_EQ(probe.signal(1.0, -1), 250.0);
  EXPECT_EQ(probe.signal(1.0, +1), 250.0);
  EXPECT_EQ(probe.signal(1.2, +1), 250.0);
  EXPECT_EQ(probe.signal(1.5, -1), 250.0) << "from before the jump";
  EXPECT_EQ(probe.signal(1.5, +1), 0.0) << "from after the jump";
  EXPECT_EQ(probe.signal(9.0, -1), 0.0);
}

TEST(TableTest, BreakpointsComeStrictlyLater) {
  const Probe<Table> probe(pulse);
  EXPECT_EQ(probe.next_breakpoint(-5.0), 0.0);
  EXPECT_EQ(probe.next_breakpoint(0.0), 1.0);
  EXPECT_EQ(probe.next_breakpoint(0.999), 1.0);
  EXPECT_EQ(probe.next_breakpoint(1.0), 1.5);
  EXPECT_EQ(probe.next_breakpoint(1.5), HUGE_VAL);
}

TEST(TableTest, JumpsAtEitherEnd) {
  const Probe<Table> step({{"times", {0.0, 0.0}}, {"values", {1.0, 2.0}}});
  EXPECT_EQ(step.signal(0.0, -1), 1.0);
  EXPECT_EQ(step.signal(0.0, +1), 2.0);
  EXPECT_EQ(step.signal(-1.0, +1), 1.0);
  EXPECT_EQ(step.signal(1.0, -1), 2.0);
  const Probe<Table> point({{"times", {2.0}}, {"values", {5.0}}});
  for (const double t : {1.0, 2.0, 3.0}) EXPECT_EQ(point.signal(t, 1), 5.0);
}

TEST(TableTest, ReportsEveryFault) {
  using List = std::vector<std::string>;
  const std::vector<double> none;
  EXPECT_EQ(Probe<Table>({{"times", none}, {"values", none}}).faults(),
            List{"times: none; expected at least one time"});
  EXPECT_EQ(Probe<Table>({{"times", {0.0, 1.0}}, {"values", {0.0}}}).faults(),
            List{"values: 1 values; expected 2, one per time"});
  EXPECT_EQ(Probe<Table>({{"times", {0.0, 2.0, 1.0}}, {"values", {0.0, 0.0, 0.0}}}).faults(),
            List{"times: 1 s after 2 s; expected times in order"});
  EXPECT_EQ(Probe<Table>({{"times", {1.0, 1.0, 1.0}}, {"values", {0.0, 0.0, 0.0}}}).faults(),
            List{"times: 1 s more than twice; expected at most two points at one time"});
}

}  // namespace
}  // namespace bramah::signals
