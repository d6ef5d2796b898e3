// The judge judged: sound components pass, and each way to break one is seen and named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "bramah/component.hpp"
#include "bramah/conformance.hpp"

namespace bramah {
namespace {

using ::testing::HasSubstr;

// ---- sound ones, for what the shipped components do not have -------------------------------------------------------

/// Rows of both kinds, one of them in time, outputs of multipliers and accelerations.
struct Skate {
  PlanarFrame body;
  Coordinate lift;
  HolonomicRow ramp;
  NonholonomicRow edge;
  Output grip, jolt;

  void describe(Description& is) {
    is.called("test/skate", "a knife edge on a ramp that rises with time");
    is.port("body", body, "what skates");
    is.own("lift", lift, "m", "height of the ramp").nominal(0.5);
    is.holonomic("ramp", ramp, "m", "lift - x t sin(t)");
    is.nonholonomic("edge", edge, "m/s", "no speed across, at a point ahead that moves with time");
    is.output("grip", grip, "N", "force across");
    is.output("jolt", jolt, "m/s^2", "acceleration along, less that of the lift");
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    rows(ramp) = at(lift) - at.position(body)[0] * at.time() * sin(at.time());
  }
  template <class T>
  void nonholonomic(const Motion<T>& at, Values<T>& rows) const {
    const Vec2<T> across = at.direction(body, {0.0, 1.0});
    rows(edge) = dot(across, at.velocity(body)) + at.rate_of_angle(body) * at.time() * at(lift);
  }
  template <class T>
  void output(const At<T>& at, Values<T>& y) const {
    y(grip) = at.multiplier(edge) * 2.0 + at.multiplier(ramp) * at.angle(body);
    y(jolt) = at.acceleration(body)[0] * cos(at.angle(body)) - at.acceleration(lift);
  }
};

TEST(ConformanceTest, PassesRowsOfBothKindsInTime) {
  EXPECT_TRUE(conforms<Skate>({{}, {.time = 0.0}, {.v = {0, 0, 0, 0}, .time = -3.0}}));
}

/// A row that compares, on every scalar that rows are evaluated on.
struct Bearing {
  PlanarFrame body;
  Coordinate angle;
  HolonomicRow row;

  void describe(Description& is) {
    is.called("test/bearing", "the direction in which a body is seen");
    is.port("body", body, "what is seen");
    is.own("angle", angle, "rad", "where it is seen").nominal(1.0);
    is.holonomic("row", row, "rad", "angle of the position less the coordinate");
  }
  template <class T>
  void holonomic(const Positions<T>& at, Values<T>& rows) const {
    const Vec2<T> r = at.position(body);
    rows(row) = atan2(r[1], r[0]) - at(angle);
  }
};

TEST(ConformanceTest, PassesRowsThatCompare) {
  EXPECT_TRUE(conforms<Bearing>({{.x = {1.0, 0.3, 0.2, 0.0}}, {.x = {-0.2, -1.0, 0.2, 0.0}}}));
}

// ---- broken ones ---------------------------------------------------------------------------------------------------

struct OnCoordinate {  // what the broken ones share
  Coordinate q;
  void name(Description& is, const char* type) {
    is.called(type, "broken on purpose");
    is.port("q", q, "a coordinate", "m");
  }
};

struct Leak : OnCoordinate {
  void describe(Description& is) { name(is, "test/leak"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, at(q) * value(at(q)));  // half of the slope gets lost
  }
};

struct QuadraticRow : OnCoordinate {
  NonholonomicRow row;
  void describe(Description& is) {
    name(is, "test/quadratic");
    is.nonholonomic("row", row, "m/s", "not affine in v");
  }
  template <class T>
  void nonholonomic(const Motion<T>& at, Values<T>& rows) const {
    rows(row) = at.rate(q) * at.rate(q);
  }
};

struct OffsetRow : OnCoordinate {
  NonholonomicRow row;
  void describe(Description& is) {
    name(is, "test/offset");
    is.nonholonomic("row", row, "m/s", "not zero at rest");
  }
  template <class T>
  void nonholonomic(const Motion<T>& at, Values<T>& rows) const {
    rows(row) = at.rate(q) + 1.0;
  }
};

struct RateReader : OnCoordinate {
  Pressure p;
  void describe(Description& is) {
    name(is, "test/rate_reader");
    is.port("p", p, "a pressure", "Pa");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, at.rate(p));
  }
};

struct AccelerationReader : OnCoordinate {
  Pressure p;
  void describe(Description& is) {
    name(is, "test/acceleration_reader");
    is.port("p", p, "a pressure", "Pa");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.inflow(p, at.acceleration(q));
  }
};

struct Hoarder : OnCoordinate {
  void describe(Description& is) { name(is, "test/hoarder"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    std::vector<T> memory;
    memory.push_back(at(q));
    rows.apply(q, memory.back());
  }
};

struct LopsidedMass : OnCoordinate {
  Coordinate other;
  void describe(Description& is) {
    name(is, "test/lopsided");
    is.port("other", other, "another coordinate", "m");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, at.acceleration(other));
  }
};

struct Moody : OnCoordinate {
  mutable double mood = 0.0;
  void describe(Description& is) { name(is, "test/moody"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    mood += 1e-3;
    rows.apply(q, at(q) + mood);
  }
};

struct Rooted : OnCoordinate {
  void describe(Description& is) { name(is, "test/rooted"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, sqrt(at(q)));
  }
};

/// Depends on q, which Trace cannot see.
struct Hidden : OnCoordinate {
  void describe(Description& is) { name(is, "test/hidden"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    const double seen = value(at(q));
    if constexpr (std::is_same_v<T, Trace>) Trace::compared() = false;
    rows.apply(q, T(seen));
  }
};

struct Kinked : OnCoordinate {
  void describe(Description& is) { name(is, "test/kinked"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, abs(at(q)));
  }
};

struct Nameless {
  Coordinate q;
  double k = 0.0;
  Coordinate mine;
  void describe(Description& is) {
    is.called("nameless", "");
    is.port("k", q, "");
    is.parameter("k", k, "").by_default(-1.0).above(0.0);
    is.own("mi ne", mine, "", "").nominal(0.0);
  }
};

struct Stuck {
  void describe(Description& is) {
    is.called("test/stuck", "a signal whose breakpoints do not advance");
    is.provide_signal<Input>("value", "1", "the value");
  }
  [[nodiscard]] double signal(double, int) const { return 0.0; }
  [[nodiscard]] double next_breakpoint(double t) const { return t < 0.0 ? 0.0 : t; }
};

struct Split {
  void describe(Description& is) {
    is.called("test/split", "a signal that jumps everywhere");
    is.provide_signal<Input>("value", "1", "the value");
  }
  [[nodiscard]] double signal(double, int side) const { return side; }
  [[nodiscard]] double next_breakpoint(double) const { return HUGE_VAL; }
};

struct Silent : OnCoordinate {
  Output said;
  void describe(Description& is) {
    name(is, "test/silent");
    is.output("said", said, "m", "never given a value");
  }
  template <class T>
  void output(const At<T>&, Values<T>&) const {}
};
struct Forward : OnCoordinate {
  Coordinate other;
  void describe(Description& is) { name(is, "test/forward"); }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, at(other));
  }
};

template <class C>
std::string fault_of(const std::vector<Sample>& samples = {Sample{}}) {
  const Conformance c = conforms<C>(samples);
  EXPECT_EQ(c.ok, c.message.empty());
  return c.message;
}

TEST(ConformanceTest, SeesALostDerivative) {
  const std::string fault = fault_of<Leak>({{.x = {3.0}}});
  EXPECT_THAT(fault, HasSubstr("test/leak, sample 1: F_X: d(force on q)/d(q) is -3; differences give -6"));
}
TEST(ConformanceTest, SeesARowThatIsNotAffineInTheVelocities) {
  const std::string fault = fault_of<QuadraticRow>();
  EXPECT_THAT(fault, HasSubstr("the nonholonomic row \"row\" is not affine in the rates"));
}
TEST(ConformanceTest, AcceptsARowThatIsNotZeroAtRest) { EXPECT_EQ(fault_of<OffsetRow>(), ""); }
TEST(ConformanceTest, SeesADependenceThatNoBlockHolds) {
  EXPECT_THAT(fault_of<RateReader>(), HasSubstr("structure refused"));
  EXPECT_THAT(fault_of<AccelerationReader>(), HasSubstr("structure refused"));
}
TEST(ConformanceTest, SeesADependenceOutsideThePattern) {
  EXPECT_THAT(fault_of<Hidden>(), HasSubstr("force on q depends on q, by"));
  EXPECT_THAT(fault_of<Hidden>(), HasSubstr("outside its pattern"));
}
TEST(ConformanceTest, SeesAllocation) { EXPECT_THAT(fault_of<Hoarder>(), HasSubstr("evaluate allocated")); }
TEST(ConformanceTest, SeesAMassMatrixThatIsNotSymmetric) {
  EXPECT_THAT(fault_of<LopsidedMass>(), HasSubstr("F_A is not symmetric"));
}
TEST(ConformanceTest, SeesAMemory) { EXPECT_THAT(fault_of<Moody>(), HasSubstr("a second evaluation changes")); }
TEST(ConformanceTest, SeesNumbersThatAreNone) {
  EXPECT_THAT(fault_of<Rooted>({{.x = {-1.0}}}), HasSubstr("force on q was not written, or is"));
  EXPECT_THAT(fault_of<Rooted>({{.x = {0.0}}}), HasSubstr("a partial of block F_X was not written, or is not finite"));
  EXPECT_TRUE(conforms<Rooted>({{.x = {2.0}}}));
}
TEST(ConformanceTest, SeesAKinkThatIsNotDeclared) {
  EXPECT_TRUE(conforms<Kinked>({{.x = {0.1}}, {.x = {-1e-3}}}));
  EXPECT_THAT(fault_of<Kinked>({{.x = {0.0}}}), HasSubstr("F_X: d(force on q)/d(q)"));
}
TEST(ConformanceTest, SeesAnIncompleteDescription) {
  const std::string fault = fault_of<Nameless>();
  for (const char* part : {"the form domain/name", "doc of the type is missing", "doc of parameter k is missing",
                           "unit of parameter k is missing", "parameter k is outside its limits by default",
                           "port 'k' has the name of another", "doc of port k is missing",
                           "variable 'mi ne': a name has letters, digits and _ only",
                           "unit of variable mi ne is missing", "variable mi ne needs a positive nominal"}) {
    EXPECT_THAT(fault, HasSubstr(part));
  }
}
TEST(ConformanceTest, SeesSignalsThatMislead) {
  EXPECT_THAT(fault_of<Stuck>(), HasSubstr("the next breakpoint after 0 is 0, not later"));
  EXPECT_THAT(fault_of<Split>(), HasSubstr("the limits are -1 and 1"));
}
TEST(ConformanceTest, SeesWhatIsDeclaredAndNeverGiven) {
  EXPECT_THAT(fault_of<Silent>(), HasSubstr("the output \"said\" is declared and never given a value"));
}
TEST(ConformanceTest, SeesWhatIsReadAndNeverDeclared) {
  EXPECT_THAT(fault_of<Forward>(), HasSubstr("a law uses a port, variable or row that describe does not declare"));
}

struct Tuned : OnCoordinate {
  double k = 0.0;
  int mode = 0;
  void describe(Description& is) {
    name(is, "test/tuned");
    is.parameter("k", k, "N/m").above(0.0).doc("stiffness");
    is.choice("mode", mode, {"soft", "hard"}).by_default(0.0).doc("how");
  }
  void check(Faults& faults) const {
    if (k > 1e6) faults.add("k", "too stiff", "a spring");
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, mode == 0 ? T(-k * at(q)) : T(-k * at(q) * at(q) * at(q)));
  }
};

TEST(ConformanceTest, SeesUnfitSamples) {
  EXPECT_TRUE(conforms<Tuned>({{.parameters = {{"k", 2.0}}}, {.parameters = {{"k", 2.0}, {"mode", "hard"}}}}));
  EXPECT_THAT(fault_of<Tuned>(), HasSubstr("the sample needs the parameter k"));
  EXPECT_THAT(fault_of<Tuned>({{.parameters = {{"k", -2.0}}}}),
              HasSubstr("the sample gives -2 for k, outside its limits"));
  EXPECT_THAT(fault_of<Tuned>({{.parameters = {{"k", 2.0}, {"K", 1.0}}}}),
              HasSubstr("the sample gives 'K', which is no parameter"));
  EXPECT_THAT(fault_of<Tuned>({{.parameters = {{"k", 2.0}, {"mode", "loud"}}}}), HasSubstr("numbers for mode"));
  EXPECT_THAT(fault_of<Tuned>({{.parameters = {{"k", 2e6}}}}), HasSubstr("check of k: too stiff; expected a spring"));
  EXPECT_THAT(fault_of<Tuned>({{.parameters = {{"k", 2.0}}, .x = {1.0, 2.0}}}), HasSubstr("2 numbers for family"));
}

// ---- tangents --------------------------------------------------------------------------------------------------------

/// A parameter whose derivative is lost on the way into a member that the law reads.
struct Forgetful : OnCoordinate {
  Parameter k = 0.0;
  double half = 0.0;
  void describe(Description& is) {
    name(is, "test/forgetful");
    is.parameter("k", k, "N/m").above(0.0).doc("stiffness");
    half = 0.5 * k.value();
  }
  template <class T>
  void balance(const At<T>& at, Rows<T>& rows) const {
    rows.apply(q, -k * at(q) - half * square(at(q)));
  }
};

/// A start value whose derivative is lost.
struct Beginner {
  Coordinate q;
  Parameter first = 0.0;
  void describe(Description& is) {
    is.called("test/beginner", "a start value that follows from a parameter");
    is.own("q", q, "m", "a coordinate");
    is.parameter("first", first, "m").doc("start");
  }
  void start(Start& start) const { start(q) = square(first.value()); }
  template <class T>
  void balance(const At<T>&, Rows<T>& rows) const {
    rows.inertia(q, 1.0);
  }
};

TEST(ConformanceTest, SeesALostTangent) {
  const std::string fault = fault_of<Forgetful>({{.parameters = {{"k", 2.0}}, .x = {3.0}}});
  EXPECT_THAT(fault, HasSubstr("sample 1: tangent of force on q along parameter k is"));
  EXPECT_THAT(fault, HasSubstr("tangent of F_X, d(force on q)/d(q), along parameter k is"));
  EXPECT_THAT(fault_of<Beginner>({{.parameters = {{"first", 2.0}}}}),
              HasSubstr("tangent of start value, constant or signal 1 along parameter first is 0; differences give"));
}
TEST(ConformanceTest, ShowsItsFaultsInAFailedExpectation) {
  const ::testing::AssertionResult result(conforms<Hoarder>());
  EXPECT_FALSE(result);
  EXPECT_THAT(result.message(), HasSubstr("test/hoarder, sample 1: evaluate allocated"));
  std::ostringstream printed;
  printed << conforms<Tuned>();
  EXPECT_THAT(printed.str(), HasSubstr("test/tuned, sample 1: the sample needs"));
}

}  // namespace
}  // namespace bramah
