// The linearizer against the paper's own elimination, Steps 1-7, Eqs. (31)-(61) written out with dense matrices and
// explicit inverses: two routes to one Jacobian.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "solve/kkt.hpp"
#include "support/machine.hpp"
#include "support/numbers.hpp"

namespace bramah::testing {
namespace {

using Eigen::MatrixXd;

/// Dense matrix of one block (or the sum of several) over all rows and columns.
MatrixXd dense(const System& system, const Blocks& blocks, std::initializer_list<int> list, Index rows, Index columns) {
  const std::vector<Index> r = shifted(rows, 0), c = shifted(columns, 0);
  std::vector<Term> terms;
  for (const int block : list) terms.push_back({block, r, c, false, 0});
  SparsePlan plan(system, rows, columns, terms);
  const double one = 1.0;
  plan.fill(blocks, {&one, 1});
  MatrixXd result = MatrixXd::Zero(rows, columns);
  for (Index j = 0; j < columns; ++j) {
    for (Index e = plan.start()[static_cast<std::size_t>(j)]; e < plan.start()[static_cast<std::size_t>(j) + 1]; ++e) {
      result(plan.row()[static_cast<std::size_t>(e)], j) = plan.values()[static_cast<std::size_t>(e)];
    }
  }
  return result;
}

MatrixXd rows_of(const MatrixXd& A, const std::vector<Index>& list) {
  MatrixXd result(static_cast<Index>(list.size()), A.cols());
  for (std::size_t k = 0; k < list.size(); ++k) result.row(static_cast<Index>(k)) = A.row(list[k]);
  return result;
}
MatrixXd columns_of(const MatrixXd& A, const std::vector<Index>& list) {
  return rows_of(A.transpose(), list).transpose();
}

/// Eq. (61), symbol by symbol. Coordinates are reordered as (x_ai, x_ad, x_d), Eq. (29).
MatrixXd jacobian_of_the_paper(const System& system, const Partition& partition, const State& state) {
  Blocks blocks(system);
  Request request;
  request.block.fill(true);
  EXPECT_TRUE(blocks.evaluate(system, state, request).ok());
  const Index n = system.n(), nz = system.nz(), all = system.m() + system.l();
  std::vector<Index> order = partition.ai;
  order.insert(order.end(), partition.ad.begin(), partition.ad.end());
  order.insert(order.end(), partition.d.begin(), partition.d.end());
  const auto k = static_cast<Index>(partition.ai.size()), l = static_cast<Index>(partition.ad.size()),
             m = static_cast<Index>(partition.d.size());
  const std::vector<Index>& rows = partition.rows;
  const std::vector<Index> rows_h(rows.begin(), rows.begin() + m);
  const auto by_x = [&](std::initializer_list<int> list, Index count) {
    return columns_of(dense(system, blocks, list, count, n), order);
  };
  const auto rows_by_x = [&](std::initializer_list<int> list) { return rows_of(by_x(list, all), rows); };

  const MatrixXd M = rows_of(by_x({BRAMAH_F_A}, n), order);
  // d(M a0)/dx + d(D^T L0)/dx - dQ/dx
  const MatrixXd minus_Q_x_and_more = rows_of(by_x({BRAMAH_F_X, BRAMAH_L_X}, n), order);
  const MatrixXd Q_v = -rows_of(by_x({BRAMAH_F_V}, n), order);
  const MatrixXd Q_p = -rows_of(dense(system, blocks, {BRAMAH_F_Z}, n, nz), order);
  const MatrixXd D = rows_by_x({BRAMAH_R_V});
  const MatrixXd Dv_x = rows_by_x({BRAMAH_R_X});         // d(D v0)/dx
  const MatrixXd d_v = rows_by_x({BRAMAH_S_V});          // dd/dv
  const MatrixXd Da_plus_d_x = rows_by_x({BRAMAH_S_X});  // d(D a0)/dx + dd/dx
  const MatrixXd C_x = rows_of(by_x({BRAMAH_C_X}, system.m()), rows_h);
  const MatrixXd K_inverse = dense(system, blocks, {BRAMAH_G_ZDOT}, nz, nz).inverse();
  const MatrixXd H_x = -K_inverse * by_x({BRAMAH_G_X}, nz), H_v = -K_inverse * by_x({BRAMAH_G_V}, nz);
  const MatrixXd H_z = -K_inverse * dense(system, blocks, {BRAMAH_G_Z}, nz, nz);

  const MatrixXd D_dd_inverse = D.rightCols(l + m).inverse();
  MatrixXd T(n, k), V_rate = MatrixXd::Zero(n, n), U_acc = MatrixXd::Zero(n, n), V_acc = MatrixXd::Zero(n, n);
  T << MatrixXd::Identity(k, k), -D_dd_inverse * D.leftCols(k);  // (31)
  V_rate.bottomRows(l + m) = -D_dd_inverse * Dv_x;               // (34), (35)
  U_acc.bottomRows(l + m) = -D_dd_inverse * d_v;                 // (39)
  V_acc.bottomRows(l + m) = -D_dd_inverse * Da_plus_d_x;         // (40)
  const MatrixXd C_xd_inverse = C_x.rightCols(m).inverse();
  MatrixXd Vh_ai(n, k), Vh_ad(n, l);
  Vh_ai << MatrixXd::Identity(k, k), MatrixXd::Zero(l, k), -C_xd_inverse * C_x.leftCols(k);  // (44)
  Vh_ad << MatrixXd::Zero(k, l), MatrixXd::Identity(l, l), -C_xd_inverse * C_x.middleCols(k, l);
  MatrixXd Th(n, k + l), Vh = MatrixXd::Zero(n, n);
  Th << MatrixXd::Identity(k + l, k + l), -C_xd_inverse * C_x.leftCols(k + l);  // (48)
  Vh.bottomRows(m) = -C_xd_inverse * Dv_x.topRows(m);
  const MatrixXd B = D.bottomRows(l), B_bar = B * Th;  // (50)
  const MatrixXd B_ad_inverse = B_bar.rightCols(l).inverse();
  const MatrixXd Unh_ai = -B_ad_inverse * B_bar.leftCols(k);  // (52)
  const MatrixXd Vnh_ai = -B_ad_inverse * (B * Vh + Dv_x.bottomRows(l)) * Vh_ai;
  const MatrixXd Vnh_ad = -B_ad_inverse * (B * Vh + Dv_x.bottomRows(l)) * Vh_ad;
  const MatrixXd m0_inverse = (T.transpose() * M * T).inverse();          // (57)
  const MatrixXd R0 = T.transpose() * (Q_v - M * U_acc);                  // (58)
  const MatrixXd S0 = T.transpose() * (-minus_Q_x_and_more - M * V_acc);  // (59)
  const MatrixXd H0 = H_x + H_v * V_rate;                                 // (60)

  MatrixXd J = MatrixXd::Zero(2 * k + l + nz, 2 * k + l + nz);  // (61)
  J.block(0, k, k, k).setIdentity();
  J.block(k, 0, k, k) = m0_inverse * (R0 * V_rate + S0) * Vh_ai;
  J.block(k, k, k, k) = m0_inverse * R0 * T;
  J.block(k, 2 * k, k, l) = m0_inverse * (R0 * V_rate + S0) * Vh_ad;
  J.block(k, 2 * k + l, k, nz) = m0_inverse * T.transpose() * Q_p;
  J.block(2 * k, 0, l, k) = Vnh_ai;
  J.block(2 * k, k, l, k) = Unh_ai;
  J.block(2 * k, 2 * k, l, l) = Vnh_ad;
  J.block(2 * k + l, 0, nz, k) = H0 * Vh_ai;
  J.block(2 * k + l, k, nz, k) = H_v * T;
  J.block(2 * k + l, 2 * k, nz, l) = H0 * Vh_ad;
  J.block(2 * k + l, 2 * k + l, nz, nz) = H_z;
  return J;
}

struct Case {
  std::string name, scene;
  std::vector<std::string> settings;
};

class Equations : public ::testing::TestWithParam<Case> {};

TEST_P(Equations, LinearizerEqualsThePapersElimination) {
  const Machine machine = load(GetParam().scene, GetParam().settings);
  const State state = consistent_start(machine.system(), machine.options(), 0.3);
  const Partition partition = choose_partition(machine.system(), state, machine.options().linearize.prescribed);
  const MatrixXd expected = jacobian_of_the_paper(machine.system(), partition, state);
  Linearizer linearizer(machine.system(), partition);
  LinearModel model;
  linearizer.linearize(state, model);
  ASSERT_EQ(model.A.rows(), expected.rows());
  // Explicit inverses and products round; each row against its largest term in nominal units, and no better than the
  // solution of the whole.
  double largest = 0.0;
  for (Index i = 0; i < expected.rows(); ++i) {
    for (Index j = 0; j < expected.cols(); ++j)
      largest = std::max(largest, std::abs(expected(i, j)) * model.states[static_cast<std::size_t>(j)].nominal /
                                      model.states[static_cast<std::size_t>(i)].nominal);
  }
  for (Index i = 0; i < expected.rows(); ++i) {
    double scale = 1e-6 * largest * model.states[static_cast<std::size_t>(i)].nominal;
    for (Index j = 0; j < expected.cols(); ++j)
      scale = std::max(scale, std::abs(expected(i, j)) * model.states[static_cast<std::size_t>(j)].nominal);
    for (Index j = 0; j < expected.cols(); ++j) {
      EXPECT_TRUE(close(model.A(i, j), expected(i, j), 1e-9, scale / model.states[static_cast<std::size_t>(j)].nominal))
          << "J(" << i << ", " << j << ")";
    }
  }
}

const std::vector<std::string> in_motion = {"start.V1.p=3.1e6", "start.V2.p=2.6e6", "start.V3.p=3.3e6",
                                            "start.valve.U=-0.2"};
std::vector<std::string> with(std::vector<std::string> list, std::initializer_list<std::string> more) {
  list.insert(list.end(), more);
  return list;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Equations,
                         ::testing::Values(Case{"planar_four_bar", "scenes/four_bar/overdamped.json",
                                                with(in_motion,
                                                     {"start.crank.angle=50 deg", "start.crank.angle.rate=0.4"})},
                                           Case{"spatial_four_bar", "scenes/four_bar/spatial.json",
                                                with(in_motion, {"start.crank.e1.rate=0.15"})},
                                           Case{"bicycle", "scenes/bicycle/benchmark.json", {}},
                                           Case{"articulated_vehicle", "scenes/articulated_vehicle/straight.json", {}},
                                           Case{"turning_disc", "scenes/rolling/turning_disc.json", {}},
                                           Case{"torus_out_of_its_steady_motion",
                                                "scenes/rolling/torus.json",
                                                {"start.wheel.lean=0.2", "start.wheel.yaw.rate=0.3"}},
                                           Case{"skate", "scenes/rolling/skate.json", {}}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace bramah::testing
