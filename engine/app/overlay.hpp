// The linear model beside the nonlinear simulation, from a given time on.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "app/transient.hpp"
#include "linear/spectrum.hpp"

namespace bramah {

/// All that a simulation has put out, kept for pictures and for the overlay.
struct Recording {
  std::vector<double> times;
  std::vector<Vector> values;  // of the scene's outputs, one vector a time
  std::vector<Vector> inputs;
  std::vector<State> from;  // the state at the start of the overlay: the last one at or just after its time
  std::size_t from_index = 0;

  void take(const System& system, const State& state, const Vector& outputs, double linear_from);
};

struct Overlay {
  struct Error {
    std::string name, unit;
    double deviation = 0.0;  // from the reference, where the overlay begins
    double largest = 0.0;    // of |linear - nonlinear|
    double peak = 0.0;       // of |nonlinear - reference| from there on
    /// Largest error over deviation; NAN where the output begins at rest, so that the quotient says nothing.
    [[nodiscard]] double relative() const {
      return std::abs(deviation) > 1e-3 * peak ? largest / std::abs(deviation) : NAN;
    }
  };
  double from = 0.0;
  std::size_t first = 0;       // of the recording
  Vector reference;            // of the outputs
  std::vector<Vector> linear;  // outputs by the linear model, from `first` on
  std::vector<Error> errors;   // one for each output
};

/// How long the slowest mode that dies takes to fall below 1 %; +infinity where none does.
double settling_time(const Spectrum& spectrum);

/// Times after `from` at which the modes are seen well, until they have settled or until `to`.
std::vector<double> overlay_times(const Spectrum& spectrum, double from, double to);

/// The linear model starts from the deviation of the simulated state at study.linear_from and sees the same inputs.
Overlay overlay_linear(const Context& context, const Linearization& linear, const Recording& recording);

}  // namespace bramah
