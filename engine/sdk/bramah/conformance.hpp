// Whether a component keeps its promises, seen through the C border as the engine sees it. One line per component:
//
//   const std::map<std::string, Setting> small = {{"C_d", 0.8}, {"A_t", 2.83e-5}, {"rho_oil", 850.0}};
//   EXPECT_TRUE(conforms<Throttle>({{.parameters = small, .z = {3e6, 2e6}}, {.parameters = small, .z = {1e5, 2e5}}}));
//
// Give one sample per regime of the law. What is checked at each:
//   describe     names, units, docs, limits, defaults, nominals; check() has no objection
//   partials     every block against differences of the rows; outside the traced pattern exactly no dependence
//   series       cdot and rdot against differences along the path x + v t + a t^2/2; s_a = r_v; S_V = 2 R_X (holonomic)
//   multipliers  L_X against differences of D^T lambda
//   tangents     of rows and partials along the state, and by every parameter that is a Parameter, against differences;
//                the same of start values, constants and signals
//   structure    f_a symmetric; b affine in v
//   energy       its rate against differences; E_v = f_a v and E_z = g_zdot z, so that what is stored is all that is stored;
//                whoever has inertia says its energy
//   evaluate     writes all it is asked for and no more; bit for bit repeatable, alone or in a batch; the same to 1e-12
//                whatever else is asked for; allocates nothing (where the program defines bramah_allocation_count)
//   signals      breakpoints advance; between them both one-sided limits agree
// Differences live here and nowhere else.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <ostream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "bramah/export.hpp"

/// How often the program has called operator new so far. A test program that replaces operator new defines it.
extern "C" __attribute__((weak)) std::size_t bramah_allocation_count();

namespace bramah {

/// The value of one parameter: a number, numbers, or a text (also the word of a choice).
struct Setting {
  std::vector<double> numbers;
  std::string text;
  Setting(double number) : numbers{number} {}
  Setting(std::initializer_list<double> list) : numbers(list) {}
  Setting(std::vector<double> list) : numbers(std::move(list)) {}
  Setting(const char* word) : text(word) {}
};

/// Where to look. Families left empty get numbers without pattern, of the given magnitudes, the same in every run.
struct Sample {
  struct Magnitude {
    double x = 1.0, v = 1.0, a = 1.0;
    double z = 0.0, zdot = 0.0;  // 0: by kind, 1e6 Pa and 1e8 Pa/s for pressures, else 1
    double u = 1.0, lambda = 1.0;
  };
  std::map<std::string, Setting> parameters = {};
  std::vector<double> x = {}, v = {}, a = {}, z = {}, zdot = {}, u = {}, lambda = {};
  double time = 0.7;  // s
  int side = 1;       // which one-sided derivative at a kink
  Magnitude magnitude = {};
};

/// The verdict: true, or false with every fault that was found.
struct Conformance {
  bool ok = true;
  std::string message;
  explicit operator bool() const { return ok; }
  /// Into what test frameworks call an assertion result, so that a failed EXPECT_TRUE shows the message.
  template <class Result>
  requires requires(Result r) {
    r.failure_message();
    r << std::string();
  }
  operator Result() const { return Result(ok) << message; }
  friend std::ostream& operator<<(std::ostream& out, const Conformance& c) {
    return out << (c.ok ? std::string("conforms") : c.message);
  }
};

namespace detail {

/// Row groups as the border returns them, and D^T lambda, which the engine forms.
enum Group : std::size_t { F, G, HOLONOMIC, RATE, SECOND_RATE, Y, PULL, groups };

struct BlockInfo {
  const char* name;
  Group rows;
  Family columns;
};
inline constexpr BlockInfo block_info[BRAMAH_BLOCKS] = {
    {"F_X", F, X},         {"F_V", F, V},          {"F_A", F, A},    {"F_Z", F, Z},           {"F_U", F, U},
    {"G_X", G, X},         {"G_V", G, V},          {"G_Z", G, Z},    {"G_ZDOT", G, ZDOT},     {"G_U", G, U},
    {"C_X", HOLONOMIC, X}, {"R_X", RATE, X},       {"R_V", RATE, V}, {"S_X", SECOND_RATE, X}, {"S_V", SECOND_RATE, V},
    {"L_X", PULL, X},      {"Y_X", Y, X},          {"Y_V", Y, V},    {"Y_A", Y, A},           {"Y_Z", Y, Z},
    {"Y_U", Y, U},         {"Y_LAMBDA", Y, LAMBDA}};

/// Which block holds the partials of a row group by a family; -1 where there is none. s_a is r_v.
inline int block_of(Group rows, Family columns) {
  if (rows == SECOND_RATE && columns == A) return BRAMAH_R_V;
  for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
    if (block_info[b].rows == rows && block_info[b].columns == columns) return b;
  }
  return -1;
}

struct LocalState {
  std::vector<double> values[families];
  double time = 0.0;
};

struct Evaluation {
  int status = 0;
  std::string message;
  std::vector<double> rows[groups];
  std::vector<double> partials[BRAMAH_BLOCKS];  // compressed, instance after instance
  std::vector<int> branch;                      // signs of the switching functions
  std::vector<double> limits;                   // quantities of `validity`
  std::size_t allocations = 0;
  bool overrun = false;
};

class Examination {
 public:
  explicit Examination(const bramah_type& type) : type_(type) {}
  ~Examination() { forget(); }
  Examination(const Examination&) = delete;
  Examination& operator=(const Examination&) = delete;

  Conformance run(const std::vector<Sample>& samples) {
    where_ = std::string(type_.name) + ": ";
    examine_description();
    for (std::size_t k = 0; k < samples.size() && faults_.empty(); ++k) {
      where_ = std::string(type_.name) + ", sample " + std::to_string(k + 1) + ": ";
      sample_ = &samples[k];
      examine(k);
    }
    std::string all;
    const std::size_t shown = std::min<std::size_t>(faults_.size(), 12);
    for (std::size_t k = 0; k < shown; ++k) all += (k == 0 ? "" : "\n") + faults_[k];
    if (faults_.size() > shown) all += "\n... and " + std::to_string(faults_.size() - shown) + " more";
    return {faults_.empty(), all};
  }

 private:
  // ---- faults -------------------------------------------------------------------------------------------------------
  template <class... Parts>
  void fault(const Parts&... parts) {
    std::ostringstream text;
    text.precision(12);
    text << where_;
    (text << ... << parts);
    faults_.push_back(text.str());
  }
  [[nodiscard]] std::string column_name(Family family, std::size_t j) const {
    static constexpr const char* prefix[families] = {"", "v of ", "a of ", "", "rate of ", "", "multiplier of "};
    if (family == LAMBDA) return prefix[LAMBDA] + row_name(RATE, j);
    const int of = family == Z || family == ZDOT ? BRAMAH_Z : family == U ? BRAMAH_U : BRAMAH_X;
    return prefix[family] + local_name(of, j);
  }
  [[nodiscard]] std::string local_name(int family, std::size_t slot) const {
    std::size_t at = 0;
    for (std::int32_t p = 0; p < type_.port_count; ++p) {
      const bramah_port_info& port = type_.ports[p];
      if (port.family != family) continue;
      const auto slots = static_cast<std::size_t>(port.slots);
      if (slot < at + slots) return slots == 1 ? port.name : port.name + ("[" + std::to_string(slot - at) + "]");
      at += slots;
    }
    for (std::int32_t k = 0; k < type_.variable_count; ++k) {
      if (type_.variables[k].family == family && at++ == slot) return type_.variables[k].name;
    }
    return "variable " + std::to_string(slot);
  }
  [[nodiscard]] std::string row_name(Group group, std::size_t i) const {
    const auto mh = static_cast<std::size_t>(type_.holonomic_count);
    switch (group) {
      case F: return "force on " + local_name(BRAMAH_X, i);
      case G: return "balance of " + local_name(BRAMAH_Z, i);
      case HOLONOMIC: return std::string("row ") + type_.holonomic[i].name;
      case RATE: return std::string("rate of ") + (i < mh ? type_.holonomic[i].name : type_.nonholonomic[i - mh].name);
      case SECOND_RATE: return "second " + row_name(RATE, i);
      case Y: return std::string("output ") + type_.outputs[i].name;
      default: return "D^T lambda on " + local_name(BRAMAH_X, i);
    }
  }

  // ---- the description ---------------------------------------------------------------------------------------------
  void need_text(const char* text, const std::string& what) {
    if (text == nullptr || *text == '\0') fault(what, " is missing");
  }
  void need_name(const char* name, const std::string& what) {
    const std::string text = name == nullptr ? "" : name;
    const bool fine = !text.empty() && std::all_of(text.begin(), text.end(),
                                                   [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (!fine) fault(what, " '", text, "': a name has letters, digits and _ only");
  }
  void need_new(std::set<std::string>& names, const char* name, const std::string& what) {
    if (!names.insert(name).second) fault(what, " '", name, "' has the name of another");
  }
  template <class Info>
  void examine_rows(const Info* rows, std::int32_t count, const std::string& what) {
    std::set<std::string> names;
    for (std::int32_t k = 0; k < count; ++k) {
      need_name(rows[k].name, what);
      need_new(names, rows[k].name, what);
      need_text(rows[k].unit, "unit of " + what + " " + rows[k].name);
      need_text(rows[k].doc, "doc of " + what + " " + rows[k].name);
    }
  }
  void examine_description() {
    const std::string name = type_.name;
    if (name.find('/') == std::string::npos) fault("the type's name has the form domain/name");
    need_text(type_.doc, "doc of the type");
    std::set<std::string> keys = {"type"};  // ports and parameters are siblings in a scene
    for (std::int32_t k = 0; k < type_.parameter_count; ++k) examine_parameter(type_.parameters[k], keys);
    for (std::int32_t k = 0; k < type_.port_count; ++k) {
      const bramah_port_info& p = type_.ports[k];
      need_name(p.name, "port");
      need_new(keys, p.name, "port");
      need_text(p.doc, std::string("doc of port ") + p.name);
      // Coordinates and signals may be of any unit; frames and fields have one unit per number.
      if (p.family == BRAMAH_Z) need_text(p.unit, std::string("unit of port ") + p.name);
      if (p.required == 0 && p.rest == nullptr) fault("port ", p.name, " is optional and has no numbers for rest");
    }
    std::set<std::string> own;
    for (std::int32_t k = 0; k < type_.variable_count; ++k) {
      const bramah_variable_info& v = type_.variables[k];
      need_name(v.name, "variable");
      need_new(own, v.name, "variable");
      need_text(v.doc, std::string("doc of variable ") + v.name);
      need_text(v.unit, std::string("unit of variable ") + v.name);
      if (!(v.nominal > 0.0) || !std::isfinite(v.nominal)) fault("variable ", v.name, " needs a positive nominal");
      if (!std::isfinite(v.start)) fault("variable ", v.name, " needs a start value");
    }
    std::set<std::string> terminals;
    for (std::int32_t k = 0; k < type_.terminal_count; ++k) {
      need_name(type_.terminals[k].name, "terminal");
      need_new(terminals, type_.terminals[k].name, "terminal");
      need_text(type_.terminals[k].doc, std::string("doc of terminal ") + type_.terminals[k].name);
    }
    examine_rows(type_.holonomic, type_.holonomic_count, "holonomic row");
    examine_rows(type_.nonholonomic, type_.nonholonomic_count, "nonholonomic row");
    examine_rows(type_.outputs, type_.output_count, "output");
    if (const auto* s = extension<bramah_switches>(BRAMAH_EXTENSION_SWITCHES)) {
      examine_rows(s->info, s->count, "switching function");
      for (std::int32_t k = 0; k < s->count; ++k) {
        if (!(s->nominal[k] > 0.0)) fault("switching function ", s->info[k].name, " needs a positive nominal");
      }
    }
    if (const auto* v = extension<bramah_validity>(BRAMAH_EXTENSION_VALIDITY)) {
      examine_rows(v->info, v->count, "limit");
      for (std::int32_t k = 0; k < v->count; ++k) {
        const bramah_limit_info& limit = v->info[k];
        if (!(limit.nominal > 0.0)) fault("limit ", limit.name, " needs a positive nominal");
        if (!(limit.lower < limit.upper) || (std::isinf(limit.lower) && std::isinf(limit.upper)))
          fault("limit ", limit.name, " needs at_least or at_most, the one below the other");
        if (!(limit.lowest <= limit.lower) || !(limit.highest >= limit.upper))
          fault("limit ", limit.name, " ends before its law does");
      }
    }
    const std::size_t columns = 3 * size(X) + 2 * size(Z) + size(U) + size(LAMBDA);
    if (columns > most_columns) fault(columns, " local values; the SDK holds ", most_columns);
  }
  void examine_parameter(const bramah_parameter_info& p, std::set<std::string>& keys) {
    need_name(p.name, "parameter");
    need_new(keys, p.name, "parameter");
    need_text(p.doc, std::string("doc of parameter ") + p.name);
    if (p.kind == BRAMAH_TEXT) {
      if (p.required == 0 && p.default_text == nullptr) fault("parameter ", p.name, " needs a text by default");
      return;
    }
    if (p.kind != BRAMAH_CHOICE) need_text(p.unit, std::string("unit of parameter ") + p.name);
    if (!(p.lower <= p.upper)) fault("parameter ", p.name, " has no number within its limits");
    if (p.required != 0) return;
    if (p.default_numbers == nullptr) return fault("parameter ", p.name, " needs numbers by default");
    if (p.kind != BRAMAH_LIST && p.default_count != p.count) {
      fault("parameter ", p.name, " has ", p.default_count, " numbers by default instead of ", p.count);
    }
    for (std::int64_t k = 0; k < p.default_count; ++k) {
      if (!within(p, p.default_numbers[k])) fault("parameter ", p.name, " is outside its limits by default");
    }
  }
  static bool within(const bramah_parameter_info& p, double number) {
    double low = p.lower, high = p.upper;
    if (p.kind == BRAMAH_CHOICE) {
      low = 0.0;
      high = -1.0;
      while (p.choices != nullptr && p.choices[static_cast<int>(high) + 1] != nullptr) high += 1.0;
    }
    return (number > low || (number == low && p.lower_open == 0)) &&
           (number < high || (number == high && p.upper_open == 0));
  }
  template <class Table>
  const Table* extension(const char* id) const {
    return type_.extension == nullptr ? nullptr : static_cast<const Table*>(type_.extension(type_.self, id));
  }

  // ---- one sample --------------------------------------------------------------------------------------------------
  void examine(std::size_t number) {
    if (!make_instances() || !make_patterns()) return;
    make_state(number);
    examine_fixed_values();
    const Evaluation base = evaluate({state_}, all_blocks());
    examine_evaluation(base);
    if (!faults_.empty()) return;  // differences of broken numbers only hide the cause
    expand(base);
    examine_partials(base);
    examine_paths(base);
    examine_identities(base);
    examine_energy(base);
    examine_repeatability(base);
    examine_tangents(base);
  }

  bool make_instances() {
    forget();
    const std::size_t before = faults_.size();
    const auto count = static_cast<std::size_t>(type_.parameter_count);
    std::vector<Setting>& settings = settings_;
    std::map<std::string, Setting> given = sample_->parameters;
    settings.clear();
    settings.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      const bramah_parameter_info& p = type_.parameters[k];
      const auto found = given.find(p.name);
      if (found != given.end()) {
        settings.push_back(found->second);
        given.erase(found);
        settle(p, settings.back());
      } else if (p.required != 0) {
        fault("the sample needs the parameter ", p.name);
      } else if (p.kind == BRAMAH_TEXT) {
        settings.emplace_back(p.default_text);
      } else {
        settings.emplace_back(std::vector<double>(p.default_numbers, p.default_numbers + p.default_count));
      }
    }
    for (const auto& [name, setting] : given) fault("the sample gives '", name, "', which is no parameter");
    if (faults_.size() > before) return false;

    const std::vector<bramah_value> values = as_values(settings);
    constexpr std::size_t behind = 64;
    constexpr auto mark = static_cast<std::byte>(0xa5);
    memory_ = static_cast<std::byte*>(
        ::operator new(copies* type_.instance_bytes + behind, std::align_val_t(type_.instance_align)));
    for (; made_ < copies; ++made_) {
      std::byte* const end = memory_ + (made_ + 1) * type_.instance_bytes;
      std::fill_n(end, behind, mark);
      if (type_.configure(type_.self, memory_ + made_ * type_.instance_bytes, values.data()) != 0) {
        fault("configure failed");
        return false;
      }
      if (std::any_of(end, end + behind, [](std::byte byte) { return byte != mark; })) {
        fault("configure writes behind the ", type_.instance_bytes,
              " bytes of its instance: instance_bytes is too small");
        return false;
      }
    }
    if (type_.check != nullptr) {
      const auto report = [](void* context, const char* parameter, const char* found, const char* expected) {
        auto* self = static_cast<Examination*>(context);
        self->fault("check of ", parameter == nullptr ? "the component" : parameter, ": ", found, "; expected ",
                    expected);
      };
      type_.check(type_.self, memory_, report, this);
    }
    return faults_.size() == before;
  }
  static std::vector<bramah_value> as_values(const std::vector<Setting>& settings) {
    std::vector<bramah_value> values;
    values.reserve(settings.size());
    for (const Setting& s : settings) {
      values.push_back(
          {sizeof(bramah_value), s.numbers.data(), static_cast<std::int64_t>(s.numbers.size()), s.text.c_str()});
    }
    return values;
  }
  void settle(const bramah_parameter_info& p, Setting& s) {
    if (p.kind == BRAMAH_CHOICE && !s.text.empty()) {
      for (int k = 0; p.choices[k] != nullptr; ++k) {
        if (s.text == p.choices[k]) s.numbers = {static_cast<double>(k)};
      }
    }
    if (p.kind == BRAMAH_TEXT) return;
    if (p.kind != BRAMAH_LIST && s.numbers.size() != static_cast<std::size_t>(p.count)) {
      fault("the sample gives ", s.numbers.size(), " numbers for ", p.name, " instead of ", p.count);
    }
    for (const double number : s.numbers) {
      if (!within(p, number)) fault("the sample gives ", number, " for ", p.name, ", outside its limits");
    }
  }
  void forget() {
    while (made_ > 0) {
      if (type_.destroy != nullptr) type_.destroy(type_.self, memory_ + --made_ * type_.instance_bytes);
    }
    if (memory_ != nullptr) ::operator delete(memory_, std::align_val_t(type_.instance_align));
    memory_ = nullptr;
  }

  [[nodiscard]] std::size_t size(std::size_t family) const { return family_size(type_, family); }
  [[nodiscard]] std::size_t row_count(std::size_t group) const {
    switch (group) {
      case F:
      case PULL: return size(X);
      case G: return size(Z);
      case HOLONOMIC: return static_cast<std::size_t>(type_.holonomic_count);
      case Y: return static_cast<std::size_t>(type_.output_count);
      default: return size(LAMBDA);
    }
  }
  bool make_patterns() {
    std::uint8_t* mark[BRAMAH_BLOCKS];
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      const std::size_t rows = row_count(block_info[b].rows), columns = size(block_info[b].columns);
      marks_[b].assign(rows * columns + 1, 0);
      mark[b] = marks_[b].data();
    }
    if (type_.structure(type_.self, memory_, mark) != 0) {
      const auto* why = extension<bramah_fault>(BRAMAH_EXTENSION_FAULT);
      fault("structure refused: ", why == nullptr ? "a row depends on what no block holds" : why->take(type_.self));
      return false;
    }
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      const std::size_t rows = row_count(block_info[b].rows), columns = size(block_info[b].columns);
      starts_[b].assign(1, 0);
      entries_[b].clear();
      for (std::size_t j = 0; j < columns; ++j) {
        for (std::size_t i = 0; i < rows; ++i) {
          if (marks_[b][i * columns + j] != 0) entries_[b].push_back(static_cast<std::int32_t>(i));
        }
        starts_[b].push_back(static_cast<std::int32_t>(entries_[b].size()));
      }
      patterns_[b] = {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns),
                      static_cast<std::int64_t>(entries_[b].size()), starts_[b].data(), entries_[b].data()};
    }
    return true;
  }

  /// A number in +-[0.3, 1], the same for the same place in every run (splitmix64).
  static double scatter(std::size_t a, std::size_t b, std::size_t c) {
    std::uint64_t n = 0x9e3779b97f4a7c15ULL * (1 + a + 64 * b + 4096 * c);
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9ULL;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebULL;
    n ^= n >> 31;
    const double share = static_cast<double>(n >> 11) * 0x1p-53;
    return (n & 1U) != 0 ? 0.3 + 0.7 * share : -0.3 - 0.7 * share;
  }
  void make_state(std::size_t number) {
    const Sample& s = *sample_;
    const std::vector<double>* given[families] = {&s.x, &s.v, &s.a, &s.z, &s.zdot, &s.u, &s.lambda};
    const double magnitude[families] = {s.magnitude.x,    s.magnitude.v, s.magnitude.a,     s.magnitude.z,
                                        s.magnitude.zdot, s.magnitude.u, s.magnitude.lambda};
    state_.time = s.time;
    for (std::size_t f = 0; f < families; ++f) {
      state_.values[f].assign(size(f), 0.0);
      scale_[f].assign(size(f), 1.0);
      if (!given[f]->empty() && given[f]->size() != size(f)) {
        fault("the sample gives ", given[f]->size(), " numbers for family ", f, " instead of ", size(f));
      }
      for (std::size_t j = 0; j < size(f); ++j) {
        double typical = magnitude[f];
        const bool pressure = (f == Z || f == ZDOT) && is_pressure(j);
        if (typical == 0.0) typical = !pressure ? 1.0 : f == Z ? 1e6 : 1e8;
        const bool known = given[f]->size() == size(f);
        double value = known ? (*given[f])[j] : typical * scatter(number, f, j);
        if (!known && pressure && f == Z) value = std::fabs(value);
        state_.values[f][j] = value;
        scale_[f][j] = std::max(std::fabs(value), typical);
      }
    }
  }
  [[nodiscard]] bool is_pressure(std::size_t slot) const {
    std::size_t at = 0;
    for (std::int32_t p = 0; p < type_.port_count; ++p) {
      if (type_.ports[p].family == BRAMAH_Z && at++ == slot) return std::strcmp(type_.ports[p].kind, "pressure") == 0;
    }
    for (std::int32_t k = 0; k < type_.variable_count; ++k) {
      if (type_.variables[k].family == BRAMAH_Z && at++ == slot) return std::strcmp(type_.variables[k].unit, "Pa") == 0;
    }
    return false;
  }

  // ---- evaluation --------------------------------------------------------------------------------------------------
  using Wanted = std::array<bool, BRAMAH_BLOCKS>;
  static Wanted all_blocks() {
    Wanted all;
    all.fill(true);
    return all;
  }
  static Wanted only(int block) {
    Wanted one{};
    one[static_cast<std::size_t>(block)] = true;
    return one;
  }

  [[nodiscard]] Evaluation evaluate(const std::vector<LocalState>& states, const Wanted& wanted,
                                    bool values = true) const {
    return evaluate_instances(memory_, states, wanted, values, nullptr);
  }
  /// Where `along` is given: the derivatives along it.
  [[nodiscard]] Evaluation evaluate_instances(const void* instances, const std::vector<LocalState>& states,
                                              const Wanted& wanted, bool values, const bramah_direction* along) const {
    constexpr double guard = 0x1.23456789abcdep+77;  // behind every buffer, so that writing too much shows
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    const std::size_t count = states.size();
    std::vector<double> in[families];
    for (std::size_t f = 0; f < families; ++f) {
      for (const LocalState& s : states) in[f].insert(in[f].end(), s.values[f].begin(), s.values[f].end());
      in[f].push_back(guard);
    }
    Evaluation e;
    const auto buffer = [&](std::vector<double>& to, std::size_t numbers) {
      to.assign(numbers, nothing);
      to.push_back(guard);
      return to.data();
    };
    bramah_batch b{};
    b.size = sizeof b;
    b.count = static_cast<std::int64_t>(count);
    b.instances = instances;
    b.time = states[0].time;
    b.side = sample_->side;
    b.x = in[X].data(), b.v = in[V].data(), b.a = in[A].data(), b.z = in[Z].data();
    b.zdot = in[ZDOT].data(), b.u = in[U].data(), b.lambda = in[LAMBDA].data();
    b.patterns = patterns_;
    if (values) {
      b.f = buffer(e.rows[F], count * row_count(F));
      b.g = buffer(e.rows[G], count * row_count(G));
      b.c = buffer(e.rows[HOLONOMIC], count * row_count(HOLONOMIC));
      b.r = buffer(e.rows[RATE], count * row_count(RATE));
      b.s = buffer(e.rows[SECOND_RATE], count * row_count(SECOND_RATE));
      b.y = buffer(e.rows[Y], count * row_count(Y));
    }
    for (std::size_t k = 0; k < BRAMAH_BLOCKS; ++k) {
      if (wanted[k]) b.partials[k] = buffer(e.partials[k], count * static_cast<std::size_t>(patterns_[k].count));
    }
    const std::size_t before = allocations();
    e.status = along == nullptr ? type_.evaluate(type_.self, &b)
                                : extension<bramah_tangent>(BRAMAH_EXTENSION_TANGENT)->evaluate(type_.self, &b, along);
    e.allocations = allocations() - before;
    e.message = b.message;

    const auto close = [&](std::vector<double>& from) {
      if (from.empty()) return;
      e.overrun = e.overrun || from.back() != guard;
      from.pop_back();
    };
    for (auto& rows : e.rows) close(rows);
    for (auto& partials : e.partials) close(partials);
    if (const auto* switches = extension<bramah_switches>(BRAMAH_EXTENSION_SWITCHES)) {
      std::vector<double> s(count * static_cast<std::size_t>(switches->count), nothing);
      switches->values(type_.self, &b, s.data());
      for (const double value : s)
        e.branch.push_back(std::isnan(value) ? 99 : value == 0.0 ? b.side : value > 0.0 ? 1 : -1);
    }
    if (const auto* validity = extension<bramah_validity>(BRAMAH_EXTENSION_VALIDITY)) {
      e.limits.assign(count * static_cast<std::size_t>(validity->count), nothing);
      validity->values(type_.self, &b, e.limits.data());
    }
    if (count == 1 && wanted[BRAMAH_R_V]) {
      e.rows[PULL].assign(size(X), 0.0);
      for (std::size_t j = 0; j < size(X); ++j) {
        for (auto n = static_cast<std::size_t>(starts_[BRAMAH_R_V][j]);
             n < static_cast<std::size_t>(starts_[BRAMAH_R_V][j + 1]); ++n) {
          const auto row = static_cast<std::size_t>(entries_[BRAMAH_R_V][n]);
          e.rows[PULL][j] += e.partials[BRAMAH_R_V][n] * states[0].values[LAMBDA][row];
        }
      }
    }
    return e;
  }
  static std::size_t allocations() { return bramah_allocation_count == nullptr ? 0 : bramah_allocation_count(); }

  void examine_evaluation(const Evaluation& e) {
    if (e.status != 0) return fault("evaluate returned ", e.status, ": ", e.message);
    if (e.overrun) fault("evaluate wrote behind the end of a record");
    if (e.allocations > 0) fault("evaluate allocated ", e.allocations, " times");
    for (std::size_t g = F; g <= Y; ++g) {
      for (std::size_t i = 0; i < row_count(g); ++i) {
        if (!std::isfinite(e.rows[g][i])) fault(row_name(Group(g), i), " was not written, or is ", e.rows[g][i]);
      }
    }
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      const bool finite =
          std::all_of(e.partials[b].begin(), e.partials[b].end(), [](double d) { return std::isfinite(d); });
      if (!finite) fault("a partial of block ", block_info[b].name, " was not written, or is not finite");
    }
    if (std::count(e.branch.begin(), e.branch.end(), 99) > 0)
      fault("a switching function was not written, or is not a number");
    if (std::any_of(e.limits.begin(), e.limits.end(), [](double q) { return std::isnan(q); }))
      fault("a quantity of `validity` was not written, or is not a number");
  }

  /// Full matrices of the base state, and how large each row's terms are.
  void expand(const Evaluation& base) {
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      const std::size_t columns = size(block_info[b].columns);
      full_[b].assign(marks_[b].size(), 0.0);
      std::size_t n = 0;
      for (std::size_t j = 0; j < columns; ++j) {
        for (; n < static_cast<std::size_t>(starts_[b][j + 1]); ++n) {
          full_[b][static_cast<std::size_t>(entries_[b][n]) * columns + j] = base.partials[b][n];
        }
      }
    }
    for (std::size_t g = 0; g < groups; ++g) {
      row_scale_[g].assign(row_count(g), 0.0);
      for (std::size_t i = 0; i < row_count(g); ++i) {
        double& largest = row_scale_[g][i];
        largest = std::fabs(base.rows[g][i]);
        for (std::size_t f = 0; f < families; ++f) {
          for (std::size_t j = 0; j < size(f); ++j) {
            largest = std::max(largest, std::fabs(partial(Group(g), Family(f), i, j)) * scale_[f][j]);
          }
        }
      }
    }
  }
  [[nodiscard]] double partial(Group g, Family f, std::size_t i, std::size_t j) const {
    const int block = block_of(g, f);
    return block < 0 ? 0.0 : full_[block][i * size(f) + j];
  }
  [[nodiscard]] bool in_pattern(Group g, Family f, std::size_t i, std::size_t j) const {
    const int block = block_of(g, f);
    return block >= 0 && marks_[block][i * size(f) + j] != 0;
  }

  // ---- differences -------------------------------------------------------------------------------------------------
  /// Slopes at 0 of all rows of `path`, one list per step that stays on the branch of `base`: three-point differences,
  /// extrapolated once, or one-sided ones, extrapolated twice, where a kink is in the way. Both are of third order or
  /// better, so that a smooth law meets 1e-6 at some step between truncation and rounding; a wrong partial meets it at
  /// none.
  static constexpr std::size_t lists = groups + std::size_t{BRAMAH_BLOCKS};
  using Slopes = std::vector<std::array<std::vector<double>, lists>>;  // rows, then partials
  template <class Path>
  [[nodiscard]] Slopes slopes(const Evaluation& base, const Path& path) const {
    return differences(base, [&](double t, double& moved) { return evaluate({path(t, moved)}, only(BRAMAH_R_V)); });
  }
  static const std::vector<double>& part(const Evaluation& e, std::size_t g) {
    return g < groups ? e.rows[g] : e.partials[g - groups];
  }
  template <class Look>
  [[nodiscard]] static Slopes differences(const Evaluation& base, const Look& look) {
    static constexpr double steps[] = {3e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
    Slopes found;
    const auto combine = [&](const Evaluation& one, const auto& formula) {
      auto& all = found.emplace_back();
      for (std::size_t g = 0; g < lists; ++g) {
        all[g].resize(part(one, g).size());
        for (std::size_t i = 0; i < all[g].size(); ++i) all[g][i] = formula(g, i);
      }
    };
    for (const double h : steps) {
      double plus = 0.0, minus = 0.0, half_plus = 0.0, half_minus = 0.0;
      const Evaluation p = look(h, plus), m = look(-h, minus);
      if (p.branch == base.branch && m.branch == base.branch) {
        const Evaluation hp = look(0.5 * h, half_plus), hm = look(-0.5 * h, half_minus);
        combine(p, [&](std::size_t g, std::size_t i) {
          const double wide = (part(p, g)[i] - part(m, g)[i]) / (plus - minus);
          const double narrow = (part(hp, g)[i] - part(hm, g)[i]) / (half_plus - half_minus);
          return (4.0 * narrow - wide) / 3.0;
        });
        continue;
      }
      for (const Evaluation* whole : {&p, &m}) {
        if (whole->branch != base.branch) continue;
        const double side = whole == &p ? 1.0 : -1.0, full = whole == &p ? plus : minus;
        double half = 0.0, quarter = 0.0;
        const Evaluation h2 = look(0.5 * side * h, half), h4 = look(0.25 * side * h, quarter);
        combine(*whole, [&](std::size_t g, std::size_t i) {
          const double at = part(base, g)[i];
          return ((part(*whole, g)[i] - at) / full - 6.0 * (part(h2, g)[i] - at) / half +
                  8.0 * (part(h4, g)[i] - at) / quarter) /
                 3.0;
        });
        break;
      }
    }
    return found;
  }
  static double nearest(const Slopes& all, std::size_t g, std::size_t i, double to) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& one : all) {
      if (std::fabs(one[g][i] - to) < std::fabs(best - to)) best = one[g][i];
    }
    return best;
  }

  void examine_partials(const Evaluation& base) {
    for (std::size_t f = 0; f < families; ++f) {
      for (std::size_t j = 0; j < size(f); ++j) {
        const double scale = scale_[f][j], at = state_.values[f][j];
        const Slopes found = slopes(base, [&](double t, double& moved) {
          LocalState s = state_;
          s.values[f][j] = at + t * scale;
          moved = s.values[f][j] - at;  // what was added after rounding
          return s;
        });
        if (found.empty()) {
          fault("every step of ", column_name(Family(f), j), " crosses a kink");
          continue;
        }
        for (std::size_t g = 0; g < groups; ++g) {
          if (g == PULL && f == LAMBDA) continue;  // D^T lambda by lambda is D^T by construction
          for (std::size_t i = 0; i < row_count(g); ++i) compare(found, Group(g), Family(f), i, j);
        }
      }
    }
  }
  void compare(const Slopes& found, Group g, Family f, std::size_t i, std::size_t j) {
    const double scale = scale_[f][j];
    const int block = block_of(g, f);
    if (!in_pattern(g, f, i, j) && !(g == PULL && f == V)) {
      for (const auto& one : found) {
        if (one[g][i] == 0.0) continue;
        return fault(row_name(g, i), " depends on ", column_name(f, j), ", by ", one[g][i],
                     block < 0 ? ", which no block can hold" : ", outside its pattern");
      }
      return;
    }
    // 1e-6 of the row of this block; and rounding, 1e-16 of the row's largest term over the smallest useful step 1e-5.
    double largest = 0.0;
    for (std::size_t k = 0; k < size(f); ++k)
      largest = std::max(largest, std::fabs(partial(g, f, i, k)) * scale_[f][k]);
    const double allowed = 1e-6 * largest + 1e-11 * row_scale_[g][i];
    const double exact = partial(g, f, i, j), by_differences = nearest(found, g, i, exact);
    if (std::fabs(by_differences - exact) * scale <= allowed) return;
    fault(block < 0 ? "none" : block_info[block].name, ": d(", row_name(g, i), ")/d(", column_name(f, j), ") is ",
          exact, "; differences give ", by_differences);
  }

  /// c, r and s are one after another the time derivatives along a path.
  void examine_paths(const Evaluation& base) {
    const Slopes found = slopes(base, [&](double t, double& moved) {
      LocalState s = state_;
      for (std::size_t j = 0; j < size(X); ++j) {
        s.values[X][j] += t * (state_.values[V][j] + 0.5 * t * state_.values[A][j]);
        s.values[V][j] += t * state_.values[A][j];
      }
      s.time += t;
      moved = t;
      return s;
    });
    for (std::size_t i = 0; i < size(LAMBDA); ++i) {
      double speed = std::fabs(base.rows[RATE][i]), push = std::fabs(base.rows[SECOND_RATE][i]);
      for (std::size_t j = 0; j < size(X); ++j) {
        speed += std::fabs(partial(RATE, V, i, j) * state_.values[V][j]);
        push += std::fabs(partial(RATE, V, i, j) * state_.values[A][j]) +
                std::fabs(partial(RATE, X, i, j) * state_.values[V][j]);
      }
      const double s = base.rows[SECOND_RATE][i], s_found = nearest(found, RATE, i, s);
      if (!(std::fabs(s_found - s) <= 1e-6 * push + 1e-11 * row_scale_[RATE][i])) {
        fault(row_name(SECOND_RATE, i), " is ", s, "; differences in time give ", s_found);
      }
      if (i >= row_count(HOLONOMIC)) continue;
      const double r = base.rows[RATE][i], r_found = nearest(found, HOLONOMIC, i, r);
      if (!(std::fabs(r_found - r) <= 1e-6 * speed + 1e-11 * row_scale_[HOLONOMIC][i])) {
        fault(row_name(RATE, i), " is ", r, "; differences in time give ", r_found);
      }
    }
  }

  // ---- identities --------------------------------------------------------------------------------------------------
  void examine_identities(const Evaluation& base) {
    const auto equal = [](double a, double b, double of) { return std::fabs(a - b) <= 1e-13 * of; };
    for (std::size_t i = 0; i < row_count(HOLONOMIC); ++i) {
      for (std::size_t j = 0; j < size(X); ++j) {
        const double c_x = partial(HOLONOMIC, X, i, j), r_v = partial(RATE, V, i, j);
        if (!equal(c_x, r_v, std::fabs(c_x)))
          fault("C_X and R_V differ: ", c_x, " and ", r_v, " in ", row_name(HOLONOMIC, i));
        const double s_v = partial(SECOND_RATE, V, i, j), r_x = partial(RATE, X, i, j);
        if (!equal(s_v, 2.0 * r_x, std::fabs(s_v)))
          fault("S_V is not 2 R_X: ", s_v, " and ", r_x, " in ", row_name(HOLONOMIC, i));
      }
    }
    double mass = 0.0;
    for (const double m : full_[BRAMAH_F_A]) mass = std::max(mass, std::fabs(m));
    for (std::size_t i = 0; i < size(X); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double a = partial(F, A, i, j), b = partial(F, A, j, i);
        if (!equal(a, b, mass))
          fault("F_A is not symmetric: ", a, " and ", b, " for ", column_name(X, i), " and ", column_name(X, j));
      }
    }
    examine_linearity(base);
  }
  void examine_linearity(const Evaluation&) {
    const std::size_t mh = row_count(HOLONOMIC);
    if (size(LAMBDA) == mh) return;
    LocalState once = state_;
    for (std::size_t j = 0; j < size(X); ++j) {
      if (once.values[V][j] == 0.0) once.values[V][j] = scale_[V][j] * scatter(7, V, j);
    }
    LocalState twice = once, rest = once;
    for (double& v : twice.values[V]) v *= 2.0;
    for (double& v : rest.values[V]) v = 0.0;
    const Evaluation e1 = evaluate({once}, {}), e2 = evaluate({twice}, {}), e0 = evaluate({rest}, {});
    for (std::size_t i = mh; i < size(LAMBDA); ++i) {
      const double b1 = e1.rows[RATE][i], b2 = e2.rows[RATE][i], b0 = e0.rows[RATE][i];
      double terms = std::fabs(b1);
      for (std::size_t j = 0; j < size(X); ++j) terms += std::fabs(partial(RATE, V, i, j) * once.values[V][j]);
      if (!(std::fabs(b2 - 2.0 * b1 + b0) <= 1e-12 * (terms + std::fabs(b0))))
        fault(row_name(RATE, i), " is not affine in v: b(0) = ", b0, ", b(v) = ", b1, ", b(2v) = ", b2);
    }
  }

  // ---- energy ------------------------------------------------------------------------------------------------------
  struct Stored {
    double energy = std::numeric_limits<double>::quiet_NaN(), rate = energy;
  };
  /// The energy at `at`, and its derivative along x, v and z of `along`.
  [[nodiscard]] Stored stored(const bramah_energy& energy, const LocalState& at, const LocalState& along) const {
    bramah_batch b{};
    b.size = sizeof b;
    b.count = 1;
    b.instances = memory_;
    b.time = at.time;
    b.side = sample_->side;
    b.x = at.values[X].data(), b.v = at.values[V].data(), b.z = at.values[Z].data(), b.u = at.values[U].data();
    const bramah_direction direction{sizeof(bramah_direction),
                                     along.values[X].data(),
                                     along.values[V].data(),
                                     nullptr,
                                     along.values[Z].data(),
                                     nullptr,
                                     nullptr,
                                     nullptr};
    Stored result;
    if (energy.values(type_.self, &b, &direction, &result.energy, &result.rate) != 0) result = Stored{};
    return result;
  }
  void examine_energy(const Evaluation& base) {
    const auto* energy = extension<bramah_energy>(BRAMAH_EXTENSION_ENERGY);
    if (energy == nullptr) {
      const auto& inertia = full_[BRAMAH_F_A];
      if (std::any_of(inertia.begin(), inertia.end(), [](double m) { return m != 0.0; }))
        fault("it has inertia and no energy; give it a function `energy`");
      return;
    }
    LocalState still = state_;
    for (auto& list : still.values) std::fill(list.begin(), list.end(), 0.0);
    examine_energy_of_motion(*energy, still);
    examine_energy_of_storage(*energy, still);
    examine_rate_of_energy(*energy, base);
    LocalState later = state_;
    later.time += 1.0;
    if (stored(*energy, later, still).energy != stored(*energy, state_, still).energy)
      fault("the energy depends on time itself");
  }
  void examine_energy_of_motion(const bramah_energy& energy, const LocalState& still) {
    LocalState along = still;
    along.values[V] = state_.values[V];
    double sum = 0.0, size_of_sum = 0.0;
    for (std::size_t i = 0; i < size(X); ++i) {
      for (std::size_t j = 0; j < size(X); ++j) {
        const double term = state_.values[V][i] * partial(F, A, i, j) * state_.values[V][j];
        sum += term;
        size_of_sum += std::fabs(term);
      }
    }
    const double said = stored(energy, state_, along).rate;
    if (!(std::fabs(said - sum) <= 1e-12 * size_of_sum))
      fault("the energy's derivative by v, times v, is ", said, "; v . f_a v is ", sum);
  }
  void examine_energy_of_storage(const bramah_energy& energy, const LocalState& still) {
    for (std::size_t i = 0; i < size(Z); ++i) {
      LocalState along = still;
      along.values[Z][i] = 1.0;
      const double said = stored(energy, state_, along).rate;
      if (said == 0.0) continue;
      double sum = 0.0;
      for (std::size_t j = 0; j < size(Z); ++j) sum += partial(G, ZDOT, i, j) * state_.values[Z][j];
      if (!(std::fabs(said - sum) <= 1e-12 * std::fabs(said)))
        fault("the energy's derivative by ", column_name(Z, i), " is ", said, "; g_zdot z is ", sum);
    }
  }
  void examine_rate_of_energy(const bramah_energy& energy, const Evaluation& base) {
    LocalState along = state_;
    for (const Family f : {X, V, Z}) {
      for (std::size_t j = 0; j < size(f); ++j) along.values[f][j] = scale_[f][j] * scatter(31, f, j);
    }
    bool leaves = false;
    const auto look = [&](double t) {
      LocalState s = state_;
      for (const Family f : {X, V, Z}) {
        for (std::size_t j = 0; j < size(f); ++j) s.values[f][j] += t * along.values[f][j];
      }
      leaves = leaves || evaluate({s}, {}).branch != base.branch;
      return stored(energy, s, along).energy;
    };
    constexpr double h = 1e-3;
    const double plus = look(h), minus = look(-h), narrow = look(0.5 * h) - look(-0.5 * h);
    if (leaves) return;  // a kink is in the way
    const auto [here, rate] = stored(energy, state_, along);
    const double by_differences = (8.0 * narrow - (plus - minus)) / (6.0 * h);
    const double size_of_terms = std::fabs(here) + std::fabs(rate) + std::fabs(plus) + std::fabs(minus);
    if (!(std::fabs(by_differences - rate) <= 1e-7 * size_of_terms))
      fault("the rate of the energy is ", rate, "; differences give ", by_differences);
  }

  void examine_repeatability(const Evaluation& base) {
    LocalState other = state_;
    for (std::size_t f = 0; f < families; ++f) {
      for (std::size_t j = 0; j < size(f); ++j) other.values[f][j] += 0.03 * scale_[f][j] * scatter(11, f, j);
    }
    const Evaluation again = evaluate({state_}, all_blocks()), beside = evaluate({other}, all_blocks());
    const Evaluation batch = evaluate({state_, other, state_}, all_blocks());
    if (batch.status != 0 || batch.overrun)
      fault("a batch of three returned ", batch.status, batch.overrun ? " and wrote too much" : "");
    const auto same = [&](const std::vector<double>& one, const std::vector<double>& another) {
      return one.size() == another.size() &&
             (one.empty() || std::memcmp(one.data(), another.data(), one.size() * sizeof(double)) == 0);
    };
    const auto joined = [](const std::vector<double>& a, const std::vector<double>& b) {
      std::vector<double> all = a;
      all.insert(all.end(), b.begin(), b.end());
      all.insert(all.end(), a.begin(), a.end());
      return all;
    };
    for (std::size_t g = F; g <= Y; ++g) {
      if (!same(base.rows[g], again.rows[g])) fault("a second evaluation changes rows of group ", g);
      if (!same(joined(base.rows[g], beside.rows[g]), batch.rows[g]))
        fault("a batch of three changes rows of group ", g);
    }
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      const char* name = block_info[b].name;
      if (!same(base.partials[b], again.partials[b])) fault("a second evaluation changes ", name);
      if (!same(joined(base.partials[b], beside.partials[b]), batch.partials[b]))
        fault("a batch of three changes ", name);
      if (patterns_[b].count == 0) continue;
      // Asked for alone, another path through the library may round differently, no more.
      const Evaluation alone = evaluate({state_}, only(static_cast<int>(b)), false);
      double largest = 0.0;
      for (const double d : base.partials[b]) largest = std::max(largest, std::fabs(d));
      for (std::size_t n = 0; n < base.partials[b].size(); ++n) {
        if (std::fabs(alone.partials[b][n] - base.partials[b][n]) <= 1e-12 * largest) continue;
        fault(name, " changes when it is asked for alone");
        break;
      }
    }
    const Evaluation values = evaluate({state_}, {});
    for (std::size_t g = F; g <= Y; ++g) {
      for (std::size_t i = 0; i < row_count(g); ++i) {
        if (std::fabs(values.rows[g][i] - base.rows[g][i]) <= 1e-12 * row_scale_[g][i]) continue;
        fault(row_name(Group(g), i), " changes from ", base.rows[g][i], " to ", values.rows[g][i], " without partials");
      }
    }
  }

  // ---- derivatives along a direction -------------------------------------------------------------------------------
  /// What moves with eps, and how fast; parameters that stand still have no numbers.
  struct Move {
    std::string name;
    std::vector<double> state[families];
    std::vector<Setting> parameters;
  };
  /// An instance with numbers of its own.
  class Instance {
   public:
    explicit Instance(const bramah_type& type)
        : type_(type),
          memory_(static_cast<std::byte*>(::operator new(type.instance_bytes, std::align_val_t(type.instance_align)))) {
    }
    ~Instance() {
      if (made_ && type_.destroy != nullptr) type_.destroy(type_.self, memory_);
      ::operator delete(memory_, std::align_val_t(type_.instance_align));
    }
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;
    /// `tangents` may be null: the numbers stand still.
    bool configure(const std::vector<Setting>& numbers, const std::vector<Setting>* tangents,
                   const bramah_tangent& by) {
      const std::vector<bramah_value> values = as_values(numbers);
      std::vector<bramah_value> moves;
      if (tangents != nullptr) moves = as_values(*tangents);
      for (bramah_value& m : moves) m.numbers = m.count == 0 ? nullptr : m.numbers;
      made_ = (tangents == nullptr ? type_.configure(type_.self, memory_, values.data())
                                   : by.configure(type_.self, memory_, values.data(), moves.data())) == 0;
      return made_;
    }
    [[nodiscard]] const std::byte* at() const { return memory_; }

   private:
    const bramah_type& type_;
    std::byte* memory_;
    bool made_ = false;
  };

  void examine_tangents(const Evaluation& base) {
    const auto* tangent = extension<bramah_tangent>(BRAMAH_EXTENSION_TANGENT);
    if (tangent == nullptr) return;
    const std::vector<Setting> still(settings_.size(), Setting(std::vector<double>{}));
    Move along{"the state", {}, still};
    // Where several kinks meet, most directions leave the branch on either side.
    bool stays = false;
    for (std::size_t salt = 13; salt < 29 && !stays; ++salt) {
      for (std::size_t f = 0; f < families; ++f) {
        along.state[f].resize(size(f));
        for (std::size_t j = 0; j < size(f); ++j) along.state[f][j] = scale_[f][j] * scatter(salt, f, j);
      }
      stays = examine_move(*tangent, along, base);
    }
    if (!stays) fault("every direction of the state crosses a kink");
    for (auto& list : along.state) std::fill(list.begin(), list.end(), 0.0);
    for (std::size_t k = 0; k < settings_.size(); ++k) {
      if (tangent->differentiable[k] == 0) continue;
      along.name = std::string("parameter ") + type_.parameters[k].name;
      along.parameters = still;
      for (std::size_t e = 0; e < settings_[k].numbers.size(); ++e) {
        const double number = std::fabs(settings_[k].numbers[e]);
        along.parameters[k].numbers.push_back((number == 0.0 ? 1.0 : number) * scatter(17, k, e));
      }
      if (!examine_move(*tangent, along, base)) fault("every step of ", along.name, " crosses a kink");
    }
  }
  /// False where no step of the move stays on the branch of `base`.
  bool examine_move(const bramah_tangent& tangent, const Move& move, const Evaluation& base) {
    Instance moving(type_);
    if (!moving.configure(settings_, &move.parameters, tangent)) {
      fault("configure with tangents failed");
      return true;
    }
    const bramah_direction along{sizeof(bramah_direction), move.state[X].data(),     move.state[V].data(),
                                 move.state[A].data(),     move.state[Z].data(),     move.state[ZDOT].data(),
                                 move.state[U].data(),     move.state[LAMBDA].data()};
    const Evaluation exact = evaluate_instances(moving.at(), {state_}, all_blocks(), true, &along);
    if (exact.status != 0) {
      fault("evaluate of tangents returned ", exact.status, ": ", exact.message);
      return true;
    }
    if (exact.overrun) fault("evaluate of tangents wrote behind the end of a record");
    if (exact.allocations > 0) fault("evaluate of tangents allocated ", exact.allocations, " times");
    const Slopes found = differences(base, [&](double t, double& moved) {
      moved = t;
      LocalState s = state_;
      for (std::size_t f = 0; f < families; ++f) {
        for (std::size_t j = 0; j < size(f); ++j) s.values[f][j] += t * move.state[f][j];
      }
      Instance there(type_);
      there.configure(settings_at(move, t), nullptr, tangent);
      return evaluate_instances(there.at(), {s}, all_blocks(), true, nullptr);
    });
    if (found.empty()) return false;
    compare_tangents(exact, found, move);
    examine_fixed_tangents(tangent, moving, move);
    return true;
  }
  [[nodiscard]] std::vector<Setting> settings_at(const Move& move, double t) const {
    std::vector<Setting> there = settings_;
    for (std::size_t k = 0; k < there.size(); ++k) {
      for (std::size_t e = 0; e < move.parameters[k].numbers.size(); ++e)
        there[k].numbers[e] += t * move.parameters[k].numbers[e];
    }
    return there;
  }
  /// Directions have the size of what they move, so a tangent is of the size of its row, or of its column's share.
  void compare_tangents(const Evaluation& exact, const Slopes& found, const Move& move) {
    for (std::size_t g = F; g <= Y; ++g) {
      for (std::size_t i = 0; i < row_count(g); ++i) {
        const double here = exact.rows[g][i], by_differences = nearest(found, g, i, here);
        // Where a law is even, its slope is zero but for rounding of the second-order terms.
        const double allowed = 1e-6 * (row_scale_[g][i] + std::fabs(here)) + 1e-12 * second_order(exact, Group(g), i);
        if (std::fabs(by_differences - here) <= allowed) continue;
        fault("tangent of ", row_name(Group(g), i), " along ", move.name, " is ", here, "; differences give ",
              by_differences);
      }
    }
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      const BlockInfo& info = block_info[b];
      for (std::size_t j = 0; j < size(info.columns); ++j) {
        for (auto n = static_cast<std::size_t>(starts_[b][j]); n < static_cast<std::size_t>(starts_[b][j + 1]); ++n) {
          const auto i = static_cast<std::size_t>(entries_[b][n]);
          const double here = exact.partials[b][n], by_differences = nearest(found, groups + b, n, here);
          const double usual = row_scale_[info.rows][i] / scale_[info.columns][j];
          if (std::fabs(by_differences - here) <= 1e-6 * (usual + std::fabs(here))) continue;
          fault("tangent of ", info.name, ", d(", row_name(info.rows, i), ")/d(", column_name(info.columns, j),
                "), along ", move.name, " is ", here, "; differences give ", by_differences);
        }
      }
    }
  }

  [[nodiscard]] double second_order(const Evaluation& exact, Group g, std::size_t i) const {
    double sum = 0.0;
    for (std::size_t b = 0; b < BRAMAH_BLOCKS; ++b) {
      for (std::size_t j = 0; block_info[b].rows == g && j < size(block_info[b].columns); ++j) {
        for (auto n = static_cast<std::size_t>(starts_[b][j]); n < static_cast<std::size_t>(starts_[b][j + 1]); ++n) {
          if (static_cast<std::size_t>(entries_[b][n]) == i)
            sum += std::fabs(exact.partials[b][n]) * scale_[block_info[b].columns][j];
        }
      }
    }
    return sum;
  }

  /// Start values, constants and the signal of an instance, or their tangents.
  [[nodiscard]] std::vector<double> fixed_values(const void* instance, const bramah_tangent* by) const {
    std::vector<double> x, v, z;
    for (std::int32_t k = 0; k < type_.variable_count; ++k) {
      const bool second = type_.variables[k].family == BRAMAH_X;
      (second ? x : z).push_back(by == nullptr ? type_.variables[k].start : 0.0);
      if (second) v.push_back(0.0);
    }
    const auto start = by == nullptr ? type_.start : by->start;
    if (start != nullptr) start(type_.self, instance, x.data(), v.data(), z.data());
    std::vector<double> all = x;
    all.insert(all.end(), v.begin(), v.end());
    all.insert(all.end(), z.begin(), z.end());
    if (const auto* constants = extension<bramah_constants>(BRAMAH_EXTENSION_CONSTANTS)) {
      std::vector<double> list(static_cast<std::size_t>(constants->count), 0.0);
      (by == nullptr ? constants->values : by->constants)(type_.self, instance, list.data());
      all.insert(all.end(), list.begin(), list.end());
    }
    if (const auto* signal = extension<bramah_signal>(BRAMAH_EXTENSION_SIGNAL)) {
      for (const double t : {-1.0, 0.0, 0.3, sample_->time, 2.0, 1e3})
        all.push_back((by == nullptr ? signal->value : by->signal)(type_.self, instance, t, sample_->side));
    }
    return all;
  }
  void examine_fixed_tangents(const bramah_tangent& tangent, const Instance& moving, const Move& move) {
    const std::vector<double> base = fixed_values(memory_, nullptr), exact = fixed_values(moving.at(), &tangent);
    const auto look = [&](double t) {
      Instance there(type_);
      there.configure(settings_at(move, t), nullptr, tangent);
      return fixed_values(there.at(), nullptr);
    };
    constexpr double h = 1e-3;
    const std::vector<double> p = look(h), m = look(-h), hp = look(0.5 * h), hm = look(-0.5 * h);
    for (std::size_t k = 0; k < base.size(); ++k) {
      const double by_differences = (8.0 * (hp[k] - hm[k]) - (p[k] - m[k])) / (6.0 * h);
      // Rounding of values over the step, and what the extrapolation leaves out: h^4.
      const double allowed = 1e-9 * std::fabs(exact[k]) + 1e-11 * std::max(1.0, std::fabs(base[k]));
      if (std::fabs(by_differences - exact[k]) <= allowed) continue;
      fault("tangent of start value, constant or signal ", k + 1, " along ", move.name, " is ", exact[k],
            "; differences give ", by_differences);
    }
  }

  // ---- what does not depend on the state ---------------------------------------------------------------------------
  void examine_fixed_values() {
    if (type_.start != nullptr) {
      std::vector<double> x, v, z;
      for (std::int32_t k = 0; k < type_.variable_count; ++k) {
        const bool second = type_.variables[k].family == BRAMAH_X;
        (second ? x : z).push_back(type_.variables[k].start);
        if (second) v.push_back(0.0);
      }
      type_.start(type_.self, memory_, x.data(), v.data(), z.data());
      for (const auto* list : {&x, &v, &z}) {
        if (!std::all_of(list->begin(), list->end(), [](double s) { return std::isfinite(s); }))
          fault("a start value is not finite");
      }
    }
    if (const auto* constants = extension<bramah_constants>(BRAMAH_EXTENSION_CONSTANTS)) {
      std::vector<double> values(static_cast<std::size_t>(constants->count), std::numeric_limits<double>::quiet_NaN());
      constants->values(type_.self, memory_, values.data());
      if (!std::all_of(values.begin(), values.end(), [](double c) { return std::isfinite(c); }))
        fault("a constant was not written");
    }
    bool constant_terminal = false, signal_terminal = false;
    for (std::int32_t k = 0; k < type_.terminal_count; ++k) {
      constant_terminal = constant_terminal || type_.terminals[k].source == BRAMAH_CONSTANT;
      signal_terminal = signal_terminal || type_.terminals[k].source == BRAMAH_SIGNAL;
    }
    const auto* signal = extension<bramah_signal>(BRAMAH_EXTENSION_SIGNAL);
    if (constant_terminal && extension<bramah_constants>(BRAMAH_EXTENSION_CONSTANTS) == nullptr)
      fault("a terminal gives constants; the component lacks constants()");
    if (signal_terminal && signal == nullptr)
      fault("a terminal gives a signal; the component lacks signal() or next_breakpoint()");
    if (signal != nullptr) examine_signal(*signal);
  }
  void examine_signal(const bramah_signal& signal) {
    double t = -10.0;
    for (int k = 0; k < 1000; ++k) {
      const double next = signal.next_breakpoint(type_.self, memory_, t);
      if (!(next > t)) return fault("the next breakpoint after ", t, " is ", next, ", not later");
      const double between = std::isfinite(next) ? 0.5 * (t + next) : t + 1.0;
      const double before = signal.value(type_.self, memory_, between, -1),
                   after = signal.value(type_.self, memory_, between, 1);
      if (!std::isfinite(before) || before != after)
        return fault("at ", between, ", between breakpoints, the limits are ", before, " and ", after);
      if (!std::isfinite(next)) return;
      t = next;
    }
  }

  static constexpr std::size_t copies = 3;
  std::vector<Setting> settings_;
  const bramah_type& type_;
  const Sample* sample_ = nullptr;
  std::string where_;
  std::vector<std::string> faults_;
  std::byte* memory_ = nullptr;
  std::size_t made_ = 0;
  std::vector<std::uint8_t> marks_[BRAMAH_BLOCKS];  // rows x columns, row-major
  std::vector<std::int32_t> starts_[BRAMAH_BLOCKS], entries_[BRAMAH_BLOCKS];
  bramah_pattern patterns_[BRAMAH_BLOCKS] = {};
  LocalState state_;
  std::vector<double> scale_[families];      // size of a variable, for steps
  std::vector<double> full_[BRAMAH_BLOCKS];  // rows x columns, row-major
  std::vector<double> row_scale_[groups];    // largest term of a row
};

}  // namespace detail

/// Component C as the border describes it; lives as long as the program, as in a library.
template <class C>
const bramah_type& type_of() {
  static const std::unique_ptr<detail::TypeEntry> entry = [] {
    auto made = std::make_unique<detail::TypeEntry>();
    detail::describe_type<C>(*made);
    return made;
  }();
  return entry->type;
}

/// Examines component C at every sample.
template <class C>
Conformance conforms(const std::vector<Sample>& samples = {Sample{}}) {
  return detail::Examination(type_of<C>()).run(samples);
}

}  // namespace bramah
