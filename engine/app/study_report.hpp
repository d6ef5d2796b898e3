// The pictures and the page of a study.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/comparison.hpp"
#include "app/overlay.hpp"
#include "app/results.hpp"
#include "io/plot.hpp"

namespace bramah {

/// All that a study has found; what the scene did not ask for is missing.
struct StudyResults {
  std::optional<Equilibrium> equilibrium;
  std::optional<Stability> stability;  // of the equilibrium
  Linearization linear;
  Census census;
  std::optional<Transient> transient;
  Recording recording;
  std::optional<Overlay> overlay;
  std::optional<Comparison> comparison;
  std::vector<std::string> remarks;
};

struct StudyFigures {
  std::vector<plot::Figure> transient;  // one for each output shown, or two: whole and close
  std::size_t columns = 1;
  std::vector<std::pair<std::string, plot::Figure>> others;  // file name without extension
};
StudyFigures study_figures(const Context& context, const StudyResults& results);

/// Figures side by side and below one another in a single file.
std::string sheet_of(const std::vector<plot::Figure>& figures, std::size_t columns);

std::string study_page(const Context& context, const StudyResults& results, const StudyFigures& figures);

Table overlay_table(const Overlay& overlay);

}  // namespace bramah
