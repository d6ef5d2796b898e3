// The augmented 24 x 24 Jacobian of Sect. 4.5: exact, and by the paper's finite differences.
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "four_bar.hpp"
#include "linear/augmented.hpp"
#include "support/numbers.hpp"
#include "support/reference.hpp"

namespace bramah::testing {
namespace {

class Augmented : public ::testing::Test {
 protected:
  Machine machine_ = load("scenes/four_bar/overdamped.json");
  State state_ = find_equilibrium(machine_.system(), machine_.options().equilibrium).state;
  Partition partition_ = choose_partition(machine_.system(), state_, machine_.options().linearize.prescribed);
  nlohmann::json reference_ = reference("four_bar.json");

  std::vector<std::complex<double>> nonzero() const {
    std::vector<std::complex<double>> list;
    for (const auto& pair : reference_["augmented"]["nonzero_eigs"])
      list.emplace_back(number(pair[0]), number(pair[1]));
    return list;
  }
  /// Errors of lambda_3, lambda_4, lambda_5 with differences of step h.
  std::array<double, 3> errors(double h) const {
    std::array<double, 3> result{};
    const std::array<double, 3> exact = {-214.391064651238277, -1391.80607440571269, -23151.7903854268843};
    const std::vector<std::complex<double>> spectrum =
        plain_eigenvalues(AugmentedByDifferences(machine_.system(), partition_, AugmentedByDifferences::Inverse::dense)
                              .jacobian(state_, h));
    for (std::size_t k = 0; k < 3; ++k) {
      result[k] = HUGE_VAL;
      for (const std::complex<double>& lambda : spectrum)
        result[k] = std::min(result[k], std::abs(lambda - exact[k]) / std::abs(exact[k]));
    }
    return result;
  }
};

TEST_F(Augmented, ExactAgreesWithTheReducedSpectrum) {
  Linearizer linearizer(machine_.system(), partition_);
  LinearModel model;
  linearizer.linearize_augmented(state_, model);
  ASSERT_EQ(model.A.rows(), 24);
  std::vector<std::complex<double>> spectrum = plain_eigenvalues(model);
  for (const std::complex<double>& expected : nonzero()) EXPECT_TRUE(take_nearest(spectrum, expected, 1e-11));
  ASSERT_EQ(spectrum.size(), 20U);  // 2 physical zeros and 18 spurious ones, nine Jordan blocks among them
  double largest = 0.0;
  for (const std::complex<double>& zero : spectrum) largest = std::max(largest, std::abs(zero));
  EXPECT_LT(largest, 1e-5);  // sqrt(eps |J|): the defect shows
  EXPECT_GT(largest, 1e-12);
}

TEST_F(Augmented, RanksOfItsPowers) {
  // Rank 13, 4, 4: zero has 20-fold multiplicity and nine 2 x 2 Jordan blocks.
  Linearizer linearizer(machine_.system(), partition_);
  LinearModel model;
  linearizer.linearize_augmented(state_, model);
  Eigen::VectorXd nominal(24);
  for (int i = 0; i < 24; ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
  const Eigen::MatrixXd A = nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal();
  Eigen::MatrixXd power = A;
  for (const auto& rank : reference_["augmented"]["ranks_of_powers_1_2_3"]) {
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(power);
    svd.setThreshold(1e-13);
    EXPECT_EQ(svd.rank(), rank.get<int>());
    power = power * A;
  }
}

TEST_F(Augmented, DifferencesShowTheCurveOfFigure14) {
  // Truncation 2.34e4 h^2 in lambda_3 above the optimum, rounding below it, no digit left below 1e-10.
  const double at_4 = errors(1e-4)[0], at_5 = errors(1e-5)[0];
  EXPECT_TRUE(close(at_4, 2.34e4 * 1e-8, 0.05));
  EXPECT_LT(at_5, 1e-4);
  double best = HUGE_VAL, best_h = 0.0;
  for (double h = 1e-1; h > 5e-13; h *= 0.1) {
    const double error = errors(h)[0];
    if (error < best) {
      best = error;
      best_h = h;
    }
  }
  EXPECT_TRUE(best_h > 2e-6 && best_h < 5e-5) << "best step " << best_h;
  EXPECT_GT(best, 1e-8);  // differences never come near the exact Jacobian
  EXPECT_GT(errors(1e-11)[2], 0.5);
  // Against the same differences in exact arithmetic, where rounding is small.
  for (const auto& row : reference_["fd_exact_arithmetic"]["table"]) {
    const double h = number(row["h"]);
    if (h > 2e-3 || h < 5e-5) continue;
    EXPECT_TRUE(close(errors(h)[0], number(row["eps3"]), 0.02)) << "h = " << h;
  }
}

}  // namespace
}  // namespace bramah::testing
