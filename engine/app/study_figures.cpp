#include <algorithm>
#include <cmath>

#include "app/study_report.hpp"

namespace bramah {
namespace {

constexpr std::size_t kMostPanels = 6;  // unless the scene says which outputs it wants

/// Outputs that are worth a picture: the scene's own list, or else the states of the linear model that move, then others.
std::vector<std::size_t> chosen_outputs(const Context& context, const StudyResults& results) {
  const std::vector<Measured>& outputs = context.options().outputs;
  const auto moves = [&](std::size_t k) {
    const auto& values = results.recording.values;
    const auto [low, high] = std::minmax_element(values.begin(), values.end(), [&](const Vector& a, const Vector& b) { return a[k] < b[k]; });
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

plot::Figure transient_figure(const Context& context, const StudyResults& results, std::size_t k) {
  const Measured& output = context.options().outputs[k];
  plot::Figure figure;
  figure.title = output.name;
  figure.x = {"time", "s"};
  figure.y = {results.overlay ? "deviation" : "", output.unit};
  const double reference = results.overlay ? results.overlay->reference[k] : 0.0;
  plot::Series nonlinear{results.overlay ? "simulation" : "", results.recording.times, {}, plot::Style::line, 0};
  for (const Vector& values : results.recording.values) nonlinear.y.push_back(values[k] - reference);
  figure.series.push_back(std::move(nonlinear));
  if (results.overlay) {
    const Overlay& overlay = *results.overlay;
    plot::Series linear{"linear model", {}, {}, plot::Style::dashes, 1};
    linear.x.assign(results.recording.times.begin() + static_cast<std::ptrdiff_t>(overlay.first), results.recording.times.end());
    for (const Vector& values : overlay.linear) linear.y.push_back(values[k] - reference);
    figure.series.push_back(std::move(linear));
    figure.marks.push_back(overlay.from);
  }
  return figure;
}

void add_points(plot::Series& series, const Eigenvalues& eigenvalues) {
  for (const std::complex<double>& value : eigenvalues) {
    series.x.push_back(value.real());
    series.y.push_back(value.imag());
  }
}

plot::Figure spectrum_figure(const StudyResults& results) {
  plot::Figure figure;
  figure.title = "Spectrum";
  figure.height = 340;
  figure.x = {"real part", "1/s", plot::Scale::symlog};
  figure.y = {"imaginary part", "1/s", plot::Scale::symlog};
  plot::Series modes{"eigenvalues", {}, {}, plot::Style::circles, 0}, zeros{"true zeros", {}, {}, plot::Style::dots, 2};
  std::vector<double> parts;
  for (const Mode& mode : results.spectrum.modes) {
    plot::Series& series = mode.zero ? zeros : modes;
    series.x.push_back(mode.zero ? 0.0 : mode.eigenvalue.real());
    series.y.push_back(mode.zero ? 0.0 : mode.eigenvalue.imag());
    if (!mode.zero) parts.insert(parts.end(), {mode.eigenvalue.real(), mode.eigenvalue.imag()});
  }
  figure.x.threshold = figure.y.threshold = plot::symlog_threshold(parts);
  if (std::all_of(modes.y.begin(), modes.y.end(), [](double y) { return y == 0.0; })) {
    figure.y.low = -figure.y.threshold * 10;
    figure.y.high = figure.y.threshold * 10;
  }
  figure.x.high = std::max(figure.x.threshold, 2.0 * *std::max_element(parts.begin(), parts.end(), std::less<>()));
  if (results.comparison) {
    plot::Series augmented{"augmented, exact", {}, {}, plot::Style::crosses, 1};
    add_points(augmented, results.comparison->exact.eigenvalues);
    figure.series.push_back(std::move(augmented));
  }
  figure.series.push_back(std::move(modes));
  if (!zeros.x.empty()) figure.series.push_back(std::move(zeros));
  return figure;
}

plot::Figure error_figure(const Comparison& comparison) {
  plot::Figure figure;
  figure.title = "Eigenvalue errors of the augmented Jacobian by differences";
  figure.height = 300;
  figure.x = {"step h", "", plot::Scale::log};
  figure.y = {"relative error", "", plot::Scale::log};
  const std::size_t count = comparison.exact.errors.size();
  for (std::size_t k = 0; k < std::min<std::size_t>(count, 4); ++k) {
    plot::Series series{"eigenvalue " + std::to_string(k + 1), {}, {}, plot::Style::line_with_dots, static_cast<int>(k)};
    for (const Contender& contender : comparison.differences) {
      series.x.push_back(contender.h);
      series.y.push_back(contender.failure.empty() ? contender.errors[k] : NAN);
    }
    figure.series.push_back(std::move(series));
  }
  return figure;
}

plot::Figure false_zero_figure(const Comparison& comparison) {
  const Contender& best = comparison.differences[comparison.best()];
  plot::Figure figure;
  figure.title = "False zeros of the augmented Jacobian";
  figure.height = 300;
  figure.x = {"real part", "1/s", plot::Scale::symlog};
  figure.y = {"imaginary part", "1/s", plot::Scale::symlog};
  plot::Series exact{"exact", {}, {}, plot::Style::crosses, 1}, differences{"differences, best h", {}, {}, plot::Style::circles, 0};
  add_points(exact, comparison.exact.unclaimed);
  add_points(differences, best.unclaimed);
  const double reach = std::max(comparison.exact.largest_false_zero, best.failure.empty() ? best.largest_false_zero : 0.0);
  if (reach > 0.0) figure.x.threshold = figure.y.threshold = std::pow(10.0, std::floor(std::log10(reach)) - 5);
  figure.series = {std::move(differences), std::move(exact)};
  figure.marks = {0.0};
  return figure;
}

}  // namespace

StudyFigures study_figures(const Context& context, const StudyResults& results) {
  StudyFigures figures;
  if (!results.recording.times.empty()) {
    for (const std::size_t k : chosen_outputs(context, results)) figures.transient.push_back(transient_figure(context, results, k));
  }
  if (!results.spectrum.modes.empty()) figures.others.emplace_back("spectrum", spectrum_figure(results));
  if (results.comparison && !results.comparison->differences.empty()) {
    figures.others.emplace_back("compare_errors", error_figure(*results.comparison));
    figures.others.emplace_back("compare_false_zeros", false_zero_figure(*results.comparison));
  }
  return figures;
}

std::string stacked_svg(const std::vector<plot::Figure>& figures) {
  double height = 0.0, width = 0.0;
  std::string inner;
  for (const plot::Figure& figure : figures) {
    inner += "<g transform=\"translate(0 " + short_number(height) + ")\">\n<svg width=\"" + short_number(figure.width) + "\" height=\"" +
             short_number(figure.height) + "\">\n" + plot::svg(figure) + "</svg></g>\n";
    height += figure.height;
    width = std::max(width, figure.width);
  }
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"" + short_number(width) + "\" height=\"" + short_number(height) +
         "\" viewBox=\"0 0 " + short_number(width) + " " + short_number(height) + "\">\n<style>\n" + plot::style_sheet() +
         "</style>\n<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n" + inner + "</svg>\n";
}

}  // namespace bramah
