// One or two numbers of a scene through a range: eigenvalues followed along it, and where they cross into instability.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/context.hpp"
#include "app/equilibrium_report.hpp"
#include "app/journal.hpp"
#include "io/plot.hpp"
#include "io/tables.hpp"
#include "linear/track.hpp"

namespace bramah {

/// A value of the (first) parameter where the real part of a mode passes zero, or where the equilibrium ends in a fold.
/// Structural zeros take no part.
struct CriticalValue {
  double at = 0.0;
  std::size_t line = 0;
  int track = 0;
  std::complex<double> eigenvalue;  // there; 0 + 0i where it stays real
  bool oscillatory = false;         // flutter, Hopf; false: divergence
  bool fold = false;                // beyond it there is no equilibrium; the eigenvalue is zero there
  bool becomes_unstable = true;     // as the parameter goes the way of the sweep
  long others_unstable = 0;         // modes with a positive real part besides this one and its conjugate
  std::string states;               // that take part
};

/// Where a complex pair becomes two real modes, or back.
struct BranchPoint {
  double at = 0.0;
  std::size_t line = 0;
  int first = 0, second = 0;  // tracks
  double eigenvalue = 0.0;    // their common real value
  bool splits = true;         // the pair becomes real
};

struct SweepFailure {
  std::vector<double> at;  // one value, or two
  std::string message;
};

struct Sweep {
  std::vector<SweptParameter> over;  // one, or two
  std::vector<Tracks> lines;         // along the first parameter: one, or one for each value of the second
  std::vector<std::string> states;   // of each track: the states that take part where it begins
  std::vector<CriticalValue> critical;
  std::vector<BranchPoint> branches;
  std::vector<SweepFailure> failures;
  std::optional<Rest> first;  // the equilibrium that the others are followed from
  std::vector<std::string> notes;
  std::size_t added = 0;  // points between those that were asked for
  bool interrupted = false;

  /// The coordinates of a point: its own and, in a grid, that of its line.
  [[nodiscard]] std::vector<double> at(std::size_t line, double value) const;
};

/// Failure where the scene has no "sweep" and the command line no --over.
void check_sweep(const Context& context);
/// Sweeps as the scene's "sweep" says. Points that are in the journal are taken from it, others are written there. Throws
/// WriteError, and what the first point throws if no point has a spectrum.
Sweep run_sweep(const Context& context, Journal& journal);

std::string sweep_document(const Sweep& sweep);
std::string critical_document(const Sweep& sweep);
/// A row for each point that was asked for: parameters, zeros, real and imaginary part of each track.
std::string sweep_csv(const Sweep& sweep);
std::string sweep_text(const Sweep& sweep);
std::string critical_text(const Sweep& sweep);
/// File names without extension.
std::vector<std::pair<std::string, plot::Figure>> sweep_figures(const Sweep& sweep);

}  // namespace bramah
