// Large systems and sensitivities from the command line.
#include <gmock/gmock.h>

#include <cmath>

#include "app/cli.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

namespace bramah {
namespace {

using testing::close;
using ::testing::HasSubstr;

const std::string lattice = "'" BRAMAH_SOURCE_DIR "/scenes/linear/lattice.json'";
const std::string four_bar = "'" BRAMAH_SOURCE_DIR "/scenes/four_bar/overdamped.json'";
const std::string turning = "'" BRAMAH_SOURCE_DIR "/scenes/rolling/turning_disc.json'";

/// Lattice of 8 masses of 0.5 kg between walls, springs of 2000 N/m: w_k = 2 sqrt(k / m) sin(k pi / 18).
double lattice_rate(int k) { return 2.0 * std::sqrt(2000.0 / 0.5) * std::sin(k * std::acos(-1.0) / 18.0); }

TEST_F(Cli, SelectedModesOfTheLattice) {
  const json nearest = document("modes " + lattice + " --set modes.count=3");
  ASSERT_EQ(nearest.at("eigenvalues").size(), 3U);
  EXPECT_TRUE(nearest.at("proven").get<bool>());
  EXPECT_EQ(nearest.at("states"), 16);
  for (int k = 1; k <= 3; ++k) {
    const json& found = nearest.at("eigenvalues")[static_cast<std::size_t>(k - 1)];
    EXPECT_TRUE(close(found.at("im"), lattice_rate(k), 1e-12));
    EXPECT_LT(std::abs(found.at("re").get<double>()), 1e-10);
  }
  const json inside = document("modes " + lattice + " --set modes.within=100 --out results");
  EXPECT_EQ(inside.at("eigenvalues").size(), 5U);  // w_5 = 96.9, w_6 = 109.5
  const std::string shapes = contents(folder_ / "results" / "mode_shapes.csv");
  EXPECT_THAT(shapes, HasSubstr(",mode_1.re,mode_1.im,mode_2.re"));
  EXPECT_THAT(shapes, HasSubstr("\nm8.x,"));
  EXPECT_TRUE(fs::exists(folder_ / "results" / "selected_modes.json"));
}

TEST_F(Cli, BandOfALongChain) {
  Scene chain = support::planar_chain(300);
  std::string text = support::scene_text(chain);
  text.insert(text.rfind('}'), R"(, "modes": { "band": ["0.5 Hz", "0.6 Hz"] })");
  write("chain.json", text);
  const json found = document("modes chain.json");
  EXPECT_TRUE(found.at("proven").get<bool>());
  EXPECT_GT(found.at("eigenvalues").size(), 1U);
  for (const json& one : found.at("eigenvalues")) {
    EXPECT_GT(one.at("frequency_hz"), 0.5);
    EXPECT_LT(one.at("frequency_hz"), 0.6);
    EXPECT_LT(one.at("residual"), 1e-12);
  }
}

TEST_F(Cli, ModesWithinARadiusHaveTheLargestRealPartFirst) {
  const std::string bicycle = "'" BRAMAH_SOURCE_DIR "/scenes/bicycle/benchmark.json'";
  const json found = document("modes " + bicycle + " --set constants.v=7 --set modes.within=100");
  ASSERT_EQ(found.at("eigenvalues").size(), 3U);
  EXPECT_EQ(found.at("zeros"), 6);
  // Above the capsize speed: unstable, slowly.
  EXPECT_GT(found.at("eigenvalues")[0].at("re").get<double>(), 0.0);
  for (std::size_t k = 1; k < 3; ++k)
    EXPECT_LT(found.at("eigenvalues")[k].at("re").get<double>(), found.at("eigenvalues")[k - 1].at("re").get<double>());
}

TEST_F(Cli, DescriptorFormAsMatrixMarket) {
  const json document = this->document("linearize " + lattice + " --set linearize.form=descriptor --out results");
  EXPECT_EQ(document.at("states").size(), 16U);
  const std::string E = contents(folder_ / "results" / "E.mtx"), A = contents(folder_ / "results" / "A.mtx");
  EXPECT_TRUE(E.starts_with("%%MatrixMarket matrix coordinate real general\n16 16 16\n1 1 1\n")) << E;
  EXPECT_THAT(E, HasSubstr("\n9 9 0.5\n"));    // the first mass
  EXPECT_THAT(A, HasSubstr("\n9 1 -4000\n"));  // its two springs
}

TEST_F(Cli, SparseFormIsRefusedWhereCoefficientsChange) {
  const Ended run = bramah("modes " + turning + " --set modes.count=2");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("changes along the reference motion"));
  EXPECT_THAT(run.err, HasSubstr("use the reduced model"));
  EXPECT_THAT(bramah("modes " + turning).out, HasSubstr("Zeros were not foretold"));
}

TEST_F(Cli, SensitivitiesRankedAndByName) {
  const json all = document("sensitivity " + four_bar + " --out results");
  double before = HUGE_VAL;
  for (const json& one : all.at("sensitivities")) {
    EXPECT_LE(one.at("importance"), before);
    before = one.at("importance");
  }
  EXPECT_GT(all.at("sensitivities").size(), 60U);
  EXPECT_TRUE(contents(folder_ / "results" / "sensitivity.csv").starts_with(",value,importance,mode_1.re,mode_1.im"));
  // Stiffer friction damps: d(-1391.8)/dF_c of the reference.
  const json one = document("sensitivity " + four_bar + " --by seal.F_c");
  ASSERT_EQ(one.at("sensitivities").size(), 1U);
  for (std::size_t k = 0; k < one.at("eigenvalues").size(); ++k) {
    if (std::abs(one.at("eigenvalues")[k].at("re").get<double>() + 1391.8) > 1.0) continue;
    EXPECT_TRUE(close(one.at("sensitivities")[0].at("derivatives")[k].at("re"), -2.16653112241484284585, 1e-8));
  }
  EXPECT_THAT(bramah("sensitivity " + four_bar).out, HasSubstr("The 20 most important of"));
  const Ended wrong = bramah("sensitivity " + four_bar + " --by seal.F_k");
  EXPECT_EQ(wrong.code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("seal.F_c"));
}

TEST_F(Cli, ModesTellStabilityAndForetellZeros) {
  const json found = document("modes " + four_bar);
  EXPECT_EQ(found.at("unstable"), 0);
  EXPECT_EQ(found.at("zeros"), 2);
  EXPECT_EQ(found.at("zeros_predicted"), 2);
  // The valve stands alone: its state alone takes part, and its left and right vectors are each other's inverse.
  for (std::size_t k = 0; k < 4; ++k) {
    const json& shares = found.at("participation")[k];
    double sum = 0.0;
    for (const json& share : shares.at("components")) sum += share.get<double>();
    EXPECT_NEAR(sum, 1.0, 1e-12);
    if (std::abs(found.at("eigenvalues")[k].at("re").get<double>() + 1.0 / 0.0045) > 1e-6) continue;
    EXPECT_NEAR(shares.at("components").at("valve").get<double>(), 1.0, 1e-12);
  }
  // Undamped: real parts are rounding, on either side.
  EXPECT_EQ(document("modes " + lattice).at("unstable"), 0);
}

TEST_F(Cli, DenseModelsOfGigabytesAreRefused) {
  write("chain.json", support::scene_text(support::planar_chain(5000)));
  const Ended run = bramah("modes chain.json");
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("10000 states, too many for a dense Jacobian"));
  EXPECT_THAT(run.err, HasSubstr("--set modes.count=20"));
}

}  // namespace
}  // namespace bramah
