// What a scene asks of the analyses, with names resolved. Plain data; defaults are those of the documentation.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "system/random.hpp"
#include "system/system.hpp"

namespace bramah {

/// A named number of a system: what outputs, tables and messages refer to.
struct Measured {
  enum class Kind { x, v, a, z, zdot, lambda, y, input, energy, power };
  Kind kind = Kind::x;
  Index index = 0;  // energy, power: of a component, -1 for the whole
  std::string name, unit;
};

struct AssemblyOptions {
  double tolerance = 0.0;  // m, by which joints that repeat each other may disagree; 0: what nine digits leave
};

struct EquilibriumOptions {
  std::vector<Index> hold_x, hold_z;  // kept at their start values
  double tolerance = 1e-12;           // residual relative to the largest term of each row
  int max_iterations = 200;
  /// A search from start values that do not balance ends at the nearest equilibrium that Newton's method finds, or at one
  /// where the potential of the forces, if they have one, is least.
  enum class Stability { nearest, stable };
  Stability stability = Stability::stable;
};

/// A condition of the scene that ends a simulation, or sends inputs elsewhere, each time it comes true.
struct EventOptions {
  std::string name;
  Measured of;
  double level = 0.0;                           // SI
  bool rises = true;                            // through the level from below; else falls from above
  bool stop = false;                            // the simulation ends
  std::vector<std::pair<Index, double>> holds;  // inputs that keep a value from then on
};

struct SimulateOptions {
  enum class From { start, equilibrium };
  From from = From::start;
  bool asked = false;  // the scene has a section "simulate"
  double from_time = 0.0, to_time = 1.0;
  double output_step = 0.0;          // 0: every accepted step
  std::vector<double> output_times;  // additional, ascending
  double rel_tol = 1e-9;             // of each variable's own motion, see simulate.cpp
  double max_step = 0.0;             // 0: no limit
  double most_rows = 1e8;            // of output, and steps, that a run may be known to need before it begins
  enum class Integrator { automatic, ida, explicit_one_step, implicit_one_step, generalized_alpha };
  Integrator integrator = Integrator::automatic;
  double step = 0.0;          // s, of generalized_alpha, which needs one
  double rho_infinity = 0.8;  // of generalized_alpha: spectral radius at infinite frequency, 0 ... 1
  bool meet_switches = true;  // locate the kinks of laws and restart there
  std::vector<EventOptions> events;
};

/// Coordinates that a partition shall use as x_ai and as x_ad; those not named are chosen.
struct Prescribed {
  std::vector<Index> independent, admissible_dependent;
};

struct LinearizeOptions {
  enum class At { equilibrium, start };
  enum class Form { reduced, descriptor };
  At at = At::equilibrium;
  bool asked = false;
  Form form = Form::reduced;
  Prescribed prescribed;
  int side = 1;               // one-sided derivatives at switching points
  std::vector<double> times;  // along the simulation, ascending; empty: only the reference state
};

/// Selected modes of large systems; where nothing is asked for, all modes are found.
struct ModesOptions {
  enum class Select { all, nearest, band, within };
  Select select = Select::all;
  Index count = 0;                        // nearest: how many, conjugates counted once
  double shift = 0.0;                     // nearest to it, 1/s; 0: chosen
  double band_from = 0.0, band_to = 0.0;  // Hz
  double within = 0.0;                    // |s| below, 1/s
  bool prove = true;                      // that none was missed
};

struct StudyOptions {
  double linear_from = -1.0;  // overlay the linear model from this time of the simulation on; < 0: no overlay
  std::string title, description;
};

struct CompareOptions {
  std::vector<double> steps;  // h of Eq. (100); empty: 1e-1 ... 1e-12
};

/// A number of the scene that takes several values in turn, as `apply_setting` would set it.
struct SweptParameter {
  std::string name, unit;      // "constants.v", "boom.mass"; unit "1" where there is none
  std::vector<double> values;  // SI
};

struct SweepOptions {
  std::vector<SweptParameter>
      over;  // none, one, or two: then a grid; values strictly ascending or descending, two or more
};

/// A number of the scene that is drawn by lot.
struct RandomParameter {
  std::string name, unit;
  Distribution distribution;  // SI
};

/// Many simulations: every point of the grid, each with `count` draws.
struct VaryOptions {
  enum class Figure { final_value, min, max, mean, rms };
  bool asked = false;
  std::vector<SweptParameter> over;  // a full grid, the last one changes fastest
  std::vector<RandomParameter> random;
  std::size_t count = 1;
  std::uint64_t seed = 1;
  std::vector<Measured> of;  // the outputs where the scene does not choose
  std::vector<Figure> figures = {Figure::final_value, Figure::min, Figure::max, Figure::mean, Figure::rms};
  /// Of the grid, times count.
  [[nodiscard]] std::size_t runs() const {
    std::size_t product = count;
    for (const SweptParameter& one : over) product *= one.values.size();
    return product;
  }
};

struct Options {
  AssemblyOptions assembly;
  EquilibriumOptions equilibrium;
  SimulateOptions simulate;
  LinearizeOptions linearize;
  ModesOptions modes;
  CompareOptions compare;
  StudyOptions study;
  SweepOptions sweep;
  VaryOptions vary;
  std::vector<Measured> outputs;  // of the scene's "outputs"; all variables where it has none
};

/// The measurement called `name` ("crank.angle", "crank.angle.rate", "hinge.lambda_x", "cylinder.force"); false where
/// there is none. Suffix ".rate" is the time derivative of x or z, ".acceleration" the second of x; "cylinder.energy" and
/// "cylinder.power" are those of Energies, "energy" and "power" their sums.
bool find_measured(const System& system, std::string_view name, Measured& found);
/// Every name that find_measured knows, for suggestions.
std::vector<std::string> measured_names(const System& system);

}  // namespace bramah
