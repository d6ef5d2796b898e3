// The sparsity that one trace finds is the sparsity that the equations have.
#include <gtest/gtest.h>

#include "components/friction/brown_mcphee.hpp"
#include "components/hydraulics/cylinder.hpp"
#include "components/hydraulics/directional_valve.hpp"
#include "components/hydraulics/hose.hpp"
#include "components/hydraulics/throttle.hpp"
#include "components/hydraulics/volume.hpp"
#include "components/mechanics/coordinate_force.hpp"
#include "components/mechanics/force.hpp"
#include "components/mechanics/planar_body.hpp"
#include "components/mechanics/planar_revolute.hpp"
#include "components/mechanics/revolute.hpp"
#include "components/mechanics/rigid_body.hpp"
#include "components/mechanics/stroke.hpp"
#include "components/probe.hpp"

namespace bramah {
namespace {

using bramah::testing::Parameters;
using bramah::testing::Probe;
using Pattern = std::vector<std::string>;

/// Blocks that are not named are empty.
template <class C>
void expect_patterns(const Probe<C>& probe, const std::map<int, Pattern>& named) {
  for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
    const Pattern found = probe.pattern(b);
    const auto expected = named.find(b);
    if (expected != named.end()) {
      EXPECT_EQ(found, expected->second) << detail::block_info[b].name;
    } else {
      for (const std::string& row : found) EXPECT_EQ(row, std::string(row.size(), '.')) << detail::block_info[b].name;
    }
  }
}

TEST(StructureTest, Revolute) {
  const Probe<mechanics::Revolute> probe;
  const Pattern gradient = {"x..xxxxx..xxxx", ".x.xxxx.x.xxxx", "..xxxxx..xxxxx", "...xxxx...xxxx", "...xxxx...xxxx"};
  const Pattern curved(5, "...xxxx...xxxx");  // Euler parameters only
  Pattern pull(14, std::string(14, '.'));
  for (const std::size_t j : {3U, 4U, 5U, 6U, 10U, 11U, 12U, 13U}) pull[j] = "...xxxx...xxxx";
  expect_patterns(probe, {{BRAMAH_C_X, gradient},
                          {BRAMAH_R_V, gradient},
                          {BRAMAH_R_X, curved},
                          {BRAMAH_S_X, curved},
                          {BRAMAH_S_V, curved},
                          {BRAMAH_L_X, pull}});
}

TEST(StructureTest, PlanarRevolute) {
  const Probe<mechanics::PlanarRevolute> probe;
  const Pattern gradient = {"x.xx.x", ".xx.xx"}, curved = {"..x..x", "..x..x"};
  // The angles do not meet in one term; a trace takes the nonlinear part of a row as one.
  const Pattern pull = {"......", "......", "..x..x", "......", "......", "..x..x"};
  expect_patterns(probe, {{BRAMAH_C_X, gradient},
                          {BRAMAH_R_V, gradient},
                          {BRAMAH_R_X, curved},
                          {BRAMAH_S_X, curved},
                          {BRAMAH_S_V, curved},
                          {BRAMAH_L_X, pull}});
}

TEST(StructureTest, RigidBody) {
  const Probe<mechanics::RigidBody> probe({{"mass", 1.0}, {"inertia", {1.0, 2.0, 3.0}}});
  Pattern e(7, std::string(7, '.')), mass = e, fall(7, "...");
  for (std::size_t k = 0; k < 7; ++k) {
    if (k < 3) {
      mass[k][k] = 'x';
      fall[k][k] = 'x';
    } else {
      e[k] = mass[k] = "...xxxx";
    }
  }
  Pattern pull(7, std::string(7, '.'));
  for (std::size_t k = 3; k < 7; ++k) pull[k] = "...xxxx";
  const Pattern norm = {"...xxxx"};
  expect_patterns(probe, {{BRAMAH_F_X, e},
                          {BRAMAH_F_V, e},
                          {BRAMAH_F_A, mass},
                          {BRAMAH_F_U, fall},
                          {BRAMAH_C_X, norm},
                          {BRAMAH_R_V, norm},
                          {BRAMAH_R_X, norm},
                          {BRAMAH_S_X, norm},
                          {BRAMAH_S_V, norm},
                          {BRAMAH_L_X, pull}});
}

TEST(StructureTest, PlanarBody) {
  const Probe<mechanics::PlanarBody> probe({{"mass", 1.0}, {"inertia", 1.0}});
  expect_patterns(probe, {{BRAMAH_F_A, {"x..", ".x.", "..x"}}, {BRAMAH_F_U, {"x..", ".x.", "..."}}});
}

TEST(StructureTest, Stroke) {
  const Probe<mechanics::Stroke> probe;
  const Pattern all = {std::string(15, 'x')}, bodies = {std::string(14, 'x') + "."};
  Pattern pull(15, std::string(14, 'x') + ".");
  pull[14] = std::string(15, '.');
  expect_patterns(probe, {{BRAMAH_C_X, all},
                          {BRAMAH_R_V, all},
                          {BRAMAH_R_X, bodies},
                          {BRAMAH_S_X, bodies},
                          {BRAMAH_S_V, bodies},
                          {BRAMAH_L_X, pull}});
}

TEST(StructureTest, Forces) {
  expect_patterns(Probe<mechanics::CoordinateForce>(), {{BRAMAH_F_U, {"x"}}});
  const Pattern turned = {".......", ".......", ".......", "...xxxx", "...xxxx", "...xxxx", "...xxxx"};
  expect_patterns(Probe<mechanics::Force>({{"direction", {1.0, 2.0, 3.0}}}),
                  {{BRAMAH_F_X, turned}, {BRAMAH_F_U, Pattern(7, "x")}});
}

TEST(StructureTest, Friction) {
  const Probe<friction::BrownMcPhee> probe({{"F_c", 210.0}, {"F_s", 830.0}, {"v_s", 0.0125}, {"sigma_2", 330.0}});
  expect_patterns(probe, {{BRAMAH_F_V, {"x"}}, {BRAMAH_Y_V, {"x"}}});
}

TEST(StructureTest, Storage) {
  expect_patterns(Probe<hydraulics::Volume>(), {});
  expect_patterns(Probe<hydraulics::Hose>({{"V_h", 3e-5}, {"B_h", 5e8}, {"B_oil", 1.5e9}}),
                  {{BRAMAH_G_ZDOT, {"x"}}, {BRAMAH_G_Z, {"x"}}});
}

TEST(StructureTest, Cylinder) {
  const Probe<hydraulics::Cylinder> probe(
      {{"D_2", 0.08}, {"D_3", 0.035}, {"l", 0.9}, {"B_oil", 1.5e9}, {"B_c", 3.15e10}});
  expect_patterns(probe, {{BRAMAH_F_Z, {"xx"}},
                          {BRAMAH_G_X, {"x", "x"}},
                          {BRAMAH_G_V, {"x", "x"}},
                          {BRAMAH_G_Z, {"x.", ".x"}},
                          {BRAMAH_G_ZDOT, {"x.", ".x"}},
                          {BRAMAH_Y_X, {".", "x", "x"}},
                          {BRAMAH_Y_Z, {"xx", "..", ".."}}});
}

TEST(StructureTest, LawsThatBranchAreTakenAsFull) {
  const Probe<hydraulics::Throttle> throttle({{"C_d", 0.8}, {"A_t", 3e-5}, {"rho_oil", 850.0}});
  const Pattern both = {"xx", "xx"};
  expect_patterns(throttle, {{BRAMAH_G_Z, both}, {BRAMAH_G_ZDOT, both}, {BRAMAH_Y_Z, {"xx"}}});
  const Probe<hydraulics::DirectionalValve> valve({{"C_v", 2e-8}, {"tau", 0.0045}});
  const Pattern all(5, "xxxxx"), outputs(2, "xxxxx");
  expect_patterns(valve, {{BRAMAH_G_Z, all},
                          {BRAMAH_G_ZDOT, all},
                          {BRAMAH_G_U, Pattern(5, "x")},
                          {BRAMAH_Y_Z, outputs},
                          {BRAMAH_Y_U, {"x", "x"}}});
}

}  // namespace
}  // namespace bramah
