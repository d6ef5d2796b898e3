// The energy of a machine over a run, against the work that was done on it: what a wrong solution cannot balance.
//
//   E(t) - E(0) - int P dt    J    what is unaccounted for; the integral by Simpson's rule on every step
//
// It is small where the solution is right, whether the machine is conservative or not. What is lost at singular positions,
// or by a step that is too long, shows here although every error test has passed.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "solve/kkt.hpp"
#include "system/energies.hpp"

namespace bramah {

struct EnergyBalance {
  std::string unknown;                          // why there is none; "" where there is
  double at_start = 0.0, at_end = 0.0;          // J
  double brought_in = 0.0, taken_out = 0.0;     // J, sums over components
  std::string most_brought_in, most_taken_out;  // the components with the largest shares
  double unaccounted = 0.0;                     // J, the largest on the way
  double activity = 0.0;                        // J, the largest energy of motion and pressure on the way
  double size = 0.0;  // J, the largest sum of magnitudes over components, of which all is rounded
  /// What is unaccounted for, over the energy that was turned over; 0 where it may be rounding.
  [[nodiscard]] double relative() const;
};

class EnergyBook {
 public:
  using Interpolate = std::function<void(double t, State& state)>;
  /// `rows`: independent constraint rows.
  EnergyBook(const System& system, std::span<const Index> rows);

  /// Other rows have become the independent ones.
  void take_rows(std::span<const Index> rows);
  /// Where a run begins, and where it goes on behind a jump of an input.
  void begin(const State& state);
  /// A step from the last state to `end`, both within the last step of the integrator; `middle` is workspace.
  void step(const State& end, const Interpolate& interpolate, State& middle);
  [[nodiscard]] EnergyBalance balance() const;

 private:
  bool constraints_move(const State& state);
  bool evaluate(const State& state);
  const System& system_;
  std::vector<Index> rows_;
  Energies energies_;
  Blocks blocks_;
  std::unique_ptr<Kkt> kkt_;  // where constraints move by themselves, and their multipliers do work
  State now_;                 // for multipliers, and at rest to see whether constraints move
  EnergyBalance balance_;
  bool begun_ = false;
  double time_ = 0.0, work_ = 0.0;                  // of the last state; up to there
  Vector before_, after_, brought_in_, taken_out_;  // powers at the ends of a step; work by component
};

}  // namespace bramah
