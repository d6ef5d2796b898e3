// Mistakes in scenes that are possible and plainly wrong: each is one change of text in crane.json, a loader crane with
// two cylinders, and is refused or told of in words that lead to it. The crane itself rests at an equilibrium at which its
// jib cylinder would have to pull.
#include <gmock/gmock.h>

#include <string>

#include "app/cli.hpp"

namespace bramah {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Change {
  const char *name, *from, *to;
  bool refused;         // by check
  const char* says[2];  // parts of the message
};
std::ostream& operator<<(std::ostream& out, const Change& change) { return out << change.name; }

const Change changes[] = {
    {"same_body_at_both_ends",
     R"("a": "jib")",
     R"("a": "boom")",
     true,
     {"\"a\" and \"b\" are the same body", "name the other body"}},
    {"degree_sign", "40 deg", "40°", true, {"is no unit", "write deg"}},
    {"pounds", "180 kg", "180 lb", true, {"is no unit", "1 lb = 0.45359237 kg"}},
    {"expression", "\"=B_oil\"", "\"=2*B_oil\"", true, {"2*B_oil", "expressions are not read"}},
    {"radians", "\"40 deg\"", "40", false, {"warning: /components/boom/angle", "did you mean \"40 deg\"?"}},
    {"pascals", "\"200 bar\"", "200", false, {"is 200 Pa (the pressure)", "did you mean \"200 bar\"?"}},
    {"metres", "\"90 mm\"", "90", false, {"is 90 m (diameter of the piston)", "did you mean \"90 mm\"?"}},
    {"chamber_too_short", "\"0.9 m\"", "\"1.4 m\"", true, {"cyl_lift.l_2", "below 0 m"}},
    {"negative_pressure", "\"50 bar\"", "\"-50 bar\"", true, {"A1.p", "below -100000 Pa"}},
    {"gravity_across_the_plane",
     "\"acceleration\": [0, -9.81, 0]",
     "\"acceleration\": [0, 0, -9.81]",
     false,
     {"has no part in the plane x-y", "[0, -9.81, 0]"}},
    {"millimetres",
     "[0.92",
     "[920",
     false,
     {"farther than the machine is large", "check the start value and its unit"}},
};

class SceneMistake : public Cli, public ::testing::WithParamInterface<Change> {};
INSTANTIATE_TEST_SUITE_P(Crane, SceneMistake, ::testing::ValuesIn(changes),
                         [](const auto& of) { return of.param.name; });

TEST_P(SceneMistake, IsTold) {
  std::string scene = contents(BRAMAH_SOURCE_DIR "/tests/mistakes/crane.json");
  const std::string from = GetParam().from;
  const std::size_t at = scene.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  write("crane.json", scene.replace(at, from.size(), GetParam().to));
  const Ended check = bramah("check crane.json");
  EXPECT_EQ(check.code != 0, GetParam().refused) << check.err;
  EXPECT_THAT(check.err, AllOf(HasSubstr(GetParam().says[0]), HasSubstr(GetParam().says[1])));
}

TEST_F(Cli, TheCraneItselfGivesNoWarning) {
  write("crane.json", contents(BRAMAH_SOURCE_DIR "/tests/mistakes/crane.json"));
  const Ended check = bramah("check crane.json --strict");
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(check.err.find("warning"), std::string::npos) << check.err;
  // Its jib cylinder pulls: 82 bar below zero at these angles, which oil cannot hold.
  EXPECT_THAT(bramah("equilibrium crane.json").err, HasSubstr("A2.p, is -8.22368e+06 Pa, below -100000 Pa"));
}

TEST_F(Cli, StrictMakesWarningsErrors) {
  std::string scene = contents(BRAMAH_SOURCE_DIR "/tests/mistakes/crane.json");
  scene.replace(scene.find("\"200 bar\""), 9, "200");
  write("crane.json", scene);
  const json warned = document("check crane.json");
  ASSERT_EQ(warned["warnings"].size(), 1U);
  EXPECT_EQ(warned["warnings"][0]["code"], "unusual");
  EXPECT_EQ(bramah("check crane.json --strict").code, 2);
}

TEST_F(Cli, ABodyThatFeelsNoGravityBesideOthersIsToldOf) {
  std::string scene = contents(BRAMAH_SOURCE_DIR "/tests/mistakes/crane.json");
  const std::size_t boom = scene.find("\"boom\":"), at = scene.find("\"gravity\"", boom);
  const std::size_t end = scene.find(',', at);
  write("crane.json", scene.erase(at, end - at + 1));
  EXPECT_THAT(bramah("check crane.json").err, HasSubstr("\"boom\" feels no gravity, and other bodies do"));
}

TEST_F(Cli, BothSidesOnOneVolumeIsToldOf) {
  std::string scene = contents(BRAMAH_SOURCE_DIR "/tests/mistakes/crane.json");
  const std::size_t cylinder = scene.find("\"cyl_lift\":"), side = scene.find("\"rod_side\": \"", cylinder) + 13;
  write("crane.json", scene.replace(side, scene.find('"', side) - side, "A1"));
  EXPECT_THAT(bramah("check crane.json").err, HasSubstr("\"piston_side\" and \"rod_side\" are the same volume"));
}

}  // namespace
}  // namespace bramah
