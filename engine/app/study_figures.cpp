#include <algorithm>
#include <cmath>

#include "app/results.hpp"
#include "app/study_report.hpp"

namespace bramah {
namespace {

constexpr std::size_t kMostPanels = 6;  // unless the scene says which outputs it wants

/// Outputs that are worth a picture: the scene's own list, or else the states of the linear model that move, then others.
std::vector<std::size_t> chosen_outputs(const Context& context, const StudyResults& results) {
  const std::vector<Measured>& outputs = context.options().outputs;
  const auto moves = [&](std::size_t k) {
    const auto& values = results.recording.values;
    const auto [low, high] = std::minmax_element(values.begin(), values.end(),
                                                 [&](const Vector& a, const Vector& b) { return a[k] < b[k]; });
    return (*high)[k] - (*low)[k] > 1e-12 * std::max(std::abs((*high)[k]), std::abs((*low)[k]));
  };
  std::vector<std::size_t> chosen;
  const auto add = [&](std::size_t k) {
    if (std::find(chosen.begin(), chosen.end(), k) == chosen.end()) chosen.push_back(k);
  };
  if (context.scene.root.find("outputs") != nullptr) {
    for (std::size_t k = 0; k < outputs.size() && k < 2 * kMostPanels; ++k) add(k);
    return chosen;
  }
  for (const NamedQuantity& state : results.linear.model.states) {
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      if (outputs[k].name == state.name && chosen.size() < kMostPanels && moves(k)) add(k);
    }
  }
  for (std::size_t k = outputs.size(); k-- > 0 && chosen.size() < kMostPanels;) {
    if (moves(k)) add(k);  // from the end: lengths, pressures and forces say more than the places of bodies
  }
  return chosen;
}

/// The whole run; with `until` the part from the overlay's begin to that time.
plot::Figure transient_figure(const Context& context, const StudyResults& results, std::size_t k, double until = NAN) {
  const Measured& output = context.options().outputs[k];
  plot::Figure figure;
  figure.title = output.name;
  figure.x = {"time", "s"};
  figure.y = {results.overlay ? "deviation" : "", output.unit};
  const double reference = results.overlay ? results.overlay->reference[k] : 0.0;
  const bool zoomed = !std::isnan(until);
  if (zoomed) figure.title += ", close";
  plot::Series nonlinear{results.overlay ? "simulation" : "", {}, {}, plot::Style::line, 0};
  for (std::size_t i = zoomed ? results.overlay->first : 0; i < results.recording.times.size(); ++i) {
    if (zoomed && results.recording.times[i] > until) break;
    nonlinear.x.push_back(results.recording.times[i]);
    nonlinear.y.push_back(results.recording.values[i][k] - reference);
  }
  figure.series.push_back(std::move(nonlinear));
  if (results.overlay) {
    const Overlay& overlay = *results.overlay;
    plot::Series linear{"linear model", {}, {}, plot::Style::dashes, 1};
    for (std::size_t i = 0; i < overlay.linear.size(); ++i) {
      const double time = results.recording.times[overlay.first + i];
      if (zoomed && time > until) break;
      linear.x.push_back(time);
      linear.y.push_back(overlay.linear[i][k] - reference);
    }
    figure.series.push_back(std::move(linear));
    if (!zoomed) figure.marks.push_back(overlay.from);
  }
  return figure;
}

void add_points(plot::Series& series, const Eigenvalues& eigenvalues) {
  for (const std::complex<double>& value : eigenvalues) {
    series.x.push_back(value.real());
    series.y.push_back(value.imag());
  }
}

/// A little beyond the next power of ten, so that no mark stands on the edge; not below `least`.
double limit(double value, double least) {
  return 1.6 * std::max(value > 0.0 ? std::pow(10.0, std::ceil(std::log10(value) - 1e-9)) : 0.0, least);
}

plot::Figure complex_plane(std::string title) {
  plot::Figure figure;
  figure.title = std::move(title);
  figure.width = 1000;
  figure.height = 340;
  figure.x = {"real part", "1/s", plot::Scale::symlog};
  figure.y = {"imaginary part", "1/s", plot::Scale::symlog};
  return figure;
}

plot::Figure spectrum_figure(const StudyResults& results) {
  plot::Figure figure = complex_plane("Spectrum");
  plot::Series modes{"eigenvalues", {}, {}, plot::Style::circles, 0},
      zeros{"true zeros", {}, {}, plot::Style::circles, 2};
  std::vector<double> parts;
  double left = 0.0, right = 0.0, up = 0.0;
  for (const Mode& mode : results.census.spectrum.modes) {
    const std::complex<double> value = mode.zero ? 0.0 : mode.eigenvalue;
    plot::Series& series = mode.zero ? zeros : modes;
    series.x.push_back(value.real());
    series.y.push_back(value.imag());
    parts.insert(parts.end(), {value.real(), value.imag()});
    left = std::max(left, -value.real());
    right = std::max(right, value.real());
    up = std::max(up, std::abs(value.imag()));
  }
  const double threshold = plot::symlog_threshold(parts);
  figure.x.threshold = figure.y.threshold = threshold;
  figure.x.low = -limit(left, threshold);
  figure.x.high = limit(right, threshold);
  figure.y.high = limit(up, threshold);
  figure.y.low = -figure.y.high;
  figure.series.push_back(std::move(modes));
  if (!zeros.x.empty()) figure.series.push_back(std::move(zeros));
  if (results.comparison) {
    plot::Series augmented{"augmented, exact", {}, {}, plot::Style::crosses, 1};
    add_points(augmented, results.comparison->exact.eigenvalues);
    figure.series.push_back(std::move(augmented));
  }
  return figure;
}

plot::Figure error_figure(const Comparison& comparison) {
  constexpr double rounding = 1e-10;  // errors below it have no place in the picture
  plot::Figure figure;
  figure.title = "Eigenvalue errors by differences";
  figure.width = 1000;
  figure.height = 320;
  figure.x = {"step h (SI)", "", plot::Scale::log};
  figure.y = {"relative error", "", plot::Scale::log};
  figure.y.low = rounding;
  figure.y.high = 10.0;
  int colour = 0;
  for (std::size_t k = 0; k < comparison.exact.errors.size() && colour < 5; ++k) {
    if (comparison.reduced[k].imag() < 0.0) continue;  // as its conjugate
    plot::Series series{complex_text(comparison.reduced[k], 4), {}, {}, plot::Style::line_with_dots, colour};
    double largest = 0.0;
    for (const Contender& contender : comparison.differences) {
      const double error = contender.failure.empty() ? contender.errors[k] : NAN;
      series.x.push_back(contender.h);
      series.y.push_back(error);
      if (error > largest) largest = error;
    }
    if (largest < rounding) continue;
    ++colour;
    figure.series.push_back(std::move(series));
  }
  return figure;
}

plot::Figure false_zero_figure(const Comparison& comparison) {
  constexpr int decades = 5;
  const Contender& best = comparison.differences[comparison.best()];
  plot::Figure figure = complex_plane("Zeros of the augmented Jacobian");
  plot::Series exact{"exact", {}, {}, plot::Style::crosses, 1};
  plot::Series differences{"differences, h = " + short_number(best.h, 3), {}, {}, plot::Style::circles, 0};
  add_points(exact, comparison.exact.unclaimed);
  add_points(differences, best.unclaimed);
  const double reach =
      std::max(comparison.exact.largest_false_zero, best.failure.empty() ? best.largest_false_zero : 0.0);
  figure.x.high = figure.y.high = limit(reach, 1e-300);
  figure.x.low = figure.y.low = -figure.x.high;
  figure.x.threshold = figure.y.threshold = figure.x.high / 1.6 * std::pow(10.0, -decades);
  figure.series = {std::move(differences), std::move(exact)};
  return figure;
}

}  // namespace

StudyFigures study_figures(const Context& context, const StudyResults& results) {
  StudyFigures figures;
  if (!results.recording.times.empty()) {
    const double settling = 1.2 * settling_time(results.census.spectrum);
    const bool closer = results.overlay && settling < 0.5 * (results.recording.times.back() - results.overlay->from);
    for (const std::size_t k : chosen_outputs(context, results)) {
      figures.transient.push_back(transient_figure(context, results, k));
      if (closer) figures.transient.push_back(transient_figure(context, results, k, results.overlay->from + settling));
    }
    figures.columns = closer ? 2 : 1;
  }
  if (!results.census.spectrum.modes.empty()) figures.others.emplace_back("spectrum", spectrum_figure(results));
  if (results.comparison && !results.comparison->differences.empty()) {
    figures.others.emplace_back("compare_errors", error_figure(*results.comparison));
    figures.others.emplace_back("compare_false_zeros", false_zero_figure(*results.comparison));
  }
  return figures;
}

std::string sheet_of(const std::vector<plot::Figure>& figures, std::size_t columns) {
  std::string inner;
  double width = 0.0, height = 0.0, row_height = 0.0, x = 0.0;
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (k > 0 && k % columns == 0) {
      height += row_height;
      x = row_height = 0.0;
    }
    inner += "<svg x=\"" + short_number(x) + "\" y=\"" + short_number(height) + "\" width=\"" +
             short_number(figures[k].width) + "\" height=\"" + short_number(figures[k].height) + "\">\n" +
             plot::svg(figures[k]) + "</svg>\n";
    x += figures[k].width;
    width = std::max(width, x);
    row_height = std::max(row_height, figures[k].height);
  }
  const std::string size = short_number(width) + "\" height=\"" + short_number(height + row_height) + "\"";
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"" + size + ">\n<style>\n" +
         plot::style_sheet() + "</style>\n<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n" + inner + "</svg>\n";
}

}  // namespace bramah
