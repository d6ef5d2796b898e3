#include "io/plot_axis.hpp"

#include <algorithm>
#include <limits>

#include "io/tables.hpp"

namespace bramah::plot {
namespace {

std::string superscript(int exponent) {
  static const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(exponent))) text += digits[c - '0'];
  return text;
}

std::string decade(int exponent) { return exponent == 0 ? "1" : "10" + superscript(exponent); }

int floor_log10(double value) { return static_cast<int>(std::floor(std::log10(value) + 1e-9)); }

constexpr double kAxisPadding = 0.04;  // of the length, at both ends
constexpr int kMostDecades = 8;        // with a number each

}  // namespace

PlacedAxis::PlacedAxis(const Axis& axis, const std::vector<const std::vector<double>*>& values) : axis_(axis) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const auto* list : values) {
    for (const double value : *list) {
      const double warped = warp(value);
      if (!std::isfinite(warped)) continue;
      least = std::min(least, warped);
      most = std::max(most, warped);
    }
  }
  if (!(least <= most)) least = most = warp(axis.scale == Scale::log ? 1.0 : 0.0);
  if (!(most - least > 1e-12 * std::max(std::abs(least), std::abs(most)))) {
    const double half = axis.scale == Scale::linear && least != 0.0 ? 0.05 * std::abs(least) : 1.0;
    least -= half;
    most += half;
  }
  const double padding = kAxisPadding * (most - least);
  low_ = std::isnan(axis.low) ? least - padding : warp(axis.low);
  high_ = std::isnan(axis.high) ? most + padding : warp(axis.high);

  caption_ = axis.label;
  std::string unit = axis.unit == "1" ? "" : axis.unit;
  if (axis.scale == Scale::linear) {
    const double largest = std::max(std::abs(low_), std::abs(high_));
    const int exponent = floor_log10(largest);
    if (exponent < -2 || exponent > 3) {  // one factor for the axis rather than one at each tick
      const int factor = 3 * static_cast<int>(std::floor(exponent / 3.0));
      axis_.threshold = std::pow(10.0, factor);
      unit = decade(factor) + (unit.empty() ? "" : " ") + unit;
    } else {
      axis_.threshold = 1.0;
    }
    place_linear_ticks();
  } else if (axis.scale == Scale::log) {
    place_log_ticks();
  } else {
    place_symlog_ticks();
  }
  if (!unit.empty()) caption_ += " (" + unit + ")";
}

double PlacedAxis::warp(double value) const {
  switch (axis_.scale) {
    case Scale::linear: return value;
    case Scale::log: return value > 0.0 ? std::log10(value) : NAN;
    case Scale::symlog: {
      const double ratio = value / axis_.threshold;
      return std::abs(ratio) <= 1.0 ? ratio : std::copysign(1.0 + std::log10(std::abs(ratio)), ratio);
    }
  }
  return NAN;
}

double PlacedAxis::place(double value) const { return (warp(value) - low_) / (high_ - low_); }

void PlacedAxis::place_linear_ticks() {
  const double raw = (high_ - low_) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / power;
  const double step = power * (ratio < 1.5 ? 1.0 : ratio < 3.5 ? 2.0 : ratio < 7.5 ? 5.0 : 10.0);
  const auto first = static_cast<long>(std::ceil(low_ / step - 1e-9)),
             last = static_cast<long>(std::floor(high_ / step + 1e-9));
  for (long k = first; k <= last; ++k) {
    const double value = static_cast<double>(k) * step;
    std::string label = short_number(value / axis_.threshold, 6);
    if (label.starts_with('-')) label.replace(0, 1, "−");
    ticks_.push_back({value, std::move(label)});
  }
}

void PlacedAxis::place_log_ticks() {
  const int first = static_cast<int>(std::ceil(low_ - 1e-9)), last = static_cast<int>(std::floor(high_ + 1e-9));
  const int stride = 1 + (last - first) / kMostDecades;
  for (int k = first; k <= last; ++k) ticks_.push_back({std::pow(10.0, k), (last - k) % stride == 0 ? decade(k) : ""});
}

void PlacedAxis::place_symlog_ticks() {
  const int lowest = floor_log10(axis_.threshold);
  const int decades_left = static_cast<int>(std::floor(-low_ + 1e-9)),
            decades_right = static_cast<int>(std::floor(high_ + 1e-9));
  const int stride = 1 + (std::max(decades_left, 0) + std::max(decades_right, 0)) / kMostDecades;
  const auto side = [&](int count, const char* sign, double factor) {
    for (int k = 0; k < count; ++k) {
      ticks_.push_back({factor * std::pow(10.0, lowest + k), k % stride == 0 ? sign + decade(lowest + k) : ""});
    }
  };
  side(decades_left, "−", -1.0);
  if (low_ <= 0.0 && high_ >= 0.0) ticks_.push_back({0.0, "0"});
  side(decades_right, "", 1.0);
}

double symlog_threshold(const std::vector<double>& values) {
  double least = std::numeric_limits<double>::infinity();
  for (const double value : values) {
    if (value != 0.0 && std::isfinite(value)) least = std::min(least, std::abs(value));
  }
  return std::isfinite(least) ? std::pow(10.0, std::floor(std::log10(least))) : 1.0;
}

}  // namespace bramah::plot
