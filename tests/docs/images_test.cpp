// The pictures of the README, drawn from the engine's own results. With BRAMAH_WRITE_DOCS set they are written to
// docs/images; without it they are only drawn.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "io/plot.hpp"
#include "linear/respond.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"

namespace bramah::docs {
namespace {

using testing::Machine;

void keep(const std::string& name, const std::string& svg) {
  if (std::getenv("BRAMAH_WRITE_DOCS") == nullptr) return;
  std::ofstream(std::string(BRAMAH_SOURCE_DIR) + "/docs/images/" + name) << svg;
}

TEST(Images, Transient) {
  // The torque of Eq. (92) is gone at 1.5 s; what follows, simulated and by the 6 x 6 model.
  const Machine machine = testing::load("scenes/four_bar/underdamped_high_friction.json");
  const State rest = find_equilibrium(machine.system(), machine.options().equilibrium).state;
  SimulateOptions options = machine.options().simulate;
  options.to_time = 1.56;
  options.output_step = 0.0;
  for (int k = 0; k <= 350; ++k) options.output_times.push_back(1.49 + 2e-4 * k);
  plot::Series simulated{"simulation", {}, {}, plot::Style::line, 0},
      linear{"6 x 6 linear model", {}, {}, plot::Style::dashes, 1};
  State release;
  Observer observer;
  observer.output = [&](const State& state) {
    if (state.t < 1.489) return;
    simulated.x.push_back(state.t);
    simulated.y.push_back(machine.value(state, "crank.angle") - machine.value(rest, "crank.angle"));
    if (std::abs(state.t - 1.5) < 1e-12) release = state;  // of two at the jump, the one after it
  };
  simulate(machine.system(), options, rest, observer);
  ASSERT_GT(release.t, 1.4);

  const Partition partition = choose_partition(machine.system(), rest, machine.options().linearize.prescribed);
  for (const double t : simulated.x) {
    if (t > release.t) linear.x.push_back(t);
  }
  const LinearModel model = testing::linear_model(machine, rest);
  const Eigen::MatrixXd X =
      free_response(model, reduced_deviation(machine.system(), partition, release, rest), release.t, linear.x);
  for (Eigen::Index k = 0; k < X.cols(); ++k) linear.y.push_back(X(0, k));

  plot::Figure figure;
  figure.width = 720;
  figure.height = 260;
  figure.title = "Crank of the four-bar, friction x 1/10: the torque ends at 1.5 s";
  figure.x = {"time", "s"};
  figure.y = {"deviation from 60 deg", "rad"};
  figure.series = {std::move(simulated), std::move(linear)};
  figure.marks = {1.5};
  keep("transient.svg", plot::svg(figure, true));
}

TEST(Images, Spectrum) {
  plot::Figure figure;
  figure.title = "Eigenvalues of the four-bar, three frictions";
  figure.width = 720;
  figure.height = 300;
  figure.x = {"real part", "1/s", plot::Scale::symlog, -1e5, 10.0, 1.0};
  figure.y = {"imaginary part", "1/s", plot::Scale::symlog, -1e4, 1e4, 1.0};
  plot::Series zeros{"two true zeros", {}, {}, plot::Style::dots, 3};
  int colour = 0;
  for (const auto& [name, file] : {std::pair{"friction x 1", "overdamped"},
                                   {"x 1/10", "underdamped_high_friction"},
                                   {"x 1/100", "underdamped_low_friction"}}) {
    const Machine machine = testing::load("scenes/four_bar/" + std::string(file) + ".json");
    const State rest = find_equilibrium(machine.system(), machine.options().equilibrium).state;
    plot::Series series{name, {}, {}, plot::Style::circles, colour++};
    for (const Mode& mode : find_spectrum(testing::linear_model(machine, rest)).modes) {
      plot::Series& to = mode.zero ? zeros : series;
      to.x.push_back(mode.zero ? 0.0 : mode.eigenvalue.real());
      to.y.push_back(mode.zero ? 0.0 : mode.eigenvalue.imag());
    }
    figure.series.push_back(std::move(series));
  }
  EXPECT_EQ(zeros.x.size(), 6U);
  figure.series.push_back(std::move(zeros));
  keep("spectrum.svg", plot::svg(figure, true));
}

}  // namespace
}  // namespace bramah::docs
