// Diagrams as SVG: lines and marks over axes that are linear, logarithmic, or logarithmic to both sides of zero.
// Knows nothing of the engine; colours follow the reader's light or dark theme.
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace bramah::plot {

enum class Scale {
  linear,
  log,
  symlog,  // linear within +-threshold, logarithmic outside: zeros and decades in one picture
};

struct Axis {
  std::string label;  // without unit
  std::string unit;   // empty: none
  Scale scale = Scale::linear;
  double low = NAN, high = NAN;  // NAN: from the data
  double threshold = 1.0;        // symlog only, a power of ten
};

enum class Style { line, dashes, line_with_dots, circles, crosses, dots };

struct Series {
  std::string name;  // of the legend; empty: not listed
  std::vector<double> x, y;
  Style style = Style::line;
  int colour = 0;  // 0 ... 4
};

struct Figure {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<double> marks;         // vertical lines
  double width = 520, height = 240;  // pixels
};

/// The CSS that the figures need: once in a page; a standalone file brings its own.
std::string style_sheet();

/// <svg>...</svg>. A standalone one is a whole file with style and background.
std::string svg(const Figure& figure, bool standalone = false);

/// The power of ten at or below the smallest magnitude that is not zero, for symlog axes; 1 where all are zero.
double symlog_threshold(const std::vector<double>& values);

/// & < > " replaced, for text in SVG and HTML.
std::string escaped(const std::string& text);

}  // namespace bramah::plot
