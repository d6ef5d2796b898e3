// Linkages that turn through their change points, at random places, headings and orders of bodies and joints: every run
// goes on along its velocity, on its branch. The rows are independent at most of these starts, so that none was left out;
// where a start happens to be the change point, rows are chosen anew on the way.
//
// The references are plane geometry and one quadrature: without forces the kinetic energy 1/2 M(theta) omega^2 of a
// linkage of one degree of freedom is constant.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "io/read_scene.hpp"
#include "solve/simulate.hpp"
#include "support/machine.hpp"
#include "support/methods.hpp"
#include "support/property.hpp"
#include "support/scene_parts.hpp"

namespace bramah::testing {
namespace {

using support::exact;
using support::Method;
using Random = std::mt19937_64;

constexpr double pi = 3.14159265358979323846;

double between(Random& random, double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); }

/// Where a bar is and how it moves with the crank: position of its centre, angle, and their derivatives by theta.
struct Bar {
  std::string name;
  double mass, inertia;
  std::function<std::array<double, 3>(double)> place, slope;
};

struct Pin {
  std::string a;
  std::array<double, 2> point_a;  // of the ground: in the plane of the linkage
  std::string b;
  std::array<double, 2> point_b;
  std::string type = "planar_revolute";
};

struct Linkage {
  std::string name;
  std::vector<Bar> bars;
  std::vector<Pin> pins;
};

std::function<std::array<double, 3>(double)> turning(double x, double y, double arm, double turn) {
  return [=](double theta) {
    const double angle = turn * theta;
    return std::array{x + arm * std::cos(angle), y + arm * std::sin(angle), angle};
  };
}
std::function<std::array<double, 3>(double)> turning_slope(double arm, double turn) {
  return [=](double theta) {
    const double angle = turn * theta;
    return std::array{-turn * arm * std::sin(angle), turn * arm * std::cos(angle), turn};
  };
}

/// Equal cranks, two to four, with one coupler: from three on some rows are redundant everywhere.
Linkage parallelogram(Random& random) {
  const double r = between(random, 0.3, 1.5);
  const int cranks = std::uniform_int_distribution<int>(2, 4)(random);
  std::vector<double> feet{0.0};
  for (int k = 1; k < cranks; ++k) feet.push_back(feet.back() + between(random, 0.4, 2.0));
  const double half = 0.5 * feet.back();
  Linkage linkage{"parallelogram", {}, {}};
  for (int k = 0; k < cranks; ++k) {
    const double foot = feet[static_cast<std::size_t>(k)];
    const std::string name = support::numbered("crank", k);
    linkage.bars.push_back({name, between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                            turning(foot, 0.0, 0.5 * r, 1.0), turning_slope(0.5 * r, 1.0)});
    linkage.pins.push_back({"ground", {foot, 0.0}, name, {-0.5 * r, 0.0}});
    linkage.pins.push_back({name, {0.5 * r, 0.0}, "coupler", {foot - half, 0.0}});
  }
  linkage.bars.push_back({"coupler", between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                          [=](double theta) {
                            return std::array{half + r * std::cos(theta), r * std::sin(theta), 0.0};
                          },
                          [=](double theta) {
                            return std::array{-r * std::sin(theta), r * std::cos(theta), 0.0};
                          }});
  return linkage;
}

/// The other branch of a parallelogram: tan(phi/2) = -k tan(theta/2), k = (L + r)/(L - r), r < L.
Linkage antiparallelogram(Random& random) {
  const double r = between(random, 0.3, 1.0), L = r * between(random, 1.5, 3.0), k = (L + r) / (L - r);
  const auto phi = [=](double theta) {
    const double turns = std::round(theta / (2.0 * pi)), rest = theta - 2.0 * pi * turns;
    return -2.0 * std::atan2(k * std::sin(0.5 * rest), std::cos(0.5 * rest)) - 2.0 * pi * turns;
  };
  const auto phi_slope = [=](double theta) {
    return -k / (std::pow(std::cos(0.5 * theta), 2) + std::pow(k * std::sin(0.5 * theta), 2));
  };
  Linkage linkage{"antiparallelogram", {}, {}};
  linkage.bars.push_back({"crank0", between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                          turning(0.0, 0.0, 0.5 * r, 1.0), turning_slope(0.5 * r, 1.0)});
  linkage.bars.push_back({"crank1", between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                          [=](double theta) { return turning(L, 0.0, 0.5 * r, 1.0)(phi(theta)); },
                          [=](double theta) {
                            std::array<double, 3> slope = turning_slope(0.5 * r, 1.0)(phi(theta));
                            for (double& s : slope) s *= phi_slope(theta);
                            return slope;
                          }});
  const auto ends = [=](double theta) {
    const double p = phi(theta);
    return std::array{r * std::cos(theta), r * std::sin(theta), L + r * std::cos(p), r * std::sin(p)};
  };
  linkage.bars.push_back({"coupler", between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                          [=](double theta) {
                            const auto [ax, ay, bx, by] = ends(theta);
                            return std::array{0.5 * (ax + bx), 0.5 * (ay + by), std::atan2(by - ay, bx - ax)};
                          },
                          [=](double theta) {
                            const auto [ax, ay, bx, by] = ends(theta);
                            const double p = phi(theta), dp = phi_slope(theta), dax = -r * std::sin(theta),
                                         day = r * std::cos(theta), dbx = -r * std::sin(p) * dp,
                                         dby = r * std::cos(p) * dp;
                            return std::array{0.5 * (dax + dbx), 0.5 * (day + dby),
                                              ((bx - ax) * (dby - day) - (by - ay) * (dbx - dax)) / (L * L)};
                          }});
  linkage.pins = {{"ground", {0.0, 0.0}, "crank0", {-0.5 * r, 0.0}},
                  {"ground", {L, 0.0}, "crank1", {-0.5 * r, 0.0}},
                  {"crank0", {0.5 * r, 0.0}, "coupler", {-0.5 * L, 0.0}},
                  {"crank1", {0.5 * r, 0.0}, "coupler", {0.5 * L, 0.0}}};
  return linkage;
}

/// Crank and rod of one length r: the slider goes through the crank's centre, x = 2 r cos(theta), where it could stay.
Linkage equal_slider_crank(Random& random) {
  const double r = between(random, 0.3, 1.5);
  Linkage linkage{"slider-crank", {}, {}};
  linkage.bars.push_back({"crank0", between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                          turning(0.0, 0.0, 0.5 * r, 1.0), turning_slope(0.5 * r, 1.0)});
  linkage.bars.push_back({"rod", between(random, 0.5, 3.0), between(random, 0.05, 0.5),
                          [=](double theta) {
                            return std::array{1.5 * r * std::cos(theta), 0.5 * r * std::sin(theta), -theta};
                          },
                          [=](double theta) {
                            return std::array{-1.5 * r * std::sin(theta), 0.5 * r * std::cos(theta), -1.0};
                          }});
  linkage.pins = {{"ground", {0.0, 0.0}, "crank0", {-0.5 * r, 0.0}},
                  {"crank0", {0.5 * r, 0.0}, "rod", {-0.5 * r, 0.0}},
                  {"ground", {0.0, 0.0}, "rod", {0.5 * r, 0.0}, "planar_slot"}};
  return linkage;
}

double mass_of(const Linkage& linkage, double theta) {
  double sum = 0.0;
  for (const Bar& bar : linkage.bars) {
    const auto [x, y, turn] = bar.slope(theta);
    sum += bar.mass * (x * x + y * y) + bar.inertia * turn * turn;
  }
  return sum;
}

/// theta after `time`, from theta and omega: d theta/dt = omega sqrt(M(theta_0)/M(theta)), by classical Runge-Kutta steps.
double turned(const Linkage& linkage, double theta, double omega, double time) {
  constexpr int steps = 20'000;
  const double start = mass_of(linkage, theta), h = time / steps;
  const auto rate = [&](double at) { return omega * std::sqrt(start / mass_of(linkage, at)); };
  for (int k = 0; k < steps; ++k) {
    const double a = rate(theta), b = rate(theta + 0.5 * h * a), c = rate(theta + 0.5 * h * b), d = rate(theta + h * c);
    theta += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return theta;
}

/// Where the linkage stands in the world.
struct Stand {
  double heading, x, y;
  [[nodiscard]] std::array<double, 2> turn(double a, double b) const {
    return {a * std::cos(heading) - b * std::sin(heading), a * std::sin(heading) + b * std::cos(heading)};
  }
  [[nodiscard]] std::array<double, 2> point(double a, double b) const {
    const auto [u, v] = turn(a, b);
    return {x + u, y + v};
  }
};

std::string pair(const std::array<double, 2>& p) { return "[" + exact(p[0]) + ", " + exact(p[1]) + "]"; }

std::string scene_of(const Linkage& linkage, const Stand& stand, double theta, double omega, double time,
                     Random& random) {
  std::vector<std::string> parts;
  for (const Bar& bar : linkage.bars) {
    const auto [x, y, angle] = bar.place(theta);
    const auto [vx, vy, rate] = bar.slope(theta);
    parts.push_back("\"" + bar.name + R"(": { "type": "mechanics/planar_body", "mass": )" + exact(bar.mass) +
                    R"(, "inertia": )" + exact(bar.inertia) + R"(, "position": )" + pair(stand.point(x, y)) +
                    R"(, "angle": )" + exact(stand.heading + angle) + R"(, "velocity": )" +
                    pair(stand.turn(omega * vx, omega * vy)) + R"(, "angular_velocity": )" + exact(omega * rate) +
                    " }");
  }
  int number = 0;
  for (const Pin& pin : linkage.pins) {
    const bool ground = pin.a == "ground";
    std::string part = "\"" + support::numbered("joint", number++) + R"(": { "type": "mechanics/)" + pin.type +
                       R"(", "a": ")" + pin.a + R"(", "b": ")" + pin.b + R"(", "point_a": )" +
                       pair(ground ? stand.point(pin.point_a[0], pin.point_a[1]) : pin.point_a) + R"(, "point_b": )" +
                       pair(pin.point_b);
    if (pin.type == "planar_slot") part += R"(, "direction": )" + pair(stand.turn(1.0, 0.0));
    parts.push_back(part + " }");
  }
  parts.push_back(R"("ground": { "type": "mechanics/ground" })");
  std::shuffle(parts.begin(), parts.end(), random);
  std::string text = R"({ "bramah": 1, "libraries": ["mechanics"], "components": { )";
  for (std::size_t k = 0; k < parts.size(); ++k) text += (k == 0 ? "" : ",\n    ") + parts[k];
  return text + R"( }, "simulate": { "to_time": )" + exact(time) + " } }";
}

class SingularPassage : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(All, SingularPassage, ::testing::ValuesIn(support::methods), support::name_of);
INSTANTIATE_TEST_SUITE_P(Automatic, SingularPassage, ::testing::Values(support::automatic), support::name_of);

TEST_P(SingularPassage, GoesOnAlongTheVelocityOnItsBranch) {
  // Which branch was taken, not how exactly: beside a change point an error of the rates shifts the way on by up to its
  // square root. The branches come to differ by far more.
  constexpr double tolerance = 1e-2;
  const int count = support::property_runs(6);
  for (int k = 0; k < count; ++k) {
    Random random(support::property_seed(k));
    const Linkage linkage = k % 3 == 0   ? parallelogram(random)
                            : k % 3 == 1 ? antiparallelogram(random)
                                         : equal_slider_crank(random);
    const Stand stand{between(random, -3.1, 3.1), between(random, -100.0, 100.0), between(random, -100.0, 100.0)};
    // A quarter starts at a change point, the others up to two radians before one, and pass it once or twice.
    const bool at_change = between(random, 0.0, 1.0) < 0.25;
    const double change = linkage.name == "slider-crank" ? 0.5 * pi : 0.0, way = between(random, 0.2, 2.0),
                 omega = (between(random, 0.0, 1.0) < 0.5 ? -1.0 : 1.0) * between(random, 0.5, 3.0),
                 theta = change - (at_change ? 0.0 : std::copysign(way, omega)), time = 4.0 / std::abs(omega);
    const std::string scene = scene_of(linkage, stand, theta, omega, time, random);
    const std::string what = linkage.name + ", case " + std::to_string(k) + "\n" + scene;
    const Compiled machine = compile(read_scene_text(scene, "linkage.json"), registry());
    SimulateOptions options = support::with(machine.options.simulate, GetParam());
    options.rel_tol = 1e-8;
    Simulation run;
    try {
      run = simulate(machine.system, options, consistent_start(machine.system, machine.options, 0.0), {});
    } catch (const AnalysisError& e) {
      ADD_FAILURE() << e.what() << "\n" << what;
      continue;
    }
    const State& last = run.last;
    if (run.statistics.energy.relative() > 0.02) continue;  // the run itself says not to trust it
    const double expected = turned(linkage, theta, omega, time);
    const auto value = [&](const std::string& name) {
      return last.x[static_cast<std::size_t>(machine.system.find_x(name))];
    };
    for (const Bar& bar : linkage.bars) {
      const auto [x, y, angle] = bar.place(expected);
      const auto [px, py] = stand.point(x, y);
      const double turns = 2.0 * pi * std::round((value(bar.name + ".angle") - stand.heading - angle) / (2.0 * pi));
      EXPECT_NEAR(value(bar.name + ".x"), px, tolerance) << what;
      EXPECT_NEAR(value(bar.name + ".y"), py, tolerance) << what;
      EXPECT_NEAR(value(bar.name + ".angle") - turns, stand.heading + angle, tolerance) << what;
    }
  }
}

}  // namespace
}  // namespace bramah::testing
