// Numbers of a scene by name, and derivatives along them: against the same scene with other numbers.
#include "system/direction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bramah/conformance.hpp"
#include "components/mechanics/spring_damper.hpp"
#include "io/read_scene.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "system/analysis_error.hpp"
#include "system/blocks.hpp"
#include "system/compile.hpp"

namespace bramah {
namespace {

using testing::close;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Rows of every kind; one constant that drives several parameters and an element, one that drives start values.
constexpr const char* text = R"({"bramah": 1,
  "libraries": ["mechanics", "hydraulics", "friction", "signals"],
  "constants": { "D": "80 mm", "B_oil": 1.5e9, "g": "-9.81 m/s^2", "v": "0.7 m/s", "p": "2 MPa", "end": "3 s" },
  "components": {
    "ground":   { "type": "mechanics/ground" },
    "gravity":  { "type": "mechanics/gravity", "acceleration": [0.3, "=g", 0] },
    "body":     { "type": "mechanics/planar_body", "gravity": "gravity", "mass": 20, "inertia": 1.5,
                  "position": [1.1, 0.4], "angle": 0.3, "velocity": ["=v", 0.2] },
    "edge":     { "type": "mechanics/knife_edge", "body": "body", "point": [0.1, -0.2], "direction": [1, 0.4] },
    "load":     { "type": "mechanics/planar_body", "gravity": "gravity", "mass": 3, "inertia": 0.2,
                  "position": [1.6, 0.7] },
    "pin":      { "type": "mechanics/planar_revolute", "a": "body", "point_a": [0.5, 0.1], "b": "load",
                  "point_b": [-0.1, 0.2] },
    "stroke":   { "type": "mechanics/planar_stroke", "a": "ground", "point_a": [0.1, -0.6], "b": "body",
                  "point_b": [-0.2, 0.1], "length": 1.4 },
    "disc":     { "type": "mechanics/rolling_disc", "gravity": "gravity", "mass": 2, "A": 0.3, "C": 0.5, "a": 0.4,
                  "rho": 0.05, "yaw": 0.2, "lean": 0.3, "yaw_rate": 0.4, "lean_rate": -0.2, "spin_rate": 3 },
    "top":      { "type": "mechanics/rigid_body", "mass": 2, "inertia": [0.2, 0.3, 0.25], "products": [0.01, 0.02, 0],
                  "gravity": "gravity", "position": [0.1, 0.2, 0.3], "rotation": [0.3, -0.2, 0.5],
                  "angular_velocity": [0.1, 2, 0.3] },
    "hinge":    { "type": "mechanics/revolute", "a": "ground", "b": "top", "point_b": [0, 0.1, -0.4],
                  "axis_a": [0.2, 1, 0.1], "axis_b": [0.1, 1, 0] },
    "lift":     { "type": "hydraulics/volume" },
    "lower":    { "type": "hydraulics/volume" },
    "cylinder": { "type": "hydraulics/cylinder", "stroke": "stroke.s", "piston_side": "lift", "rod_side": "lower",
                  "D_2": "=D", "D_3": 0.035, "l": 2.1, "c_1": 0.4, "B_oil": "=B_oil", "B_c": 3e10,
                  "air": 0.01 },
    "hose":     { "type": "hydraulics/hose", "volume": "lift", "V_h": 3e-5, "B_h": 5e8, "B_oil": "=B_oil",
                  "air": 0.01 },
    "supply":   { "type": "hydraulics/pressure_source", "p": "=p" },
    "throttle": { "type": "hydraulics/throttle", "a": "supply", "b": "lift", "C_d": 0.8, "A_t": 3e-5, "rho_oil": 850 },
    "seal":     { "type": "friction/brown_mcphee", "along": "stroke.s", "F_c": 210, "F_s": 830, "v_s": 0.3,
                  "sigma_2": 330 },
    "torque":   { "type": "signals/table", "unit": "N.m", "times": [0, 1, 2], "values": [1, 5, 4] },
    "motor":    { "type": "mechanics/planar_torque", "on": "body", "magnitude": "torque" }
  },
  "start": { "lift.p": "=p", "load.x": 1.65, "load.angle.rate": 0.4, "disc.x.rate": "=v" },
  "simulate": { "to_time": "=end" }
})";

Compiled compiled(const Scene& scene) { return compile(scene, testing::registry()); }
Scene scene() { return read_scene_text(text, "test.json"); }

/// The scene with another value for one of its numbers, written as a plain SI number.
Scene with(const System& system, const SceneNumber& number, double value) {
  Scene s = scene();
  const std::size_t dot = number.name.find('.');
  const std::string first = number.name.substr(0, dot), rest = number.name.substr(dot + 1);
  if (first == "constants" || first == "start") {
    s.root.find(first)->set(rest, value);
    return s;
  }
  const std::string key = rest.substr(0, rest.find('.'));
  Value* component = s.root.find("components")->find(first);
  if (key == rest) {
    component->set(key, value);
    return s;
  }
  const ParameterRef& ref = number.parameters.front();
  const Component& made = system.components[static_cast<std::size_t>(ref.component)];
  const std::vector<double>& numbers = made.numbers[static_cast<std::size_t>(ref.parameter)];
  const Value* written = component->find(key);
  Value::List list = written == nullptr ? Value::List(numbers.begin(), numbers.end()) : *written->list();
  list[static_cast<std::size_t>(ref.element)] = Value(value);
  component->set(key, list);
  return s;
}

/// A number in +-[0.3, 1.3] without pattern.
double scatter(std::size_t k) {
  const double share = 0.618033988749895 * static_cast<double>(k + 1);
  const double part = share - std::floor(share);
  return (k % 2 == 0 ? 1.0 : -1.0) * (0.3 + part);
}

State generic_state(const System& system) {
  State state = initial_state(system, 0.4);
  std::size_t k = 0;
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    state.v[i] += 0.1 * scatter(++k);
    state.a[i] = scatter(++k);
  }
  for (std::size_t i = 0; i < system.z.size(); ++i) {
    state.z[i] += 1e4 * scatter(++k);
    state.zdot[i] = 1e6 * scatter(++k);
  }
  for (double& l : state.lambda) l = 100.0 * scatter(++k);
  return state;
}

void move_all(const System& system, State& direction) {
  std::size_t k = 100;
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    direction.x[i] += 0.1 * scatter(++k);
    direction.v[i] += 0.1 * scatter(++k);
    direction.a[i] += scatter(++k);
  }
  for (std::size_t i = 0; i < system.z.size(); ++i) {
    direction.z[i] += 1e4 * scatter(++k);
    direction.zdot[i] += 1e6 * scatter(++k);
  }
  for (double& l : direction.lambda) l += 10.0 * scatter(++k);
}

/// All rows, then all blocks, of one evaluation.
std::vector<Vector> everything(const System& system, const Blocks& blocks) {
  std::vector<Vector> all = {blocks.f, blocks.g, blocks.c, blocks.r, blocks.s, blocks.y};
  for (std::size_t g = 0; g < system.groups.size(); ++g) {
    for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
      const auto values = blocks.block(g, b);
      all.emplace_back(values.begin(), values.end());
    }
  }
  return all;
}

Request whole() {
  Request request = Request{}.rows("fgcrsy");
  request.block.fill(true);
  return request;
}

/// How far a number moves per unit of eps: as far as it is large.
double reach(const SceneNumber& number) { return number.value == 0.0 ? 0.1 : std::fabs(number.value); }

/// Everything of the scene with its number and its state moved by h.
std::vector<Vector> moved(const SceneNumber& number, const System& base, const State& at, const State& direction,
                          double h) {
  const Compiled other = compiled(with(base, number, number.value + h * reach(number)));
  State state = initial_state(other.system, at.t);  // its constants and inputs are those of the number
  const auto copy = [h](const Vector& from, const Vector& along, std::size_t count, Vector& to) {
    for (std::size_t i = 0; i < count; ++i) to[i] = from[i] + h * along[i];
  };
  copy(at.x, direction.x, base.x.size(), state.x);
  copy(at.v, direction.v, base.x.size(), state.v);
  copy(at.a, direction.a, base.x.size(), state.a);
  copy(at.z, direction.z, base.z.size(), state.z);
  copy(at.zdot, direction.zdot, base.z.size(), state.zdot);
  copy(at.lambda, direction.lambda, at.lambda.size(), state.lambda);
  Blocks blocks(other.system);
  EXPECT_TRUE(blocks.evaluate(other.system, state, whole()).ok());
  return everything(other.system, blocks);
}

/// Central differences, extrapolated once: error of fourth order in h.
double slope(double plus, double minus, double half_plus, double half_minus, double h) {
  return (8.0 * (half_plus - half_minus) - (plus - minus)) / (6.0 * h);
}

double largest(const Vector& list) {
  double size = 0.0;
  for (const double d : list) size = std::max(size, std::fabs(d));
  return size;
}

TEST(Direction, RowsAndBlocksMoveAsTheyDoFromSceneToScene) {
  const Compiled base = compiled(scene());
  const System& system = base.system;
  const State at = generic_state(system);
  Direction still(system);
  move_all(system, still.state);
  Blocks plain(system), by_state(system), by_number(system);
  ASSERT_TRUE(plain.evaluate(system, at, whole()).ok());
  ASSERT_TRUE(by_state.evaluate_along(system, at, still, whole()).ok());
  const std::vector<Vector> here = everything(system, plain), first = everything(system, by_state);
  const std::vector<SceneNumber> numbers = differentiable_numbers(system);
  EXPECT_GT(numbers.size(), 60U);
  for (const SceneNumber& number : numbers) {
    Direction along(system, number);
    along.apply_inputs(system, at);
    ASSERT_TRUE(by_number.evaluate_along(system, at, along, whole()).ok());
    const std::vector<Vector> second = everything(system, by_number);
    constexpr double h = 1e-3;
    const auto p = moved(number, system, at, still.state, h), m = moved(number, system, at, still.state, -h);
    const auto hp = moved(number, system, at, still.state, 0.5 * h),
               hm = moved(number, system, at, still.state, -0.5 * h);
    for (std::size_t n = 0; n < here.size(); ++n) {
      ASSERT_EQ(here[n].size(), p[n].size());
      const double rounding = 1e-11 * largest(here[n]);  // 1e-16 over the step, some terms larger than their sum
      for (std::size_t i = 0; i < here[n].size(); ++i) {
        const double exact = first[n][i] + reach(number) * second[n][i];
        const double found = slope(p[n][i], m[n][i], hp[n][i], hm[n][i], h);
        EXPECT_LE(std::fabs(found - exact), 1e-7 * std::fabs(exact) + rounding)
            << number.name << ", list " << n << ", entry " << i << ": found " << exact << ", differences " << found
            << ", relative " << std::fabs(found - exact) / std::fabs(exact) << ", value " << here[n][i];
      }
    }
  }
}

TEST(Direction, StartValuesMoveAsTheyDoFromSceneToScene) {
  const Compiled base = compiled(scene());
  const System& system = base.system;
  for (const SceneNumber& number : differentiable_numbers(system)) {
    Direction along(system, number);
    along.apply_inputs(system, initial_state(system, 0.4));
    along.add_start(system);
    const double h = 1e-3 * reach(number);
    const auto at = [&](double t) {
      return initial_state(compiled(with(system, number, number.value + t)).system, 0.4);
    };
    const State p = at(h), m = at(-h), hp = at(0.5 * h), hm = at(-0.5 * h);
    for (const auto list : {&State::x, &State::v, &State::z}) {
      for (std::size_t i = 0; i < (p.*list).size(); ++i) {
        const double found = slope((p.*list)[i], (m.*list)[i], (hp.*list)[i], (hm.*list)[i], h);
        const double exact = (along.state.*list)[i];
        const double noise = 1e-15 * std::fabs((p.*list)[i]) / h;
        EXPECT_LE(std::fabs(found - exact), 1e-9 * std::fabs(exact) + 20.0 * noise)
            << number.name << ", entry " << i << ": found " << exact << ", differences " << found;
      }
    }
  }
}

TEST(Direction, IsLinear) {
  // A number and the state moving together give the sum of what each gives alone.
  const Compiled base = compiled(scene());
  const System& system = base.system;
  const State at = generic_state(system);
  const SceneNumber number = find_number(system, "constants.D");
  Direction alone(system, number), still(system), both(system, number);
  move_all(system, still.state);
  move_all(system, both.state);
  Blocks a(system), b(system), sum(system);
  ASSERT_TRUE(a.evaluate_along(system, at, alone, whole()).ok());
  ASSERT_TRUE(b.evaluate_along(system, at, still, whole()).ok());
  ASSERT_TRUE(sum.evaluate_along(system, at, both, whole()).ok());
  const auto all_a = everything(system, a), all_b = everything(system, b), all = everything(system, sum);
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (std::size_t i = 0; i < all[n].size(); ++i) {
      const double scale = std::fabs(all_a[n][i]) + std::fabs(all_b[n][i]);
      EXPECT_TRUE(close(all[n][i], all_a[n][i] + all_b[n][i], 1e-11, scale + 1e-9)) << n << " " << i;
    }
  }
}

// ---- names ---------------------------------------------------------------------------------------------------------

TEST(SceneNumbers, AreFoundByName) {
  const Compiled base = compiled(scene());
  const System& s = base.system;
  const SceneNumber mass = find_number(s, "body.mass");
  EXPECT_EQ(mass.value, 20.0);
  EXPECT_EQ(mass.unit, "kg");
  ASSERT_EQ(mass.parameters.size(), 1U);
  EXPECT_TRUE(mass.starts.empty());
  const SceneNumber value = find_number(s, "torque.values.1");
  EXPECT_EQ(value.value, 5.0);
  EXPECT_EQ(value.unit, "N.m") << "of the text parameter unit";
  EXPECT_EQ(value.parameters[0].element, 1);
  EXPECT_EQ(find_number(s, "gravity.acceleration.0").value, 0.3);
  EXPECT_EQ(find_number(s, "cylinder.c_2").value, 0.0) << "by default";
  const SceneNumber start = find_number(s, "start.load.angle.rate");
  EXPECT_EQ(start.value, 0.4);
  EXPECT_EQ(start.unit, "rad/s");
}

TEST(SceneNumbers, ConstantsDriveAllThatIsWrittenWithThem) {
  const Compiled base = compiled(scene());
  const System& s = base.system;
  const auto driven = [&](const char* name) {
    std::vector<std::string> names;
    const SceneNumber number = find_number(s, name);
    for (const ParameterRef& p : number.parameters) {
      const Component& c = s.components[static_cast<std::size_t>(p.component)];
      names.push_back(c.name + "." + c.type->parameters[p.parameter].name + "." + std::to_string(p.element));
    }
    for (const StartRef& r : number.starts) {
      const bool first_order = r.kind == StartRef::Kind::z;
      names.push_back("start " + (first_order ? s.z : s.x)[static_cast<std::size_t>(r.index)].name +
                      (r.kind == StartRef::Kind::v ? ".rate" : ""));
    }
    return names;
  };
  EXPECT_THAT(driven("constants.B_oil"), ElementsAre("cylinder.B_oil.0", "hose.B_oil.0"));
  EXPECT_THAT(driven("constants.g"), ElementsAre("gravity.acceleration.1"));
  EXPECT_THAT(driven("constants.p"), ElementsAre("supply.p.0", "start lift.p"));
  EXPECT_THAT(driven("constants.v"), ElementsAre("body.velocity.0", "start disc.x.rate"));
  const SceneNumber D = find_number(s, "constants.D");
  EXPECT_EQ(D.value, 0.08) << "SI, though written in mm";
  EXPECT_EQ(D.unit, "m");
}

TEST(SceneNumbers, AreListedOnce) {
  const Compiled base = compiled(read_scene_text(R"({"bramah": 1, "libraries": ["mechanics"],
    "constants": {"k": 3},
    "components": {
      "mass": {"type": "mechanics/mass", "mass": 2},
      "spring": {"type": "mechanics/spring_damper", "to": "mass.x", "stiffness": "=k"}},
    "start": {"mass.x": 0.1}})",
                                                 "test.json"));
  std::vector<std::string> names;
  for (const SceneNumber& n : differentiable_numbers(base.system)) names.push_back(n.name);
  EXPECT_THAT(names, ElementsAre("constants.k", "mass.mass", "mass.position", "mass.velocity", "spring.damping",
                                 "spring.free_length", "start.mass.x"));
}

std::string refusal(const System& system, const char* name) {
  try {
    find_number(system, name);
  } catch (const AnalysisError& error) {
    return error.what();
  }
  return "found";
}

TEST(SceneNumbers, AreRefusedWithAPlaceAndARemedy) {
  const Compiled base = compiled(scene());
  const System& s = base.system;
  EXPECT_EQ(refusal(s, "body.mess"),
            "derivatives by \"body.mess\": mechanics/planar_body has no parameter \"mess\"; expected one of: "
            "\"body.mass\", \"body.inertia\", \"body.position.0\", \"body.position.1\", \"body.angle\", "
            "\"body.velocity.0\", \"body.velocity.1\", \"body.angular_velocity\"; did you mean \"body.mass\"?");
  EXPECT_THAT(refusal(s, "boddy.mass"), HasSubstr("there is no component \"boddy\"; expected component.parameter"));
  EXPECT_THAT(refusal(s, "boddy.mass"), HasSubstr("did you mean \"body\"?"));
  EXPECT_THAT(refusal(s, "body.position"), HasSubstr("is a list of 2 numbers; expected one of them: body.position.0 to "
                                                     ".1; name one element, counted from 0"));
  EXPECT_THAT(refusal(s, "body.position.2"), HasSubstr("is a list of 2 numbers"));
  EXPECT_THAT(refusal(s, "body.position.x"), HasSubstr("is a list of 2 numbers"));
  EXPECT_THAT(refusal(s, "body.mass.0"), HasSubstr("\"mass\" is one number; expected \"body.mass\""));
  EXPECT_THAT(refusal(s, "torque.unit"), HasSubstr("\"unit\" is a text"));
  EXPECT_THAT(refusal(s, "seal.viscous_factor"), HasSubstr("\"viscous_factor\" is a choice"));
  EXPECT_THAT(refusal(s, "torque.times.1"),
              HasSubstr("the type signals/table gives no derivatives by \"times\"; expected a parameter that the type "
                        "declares as bramah::Parameter; declare \"times\" as bramah::Parameter"));
  EXPECT_THAT(refusal(s, "constants.B_oel"), HasSubstr("did you mean \"constants.B_oil\"?"));
  EXPECT_THAT(refusal(s, "constants.end"), HasSubstr("no parameter and no start value is written \"=end\""));
  EXPECT_THAT(refusal(s, "start.body.x"), HasSubstr("the scene gives no such start value"));
  EXPECT_THAT(refusal(s, ""), HasSubstr("there is no component \"\""));
}

// A type of the border's minor 0: all but the derivatives.
std::shared_ptr<Registry> registry_with_bare_spring() {
  static const bramah_type bare = [] {
    bramah_type type = type_of<mechanics::SpringDamper>();
    type.name = "bare/spring";
    type.extension = nullptr;
    return type;
  }();
  static const bramah_type* const types[] = {&bare};
  static const bramah_library library = {
      sizeof(bramah_library), BRAMAH_ABI_EPOCH, 0, "bare", "1.0.0", "a test", types, 1};
  auto registry = std::make_shared<Registry>();
  registry->add(&library, "test");
  return registry;
}

TEST(Direction, NamesAComponentWithoutDerivatives) {
  const Compiled base = compile(read_scene_text(R"({"bramah": 1, "libraries": ["mechanics", "bare"], "components": {
      "mass": {"type": "mechanics/mass", "mass": 2}, "other": {"type": "mechanics/mass", "mass": 3},
      "spring": {"type": "bare/spring", "to": "mass.x", "stiffness": 3}}})",
                                                "test.json"),
                                registry_with_bare_spring());
  const System& s = base.system;
  EXPECT_EQ(
      refusal(s, "spring.stiffness"),
      "derivatives by \"spring.stiffness\": the type bare/spring gives no derivatives by \"stiffness\"; expected a "
      "type that gives second derivatives; build its library again with this SDK, or add the extension "
      "bramah.tangent/1");
  const State at = initial_state(s);
  Blocks blocks(s);
  Direction along(s, find_number(s, "mass.mass"));
  ASSERT_TRUE(blocks.evaluate_along(s, at, along, whole()).ok()) << "what stands still has derivatives of zero";
  along.state.x[static_cast<std::size_t>(s.find_x("other.x"))] = 1.0;
  ASSERT_TRUE(blocks.evaluate_along(s, at, along, whole()).ok()) << "nor does the spring move here";
  along.state.v[static_cast<std::size_t>(s.find_x("mass.x"))] = 1.0;
  try {
    (void)blocks.evaluate_along(s, at, along, whole());
    FAIL() << "not refused";
  } catch (const AnalysisError& error) {
    EXPECT_STREQ(error.what(),
                 "second derivatives: spring (bare/spring) gives none, and its variables move; expected the extension "
                 "bramah.tangent/1; build its library again with this SDK, or add the extension to it");
    EXPECT_EQ(error.pointer(), "/components/spring");
  }
}

}  // namespace
}  // namespace bramah
