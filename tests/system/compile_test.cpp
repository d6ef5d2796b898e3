// From a scene to a system: numbering, constants, patterns, assembly, inputs, names.
#include "system/compile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "io/read_scene.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"
#include "system/blocks.hpp"
#include "system/energies.hpp"

namespace bramah {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

Compiled compiled(const std::string& text) { return compile(read_scene_text(text, "test.json"), testing::registry()); }

/// A scene of these components, written as JSON members.
std::string scene(const std::vector<std::string>& components, const std::string& more = "") {
  std::string text =
      R"({"bramah": 1, "libraries": ["mechanics", "hydraulics", "friction", "signals"], "components": {)";
  for (std::size_t i = 0; i < components.size(); ++i) text += (i == 0 ? "\n" : ",\n") + components[i];
  return text + "}" + more + "}";
}

template <class List>
std::vector<std::string> names(const List& list) {
  std::vector<std::string> result;
  for (const auto& item : list) result.push_back(item.name);
  return result;
}

// A slider-crank with a hydraulic cylinder: types interleaved, constants of two families, signals, outputs.
const std::vector<std::string> machine = {
    R"("tank": {"type": "hydraulics/pressure_source", "p": "1 bar"})",
    R"("rod": {"type": "mechanics/planar_body", "mass": 2, "inertia": 0.5, "position": [1, 0.2], "angle": 0.3,
        "gravity": "field"})",
    R"("V1": {"type": "hydraulics/volume"})",
    R"("ground": {"type": "mechanics/ground"})",
    R"("pin": {"type": "mechanics/planar_revolute", "a": "rod", "point_a": [-1, 0], "b": "ground"})",
    R"("bar": {"type": "mechanics/planar_body", "mass": 3, "inertia": 0.7, "position": [3, 0.1], "angle": -0.2})",
    R"("field": {"type": "mechanics/gravity", "acceleration": [0, -9.81, 0]})",
    R"("knee": {"type": "mechanics/planar_revolute", "a": "rod", "point_a": [1, 0], "b": "bar", "point_b": [-1, 0]})",
    R"("V2": {"type": "hydraulics/volume"})",
    R"("piston": {"type": "mechanics/planar_stroke", "a": "ground", "b": "bar", "length": 3})",
    R"("hose": {"type": "hydraulics/hose", "volume": "V1", "V_h": 5e-5, "B_h": "550 MPa", "B_oil": "1500 MPa"})",
    R"("cylinder": {"type": "hydraulics/cylinder", "stroke": "piston.s", "piston_side": "V1", "rod_side": "V2",
        "D_2": "80 mm", "D_3": "35 mm", "l": 3, "c_1": 0.5, "B_oil": "1500 MPa", "B_c": "31500 MPa"})",
    R"("torque": {"type": "signals/table", "unit": "N.m", "times": [0, 1, 1, 2], "values": [0, 5, 7, 0]})",
    R"("motor": {"type": "mechanics/planar_torque", "on": "rod", "magnitude": "torque"})",
    R"("leak": {"type": "hydraulics/throttle", "a": "V2", "b": "tank", "C_d": 0.8, "A_t": 1e-6, "rho_oil": 850})",
    R"("seal": {"type": "friction/brown_mcphee", "along": "piston.s", "F_c": 210, "F_s": 830, "v_s": 0.0125,
        "sigma_2": 330})"};

/// A state away from everything special, the same for variables of the same name.
State some_state(const System& system) {
  State state = initial_state(system, 0.4);
  const auto number = [](const std::string& name, double scale) {
    double sum = 0.0;
    for (const char c : name) sum = std::fmod(sum * 31.0 + static_cast<double>(c), 1009.0);
    return scale * (sum / 1009.0 - 0.5);
  };
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    state.x[i] += number(system.x[i].name, 0.2);
    state.v[i] = number(system.x[i].name + "v", 1.0);
    state.a[i] = number(system.x[i].name + "a", 3.0);
  }
  for (std::size_t i = 0; i < system.z.size(); ++i) {
    state.z[i] = 3e6 + number(system.z[i].name, 1e6);
    state.zdot[i] = number(system.z[i].name + "dot", 1e7);
  }
  for (Index i = 0; i < system.m() + system.l(); ++i) {
    state.lambda[static_cast<std::size_t>(i)] = number(system.constraint(i).name, 100.0);
  }
  return state;
}

// ---- numbering ----

TEST(Compile, NumbersInTheOrderOfDeclaration) {
  const Compiled result = compiled(scene(machine));
  const System& s = result.system;
  EXPECT_THAT(names(s.x), ElementsAre("rod.x", "rod.y", "rod.angle", "bar.x", "bar.y", "bar.angle", "piston.s"));
  EXPECT_THAT(names(s.z), ElementsAre("V1.p", "V2.p"));
  EXPECT_THAT(names(s.holonomic), ElementsAre("pin.x", "pin.y", "knee.x", "knee.y", "piston.length"));
  EXPECT_THAT(names(s.inputs), ElementsAre("tank", "torque"));
  EXPECT_THAT(names(s.outputs),
              ElementsAre("cylinder.force", "cylinder.l_2", "cylinder.l_3", "leak.flow", "seal.force"));
  ASSERT_EQ(s.components.size(), machine.size());
  for (const Variable& v : s.x) EXPECT_TRUE(v.name.starts_with(s.component_name(v.component) + "."));
  for (const Row& row : s.outputs) EXPECT_TRUE(row.name.starts_with(s.component_name(row.component) + "."));
  for (std::size_t k = 0; k < s.components.size(); ++k) {
    const Component& component = s.components[k];
    const Group& group = s.groups[static_cast<std::size_t>(component.group)];
    EXPECT_EQ(group.type, component.type);
    EXPECT_EQ(group.component[static_cast<std::size_t>(component.position)], static_cast<Index>(k));
  }
}

TEST(Compile, GathersInstancesOfOneTypeInOneGroup) {
  const Compiled result = compiled(scene(machine));
  std::set<const bramah_type*> types;
  Index instances = 0;
  for (const Group& group : result.system.groups) {
    EXPECT_TRUE(types.insert(group.type).second) << group.type->name;
    EXPECT_EQ(static_cast<Index>(group.component.size()), group.count);
    instances += group.count;
  }
  EXPECT_EQ(instances, static_cast<Index>(machine.size()));
}

TEST(Compile, TakesStartValuesFromParametersAndFromTheScene) {
  const Compiled result =
      compiled(scene(machine, R"(, "start": {"rod.angle": "60 deg", "bar.x.rate": "2 cm/s", "V2.p": "2 bar"})"));
  const System& s = result.system;
  EXPECT_EQ(s.x[0].start, 1.0);
  EXPECT_DOUBLE_EQ(s.x[2].start, std::acos(-1.0) / 3.0);
  EXPECT_TRUE(s.x[2].start_given);
  EXPECT_FALSE(s.x[0].start_given);
  EXPECT_EQ(s.x[3].start_rate, 0.02);
  EXPECT_TRUE(s.x[3].start_rate_given);
  EXPECT_EQ(s.z[0].start, 1e5);
  EXPECT_EQ(s.z[1].start, 2e5);
  EXPECT_EQ(s.x[6].start, 3.0);
  EXPECT_EQ(s.x[6].kind, "coordinate");
  EXPECT_EQ(s.z[0].kind, "pressure");
}

// ---- constants ----

/// The group of a type and the local x of one of its instances.
const Group& group_of(const System& system, const std::string& type) {
  const auto found =
      std::find_if(system.groups.begin(), system.groups.end(), [&](const Group& g) { return g.type->name == type; });
  if (found == system.groups.end()) throw std::runtime_error("no " + type);
  return *found;
}

std::vector<double> local(const std::vector<std::int32_t>& map, std::int32_t slots, Index instance,
                          const Vector& values) {
  std::vector<double> result;
  for (std::int32_t j = 0; j < slots; ++j) {
    result.push_back(values[static_cast<std::size_t>(map[static_cast<std::size_t>(instance * slots + j)])]);
  }
  return result;
}

TEST(Compile, GivesGroundAndUnconnectedPortsConstants) {
  const Compiled result = compiled(scene(machine));
  const System& s = result.system;
  const State state = initial_state(s);
  ASSERT_EQ(static_cast<Index>(state.x.size()), s.n() + static_cast<Index>(s.x_constants.size()));
  const Group& joints = group_of(s, "mechanics/planar_revolute");
  const auto n = static_cast<std::int32_t>(s.n());
  for (int j = 0; j < 3; ++j) {
    EXPECT_EQ(joints.x[static_cast<std::size_t>(j)], j);          // pin: a is rod
    EXPECT_GE(joints.x[static_cast<std::size_t>(3 + j)], n);      // pin: b is ground
    EXPECT_EQ(joints.x[static_cast<std::size_t>(9 + j)], 3 + j);  // knee: b is bar
  }
  EXPECT_THAT(local(joints.x, 6, 0, state.x), ElementsAre(1.0, 0.2, 0.3, 0.0, 0.0, 0.0));
  // Ground serves pin and piston with the same numbers.
  EXPECT_EQ(group_of(s, "mechanics/planar_stroke").x[0], joints.x[3]);
  // Gravity is a constant of three slots; the bar has none and reads the port's rest values.
  const Group& bodies = group_of(s, "mechanics/planar_body");
  EXPECT_THAT(local(bodies.u, 3, 0, state.z), ElementsAre(0.0, -9.81, 0.0));
  EXPECT_THAT(local(bodies.u, 3, 1, state.z), ElementsAre(0.0, 0.0, 0.0));
  for (const std::int32_t position : bodies.u) EXPECT_GE(position, s.nz() + s.nu());
  // A pressure source is an input, not a constant.
  EXPECT_EQ(group_of(s, "hydraulics/throttle").z[1], s.nz());
}

TEST(Compile, KeepsRestValuesOfAPortOnce) {
  const std::string body = R"(: {"type": "mechanics/planar_body", "mass": 1, "inertia": 1})";
  const Compiled one = compiled(scene({"\"a\"" + body})),
                 three = compiled(scene({"\"a\"" + body, "\"b\"" + body, "\"c\"" + body}));
  EXPECT_EQ(one.system.z_constants.size(), 3U);
  EXPECT_EQ(three.system.z_constants.size(), 3U);
}

bool is_empty(const BlockPattern& pattern, std::size_t column) {
  return pattern.start[column] == pattern.start[column + 1];
}

TEST(Compile, DropsPatternsOfConstants) {
  const std::vector<std::string> pendulum = {machine[1], machine[3], machine[4], machine[6]};
  const Compiled alone = compiled(scene(pendulum)), pair = compiled(scene(machine));
  const BlockPattern& to_ground = group_of(alone.system, "mechanics/planar_revolute").patterns[BRAMAH_R_V];
  const BlockPattern& mixed = group_of(pair.system, "mechanics/planar_revolute").patterns[BRAMAH_R_V];
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_FALSE(is_empty(to_ground, j));
    EXPECT_TRUE(is_empty(to_ground, 3 + j));  // no instance connects b to a variable
    EXPECT_FALSE(is_empty(mixed, 3 + j));     // one does
  }
  // No variable, no row: the tank's side of a throttle.
  const Group& leak = group_of(pair.system, "hydraulics/throttle");
  const BlockPattern& g_z = leak.patterns[BRAMAH_G_Z];
  EXPECT_TRUE(std::all_of(g_z.row.begin(), g_z.row.end(), [](std::int32_t row) { return row == 0; }));
  EXPECT_FALSE(is_empty(g_z, 1));  // but its pressure is an input, a column of G_Z
  // Constants such as gravity are no columns of F_U.
  EXPECT_TRUE(group_of(pair.system, "mechanics/planar_body").patterns[BRAMAH_F_U].row.empty());
}

// ---- assembly ----

TEST(SparsePlan, IsTheSumOfBlocksAtTheirPlaces) {
  const Compiled result = compiled(scene(machine));
  const System& s = result.system;
  Blocks blocks(s);
  const State state = some_state(s);
  ASSERT_TRUE(
      blocks.evaluate(s, state, Request{}.blocks({BRAMAH_F_A, BRAMAH_F_X, BRAMAH_R_V, BRAMAH_G_Z, BRAMAH_F_Z})).ok());

  std::mt19937 random(7);
  const Index n = s.n(), nz = s.nz(), m = s.m(), size = n + nz + m;
  const auto shuffled = [&](Index count, bool holes) {
    std::vector<Index> places(static_cast<std::size_t>(size)), map;
    for (Index i = 0; i < size; ++i) places[static_cast<std::size_t>(i)] = i;
    for (std::size_t i = places.size(); i > 1; --i) std::swap(places[i - 1], places[random() % i]);
    for (Index i = 0; i < count; ++i)
      map.push_back(holes && random() % 4 == 0 ? -1 : places[static_cast<std::size_t>(i)]);
    return map;
  };
  for (int trial = 0; trial < 20; ++trial) {
    const bool holes = trial > 0;
    // Inputs are columns nz.. of a block on z; a map that ends before them leaves them out.
    const std::vector<Index> x = shuffled(n, holes), z = shuffled(nz, holes), f = shuffled(n, holes),
                             g = shuffled(nz, holes), c = shuffled(m, holes);
    const Term terms[] = {{BRAMAH_F_A, f, x, false, 0}, {BRAMAH_F_X, f, x, false, 1}, {BRAMAH_R_V, c, x, false, 1},
                          {BRAMAH_R_V, c, f, true, 2},  {BRAMAH_G_Z, g, z, false, 0}, {BRAMAH_F_Z, f, z, false, 2}};
    const Diagonal diagonals[] = {{0, 0, size, 1, {}},
                                  {1, 0, size - 1, 2, std::vector<double>(static_cast<std::size_t>(size - 1), 0.5)}};
    const double weights[] = {1.0, -2.5, 0.75};
    SparsePlan plan(s, size, size, terms, diagonals);
    plan.fill(blocks, weights);
    plan.fill(blocks, weights);  // values are replaced, not added

    std::vector<std::vector<double>> dense(static_cast<std::size_t>(size),
                                           std::vector<double>(static_cast<std::size_t>(size), 0.0));
    std::set<std::pair<Index, Index>> places;
    const auto add = [&](Index row, Index column, double value) {
      dense[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] += value;
      places.emplace(row, column);
    };
    const auto global_row = [&](const Group& group, int block, std::size_t i, std::size_t row) -> Index {
      const auto k = [&](std::int32_t slots) { return i * static_cast<std::size_t>(slots) + row; };
      switch (block) {
        case BRAMAH_R_V: return group.first_holonomic[i] + static_cast<Index>(row);
        case BRAMAH_G_Z: return group.z[k(group.type->nz)];
        default: return group.x[k(group.type->nx)];
      }
    };
    for (const Term& term : terms) {
      for (std::size_t k = 0; k < s.groups.size(); ++k) {
        const Group& group = s.groups[k];
        const BlockPattern& pattern = group.patterns[static_cast<std::size_t>(term.block)];
        const bool on_z = term.block == BRAMAH_G_Z || term.block == BRAMAH_F_Z;
        std::size_t entry = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(group.count); ++i) {
          for (std::size_t j = 0; j < static_cast<std::size_t>(pattern.columns); ++j) {
            for (auto e = static_cast<std::size_t>(pattern.start[j]);
                 e < static_cast<std::size_t>(pattern.start[j + 1]); ++e) {
              const double value = blocks.block(k, term.block)[entry++];
              const std::int32_t slots = on_z ? group.type->nz : group.type->nx;
              const Index from_column = (on_z ? group.z : group.x)[i * static_cast<std::size_t>(slots) + j];
              const Index from_row = global_row(group, term.block, i, static_cast<std::size_t>(pattern.row[e]));
              const Index columns = on_z ? nz : n;
              const Index rows = term.block == BRAMAH_R_V ? m : term.block == BRAMAH_G_Z ? nz : n;
              if (from_column >= columns || from_row >= rows) continue;
              Index row = term.rows[static_cast<std::size_t>(from_row)],
                    column = term.columns[static_cast<std::size_t>(from_column)];
              if (row < 0 || column < 0) continue;
              if (term.transposed) std::swap(row, column);
              add(row, column, weights[term.weight] * value);
            }
          }
        }
      }
    }
    for (const Diagonal& d : diagonals) {
      for (Index i = 0; i < d.count; ++i)
        add(d.row + i, d.column + i,
            weights[d.weight] * (d.scale.empty() ? 1.0 : d.scale[static_cast<std::size_t>(i)]));
    }

    ASSERT_EQ(plan.nonzeros(), static_cast<Index>(places.size()));
    double largest = 0.0;
    for (const auto& row : dense) {
      for (const double value : row) largest = std::max(largest, std::abs(value));
    }
    for (Index j = 0; j < size; ++j) {
      for (Index e = plan.start()[static_cast<std::size_t>(j)]; e < plan.start()[static_cast<std::size_t>(j) + 1];
           ++e) {
        const Index row = plan.row()[static_cast<std::size_t>(e)];
        const bool is_first = e == plan.start()[static_cast<std::size_t>(j)];
        ASSERT_TRUE(is_first || plan.row()[static_cast<std::size_t>(e) - 1] < row);
        ASSERT_TRUE(places.contains({row, j}));
        ASSERT_NEAR(plan.values()[static_cast<std::size_t>(e)],
                    dense[static_cast<std::size_t>(row)][static_cast<std::size_t>(j)], 1e-14 * largest);
      }
    }
  }
}

TEST(Blocks, DoNotDependOnTheOrderOfComponents) {
  std::vector<std::string> order = machine;
  const Compiled reference = compiled(scene(order));
  std::mt19937 random(3);
  for (int trial = 0; trial < 5; ++trial) {
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    const Compiled other = compiled(scene(order));
    const auto rows_of = [](const System& s) {
      Blocks blocks(s);
      EXPECT_TRUE(blocks.evaluate(s, some_state(s), Request{}.rows("fgcrsy")).ok());
      std::vector<std::pair<std::string, double>> rows;
      for (std::size_t i = 0; i < s.x.size(); ++i) rows.emplace_back("f of " + s.x[i].name, blocks.f[i]);
      for (std::size_t i = 0; i < s.z.size(); ++i) rows.emplace_back("g of " + s.z[i].name, blocks.g[i]);
      for (std::size_t i = 0; i < s.holonomic.size(); ++i) {
        rows.emplace_back("c of " + s.holonomic[i].name, blocks.c[i]);
        rows.emplace_back("r of " + s.holonomic[i].name, blocks.r[i]);
        rows.emplace_back("s of " + s.holonomic[i].name, blocks.s[i]);
      }
      for (std::size_t i = 0; i < s.outputs.size(); ++i) rows.emplace_back("y of " + s.outputs[i].name, blocks.y[i]);
      std::sort(rows.begin(), rows.end());
      return rows;
    };
    const auto expected = rows_of(reference.system), found = rows_of(other.system);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].first, expected[i].first);
      // Sums of a few terms in another order: rounding of the largest term, which is a force of the oil.
      EXPECT_TRUE(testing::close(found[i].second, expected[i].second, 1e-13, found[i].first[0] == 'f' ? 1e4 : 0.0))
          << found[i].first;
    }
  }
}

// ---- inputs ----

TEST(Inputs, HaveTwoSidesAtJumps) {
  const Compiled result = compiled(scene(machine));
  const System& s = result.system;
  const auto torque = static_cast<std::size_t>(s.nz()) + 1;
  State state = initial_state(s, 1.0);
  EXPECT_EQ(state.z[torque], 7.0);
  state.side = -1;
  apply_inputs(s, state);
  EXPECT_EQ(state.z[torque], 5.0);
  EXPECT_EQ(state.z[torque - 1], 1e5);
  state.t = 1.5;
  apply_inputs(s, state);
  EXPECT_EQ(state.z[torque], 3.5);
  EXPECT_EQ(next_breakpoint(s, -1.0), 0.0);
  EXPECT_EQ(next_breakpoint(s, 0.0), 1.0);
  EXPECT_EQ(next_breakpoint(s, 1.0), 2.0);
  EXPECT_EQ(next_breakpoint(s, 2.0), HUGE_VAL);
}

// ---- names ----

TEST(Measured, KnowsEveryNameOnce) {
  const Compiled result = compiled(scene(machine));
  const System& s = result.system;
  const std::vector<std::string> all = measured_names(s);
  EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size());
  const auto storing =
      std::count_if(s.components.begin(), s.components.end(), [](const Component& c) { return says_energy(*c.type); });
  const auto energetic = static_cast<Index>(s.components.size()) + storing + 2;  // powers, energies, both of the whole
  EXPECT_EQ(static_cast<Index>(all.size()), 3 * s.n() + 2 * s.nz() + s.m() + s.l() + s.ny() + s.nu() + energetic);
  for (const std::string& name : all) {
    Measured found;
    EXPECT_TRUE(find_measured(s, name, found)) << name;
    EXPECT_EQ(found.name, name);
    EXPECT_FALSE(found.unit.empty()) << name;
  }
  Measured found;
  for (const char* name :
       {"", "rod", "rod.", "rod.angle.", "rod.angle.rate.rate", "V1.p.acceleration", "pin.lambda", "Rod.x"}) {
    EXPECT_FALSE(find_measured(s, name, found)) << name;
  }
}

TEST(Measured, TellsKindAndUnit) {
  const Compiled result = compiled(scene(machine));
  const auto s_index = [&](const std::string& name) -> Index {
    const auto& list = result.system.components;
    return std::find_if(list.begin(), list.end(), [&](const Component& c) { return c.name == name; }) - list.begin();
  };
  const auto expect = [&](const std::string& name, Measured::Kind kind, Index index, const std::string& unit) {
    Measured found;
    ASSERT_TRUE(find_measured(result.system, name, found)) << name;
    EXPECT_EQ(found.kind, kind) << name;
    EXPECT_EQ(found.index, index) << name;
    EXPECT_EQ(found.unit, unit) << name;
  };
  expect("rod.angle", Measured::Kind::x, 2, "rad");
  expect("rod.angle.rate", Measured::Kind::v, 2, "rad/s");
  expect("piston.s.acceleration", Measured::Kind::a, 6, "m/s^2");
  expect("V2.p", Measured::Kind::z, 1, "Pa");
  expect("V2.p.rate", Measured::Kind::zdot, 1, "Pa/s");
  expect("knee.lambda_y", Measured::Kind::lambda, 3, "N");
  expect("leak.flow", Measured::Kind::y, 3, "m^3/s");
  expect("torque", Measured::Kind::input, 1, "N.m");
  expect("rod.energy", Measured::Kind::energy, s_index("rod"), "J");
  expect("leak.power", Measured::Kind::power, s_index("leak"), "W");
  expect("energy", Measured::Kind::energy, -1, "J");
  expect("power", Measured::Kind::power, -1, "W");
}

TEST(System, NamesMultipliersAfterTheirRows) {
  System s;
  s.holonomic = {{"hinge.x", "m", 0}, {"hinge.tilt_1", "1", 0}, {"gear.ratio", "rad", 0}, {"valve.area", "m^2", 0}};
  s.nonholonomic = {{"wheel.roll", "m/s", 0}};
  const auto multiplier = [&](Index i) { return s.multiplier_name(i) + " in " + s.multiplier_unit(i); };
  EXPECT_EQ(multiplier(0), "hinge.lambda_x in N");
  EXPECT_EQ(multiplier(1), "hinge.lambda_tilt_1 in N.m");
  EXPECT_EQ(multiplier(2), "gear.lambda_ratio in N.m");
  EXPECT_EQ(multiplier(3), "valve.lambda_area in J/(m^2)");
  EXPECT_EQ(multiplier(4), "wheel.lambda_roll in N");
  EXPECT_EQ(s.constraint(4).name, "wheel.roll");
}

TEST(Options, DefaultToAllVariablesAndOutputs) {
  const Compiled result = compiled(scene(machine));
  const System& s = result.system;
  std::vector<std::string> expected = names(s.x);
  for (const std::vector<std::string>& more : {names(s.z), names(s.outputs)})
    expected.insert(expected.end(), more.begin(), more.end());
  EXPECT_THAT(names(result.options.outputs), ElementsAreArray(expected));
  EXPECT_FALSE(result.options.simulate.asked);
  EXPECT_FALSE(result.options.linearize.asked);
}

// ---- faults ----

TEST(Compile, ReportsEarlierFaultsWithItsOwn) {
  std::vector<Diagnostic> of_shape;
  const Scene broken =
      read_scene_text(scene(machine, R"(, "titel": "", "hold": ["rod.angel"])"), "test.json", &of_shape);
  ASSERT_EQ(of_shape.size(), 1U);
  try {
    compile(broken, testing::registry(), of_shape);
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.diagnostics().size(), 2U);
    EXPECT_EQ(error.diagnostics()[0].pointer, "/titel");
    EXPECT_EQ(error.diagnostics()[1].pointer, "/hold/0");
  }
  // Earlier faults alone are faults, too, and one place is reported once.
  const Scene sound = read_scene_text(scene(machine), "test.json");
  EXPECT_THROW(compile(sound, testing::registry(), of_shape), SceneError);
  of_shape[0].pointer = "/hold/0";
  try {
    compile(broken, testing::registry(), of_shape);
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.diagnostics().size(), 1U);
  }
}

TEST(Compile, MeansTheSameInARegistryThatKnowsMore) {
  const auto registry = testing::registry();
  compile(read_scene_text(scene(machine), "test.json"), registry);  // loads everything
  const std::string text =
      R"({"bramah": 1, "libraries": ["mechanics"], "components": {"V": {"type": "hydraulics/volume"}}})";
  EXPECT_THROW(compile(read_scene_text(text, "test.json"), registry), SceneError);
}

}  // namespace
}  // namespace bramah
