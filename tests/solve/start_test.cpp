// What is made of rough start values, and what is said about it.
#include "solve/start.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "io/read_scene.hpp"
#include "solve/assemble.hpp"
#include "solve/near_assembly.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "support/scene_parts.hpp"
#include "support/shipped.hpp"

namespace bramah::testing {
namespace {

using support::exact;

constexpr double r = 0.5, l = 1.0;  // crank and rod of the slider crank

/// A slider crank, its crank and rod placed roughly, with `keys` of the scene; "start" and "hold" are among them; `more`
/// components.
Compiled slider_crank(double crank, double rod, const std::string& keys, const std::string& more = "") {
  const std::string text = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "crank":  { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [0.25, 0], "angle": )" +
                           exact(crank) + R"(},
    "rod":    { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [1, 0], "angle": )" +
                           exact(rod) + R"(},
    "slide":  { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [1.5, 0] },
    "O":      { "type": "mechanics/planar_revolute", "a": "ground", "b": "crank", "point_b": [-0.25, 0] },
    "A":      { "type": "mechanics/planar_revolute", "a": "crank", "point_a": [0.25, 0], "b": "rod",
                "point_b": [-0.5, 0] },
    "B":      { "type": "mechanics/planar_revolute", "a": "rod", "point_a": [0.5, 0], "b": "slide" },
    "rail":   { "type": "mechanics/planar_slot", "a": "ground", "b": "slide" })" +
                           more + "}, " + keys + "}";
  return compile(read_scene_text(text, "slider_crank.json"), registry());
}

/// The slider crank with the crank at `angle` above the dead centre.
struct Place {
  explicit Place(double angle)
      : crank(angle), rod(-std::asin(r / l * std::sin(angle))), slide(r * std::cos(angle) + l * std::cos(rod)) {}
  double crank, rod, slide;
  /// To the other assembly with the same slide: both angles change their signs, and so do crank.y and rod.y.
  [[nodiscard]] double to_the_other(const System& system) const {
    const double y = 0.5 * r * std::sin(crank) / system.sizes.length;
    return 2.0 * std::sqrt(crank * crank + rod * rod + 2.0 * y * y);
  }
};

std::optional<NearAssembly> near_assembly(const Compiled& machine) {
  const std::vector<Index>& held = machine.options.equilibrium.hold_x;
  State state = initial_state(machine.system);
  const Vector start = state.x;
  assemble_positions(machine.system, state, held);
  return find_near_assembly(machine.system, state, start, held);
}

std::string start_at(const Place& place) { return R"("start": { "slide.x": )" + exact(place.slide) + "}"; }

/// A cart with one rate of its own given, seen by a length from (-1, 0) to its point (0, 1).
TEST(Start, AMeasuredLengthHasNoSayInTheRates) {
  const Compiled machine = compile(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "cart": { "type": "mechanics/planar_body", "mass": 1, "inertia": 1, "velocity": [1, 0] },
    "len": { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [-1, 0], "b": "cart", "point_b": [0, 1] } } })",
                                                   "measured.json"),
                                   registry());
  const State state = consistent_start(machine.system, machine.options, 0.0);
  const auto rate = [&](std::string_view name) {
    const auto x = std::find_if(machine.system.x.begin(), machine.system.x.end(),
                                [&](const Variable& v) { return v.name == name; });
    return x == machine.system.x.end() ? NAN : state.v[static_cast<std::size_t>(x - machine.system.x.begin())];
  };
  EXPECT_EQ(rate("cart.x"), 1.0);
  EXPECT_EQ(rate("cart.y"), 0.0);
  EXPECT_EQ(rate("cart.angle"), 0.0);
}

double value(const Compiled& machine, const Vector& of, std::string_view name) {
  const Index i = machine.system.find_x(name);
  return i < 0 ? NAN : of[static_cast<std::size_t>(i)];
}

// Its default length is 1 m, and the points are sqrt(2) m apart.
TEST(Start, AMeasuredLengthHasNoSayInThePositions) {
  const auto machine = [](const std::string& length) {
    return compile(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
      "ground": { "type": "mechanics/ground" },
      "cart": { "type": "mechanics/planar_body", "mass": 1, "inertia": 1, "position": [0.25, 0] },
      "len": { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [-1, 0], "b": "cart", "point_b": [0, 1])" +
                                       length + "} } }",
                                   "measured.json"),
                   registry());
  };
  const Compiled measured = machine("");
  const State state = consistent_start(measured.system, measured.options, 0.0);
  EXPECT_EQ(value(measured, state.x, "cart.x"), 0.25);
  EXPECT_EQ(value(measured, state.x, "cart.y"), 0.0);
  EXPECT_EQ(value(measured, state.x, "cart.angle"), 0.0);
  EXPECT_TRUE(close(value(measured, state.x, "len.s"), std::hypot(1.25, 1.0), 1e-15));
  // A length that the scene writes out is meant.
  const Compiled given = machine(R"(, "length": 1.5)");
  const State moved = consistent_start(given.system, given.options, 0.0);
  EXPECT_GT(std::abs(value(given, moved.x, "cart.x") - 0.25), 0.01);
  EXPECT_LT(std::abs(value(given, moved.x, "len.s") - 1.5), 0.1);
}

// Where bodies have to move, too, the assembly is the one that it would be without the length.
TEST(Start, AMeasuredLengthHasNoSayInAnAssembly) {
  for (const double angle : {0.4, 1.1, 2.0}) {
    SCOPED_TRACE(angle);
    const Place place(angle);
    const std::string length = R"(, "len": { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [-1, 0.5],
      "b": "rod", "point_b": [0, 0.3] })";
    const Compiled bare = slider_crank(1.05 * angle, place.rod, R"("title": "bare")");
    const Compiled measured = slider_crank(1.05 * angle, place.rod, R"("title": "measured")", length);
    const State without = consistent_start(bare.system, bare.options, 0.0);
    const State with = consistent_start(measured.system, measured.options, 0.0);
    for (const char* name : {"crank.angle", "rod.angle", "slide.x"})
      EXPECT_TRUE(close(value(measured, with.x, name), value(bare, without.x, name), 1e-7)) << name;
  }
}

// A trolley with a pendulum: the list is given whole, and the pendulum follows.
TEST(Start, AZeroThatTheSceneWritesIsGiven) {
  const auto machine = [](const std::string& velocity) {
    return compile(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
      "trolley":  { "type": "mechanics/planar_body", "mass": 1, "inertia": 1, )" +
                                       velocity + R"( },
      "pendulum": { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [0.6, -0.8] },
      "pin": { "type": "mechanics/planar_revolute", "a": "trolley", "b": "pendulum", "point_b": [-0.6, 0.8] } } })",
                                   "trolley.json"),
                   registry());
  };
  const Compiled whole = machine(R"("velocity": [1, 0])");
  const State state = consistent_start(whole.system, whole.options, 0.0);
  EXPECT_EQ(value(whole, state.v, "trolley.x"), 1.0);
  EXPECT_EQ(value(whole, state.v, "trolley.y"), 0.0);
  EXPECT_TRUE(start_notes(whole.system, whole.options, false, 0.0).empty());
  // One that nobody wrote is not: the trolley turns and climbs a little, as the pendulum does.
  const Compiled part = machine(R"("angular_velocity": 1)");
  const State free = consistent_start(part.system, part.options, 0.0);
  EXPECT_EQ(value(part, free.v, "trolley.angle"), 1.0);
}

// At rest on a shaker: the smallest rates are those of the body.
TEST(Start, AMeasuredLengthHasNoSayBesideADriver) {
  const auto machine = [](const std::string& more) {
    return compile(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
      "ground": { "type": "mechanics/ground" },
      "body": { "type": "mechanics/planar_body", "mass": 1, "inertia": 1 },
      "shaker": { "type": "mechanics/planar_shaker", "body": "body", "point": [0, 0.5], "direction": [1, 0],
                  "amplitude": 0.1, "omega": 10 })" +
                                       more + "} }",
                                   "shaken.json"),
                   registry());
  };
  const Compiled bare = machine(""), measured = machine(R"(,
      "len": { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [-1, 0], "b": "body", "point_b": [0, 1] })");
  const State without = consistent_start(bare.system, bare.options, 0.0);
  const State with = consistent_start(measured.system, measured.options, 0.0);
  EXPECT_TRUE(close(value(bare, without.v, "body.x"), 0.8, 1e-13));  // least x^2 + w^2 with x - w / 2 = 1
  EXPECT_TRUE(close(value(bare, without.v, "body.angle"), -0.4, 1e-13));
  EXPECT_TRUE(close(value(measured, with.v, "body.x"), 0.8, 1e-7));  // the length weighs 1e-8
  EXPECT_TRUE(close(value(measured, with.v, "body.angle"), -0.4, 1e-7));
}

TEST(Start, FindsTheOtherAssemblyNearTheDeadCentre) {
  for (const double angle : {1e-4, 1e-3, 0.007, -0.003}) {
    SCOPED_TRACE(angle);
    const Place place(angle);
    const Compiled machine = slider_crank(1.01 * place.crank, place.rod, start_at(place) + R"(, "hold": ["slide.x"])");
    const std::optional<NearAssembly> other = near_assembly(machine);
    ASSERT_TRUE(other);
    // c closes to 1e-14 of its size, which sigma, of the size of the angle, turns into 1e-14 / angle.
    EXPECT_TRUE(close(other->distance, place.to_the_other(machine.system), 1e-13 / (angle * angle)));
    ASSERT_FALSE(other->coordinates.empty());
    EXPECT_EQ(machine.system.x[static_cast<std::size_t>(other->coordinates[0].first)].name, "crank.angle");
    EXPECT_NEAR(other->coordinates[0].second, -2.0 * angle, 1e-9);
    ASSERT_EQ(other->kept.size(), 1U);
    EXPECT_EQ(machine.system.x[static_cast<std::size_t>(other->kept[0])].name, "slide.x");
    EXPECT_GT(other->moved, 0.009 * std::abs(angle));
  }
}

// Of what the user gives nothing is held here; it counts as that which both assemblies share.
TEST(Start, FindsItForCoordinatesThatAreGiven) {
  const Place place(0.005);
  const Compiled machine = slider_crank(place.crank, place.rod, start_at(place));
  const std::optional<NearAssembly> other = near_assembly(machine);
  ASSERT_TRUE(other);
  // Without holding it, the assembly moves all: the crank is where that leaves it.
  const Place there(consistent_start(machine.system, machine.options, 0.0).x[2]);
  EXPECT_TRUE(close(other->distance, there.to_the_other(machine.system), 1e-8));
}

TEST(Start, IsSilentAwayFromTheDeadCentreAndWhereTheCrankIsHeld) {
  const Place place(0.05);
  const std::string hold = R"(, "hold": ["slide.x"])";
  EXPECT_FALSE(near_assembly(slider_crank(place.crank, place.rod, start_at(place) + hold)));
  EXPECT_FALSE(near_assembly(slider_crank(0.9 * place.crank, place.rod, start_at(place) + hold)));
  // From start values close to the middle nobody can tell which one is meant.
  EXPECT_TRUE(near_assembly(slider_crank(0.3 * place.crank, 0.3 * place.rod, start_at(place) + hold)));
  const Place dead(0.001);
  EXPECT_FALSE(near_assembly(slider_crank(dead.crank, dead.rod, R"("hold": ["crank.angle"])")));
  EXPECT_FALSE(near_assembly(slider_crank(0.0, 0.0, R"("hold": ["crank.angle"])")));  // both are the same one
}

// A four-bar whose coupler and rocker nearly lie in line: with the crank as it is, both change sides of the line from the
// crank's pin to the rocker's bearing.
TEST(Start, FindsTheOtherAssemblyOfAFourBar) {
  constexpr double crank = 1.0, coupler = 2.0, rocker = 1.5;
  const double gap = 1e-4;                      // of the reach of coupler and rocker
  const double reach = coupler + rocker - gap;  // from the crank's pin at (0, 1) to the rocker's bearing at (base, 0)
  const double base = std::sqrt(reach * reach - crank * crank), slope = std::atan2(-crank, base);
  const double at_pin = std::acos((coupler * coupler + reach * reach - rocker * rocker) / (2.0 * coupler * reach));
  const double at_bearing = std::asin(coupler * std::sin(at_pin) / rocker);
  const auto body = [](double x, double y, double angle) {
    return R"({ "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [)" + exact(x) + "," +
           exact(y) + R"(], "angle": )" + exact(angle) + "}";
  };
  const double knee_x = coupler * std::cos(slope + at_pin), knee_y = 1.0 + coupler * std::sin(slope + at_pin);
  const std::string text =
      R"({ "bramah": 1, "libraries": ["mechanics"], "components": { "ground": { "type": "mechanics/ground" },
    "crank": )" +
      body(0.0, 0.5, 1.5707963267948966) + R"(, "coupler": )" +
      body(0.5 * knee_x, 0.5 * (1.0 + knee_y), slope + at_pin) + R"(, "rocker": )" +
      body(0.5 * (base + knee_x), 0.5 * knee_y, slope - at_bearing) + R"(,
    "O": { "type": "mechanics/planar_revolute", "a": "ground", "b": "crank", "point_b": [-0.5, 0] },
    "A": { "type": "mechanics/planar_revolute", "a": "crank", "point_a": [0.5, 0], "b": "coupler", "point_b": [-1, 0] },
    "B": { "type": "mechanics/planar_revolute", "a": "coupler", "point_a": [1, 0], "b": "rocker", "point_b": [-0.75, 0] },
    "C": { "type": "mechanics/planar_revolute", "a": "ground", "point_a": [)" +
      exact(base) + R"(, 0], "b": "rocker", "point_b": [0.75, 0] } }, "hold": ["crank.angle"] })";
  const Compiled machine = compile(read_scene_text(text, "four_bar.json"), registry());
  // Both centres lie half as far from the line as the knee, on either side of it.
  const double centre = coupler * std::sin(at_pin) / machine.system.sizes.length;
  const double expected =
      std::sqrt(std::pow(2.0 * at_pin, 2) + std::pow(2.0 * at_bearing, 2) + 2.0 * std::pow(centre, 2));
  std::vector<Index> held = machine.options.equilibrium.hold_x;
  State state = initial_state(machine.system);
  const Vector start = state.x;
  assemble_positions(machine.system, state, held);
  // Angles of a degree: reported for start values that are as rough.
  Vector rough = start;
  rough[static_cast<std::size_t>(machine.system.find_x("rocker.angle"))] += 0.02;
  const std::optional<NearAssembly> other = find_near_assembly(machine.system, state, rough, held);
  ASSERT_TRUE(other);
  EXPECT_TRUE(close(other->distance, expected, 1e-8));
  EXPECT_EQ(machine.system.x[static_cast<std::size_t>(other->coordinates[0].first)].name, "rocker.angle");
  EXPECT_FALSE(find_near_assembly(machine.system, state, start, held));
}

TEST(Start, SaysWhatIsNear) {
  const Place place(0.003);
  const Compiled machine = slider_crank(place.crank, place.rod, start_at(place) + R"(, "hold": ["slide.x"])");
  for (const bool equilibrium : {false, true}) {
    const std::vector<StartNote> notes = start_notes(machine.system, machine.options, equilibrium, 0.0);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].kind, "near assembly");
    EXPECT_EQ(notes[0].names.front(), "crank.angle");
    for (const char* part : {"crank.angle -0.006 rad", "with the same slide.x", "O, A, B also close", "nominals away"})
      EXPECT_NE(notes[0].found.find(part), std::string::npos) << notes[0].found;
    EXPECT_NE(notes[0].remedy.find("give crank.angle a start value"), std::string::npos) << notes[0].remedy;
  }
}

TEST(Start, HasNothingToSayAboutShippedScenes) {
  int read = 0;
  for (const std::string& file : shipped_scenes()) {
    const Machine machine = load(file);
    for (const StartNote& note : start_notes(machine.system(), machine.options(), false, 0.0))
      ADD_FAILURE() << file << ": " << note.found;
    ++read;
  }
  EXPECT_GE(read, 25);
}

// Long chains and ladders are soft along their longest wave, and have no other assembly nearby.
TEST(Start, HasNothingToSayAboutFamiliesOfMachines) {
  for (const support::Family& family : support::families()) {
    for (const int size : {2, 30, 300}) {
      if (family.name == std::string("spring_lattice") && size > 30) continue;
      const Compiled machine = support::compiled(family.make(size));
      for (const StartNote& note : start_notes(machine.system, machine.options, false, 0.0))
        ADD_FAILURE() << family.name << ' ' << size << ": " << note.found;
    }
  }
}

double rate(const Compiled& machine, const State& state, const std::string& name) {
  return value(machine, state.v, name);
}

TEST(Start, RatesThatNobodyGivesFollowThoseOfStart) {
  const Place place(0.7);
  const Compiled machine = slider_crank(place.crank, place.rod, R"("start": { "slide.x.rate": -2 })");
  const State state = consistent_start(machine.system, machine.options, 0.0);
  EXPECT_EQ(rate(machine, state, "slide.x"), -2.0);
  // Positions are assembled from rough ones; the crank is where they leave it.
  const Place there(state.x[static_cast<std::size_t>(machine.system.find_x("crank.angle"))]);
  const double by_crank = -r * std::sin(there.crank) + r * std::cos(there.crank) * std::tan(there.rod);
  EXPECT_TRUE(close(rate(machine, state, "crank.angle"), -2.0 / by_crank, 1e-13));
  EXPECT_TRUE(start_notes(machine.system, machine.options, false, 0.0).empty());
}

// The measure of a length has no rate of its own to give; before, its zero slowed the rod down.
TEST(Start, RatesOfMeasuresFollowParametersOfBodies) {
  const Compiled machine = compile(read_scene_text(R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "rod":    { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [0.5, 0], "angular_velocity": 3 },
    "hinge":  { "type": "mechanics/planar_revolute", "a": "ground", "b": "rod", "point_b": [-0.5, 0] },
    "length": { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [0, 1], "b": "rod", "point_b": [0.5, 0],
                "length": 1.4142135623730951 } } })",
                                                   "rod.json"),
                                   registry());
  const State state = consistent_start(machine.system, machine.options, 0.0);
  EXPECT_EQ(rate(machine, state, "rod.angle"), 3.0);
  EXPECT_TRUE(close(rate(machine, state, "rod.y"), 1.5, 1e-14));
  EXPECT_TRUE(close(rate(machine, state, "length.s"), -3.0 / std::sqrt(2.0), 1e-14));
  EXPECT_TRUE(start_notes(machine.system, machine.options, false, 0.0).empty());
}

TEST(Start, GivenRatesThatContradictEachOtherAreChangedAsLittleAsPossible) {
  const Place place(0.7);
  const std::string rates = R"("slide.x.rate": -2, "crank.angle.rate": 3 })";
  const Compiled loose = slider_crank(place.crank, place.rod, R"("start": { )" + rates);
  const State state = consistent_start(loose.system, loose.options, 0.0);
  const Place there(state.x[static_cast<std::size_t>(loose.system.find_x("crank.angle"))]);
  const double J = -r * std::sin(there.crank) + r * std::cos(there.crank) * std::tan(there.rod);
  const double L2 = std::pow(loose.system.sizes.length, 2);
  const double omega = (3.0 - 2.0 * J / L2) / (1.0 + J * J / L2);      // least (omega - 3)^2 + (J omega + 2)^2 / L^2
  EXPECT_TRUE(close(rate(loose, state, "crank.angle"), omega, 1e-7));  // the others weigh 1e-8
  EXPECT_TRUE(close(rate(loose, state, "slide.x"), J * omega, 1e-7));
  const std::vector<StartNote> notes = start_notes(loose.system, loose.options, false, 0.0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].kind, "rate changed");
  EXPECT_EQ(notes[0].names, (std::vector<std::string>{"crank.angle.rate", "slide.x.rate"}));
  EXPECT_NE(notes[0].found.find("crank.angle.rate from 3 to "), std::string::npos) << notes[0].found;

  // What is held is not changed at all.
  const Compiled machine = slider_crank(
      place.crank, place.rod, R"("hold": ["slide.x"], "start": { "slide.x": )" + exact(place.slide) + ", " + rates);
  const State held = consistent_start(machine.system, machine.options, 0.0);
  EXPECT_EQ(rate(machine, held, "slide.x"), -2.0);
  EXPECT_TRUE(close(rate(machine, held, "crank.angle"),
                    -2.0 / (-r * std::sin(place.crank) + r * std::cos(place.crank) * std::tan(place.rod)), 1e-12));
}

}  // namespace
}  // namespace bramah::testing
