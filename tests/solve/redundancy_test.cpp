// Partition and redundancy of overconstrained mechanisms: ranks against a dense SVD, motions against closed forms, and
// what the texts say.
#include "solve/redundancy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "io/read_scene.hpp"
#include "solve/simulate.hpp"
#include "support/generators.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

using Eigen::MatrixXd;

/// D = d[c; b]/dv, dense, its columns scaled by the nominals of the coordinates.
MatrixXd constraint_matrix(const System& system, const State& state) {
  Blocks blocks(system);
  blocks.evaluate(system, state, Request{}.blocks({BRAMAH_R_V}));
  const std::vector<Index> coordinates = shifted(system.n(), 0), rows = shifted(system.m() + system.l(), 0);
  const Term term{BRAMAH_R_V, rows, coordinates, false, 0};
  SparsePlan plan(system, system.m() + system.l(), system.n(), {&term, 1});
  const double one = 1.0;
  plan.fill(blocks, {&one, 1});
  MatrixXd D = MatrixXd::Zero(plan.rows(), plan.columns());
  for (Index j = 0; j < plan.columns(); ++j) {
    for (Index e = plan.start()[static_cast<std::size_t>(j)]; e < plan.start()[static_cast<std::size_t>(j) + 1]; ++e)
      D(plan.row()[static_cast<std::size_t>(e)], j) =
          plan.values()[static_cast<std::size_t>(e)] * system.x[static_cast<std::size_t>(j)].nominal;
  }
  return D;
}

Index rank_by_svd(const MatrixXd& D) {
  Eigen::BDCSVD<MatrixXd> svd(D);
  return (svd.singularValues().array() > 1e-8 * svd.singularValues()(0)).count();
}

/// The number of redundant rows and of freedoms, and that every dependency holds.
void expect_partition(const System& system, const State& state, Index redundant, Index freedoms) {
  const MatrixXd D = constraint_matrix(system, state);
  const Partition partition = choose_partition(system, state);
  EXPECT_EQ(static_cast<Index>(partition.redundant.size()), redundant);
  EXPECT_EQ(D.rows() - rank_by_svd(D), redundant);
  EXPECT_EQ(static_cast<Index>(partition.ai.size()), freedoms);
  EXPECT_EQ(system.n() - rank_by_svd(D), freedoms);
  for (const RedundantRow& row : partition.redundant) {
    Eigen::RowVectorXd difference = D.row(row.row);
    for (const auto& [other, c] : row.follows_from) {
      difference -= c * D.row(other);
      EXPECT_TRUE(std::binary_search(partition.rows.begin(), partition.rows.end(), other));
    }
    EXPECT_LT(difference.norm(), 1e-11 * D.row(row.row).norm()) << system.constraint(row.row).name;
  }
  // The kept rows on the dependent coordinates can be solved for them.
  MatrixXd kept(static_cast<Index>(partition.d.size()), static_cast<Index>(partition.d.size()));
  for (Index i = 0; i < kept.rows(); ++i) {
    for (Index j = 0; j < kept.cols(); ++j)
      kept(i, j) = D(partition.rows[static_cast<std::size_t>(i)], partition.d[static_cast<std::size_t>(j)]);
  }
  EXPECT_EQ(rank_by_svd(kept), kept.rows());
}

struct Overconstrained {
  const char* file;
  Index redundant, freedoms;
};

class RedundantScene : public ::testing::TestWithParam<Overconstrained> {};

TEST_P(RedundantScene, HasTheRankOfTheDenseSvd) {
  const Machine machine = load(GetParam().file);
  const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
  const State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
  expect_partition(machine.system(), state, GetParam().redundant, GetParam().freedoms);
}

// The multipliers are those of least norm in their nominals: no self-stress in them, and the forces still balance.
TEST_P(RedundantScene, MultipliersAreOfLeastNorm) {
  const Machine machine = load(GetParam().file);
  const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
  const State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
  const MatrixXd D = constraint_matrix(machine.system(), state);
  const Eigen::Map<const Eigen::VectorXd> lambda(state.lambda.data(), static_cast<Index>(state.lambda.size()));
  const MatrixXd stresses = Eigen::FullPivLU<MatrixXd>(D.transpose()).setThreshold(1e-8).kernel();
  ASSERT_EQ(stresses.cols(), GetParam().redundant);
  Eigen::VectorXd weighed = lambda;
  for (Index i = 0; i < weighed.size(); ++i) weighed(i) *= std::pow(machine.system().constraint(i).size, 2);
  weighed /= weighed.norm();
  EXPECT_LT((stresses.transpose() * weighed).norm(), 1e-9 * stresses.norm());
  EXPECT_GT(lambda.norm(), 1.0) << "there are forces to distribute";
  Blocks blocks(machine.system());
  blocks.evaluate(machine.system(), state, Request{}.rows("f").blocks({BRAMAH_R_V}));
  for (const double f : blocks.f) EXPECT_NEAR(f, 0.0, 1e-9 * lambda.norm());
}

INSTANTIATE_TEST_SUITE_P(Scenes, RedundantScene,
                         ::testing::Values(Overconstrained{"scenes/redundant/door.json", 10, 1},
                                           Overconstrained{"scenes/redundant/bricard.json", 1, 1},
                                           Overconstrained{"scenes/redundant/stewart.json", 24, 6},
                                           Overconstrained{"scenes/redundant/scott_russell.json", 14, 1},
                                           Overconstrained{"scenes/four_bar/spatial.json", 3, 1}),
                         [](const auto& p) {
                           const std::string file = p.param.file;
                           const std::size_t from = file.find_last_of('/') + 1;
                           return file.substr(from, file.find('.') - from);
                         });

TEST(Ladder, RepeatsThreeRowsPerLoop) {
  const Compiled ladder = support::compiled(support::spatial_ladder(12));
  expect_partition(ladder.system, initial_state(ladder.system), 36, 1);
  const Compiled open = support::compiled(support::planar_chain(20, support::bent(0.7)));
  expect_partition(open.system, initial_state(open.system), 0, 20);
}

// The order of declaration costs time at most: the same ladder with its joints shuffled.
TEST(Ladder, DeclaredInNoOrder) {
  constexpr int loops = 300;
  Scene scene = support::spatial_ladder(loops);
  Value::Object components = *scene.root.find("components")->object();
  std::mt19937 random(3);
  for (std::size_t i = components.size(); i > 1; --i) std::swap(components[i - 1], components[random() % i]);
  scene.root.set("components", std::move(components));
  const Compiled ladder = support::compiled(scene);
  const Partition partition = choose_partition(ladder.system, initial_state(ladder.system));
  EXPECT_EQ(partition.redundant.size(), 3U * loops);
  EXPECT_EQ(partition.ai.size(), 1U);
  EXPECT_GT(partition.smallest_pivot, 1e-6);
  EXPECT_LT(partition.largest_refused, 1e-12);
}

std::vector<RedundantSet> sets_of(const std::string& file) {
  const Machine machine = load(file);
  const bool equilibrium = machine.options().linearize.at == LinearizeOptions::At::equilibrium;
  const State state = reference_state(machine.system(), machine.options(), equilibrium, 0.0);
  return describe_redundancy(machine.system(), state, choose_partition(machine.system(), state));
}

TEST(RedundancyTexts, FourBar) {
  const Machine machine = load("scenes/four_bar/spatial.json");
  const std::vector<RedundantSet> sets = sets_of("scenes/four_bar/spatial.json");
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_EQ(row_names(machine.system(), sets[0].rows), "O2.x, O2.tilt_1, O2.tilt_2");
  EXPECT_EQ(sets[0].joints, "4 mechanics/revolute (O1, C, D, O2)");
  EXPECT_EQ(sets[0].geometry, "in one plane, normal to x");
  EXPECT_EQ(sets[0].undetermined, "a force along x and moments normal to x");
  EXPECT_EQ(sets[0].remedy, "free O2 along x and about axes normal to x; as much in O1, C or D would do");
}

TEST(RedundancyTexts, Door) {
  const std::vector<RedundantSet> sets = sets_of("scenes/redundant/door.json");
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_EQ(sets[0].rows.size(), 10U);
  EXPECT_EQ(sets[0].joints, "3 mechanics/revolute (bottom, middle, top)");
  EXPECT_EQ(sets[0].geometry, "on one axis, along z");
  EXPECT_EQ(sets[0].undetermined, "any force and moments normal to z in middle, and so on");
  EXPECT_EQ(sets[0].remedy, "leave out middle and leave out top");
}

// The self-stress of the closed cube: the same force along the space diagonal in every hinge.
TEST(RedundancyTexts, Bricard) {
  const std::vector<RedundantSet> sets = sets_of("scenes/redundant/bricard.json");
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_EQ(sets[0].rows.size(), 1U);
  EXPECT_EQ(sets[0].joints, "6 mechanics/revolute (R_1, R_2, R_3, R_4, R_5, R_6)");
  EXPECT_EQ(sets[0].geometry, "");
  EXPECT_EQ(sets[0].undetermined, "a force along (0.577, 0.577, 0.577)");
  EXPECT_EQ(sets[0].remedy, "free R_6 along (0.577, 0.577, 0.577); as much in R_1, R_2, R_3, R_4 or R_5 would do");
}

TEST(RedundancyTexts, StewartPlatform) {
  const std::vector<RedundantSet> sets = sets_of("scenes/redundant/stewart.json");
  ASSERT_EQ(sets.size(), 6U);
  EXPECT_EQ(sets[0].joints, "1 mechanics/cylindrical (gland_1) and 1 mechanics/prismatic (piston_1)");
  EXPECT_EQ(sets[0].geometry, "on one axis, along (0.527, 0.218, -0.821)");
  EXPECT_EQ(sets[5].remedy, "leave out gland_6; as much in piston_6 would do");
}

TEST(RedundancyTexts, ScottRussell) {
  const std::vector<RedundantSet> sets = sets_of("scenes/redundant/scott_russell.json");
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_EQ(sets[0].rows.size(), 14U);
  EXPECT_EQ(sets[0].components.size(), 11U);
  EXPECT_EQ(sets[0].geometry, "in one plane, normal to y");
}

// In the plane there are rows in the plane only.
TEST(RedundancyTexts, TwoPinsOfOneRod) {
  const char* text = R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "ground": { "type": "mechanics/ground" },
    "rod": { "type": "mechanics/planar_body", "mass": 1, "inertia": 0.1, "position": [1, 0] },
    "pin": { "type": "mechanics/planar_revolute", "a": "rod", "point_a": [-1, 0], "b": "ground" },
    "far": { "type": "mechanics/planar_revolute", "a": "rod", "point_a": [1, 0], "b": "ground", "point_b": [2, 0] }
  } })";
  const Compiled rod = compile(read_scene_text(text, "rod.json"), registry());
  const State state = consistent_start(rod.system, rod.options, 0.0);
  const std::vector<RedundantSet> sets = describe_redundancy(rod.system, state, choose_partition(rod.system, state));
  ASSERT_EQ(sets.size(), 1U);
  EXPECT_EQ(sets[0].undetermined, "a force along x");
  EXPECT_EQ(sets[0].remedy, "free far along x; as much in pin would do");
}

// A physical pendulum about an axis 3 degrees off the plumb: omega^2 = m g sin(3 deg) d / (I + m d^2).
TEST(Door, SwingsAsAPendulum) {
  const Machine machine = load("scenes/redundant/door.json");
  const State state = find_equilibrium(machine.system(), machine.options().equilibrium).state;
  const double omega = std::sqrt(30 * 0.513415688 * 0.45 / (2.029 + 30 * 0.45 * 0.45));
  for (const std::complex<double> eigenvalue : eigenvalues(linear_model(machine, state))) {
    EXPECT_NEAR(eigenvalue.real(), 0.0, 1e-12);
    EXPECT_TRUE(close(std::abs(eigenvalue.imag()), omega, 1e-12));
  }
}

// One coordinate theta, the angle of the crank against x, with z = 2 L sin(theta) of the carriage:
//   M = 2 (m_c L^2 / 3 + m_r (L^2 + (2 L)^2 / 12) + m_s (2 L sin)^2) + m (2 L cos)^2,  c (2 L cos)^2,  k (2 L cos)^2
TEST(ScottRussell, MovesAsItsOneCoordinate) {
  const Machine machine = load("scenes/redundant/scott_russell.json");
  const State state = find_equilibrium(machine.system(), machine.options().equilibrium).state;
  constexpr double L = 0.5, crank = 1, rod = 2, slider = 0.5, carriage = 3, k = 2000, c = 20, g = 9.81;
  const double force = g * (2 * crank * L / 2 + 2 * rod * L + carriage * 2 * L) / (2 * L);
  const double z = 1.5 - 0.7 - force / k, sine = z / (2 * L), cosine = std::sqrt(1 - sine * sine);
  EXPECT_TRUE(close(machine.value(state, "carriage.z"), z, 1e-12));
  EXPECT_TRUE(close(machine.value(state, "spring.force"), force, 1e-10));
  const double M = 2 * (crank * L * L / 3 + rod * (L * L + 4 * L * L / 12) + slider * 4 * L * L * sine * sine) +
                   carriage * 4 * L * L * cosine * cosine,
               lever = 4 * L * L * cosine * cosine;
  const std::complex<double> root =
      (-c * lever + std::sqrt(std::complex<double>(c * c * lever * lever - 4 * M * k * lever))) / (2 * M);
  std::vector<std::complex<double>> found = eigenvalues(linear_model(machine, state));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(take_nearest(found, root, 1e-11));
  EXPECT_TRUE(take_nearest(found, std::conj(root), 1e-11));
}

// It moves although it should not: the loop stays closed and the energy constant far from the start, and there too one
// row is redundant.
TEST(Bricard, MovesThroughOverconstrainedPositions) {
  const Machine machine = load("scenes/redundant/bricard.json");
  const System& system = machine.system();
  const State start = consistent_start(system, machine.options(), 0.0);
  const auto energy = [&](const State& state) {
    double sum = 0.0;
    for (const char* rod : {"rod_1", "rod_2", "rod_3", "rod_4", "rod_5"}) {
      const auto i = static_cast<std::size_t>(system.find_x(std::string(rod) + ".x"));
      const double *e = &state.x[i + 3], *edot = &state.v[i + 3];
      // Thin rods: the kinetic energy of the turn is |d'|^2 / 24, with d the direction of the rod.
      const std::size_t along = std::string(rod) == "rod_1" || std::string(rod) == "rod_4"   ? 0
                                : std::string(rod) == "rod_2" || std::string(rod) == "rod_5" ? 1
                                                                                             : 2;
      Eigen::Vector3d axis = Eigen::Vector3d::Zero();
      axis(static_cast<Index>(along)) = 1.0;
      const Eigen::Quaterniond q(e[0], e[1], e[2], e[3]), qdot(edot[0], edot[1], edot[2], edot[3]);
      const Eigen::Quaterniond w = q.conjugate() * qdot;  // half the angular velocity in body axes
      const Eigen::Vector3d omega = 2.0 * w.vec();
      for (std::size_t k = 0; k < 3; ++k) sum += 0.5 * state.v[i + k] * state.v[i + k];
      sum += omega.cross(axis).squaredNorm() / 24.0 + 9.81 * state.x[i + 1];
    }
    return sum;
  };
  double drift = 0.0, lowest = 0.0, height = machine.value(start, "rod_3.y");
  Observer observer;
  observer.output = [&](const State& state) {
    drift = std::max(drift, std::abs(energy(state) - energy(start)));
    lowest = std::min(lowest, machine.value(state, "rod_3.y") - height);
  };
  const Simulation run = simulate(system, machine.options().simulate, start, observer);
  EXPECT_LT(lowest, -0.25) << "it has moved";
  EXPECT_LT(drift, 1e-5) << "J, of some ten";
  expect_partition(system, run.last, 1, 1);
}

}  // namespace
}  // namespace bramah::testing
