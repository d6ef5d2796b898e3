// The arithmetic of an axis: from values to pixels, and where ticks stand. For plot.cpp.
#pragma once

#include <string>
#include <vector>

#include "io/plot.hpp"

namespace bramah::plot {

struct Tick {
  double value;
  std::string label;  // empty: a line without a number
};

/// An axis with its limits chosen and its ticks placed.
class PlacedAxis {
 public:
  /// Limits that hold all `values` (finite ones; on a log axis those above zero).
  PlacedAxis(const Axis& axis, const std::vector<const std::vector<double>*>& values);

  /// Position along the axis, 0 at its low end and 1 at its high end; NAN where the scale has no place for the value.
  [[nodiscard]] double place(double value) const;
  [[nodiscard]] const std::vector<Tick>& ticks() const { return ticks_; }
  /// Label with unit and the common power of ten of the ticks.
  [[nodiscard]] const std::string& caption() const { return caption_; }

 private:
  [[nodiscard]] double warp(double value) const;
  void place_linear_ticks();
  void place_log_ticks();
  void place_symlog_ticks();

  Axis axis_;
  double low_ = 0.0, high_ = 1.0;  // warped
  std::vector<Tick> ticks_;
  std::string caption_;
};

}  // namespace bramah::plot
