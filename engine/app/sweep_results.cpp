// A sweep as JSON, CSV, text and pictures.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/results.hpp"
#include "app/sweep.hpp"
#include "io/tables.hpp"

namespace bramah {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t most_rows = 25;  // of the table for people; files have all
constexpr int colours = 4;             // the fifth is pale

double hertz(Complex value) { return std::abs(value.imag()) / (2.0 * std::numbers::pi); }

std::string track_name(int track) { return "m" + std::to_string(track + 1); }

void write_at(JsonWriter& json, const Sweep& sweep, std::size_t line, double value) {
  json.key("at").values(sweep.at(line, value));
}

void write_over(JsonWriter& json, const Sweep& sweep) {
  json.key("over").begin_list();
  for (const SweptParameter& over : sweep.over) {
    json.begin_object().member("parameter", over.name).member("unit", over.unit).key("values").values(over.values);
    json.end_object();
  }
  json.end_list();
}

const char* kind_of(const CriticalValue& critical) {
  return critical.fold ? "fold" : critical.oscillatory ? "flutter" : "divergence";
}
const char* becomes(const CriticalValue& critical) {
  return critical.fold ? "no equilibrium" : critical.becomes_unstable ? "unstable" : "stable";
}

void write_critical(JsonWriter& json, const Sweep& sweep) {
  json.key("critical").begin_list();
  for (const CriticalValue& critical : sweep.critical) {
    json.begin_flat_object();
    write_at(json, sweep, critical.line, critical.at);
    json.member("mode", track_name(critical.track)).member("kind", kind_of(critical));
    json.member("oscillatory", critical.oscillatory);
    json.member("rad_s", critical.eigenvalue.imag()).member("frequency_hz", hertz(critical.eigenvalue));
    json.member("becomes", becomes(critical));
    json.member("others_unstable", critical.others_unstable).member("states", critical.states).end_object();
  }
  json.end_list();
}

void write_remarks(JsonWriter& json, const Sweep& sweep) {
  json.key("failures").begin_list();
  for (const SweepFailure& failure : sweep.failures) {
    json.begin_flat_object().key("at").values(failure.at).member("message", failure.message).end_object();
  }
  json.end_list().key("notes").values(sweep.notes).member("interrupted", sweep.interrupted);
}

long unstable(const Tracks::Point& point) {
  return std::count_if(point.value.begin(), point.value.end(), [](Complex value) { return value.real() > 0.0; });
}

/// Of the asked points of all lines.
template <class Visit>
void each_asked(const Sweep& sweep, Visit&& visit) {
  for (std::size_t line = 0; line < sweep.lines.size(); ++line) {
    for (const Tracks::Point& point : sweep.lines[line].points) {
      if (point.asked) visit(line, point);
    }
  }
}

std::string place_text(const Sweep& sweep, std::size_t line, double value, int digits) {
  std::string text = with_unit(short_number(value, digits), sweep.over[0].unit);
  if (sweep.over.size() > 1)
    text += ", " + with_unit(short_number(sweep.over[1].values[line], digits), sweep.over[1].unit);
  return text;
}

std::string names_of(const Sweep& sweep) {
  return sweep.over[0].name + (sweep.over.size() > 1 ? ", " + sweep.over[1].name : "");
}

Table critical_table(const Sweep& sweep) {
  const bool ascending = sweep.over[0].values.front() < sweep.over[0].values.back();
  Table table{{names_of(sweep), "mode", "kind", "frequency", ascending ? "above it" : "below it", "others unstable",
               "of which states"},
              {},
              "lllrlrl"};
  for (const CriticalValue& critical : sweep.critical) {
    table.rows.push_back({place_text(sweep, critical.line, critical.at, 15), track_name(critical.track),
                          critical.fold          ? "the equilibrium ends (fold)"
                          : critical.oscillatory ? "oscillatory (flutter)"
                                                 : "not oscillatory (divergence)",
                          critical.oscillatory ? short_number(hertz(critical.eigenvalue), 6) + " Hz" : "",
                          becomes(critical), std::to_string(critical.others_unstable), critical.states});
  }
  return table;
}

std::string range_text(const Sweep& sweep) {
  std::string text;
  for (const SweptParameter& over : sweep.over) {
    text += over.name + " from " + with_unit(short_number(over.values.front(), 10), over.unit) + " to " +
            with_unit(short_number(over.values.back(), 10), over.unit) + ", " + counted(over.values.size(), "value") +
            "\n";
  }
  if (sweep.added > 0) text += counted(sweep.added, "point") + " more between them, to tell modes apart\n";
  return text;
}

std::string remarks_text(const Sweep& sweep) {
  std::string text;
  for (const BranchPoint& branch : sweep.branches) {
    const std::string pair = track_name(branch.first) + " and " + track_name(branch.second);
    text += "At " + place_text(sweep, branch.line, branch.at, 12) +
            (branch.splits ? " the pair " + pair + " becomes real" : " the real modes " + pair + " become a pair") +
            ", both " + short_number(branch.eigenvalue, 6) + " 1/s.\n";
  }
  constexpr std::size_t most = 8;
  const auto place = [&](const SweepFailure& failure) {
    std::string at;
    for (std::size_t i = 0; i < failure.at.size(); ++i)
      at += (i > 0 ? ", " : "") + with_unit(short_number(failure.at[i], 10), sweep.over[i].unit);
    return at;
  };
  std::size_t k = 0;
  for (std::size_t shown = 0; k < sweep.failures.size() && shown < most; ++shown) {
    const SweepFailure& first = sweep.failures[k];
    std::size_t same = 1;
    while (k + same < sweep.failures.size() && sweep.failures[k + same].message == first.message) ++same;
    text += "No answer at " + place(first);
    if (same > 1) text += " ... " + place(sweep.failures[k + same - 1]) + " (" + counted(same, "point") + ")";
    text += ": " + first.message + "\n";
    k += same;
  }
  if (k < sweep.failures.size())
    text += "... " + counted(sweep.failures.size(), "point") + " without an answer in all.\n";
  for (const std::string& note : sweep.notes) text += note + "\n";
  if (sweep.interrupted)
    text += "Interrupted: what was found so far is shown; events between points were not looked for.\n";
  return text.empty() ? "" : "\n" + text;
}

/// The whole line with NAN for what is missing, so that plots have gaps there.
plot::Series series_of(const Sweep& sweep, std::size_t line, std::size_t track, double (*x)(double, Complex),
                       double (*y)(double, Complex)) {
  plot::Series series;
  const int group = sweep.lines.size() > 1
                        ? static_cast<int>(line * static_cast<std::size_t>(colours) / sweep.lines.size())
                        : static_cast<int>(track) % colours;
  series.colour = group;
  const auto put = [&](double at, Complex value) {
    series.x.push_back(x(at, value));
    series.y.push_back(y(at, value));
  };
  const Tracks::Point* last = nullptr;
  for (const Tracks::Point& point : sweep.lines[line].points) {
    const bool there = track < point.value.size() && point.mode[track] >= 0;
    for (const BranchPoint& branch : sweep.branches) {
      const bool is_own =
          branch.line == line && (branch.first == static_cast<int>(track) || branch.second == static_cast<int>(track));
      if (is_own && there && last != nullptr && (branch.at - last->at) * (branch.at - point.at) < 0.0)
        put(branch.at, branch.eigenvalue);
    }
    put(there ? point.at : NAN, there ? point.value[track] : Complex(NAN, NAN));
    last = there ? &point : nullptr;
  }
  return series;
}

/// Linear, unless decades lie between the values.
void scale(plot::Axis& axis, const std::vector<plot::Series>& all, std::vector<double> plot::Series::*values) {
  constexpr double wide = 2e3;  // between the largest value and the typical one of a track
  double largest = 0.0, smallest = HUGE_VAL;
  for (const plot::Series& series : all) {
    double peak = 0.0;
    for (const double value : series.*values) peak = std::isnan(value) ? peak : std::max(peak, std::abs(value));
    largest = std::max(largest, peak);
    if (peak > 0.0) smallest = std::min(smallest, peak);
  }
  if (!(largest > wide * smallest)) return;
  axis.scale = plot::Scale::symlog;
  axis.threshold = std::pow(10.0, std::floor(std::log10(std::max(smallest, 1e-8 * largest))) - 1.0);
}

plot::Figure figure_of(const Sweep& sweep, std::string title, double (*x)(double, Complex),
                       double (*y)(double, Complex)) {
  plot::Figure figure;
  figure.title = std::move(title);
  figure.width = 760;
  figure.height = 420;
  for (std::size_t line = 0; line < sweep.lines.size(); ++line) {
    const std::size_t tracks = sweep.lines[line].points.empty() ? 0 : sweep.lines[line].points.back().value.size();
    for (std::size_t track = 0; track < tracks; ++track) {
      figure.series.push_back(series_of(sweep, line, track, x, y));
      const std::size_t count = sweep.lines.size();
      const bool leads = track == 0 && (line == 0 || line * colours / count != (line - 1) * colours / count);
      if (count > 1 && leads)
        figure.series.back().name = sweep.over[1].name + " " + (count > colours ? "from " : "") +
                                    with_unit(short_number(sweep.over[1].values[line], 4), sweep.over[1].unit);
    }
  }
  return figure;
}

double real_part(double, Complex value) { return value.real(); }
double imaginary_part(double, Complex value) { return value.imag(); }
double parameter(double at, Complex) { return at; }
double frequency(double, Complex value) { return value.imag() >= 0.0 ? hertz(value) : NAN; }

plot::Figure root_locus(const Sweep& sweep) {
  plot::Figure figure = figure_of(sweep, "Root locus", real_part, imaginary_part);
  figure.x = {"real part", "1/s"};
  figure.y = {"imaginary part", "1/s"};
  scale(figure.x, figure.series, &plot::Series::x);
  scale(figure.y, figure.series, &plot::Series::y);
  plot::Series begin{"first value", {}, {}, plot::Style::circles, 4},
      end{"last value", {}, {}, plot::Style::crosses, 4};
  for (const Tracks& tracks : sweep.lines) {
    if (tracks.points.empty()) continue;
    for (auto [series, point] : {std::pair{&begin, &tracks.points.front()}, {&end, &tracks.points.back()}}) {
      for (std::size_t k = 0; k < point->value.size(); ++k) {
        if (point->mode[k] < 0) continue;
        series->x.push_back(point->value[k].real());
        series->y.push_back(point->value[k].imag());
      }
    }
  }
  figure.series.push_back(std::move(begin));
  figure.series.push_back(std::move(end));
  return figure;
}

plot::Figure against_parameter(const Sweep& sweep, const char* title, plot::Axis y, double (*value)(double, Complex)) {
  plot::Figure figure = figure_of(sweep, title, parameter, value);
  figure.x = {sweep.over[0].name, sweep.over[0].unit == "1" ? "" : sweep.over[0].unit};
  figure.y = std::move(y);
  scale(figure.y, figure.series, &plot::Series::y);
  for (const CriticalValue& critical : sweep.critical) figure.marks.push_back(critical.at);
  return figure;
}

}  // namespace

std::string sweep_document(const Sweep& sweep) {
  JsonWriter json;
  json.begin_object();
  write_over(json, sweep);
  json.key("modes").begin_list();
  for (std::size_t k = 0; k < sweep.states.size(); ++k) {
    json.begin_flat_object()
        .member("name", track_name(static_cast<int>(k)))
        .member("states_at_first", sweep.states[k])
        .end_object();
  }
  json.end_list().key("points").begin_list();
  each_asked(sweep, [&](std::size_t line, const Tracks::Point& point) {
    json.begin_object();
    write_at(json, sweep, line, point.at);
    json.member("failed", point.failed).member("zeros", point.zeros).member("unstable", unstable(point));
    std::vector<double> re, im;
    for (std::size_t k = 0; k < point.value.size(); ++k) {
      re.push_back(point.mode[k] < 0 ? NAN : point.value[k].real());
      im.push_back(point.mode[k] < 0 ? NAN : point.value[k].imag());
    }
    json.key("re").values(re).key("im").values(im).end_object();
  });
  json.end_list();
  write_critical(json, sweep);
  json.key("branch_points").begin_list();
  for (const BranchPoint& branch : sweep.branches) {
    json.begin_flat_object();
    write_at(json, sweep, branch.line, branch.at);
    json.member("first", track_name(branch.first)).member("second", track_name(branch.second));
    json.member("re", branch.eigenvalue).member("becomes", branch.splits ? "real" : "complex").end_object();
  }
  json.end_list().member("points_added", sweep.added);
  write_equilibrium(json, sweep.first ? &sweep.first->equilibrium : nullptr,
                    sweep.first ? &sweep.first->stability : nullptr);
  write_remarks(json, sweep);
  json.end_object();
  return json.take();
}

std::string critical_document(const Sweep& sweep) {
  JsonWriter json;
  json.begin_object();
  write_over(json, sweep);
  write_critical(json, sweep);
  write_equilibrium(json, sweep.first ? &sweep.first->equilibrium : nullptr,
                    sweep.first ? &sweep.first->stability : nullptr);
  write_remarks(json, sweep);
  json.end_object();
  return json.take();
}

std::string sweep_csv(const Sweep& sweep) {
  std::size_t tracks = 0;
  each_asked(sweep, [&](std::size_t, const Tracks::Point& point) { tracks = std::max(tracks, point.value.size()); });
  std::string text = csv_field(sweep.over[0].name);
  if (sweep.over.size() > 1) text += "," + csv_field(sweep.over[1].name);
  text += ",zeros";
  for (std::size_t k = 0; k < tracks; ++k) {
    const std::string name = track_name(static_cast<int>(k));
    text.append(",").append(name).append(".re,").append(name).append(".im");
  }
  text += '\n';
  each_asked(sweep, [&](std::size_t line, const Tracks::Point& point) {
    const std::vector<double> at = sweep.at(line, point.at);
    for (const double value : at) text += exact_number(value) + ",";
    if (!point.failed) text += std::to_string(point.zeros);
    for (std::size_t k = 0; k < tracks; ++k) {
      const bool there = k < point.value.size() && point.mode[k] >= 0;
      text += there ? "," + exact_number(point.value[k].real()) + "," + exact_number(point.value[k].imag()) : ",,";
    }
    text += '\n';
  });
  return text;
}

std::string sweep_text(const Sweep& sweep) {
  Table table{{names_of(sweep), "unstable", "zeros", "largest real part (1/s)", "frequency", "mode"}, {}, "lrrlrl"};
  std::size_t count = 0, k = 0;
  each_asked(sweep, [&](std::size_t, const Tracks::Point&) { ++count; });
  const std::size_t stride = (count + most_rows - 1) / most_rows;
  each_asked(sweep, [&](std::size_t line, const Tracks::Point& point) {
    const bool shown = k % std::max<std::size_t>(stride, 1) == 0 || k + 1 == count;
    ++k;
    if (!shown) return;
    const std::string place = place_text(sweep, line, point.at, 8);
    std::size_t worst = point.value.size();
    for (std::size_t i = 0; i < point.value.size(); ++i) {
      if (point.mode[i] >= 0 && (worst == point.value.size() || point.value[i].real() > point.value[worst].real()))
        worst = i;
    }
    if (point.failed) {
      table.rows.push_back({place, "", "", "no answer", "", ""});
    } else if (worst == point.value.size()) {
      table.rows.push_back({place, "0", std::to_string(point.zeros), "", "", ""});
    } else {
      const double hz = hertz(point.value[worst]);
      table.rows.push_back({place, std::to_string(unstable(point)), std::to_string(point.zeros),
                            short_number(point.value[worst].real(), 8), hz > 0.0 ? short_number(hz, 5) + " Hz" : "",
                            track_name(static_cast<int>(worst))});
    }
  });
  std::string text = range_text(sweep) + "\n" + as_text(table);
  if (stride > 1) text += "  every " + std::to_string(stride) + ". point; --out DIR and --json give all\n";
  Table modes{{"mode", "of which states at the first point"}, {}, "ll"};
  for (std::size_t i = 0; i < sweep.states.size(); ++i)
    modes.rows.push_back({track_name(static_cast<int>(i)), sweep.states[i]});
  if (!modes.rows.empty()) text += "\n" + as_text(modes);
  if (!sweep.critical.empty()) text += "\nCritical values\n" + as_text(critical_table(sweep));
  return text + remarks_text(sweep);
}

std::string critical_text(const Sweep& sweep) {
  std::string text = range_text(sweep) + "\n";
  text += sweep.critical.empty() ? "No real part passes zero, and the equilibrium does not end.\n"
                                 : as_text(critical_table(sweep));
  return text + remarks_text(sweep);
}

std::vector<std::pair<std::string, plot::Figure>> sweep_figures(const Sweep& sweep) {
  return {{"root_locus", root_locus(sweep)},
          {"real_parts", against_parameter(sweep, "Real parts", {"real part", "1/s"}, real_part)},
          {"frequencies", against_parameter(sweep, "Frequencies", {"frequency", "Hz"}, frequency)}};
}

}  // namespace bramah
