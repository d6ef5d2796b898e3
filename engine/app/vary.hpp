// Many simulations of one scene: a grid of its numbers, random draws of them, or both; figures of each run.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "app/context.hpp"
#include "app/equilibrium_report.hpp"
#include "app/journal.hpp"

namespace bramah {

/// A column of the table: a figure of an output, or "time", the time that a run reached.
struct RunFigure {
  std::string name, unit;  // "boom.angle.max"
};

struct VariedRun {
  enum class Status { ok, failed, interrupted };
  Status status = Status::interrupted;
  std::vector<double> at;      // of the parameters, SI
  std::vector<double> values;  // of the figures; empty unless ok
  std::string message;         // why it failed; of a run that is ok: where it was beyond a law's limits
};

struct FigureStatistics {
  double mean = NAN, deviation = NAN, min = NAN, max = NAN, low = NAN, median = NAN, high = NAN;  // 5, 50, 95 %
};

struct Vary {
  std::vector<RunFigure> parameters, figures;
  std::vector<VariedRun> runs;  // grid points in order, at each its draws
  std::optional<Rest> rest;     // of the scene as it is written, where runs begin at an equilibrium and it has one
  bool interrupted = false;
  [[nodiscard]] std::size_t count(VariedRun::Status status) const;
};

/// As results write it.
const char* word_for(VariedRun::Status status);

/// Failure where the scene has no "vary".
void check_vary(const Context& context);
/// Simulates as the scene's "vary" says. Runs that are in the journal are taken from it, others are written there. Throws
/// WriteError.
Vary run_vary(const Context& context, Journal& journal);

/// Over the runs that are ok, one for each figure; NAN where there are none. The deviation is that of a sample, with
/// n - 1; percentiles lie on straight lines between the sorted values.
std::vector<FigureStatistics> statistics_of(const Vary& vary);

std::string vary_document(const Vary& vary);
/// A row a run.
std::string vary_csv(const Vary& vary);
std::string vary_text(const Vary& vary);

}  // namespace bramah
