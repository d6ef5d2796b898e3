#include "system/units.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace bramah {
namespace {

using Twice = std::array<signed char, 6>;  // m, kg, s, A, K, rad

// "80 mm" in SI; NaN where the text or its unit is not understood.
double si(std::string_view text) {
  const std::optional<Quantity> quantity = parse_quantity(text);
  if (!quantity) return std::nan("");
  const std::optional<Unit> unit = parse_unit(quantity->unit);
  return unit ? unit->to_si(quantity->value) : std::nan("");
}

Twice dimension(std::string_view text) {
  const std::optional<Unit> unit = parse_unit(text);
  return unit ? unit->twice : Twice{99, 99, 99, 99, 99, 99};
}

TEST(Units, ConvertToTheNearestDouble) {
  EXPECT_EQ(si("80 mm"), 0.08);
  EXPECT_EQ(si("0.1 MPa"), 1e5);
  EXPECT_EQ(si("1500 MPa"), 1.5e9);
  EXPECT_EQ(si("3.14 L/min"), 3.14 / 60000);
  EXPECT_EQ(si("60 L/min"), 1e-3);
  EXPECT_EQ(si("250 bar"), 2.5e7);
  EXPECT_EQ(si("3 mbar"), 300.0);
  EXPECT_EQ(si("7 cm"), 0.07);
  EXPECT_EQ(si("31.4 cm^3"), 31.4e-6);
  EXPECT_EQ(si("12 um"), 12e-6);
  EXPECT_EQ(si("12 µm"), 12e-6);       // U+00B5
  EXPECT_EQ(si("12 \u03bcm"), 12e-6);  // U+03BC
  EXPECT_EQ(si("5 ms"), 5e-3);
  EXPECT_EQ(si("7 g"), 7e-3);
  EXPECT_EQ(si("7 mg"), 7e-6);
  EXPECT_EQ(si("7 kg"), 7.0);
  EXPECT_EQ(si("7 t"), 7000.0);
  EXPECT_EQ(si("2 min"), 120.0);
  EXPECT_EQ(si("2 h"), 7200.0);
  EXPECT_EQ(si("36 km/h"), 10.0);
  EXPECT_EQ(si("3 %"), 0.03);
  EXPECT_EQ(si("3 percent"), 0.03);
  EXPECT_EQ(si("210 GPa"), 2.1e11);
  EXPECT_EQ(si("2 TW"), 2e12);
  EXPECT_EQ(si("3 kN/mm"), 3e6);
  EXPECT_EQ(si("3 N/mm^2"), 3e6);
  EXPECT_EQ(si("1 in"), 0.0254);
  EXPECT_EQ(si("42"), 42.0);
}

TEST(Units, ConvertAngles) {
  EXPECT_EQ(si("180 deg"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(si("60 deg"), std::numbers::pi / 3);
  EXPECT_EQ(si("1 rev"), 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(si("60 rpm"), 2 * std::numbers::pi);
  EXPECT_EQ(si("1500 rpm"), si("1500 rev/min"));
  EXPECT_DOUBLE_EQ(si("6 deg/s"), si("1 rpm"));
  EXPECT_EQ(si("3 mrad"), 3e-3);
}

TEST(Units, ConvertPsiAndCelsius) {
  EXPECT_DOUBLE_EQ(si("1 psi"), 6894.757293168361);
  EXPECT_EQ(si("20 degC"), 293.15);
  EXPECT_EQ(si("-273.15 degC"), 0.0);
  EXPECT_EQ(dimension("degC"), dimension("K"));
}

TEST(Units, KnowDimensions) {
  EXPECT_EQ(dimension(""), Twice{});
  EXPECT_EQ(dimension("1"), Twice{});
  EXPECT_EQ(dimension("%"), Twice{});
  EXPECT_EQ(dimension("N"), (Twice{2, 2, -4, 0, 0, 0}));
  EXPECT_EQ(dimension("Pa"), (Twice{-2, 2, -4, 0, 0, 0}));
  EXPECT_EQ(dimension("J"), dimension("N.m"));
  EXPECT_EQ(dimension("W"), dimension("J/s"));
  EXPECT_EQ(dimension("V.A"), dimension("W"));
  EXPECT_EQ(dimension("Hz"), dimension("1/s"));
  EXPECT_EQ(dimension("L"), dimension("m^3"));
  EXPECT_EQ(dimension("kg*m^2"), (Twice{4, 2, 0, 0, 0, 0}));
  EXPECT_EQ(dimension("rpm"), (Twice{0, 0, -2, 0, 0, 2}));
}

TEST(Units, KeepAnglesApart) {
  EXPECT_NE(dimension("rad/s"), dimension("1/s"));
  EXPECT_NE(dimension("N.m/rad"), dimension("N.m"));
  EXPECT_EQ(dimension("deg"), dimension("rad"));
  EXPECT_NE(dimension("deg"), dimension("1"));
  EXPECT_EQ(dimension("rpm"), dimension("rad/s"));
  EXPECT_NE(dimension("rpm"), dimension("Hz"));
}

TEST(Units, TakeHalfExponents) {
  EXPECT_EQ(dimension("Pa^0.5"), (Twice{-1, 1, -2, 0, 0, 0}));
  EXPECT_EQ(dimension("Pa^(1/2)"), dimension("Pa^0.5"));
  EXPECT_EQ(dimension("m^3/(s.Pa^0.5)"), (Twice{7, -1, 0, 0, 0, 0}));
  EXPECT_EQ(dimension("(Pa^0.5)^2"), dimension("Pa"));
  EXPECT_EQ(dimension("m^1.5"), (Twice{3, 0, 0, 0, 0, 0}));
  EXPECT_EQ(dimension("s^-1"), dimension("Hz"));
  EXPECT_EQ(dimension("s^(-1)"), dimension("Hz"));
  EXPECT_EQ(si("3 MPa^0.5"), 3000.0);
  EXPECT_EQ(si("3 (mm^2)^0.5"), 0.003);
  EXPECT_DOUBLE_EQ(si("1 L/(min.bar^0.5)"), 1e-3 / 60 / std::sqrt(1e5));
  EXPECT_FALSE(parse_unit("m^0.25"));
  EXPECT_FALSE(parse_unit("(m^0.5)^0.5"));
}

TEST(Units, DivideFromLeftToRight) {
  EXPECT_EQ(dimension("kg/m/s"), dimension("kg/(m.s)"));
  EXPECT_EQ(dimension("kg/m.s"), dimension("kg.s/m"));
  EXPECT_EQ(dimension("m^2.s"), (Twice{4, 0, 2, 0, 0, 0}));  // the point is no decimal point
}

TEST(Units, PreferWholeNamesToPrefixes) {
  EXPECT_EQ(dimension("min"), dimension("s"));
  EXPECT_EQ(dimension("Pa"), dimension("bar"));
  EXPECT_EQ(dimension("mm"), dimension("m"));
  EXPECT_EQ(dimension("m"), dimension("km"));
}

TEST(Units, RejectNonsense) {
  const std::string deep = std::string(100000, '(') + "m" + std::string(100000, ')');
  for (const char* text :
       {"metre",  "N m",    " m",     "m ",     "Nm",       "kgs",    "M",      "k",     "mmin", "kbar",    "kt",
        "mpsi",   "kdeg",   "mL2",    "m2",     "m^",       "m^^2",   "m^2^2",  "m**2",  "m//s", "/s",      "m/",
        ".m",     "m.",     "(m",     "m)",     "()",       "^2",     "m^x",    "m^1e3", "m^(2", "m^(1/0)", "m^1/",
        "2",      "10 m",   "kkg",    "mkm",    "degC/m",   "1/degC", "degC^2", "pa",    "PA",   "mpa",     "Bar",
        "m^1000", "m^99.5", "m^-500", "m^0.33", "(m^40)^2", "-",      "°",      "m\xff", "hPa",  "(m)s"}) {
    EXPECT_FALSE(parse_unit(text)) << text;
  }
  EXPECT_FALSE(parse_unit(deep));
  EXPECT_FALSE(parse_unit(std::string("m\0", 2)));
}

TEST(Units, ParseQuantities) {
  const auto expect = [](std::string_view text, double value, std::string_view unit) {
    const std::optional<Quantity> quantity = parse_quantity(text);
    ASSERT_TRUE(quantity) << text;
    EXPECT_EQ(quantity->value, value) << text;
    EXPECT_EQ(quantity->unit, unit) << text;
  };
  expect("80 mm", 80, "mm");
  expect("80mm", 80, "mm");
  expect("-1.5e3 N", -1500, "N");
  expect("+2 m", 2, "m");
  expect("  7 kg  ", 7, "kg");
  expect("3", 3, "");
  expect(".5 m", 0.5, "m");
  expect("1e3N", 1000, "N");
  expect("1 N m", 1, "N m");
  expect("1,5 mm", 1, ",5 mm");  // which is no unit
  expect("0x10", 0, "x10");
}

TEST(Units, RejectWhatIsNoQuantity) {
  for (const char* text :
       {"", " ", "mm", "mm 80", "inf", "-inf m", "nan", "1e999", "-1e999 m", "--1", "+-1", "-", "+", "=x"}) {
    EXPECT_FALSE(parse_quantity(text)) << text;
  }
}

TEST(Units, NameAlternatives) {
  const auto of = [](std::string_view text) { return alternatives(parse_unit(text).value()); };
  EXPECT_EQ(of("km"), "m, mm, cm, km");
  EXPECT_EQ(of("psi"), "Pa, bar, kPa, MPa, GPa, psi");
  EXPECT_EQ(of("rpm"), "rad/s, deg/s, rpm");
  EXPECT_EQ(of("m^3/(s.Pa^0.5)"), "m^3/(s.Pa^0.5), L/(min.bar^0.5)");
  EXPECT_EQ(of("1"), "1, %");
  EXPECT_EQ(of("kg^1.5/(m^2.s^0.5)"), "m^-2.kg^1.5.s^-0.5");
}

TEST(Units, AlternativesAreUnitsOfOneDimension) {
  for (const char* text : {"m",
                           "m^2",
                           "m^3",
                           "kg",
                           "kg/m^3",
                           "kg.m^2",
                           "s",
                           "Hz",
                           "rad",
                           "rad/s",
                           "rad/s^2",
                           "m/s",
                           "m/s^2",
                           "N",
                           "N.m",
                           "N/m",
                           "N.s/m",
                           "N.m/rad",
                           "N.m.s/rad",
                           "W",
                           "Pa",
                           "1/Pa",
                           "Pa.s",
                           "m^3/s",
                           "m^3/rad",
                           "m^3/(s.Pa)",
                           "A",
                           "V",
                           "K",
                           "1",
                           "m^3/(s.Pa^0.5)",
                           "K^2"}) {
    const Unit unit = parse_unit(text).value();
    std::string rest = alternatives(unit);
    while (!rest.empty()) {
      const std::size_t comma = std::min(rest.find(", "), rest.size());
      const std::string name = rest.substr(0, comma);
      const std::optional<Unit> alternative = parse_unit(name);
      ASSERT_TRUE(alternative) << name;
      EXPECT_TRUE(alternative->same_dimension(unit)) << name << " for " << text;
      rest.erase(0, comma + 2);
    }
  }
}

}  // namespace
}  // namespace bramah
