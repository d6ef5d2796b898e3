#include "linear/stability.hpp"

#include <cmath>

#include "system/analysis_error.hpp"

namespace bramah {
namespace {

std::string counted(Eigen::Index count, const char* noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

Stability judge_stability(const LinearModel& model, const Spectrum& spectrum) {
  Stability result;
  result.states = model.states;
  Eigen::MatrixXd shares;
  for (std::size_t k = 0; k < spectrum.modes.size(); ++k) {
    const Mode& mode = spectrum.modes[k];
    const bool oscillates = mode.eigenvalue.imag() != 0.0;
    if (mode.zero || (mode.doubtful && !oscillates)) {
      ++result.zeros;
    } else if (mode.eigenvalue.real() > mode.rounding) {
      ++result.directions;
      if (mode.eigenvalue.imag() < 0.0) continue;
      if (shares.size() == 0) shares = participation(spectrum);
      result.modes.push_back({mode.eigenvalue, shares.col(static_cast<Eigen::Index>(k))});
    } else if (mode.eigenvalue.imag() > 0.0 && mode.eigenvalue.real() >= -mode.rounding) {
      ++result.undamped;
    }
  }
  if (result.directions > 0) {
    result.verdict = Stability::Verdict::unstable;
  } else if (result.zeros == 0 && result.undamped == 0) {
    result.verdict = Stability::Verdict::stable;
  } else {
    if (result.zeros > 0) result.why = counted(result.zeros, "zero");
    if (result.undamped > 0)
      result.why += (result.why.empty() ? "" : " and ") + counted(result.undamped, "undamped pair");
  }
  return result;
}

Stability judge_stability(const System& system, const State& equilibrium, Index most) {
  Stability result;
  try {
    const Partition partition = choose_partition(system, equilibrium);
    const Index states = static_cast<Index>(2 * partition.ai.size() + partition.ad.size()) + system.nz();
    if (states > most) {
      result.why = std::to_string(states) + " states, not computed above " + std::to_string(most);
      return result;
    }
    LinearModel model;
    Linearizer linearizer(system, partition);
    linearizer.linearize(equilibrium, model);
    linearizer.estimate_rounding(model);
    return judge_stability(model, find_spectrum(model));
  } catch (const AnalysisError& error) {
    result.why = std::string("no linear model: ") + error.found();
  }
  return result;
}

}  // namespace bramah
