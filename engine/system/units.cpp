#include "system/units.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace bramah {

namespace {

constexpr std::size_t kBases = 6;
constexpr std::array<std::string_view, kBases> kBaseNames = {"m", "kg", "s", "A", "K", "rad"};
constexpr int kMostTwice = 80;  // larger exponents are slips of the finger
constexpr int kDeepestNesting = 16;

struct Symbol {
  std::string_view name;
  double numerator;
  double denominator;
  std::array<signed char, kBases> exponents;  // m, kg, s, A, K, rad
  bool prefixed = false;                      // takes SI prefixes
  double offset = 0.0;
};

constexpr double kPi = std::numbers::pi;

constexpr Symbol kSymbols[] = {
    {"m", 1, 1, {1, 0, 0, 0, 0, 0}, true},
    {"g", 1, 1000, {0, 1, 0, 0, 0, 0}, true},
    {"s", 1, 1, {0, 0, 1, 0, 0, 0}, true},
    {"A", 1, 1, {0, 0, 0, 1, 0, 0}, true},
    {"K", 1, 1, {0, 0, 0, 0, 1, 0}, true},
    {"rad", 1, 1, {0, 0, 0, 0, 0, 1}, true},
    {"N", 1, 1, {1, 1, -2, 0, 0, 0}, true},
    {"Pa", 1, 1, {-1, 1, -2, 0, 0, 0}, true},
    {"J", 1, 1, {2, 1, -2, 0, 0, 0}, true},
    {"W", 1, 1, {2, 1, -3, 0, 0, 0}, true},
    {"Hz", 1, 1, {0, 0, -1, 0, 0, 0}, true},
    {"V", 1, 1, {2, 1, -3, -1, 0, 0}, true},
    {"L", 1, 1000, {3, 0, 0, 0, 0, 0}, true},
    {"t", 1000, 1, {0, 1, 0, 0, 0, 0}},
    {"bar", 1e5, 1, {-1, 1, -2, 0, 0, 0}},
    {"mbar", 100, 1, {-1, 1, -2, 0, 0, 0}},
    {"psi", 44482216152605.0, 6451600000.0, {-1, 1, -2, 0, 0, 0}},  // 4.4482216152605 N on (0.0254 m)^2
    {"in", 127, 5000, {1, 0, 0, 0, 0, 0}},
    {"min", 60, 1, {0, 0, 1, 0, 0, 0}},
    {"h", 3600, 1, {0, 0, 1, 0, 0, 0}},
    {"deg", kPi, 180, {0, 0, 0, 0, 0, 1}},
    {"rev", 2 * kPi, 1, {0, 0, 0, 0, 0, 1}},
    {"rpm", 2 * kPi, 60, {0, 0, -1, 0, 0, 1}},
    {"degC", 1, 1, {0, 0, 0, 0, 1, 0}, false, 273.15},
    {"1", 1, 1, {}},
    {"%", 1, 100, {}},
    {"percent", 1, 100, {}},
};

struct Prefix {
  std::string_view name;
  double numerator;
  double denominator;
};

constexpr Prefix kPrefixes[] = {
    {"p", 1, 1e12}, {"n", 1, 1e9}, {"u", 1, 1e6}, {"\u00b5", 1, 1e6}, {"\u03bc", 1, 1e6}, {"m", 1, 1e3},
    {"c", 1, 1e2},  {"d", 1, 1e1}, {"k", 1e3, 1}, {"M", 1e6, 1},      {"G", 1e9, 1},      {"T", 1e12, 1},
};

const Symbol* find_symbol(std::string_view name) {
  for (const Symbol& symbol : kSymbols) {
    if (symbol.name == name) return &symbol;
  }
  return nullptr;
}

Unit unit_of(const Symbol& symbol) {
  Unit unit{symbol.numerator, symbol.denominator, symbol.offset, {}};
  for (std::size_t i = 0; i < kBases; ++i) unit.twice[i] = static_cast<signed char>(2 * symbol.exponents[i]);
  return unit;
}

// Whole names come first: "min" is no milli-inch.
std::optional<Unit> lookup(std::string_view name) {
  if (const Symbol* symbol = find_symbol(name)) return unit_of(*symbol);
  for (const Prefix& prefix : kPrefixes) {
    if (!name.starts_with(prefix.name)) continue;
    const Symbol* symbol = find_symbol(name.substr(prefix.name.size()));
    if (symbol == nullptr || !symbol->prefixed) continue;
    Unit unit = unit_of(*symbol);
    unit.numerator *= prefix.numerator;
    unit.denominator *= prefix.denominator;
    return unit;
  }
  return std::nullopt;
}

// a . b^sign. A unit with an offset is a point on a scale: products with it mean nothing.
std::optional<Unit> multiplied(const Unit& a, const Unit& b, int sign) {
  if (a.offset != 0.0 || b.offset != 0.0) return std::nullopt;
  Unit unit = a;
  unit.numerator *= sign > 0 ? b.numerator : b.denominator;
  unit.denominator *= sign > 0 ? b.denominator : b.numerator;
  for (std::size_t i = 0; i < kBases; ++i) {
    const int twice = a.twice[i] + sign * b.twice[i];
    if (std::abs(twice) > kMostTwice) return std::nullopt;
    unit.twice[i] = static_cast<signed char>(twice);
  }
  return unit;
}

// Whole powers of ten stay exact, and so do their roots.
double power(double base, int twice) {
  double product = 1.0;
  for (int i = 0; i < twice / 2; ++i) product *= base;
  return twice % 2 == 0 ? product : product * std::sqrt(base);
}

std::optional<Unit> raised(const Unit& base, int twice) {
  if (base.offset != 0.0) return std::nullopt;
  Unit unit;
  unit.numerator = power(twice < 0 ? base.denominator : base.numerator, std::abs(twice));
  unit.denominator = power(twice < 0 ? base.numerator : base.denominator, std::abs(twice));
  for (std::size_t i = 0; i < kBases; ++i) {
    const int scaled = base.twice[i] * twice;  // four times the exponent
    if (scaled % 2 != 0 || std::abs(scaled / 2) > kMostTwice) return std::nullopt;
    unit.twice[i] = static_cast<signed char>(scaled / 2);
  }
  return unit;
}

// One exact division less in `to_si` wherever the fraction is a whole number or the reciprocal of one.
void reduce(Unit& unit) {
  if (std::fmod(unit.numerator, unit.denominator) == 0.0) {
    unit.numerator /= unit.denominator;
    unit.denominator = 1.0;
  } else if (std::fmod(unit.denominator, unit.numerator) == 0.0) {
    unit.denominator /= unit.numerator;
    unit.numerator = 1.0;
  }
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// product = factor { ( "." | "*" | "/" ) factor };  factor = ( symbol | "(" product ")" ) [ "^" exponent ]
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : rest_(text) {}

  std::optional<Unit> parse() {
    std::optional<Unit> unit = product(0);
    return rest_.empty() ? unit : std::nullopt;
  }

 private:
  std::optional<Unit> product(int depth) {
    std::optional<Unit> unit = factor(depth);
    while (unit && !rest_.empty() && (rest_[0] == '.' || rest_[0] == '*' || rest_[0] == '/')) {
      const int sign = rest_[0] == '/' ? -1 : 1;
      rest_.remove_prefix(1);
      const std::optional<Unit> next = factor(depth);
      unit = next ? multiplied(*unit, *next, sign) : std::nullopt;
    }
    return unit;
  }

  std::optional<Unit> factor(int depth) {
    std::optional<Unit> unit;
    if (take('(')) {
      if (depth == kDeepestNesting) return std::nullopt;
      unit = product(depth + 1);
      if (!take(')')) return std::nullopt;
    } else {
      const std::size_t length = std::min(rest_.find_first_of(".*/^()"), rest_.size());
      unit = lookup(rest_.substr(0, length));
      rest_.remove_prefix(length);
    }
    if (!unit || !take('^')) return unit;
    const std::optional<int> twice = exponent();
    return twice ? raised(*unit, *twice) : std::nullopt;
  }

  // Twice the exponent written next: 2, -1, 0.5, (1/2).
  std::optional<int> exponent() {
    const bool enclosed = take('(');
    std::optional<double> value = number();
    if (value && enclosed && take('/')) {
      const std::optional<double> divisor = number();
      if (!divisor || *divisor == 0.0) return std::nullopt;
      value = *value / *divisor;
    }
    if (!value || (enclosed && !take(')'))) return std::nullopt;
    const double twice = 2 * *value;
    if (std::abs(twice) > kMostTwice || twice != std::trunc(twice)) return std::nullopt;
    return static_cast<int>(twice);
  }

  // A point is a decimal point only before a digit: "m^2.s" is a product.
  std::optional<double> number() {
    std::size_t length = !rest_.empty() && rest_[0] == '-' ? 1 : 0;
    const auto digits = [&] {
      while (length < rest_.size() && is_digit(rest_[length])) ++length;
    };
    digits();
    if (length + 1 < rest_.size() && rest_[length] == '.' && is_digit(rest_[length + 1])) {
      ++length;
      digits();
    }
    double value = 0.0;
    const char* end = rest_.data() + length;
    const auto [read, fault] = std::from_chars(rest_.data(), end, value, std::chars_format::fixed);
    if (fault != std::errc{} || read != end) return std::nullopt;
    rest_.remove_prefix(length);
    return value;
  }

  bool take(char c) {
    if (rest_.empty() || rest_[0] != c) return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::string_view rest_;
};

bool usable(double factor) { return std::isfinite(factor) && factor > 0.0; }

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

// What engineers write, by dimension; each line's first unit is the one of SI.
constexpr std::string_view kFamiliar[] = {
    "1, %",
    "m, mm, cm, km",
    "m^2, cm^2, mm^2",
    "m^3, L, cm^3, mm^3",
    "kg, g, t",
    "kg/m^3, g/cm^3",
    "kg.m^2, kg.mm^2",
    "s, ms, min, h",
    "Hz, kHz, 1/s",
    "rad, deg, rev",
    "rad/s, deg/s, rpm",
    "rad/s^2, deg/s^2",
    "m/s, mm/s, km/h",
    "m/s^2, mm/s^2",
    "N, kN",
    "N.m, kN.m, J, kJ",
    "N/m, N/mm, kN/m",
    "N.s/m, N.s/mm",
    "N.m/rad, N.m/deg",
    "N.m.s/rad, N.m.s/deg",
    "W, kW",
    "Pa, bar, kPa, MPa, GPa, psi",
    "1/Pa, 1/bar",
    "Pa.s, mPa.s",
    "m^3/s, L/min, L/s",
    "m^3/rad, cm^3/rev",
    "m^3/(s.Pa), L/(min.bar)",
    "m^3/(s.Pa^0.5), L/(min.bar^0.5)",
    "A, mA",
    "V, mV",
    "K, degC",
};

std::string in_base_units(const Unit& unit) {
  std::string text;
  for (std::size_t i = 0; i < kBases; ++i) {
    const int twice = unit.twice[i];
    if (twice == 0) continue;
    if (!text.empty()) text += '.';
    text += kBaseNames[i];
    if (twice == 2) continue;
    text += '^';
    if (twice < 0) text += '-';
    text += std::to_string(std::abs(twice) / 2);
    if (twice % 2 != 0) text += ".5";
  }
  return text;
}

}  // namespace

std::optional<Unit> parse_unit(std::string_view text) {
  if (text.empty()) return Unit{};
  std::optional<Unit> unit = UnitParser(text).parse();
  if (!unit || !usable(unit->numerator) || !usable(unit->denominator)) return std::nullopt;
  reduce(*unit);
  return unit;
}

std::optional<Quantity> parse_quantity(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  // from_chars also knows "inf" and "nan", which are no quantities.
  const std::size_t first = text.starts_with('-') ? 1 : 0;
  if (first >= text.size() || !(is_digit(text[first]) || text[first] == '.')) return std::nullopt;
  Quantity quantity;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), quantity.value);
  if (fault != std::errc{} || !std::isfinite(quantity.value)) return std::nullopt;
  quantity.unit = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  return quantity;
}

std::string alternatives(const Unit& unit) {
  for (const std::string_view line : kFamiliar) {
    if (parse_unit(line.substr(0, line.find(',')))->same_dimension(unit)) return std::string(line);
  }
  return in_base_units(unit);
}

}  // namespace bramah
