// The three models of the paper's machine, and how each calls the same things.
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "support/machine.hpp"

namespace bramah::testing {

struct FourBar {
  std::string name, scene;
  std::string angle;  // the independent coordinate: phi2, or the Euler parameter sin(phi2 / 2)
};

inline const std::vector<FourBar> four_bars = {{"planar", "scenes/four_bar/overdamped.json", "crank.angle"},
                                               {"spatial", "scenes/four_bar/spatial.json", "crank.e1"},
                                               {"plugin", "plugins/paper_four_bar/scene.json", "machine.phi2"}};

struct Friction {
  std::string name;  // key of the reference: "1", "1/10", "1/100"
  std::vector<std::string> settings;
};

inline const std::vector<Friction> frictions = {{"1", {}},
                                                {"1/10", {"seal.F_c=21", "seal.F_s=83", "seal.sigma_2=33"}},
                                                {"1/100", {"seal.F_c=2.1", "seal.F_s=8.3", "seal.sigma_2=3.3"}}};

}  // namespace bramah::testing
