#include "io/plot.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "io/plot_axis.hpp"
#include "io/tables.hpp"

namespace bramah::plot {
namespace {

constexpr double kLeft = 62, kRight = 18, kTop = 34, kBottom = 46;  // margins
constexpr double kLegendRow = 18;                    // on top, where the legend does not fit beside the title
constexpr double kLetter = 6.2, kTitleLetter = 7.4;  // mean widths
constexpr double kKey = 34;                          // a legend's sample with its gaps

std::string px(double value) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.1f", value);
  return {text.data(), static_cast<std::size_t>(length)};
}

std::string colour(int index) { return "s" + std::to_string(std::clamp(index, 0, 4)); }

struct Pixel {
  double x, y;
};

/// At most two points per half pixel, the lowest and the highest: what the eye would see of more.
std::vector<Pixel> thinned(const std::vector<Pixel>& points, double width) {
  if (static_cast<double>(points.size()) < 4.0 * width) return points;
  std::vector<Pixel> kept;
  for (std::size_t first = 0; first < points.size();) {
    const double column = std::floor(2.0 * points[first].x);
    std::size_t low = first, high = first, next = first;
    for (; next < points.size() && std::floor(2.0 * points[next].x) == column; ++next) {
      if (points[next].y < points[low].y) low = next;
      if (points[next].y > points[high].y) high = next;
    }
    kept.push_back(points[std::min(low, high)]);
    if (low != high) kept.push_back(points[std::max(low, high)]);
    first = std::max(next, first + 1);
  }
  return kept;
}

class Drawing {
 public:
  Drawing(const Figure& figure, bool standalone)
      : figure_(figure),
        top_(kTop + (legend_fits() ? 0.0 : kLegendRow)),
        width_(figure.width - kLeft - kRight),
        height_(figure.height - top_ - kBottom),
        x_(figure.x, data(&Series::x)),
        y_(figure.y, data(&Series::y)) {
    out_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 " + px(figure.width) + " " +
           px(figure.height) + "\"";
    if (standalone) out_ += " width=\"" + px(figure.width) + "\" height=\"" + px(figure.height) + "\"";
    out_ += " role=\"img\" aria-label=\"" + escaped(figure.title) + "\">\n";
    if (standalone) {
      out_ += "<style>\n" + style_sheet() + "</style>\n<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n";
    }
  }

  std::string draw() {
    grid();
    // An inner <svg> clips without ids, which would collide in a page of many figures.
    out_ += "<svg x=\"" + px(kLeft) + "\" y=\"" + px(top_) + "\" width=\"" + px(width_) + "\" height=\"" + px(height_) +
            "\" viewBox=\"0 0 " + px(width_) + " " + px(height_) + "\" overflow=\"hidden\">\n";
    for (const double mark : figure_.marks) {
      const std::string x = px(x_.place(mark) * width_);
      out_ += "<line class=\"mark\" x1=\"" + x;
      out_ += "\" x2=\"" + x;
      out_ += "\" y1=\"0\" y2=\"" + px(height_) + "\"/>\n";
    }
    for (const Series& series : figure_.series) draw(series);
    out_ += "</svg>\n";
    captions();
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::vector<const std::vector<double>*> data(std::vector<double> Series::*member) const {
    std::vector<const std::vector<double>*> lists;
    for (const Series& series : figure_.series) lists.push_back(&(series.*member));
    return lists;
  }

  [[nodiscard]] double legend_width() const {
    double sum = 0.0;
    for (const Series& series : figure_.series) {
      if (!series.name.empty()) sum += kLetter * static_cast<double>(width(series.name)) + kKey;
    }
    return sum;
  }
  [[nodiscard]] bool legend_fits() const {
    return legend_width() + kTitleLetter * static_cast<double>(width(figure_.title)) < figure_.width - kLeft - kRight;
  }

  void line(const char* kind, double x1, double y1, double x2, double y2) {
    out_ += std::string("<line class=\"") + kind + "\" x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) +
            "\" y2=\"" + px(y2) + "\"/>\n";
  }
  void label(const char* kind, double x, double y, const char* anchor, const std::string& content) {
    out_ += std::string("<text class=\"") + kind + "\" x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" +
            anchor + "\">" + escaped(content) + "</text>\n";
  }

  void grid() {
    const double bottom = top_ + height_;
    for (const Tick& tick : y_.ticks()) {
      const double y = bottom - y_.place(tick.value) * height_;
      if (y < top_ - 0.1 || y > bottom + 0.1) continue;
      line(tick.value == 0.0 ? "zero" : "grid", kLeft, y, kLeft + width_, y);
      label("tick", kLeft - 8, y + 3.8, "end", tick.label);
    }
    for (const Tick& tick : x_.ticks()) {
      const double x = kLeft + x_.place(tick.value) * width_;
      if (x < kLeft - 0.1 || x > kLeft + width_ + 0.1) continue;
      line(tick.value == 0.0 && figure_.x.scale == Scale::symlog ? "zero" : "grid", x, top_, x, bottom);
      label("tick", x, bottom + 16, "middle", tick.label);
    }
  }

  void draw(const Series& series) {
    std::vector<Pixel> run;
    const bool has_line =
        series.style == Style::line || series.style == Style::dashes || series.style == Style::line_with_dots;
    for (std::size_t i = 0; i <= std::min(series.x.size(), series.y.size()); ++i) {
      const bool inside = i < std::min(series.x.size(), series.y.size());
      const Pixel p =
          inside ? Pixel{x_.place(series.x[i]) * width_, height_ - y_.place(series.y[i]) * height_} : Pixel{NAN, NAN};
      if (std::isfinite(p.x) && std::isfinite(p.y)) {
        run.push_back(p);
        continue;
      }
      if (has_line) path(series, run);  // a hole in the data is a hole in the line
      if (series.style != Style::line && series.style != Style::dashes) marks(series, run);
      run.clear();
    }
  }

  void path(const Series& series, const std::vector<Pixel>& run) {
    if (run.size() < 2) return;
    out_ += "<polyline class=\"line " + colour(series.colour) + (series.style == Style::dashes ? " dashes" : "") +
            "\" points=\"";
    for (const Pixel& p : thinned(run, width_)) out_ += px(p.x) + "," + px(p.y) + " ";
    out_.back() = '"';
    out_ += "/>\n";
  }

  void marks(const Series& series, const std::vector<Pixel>& run) {
    for (const Pixel& p : run) mark(series, p.x, p.y);
  }

  void mark(const Series& series, double x, double y) {
    if (series.style == Style::crosses) {
      out_ += "<path class=\"line " + colour(series.colour) + "\" d=\"M" + px(x - 4) + " " + px(y - 4) +
              "l8 8m0 -8l-8 8\"/>\n";
      return;
    }
    const bool hollow = series.style == Style::circles;
    out_ += "<circle class=\"" + std::string(hollow ? "line " : "dot ") + colour(series.colour) + "\" cx=\"" + px(x) +
            "\" cy=\"" + px(y) + "\" r=\"" + (hollow ? "5.5" : "2.8") + "\"/>\n";
  }

  void captions() {
    label("title", kLeft, 20, "start", figure_.title);
    label("label", kLeft + width_ / 2, figure_.height - 8, "middle", x_.caption());
    const double middle = top_ + height_ / 2;
    out_ += "<text class=\"label\" text-anchor=\"middle\" transform=\"translate(14 " + px(middle) + ") rotate(-90)\">" +
            escaped(y_.caption()) + "</text>\n";
    double left = legend_fits() ? kLeft + width_ - legend_width() + 8 : kLeft;
    const double base = top_ - 14;
    for (const Series& series : figure_.series) {
      if (series.name.empty()) continue;
      if (series.style != Style::circles && series.style != Style::crosses && series.style != Style::dots) {
        out_ += "<path class=\"line " + colour(series.colour) + (series.style == Style::dashes ? " dashes" : "") +
                "\" d=\"M" + px(left) + " " + px(base - 4) + "h18\"/>\n";
      }
      if (series.style != Style::line && series.style != Style::dashes) mark(series, left + 9, base - 4);
      label("legend", left + 24, base, "start", series.name);
      left += kLetter * static_cast<double>(width(series.name)) + kKey;
    }
  }

  const Figure& figure_;
  double top_, width_, height_;
  PlacedAxis x_, y_;
  std::string out_;
};

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string style_sheet() {
  return R"(:root, svg.plot { --ink: #1f2933; --soft: #66727f; --rule: #e3e7eb; --axis: #b4bdc6; --page: #ffffff;
  --s0: #1f66d1; --s1: #e0651a; --s2: #128a72; --s3: #a6368f; --s4: #8a94a0; }
@media (prefers-color-scheme: dark) { :root, svg.plot { --ink: #e4e8ec; --soft: #98a4b0; --rule: #2c343d; --axis: #56626e;
  --page: #14181c; --s0: #6aa6ff; --s1: #ff9d57; --s2: #45c9ac; --s3: #e07fce; --s4: #7d8894; } }
svg.plot { font-family: system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; font-size: 11.5px; }
svg.plot text { fill: var(--soft); } svg.plot text.title { fill: var(--ink); font-size: 13px; font-weight: 600; }
svg.plot text.legend { fill: var(--ink); } svg.plot text.tick { font-variant-numeric: tabular-nums; }
svg.plot .page { fill: var(--page); } svg.plot .grid { stroke: var(--rule); } svg.plot .zero { stroke: var(--axis); }
svg.plot .mark { stroke: var(--axis); stroke-dasharray: 2 4; }
svg.plot .line { fill: none; stroke-width: 1.8; stroke-linejoin: round; } svg.plot .dashes { stroke-dasharray: 6 4; }
svg.plot .s0 { stroke: var(--s0); } svg.plot .s1 { stroke: var(--s1); } svg.plot .s2 { stroke: var(--s2); }
svg.plot .s3 { stroke: var(--s3); } svg.plot .s4 { stroke: var(--s4); }
svg.plot .dot { stroke: none; } svg.plot .dot.s0 { fill: var(--s0); } svg.plot .dot.s1 { fill: var(--s1); }
svg.plot .dot.s2 { fill: var(--s2); } svg.plot .dot.s3 { fill: var(--s3); } svg.plot .dot.s4 { fill: var(--s4); }
)";
}

std::string svg(const Figure& figure, bool standalone) { return Drawing(figure, standalone).draw(); }

}  // namespace bramah::plot
