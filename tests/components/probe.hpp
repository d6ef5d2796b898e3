// One instance of a component behind the C border, for tests that know its numbers in closed form.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "bramah/conformance.hpp"

namespace bramah::testing {

using Parameters = std::map<std::string, Setting>;

template <class C>
class Probe {
 public:
  std::vector<double> x, v, a, z, zdot, u, lambda;  // zero until set
  double time = 0.0;
  int side = 1;

  struct Rows {
    std::vector<double> f, g, c, r, s, y, switches;
  };

  explicit Probe(const Parameters& given = {}) {
    std::vector<Setting> settings;
    std::vector<bramah_value> values;
    for (std::int32_t k = 0; k < type.parameter_count; ++k) {
      const bramah_parameter_info& p = type.parameters[k];
      const auto found = given.find(p.name);
      if (found != given.end()) {
        settings.push_back(found->second);
        for (int c = 0; p.kind == BRAMAH_CHOICE && p.choices[c] != nullptr; ++c) {
          if (settings.back().text == p.choices[c]) settings.back().numbers = {static_cast<double>(c)};
        }
      } else if (p.required != 0) {
        throw std::invalid_argument(std::string("the probe needs ") + p.name);
      } else if (p.kind == BRAMAH_TEXT) {
        settings.emplace_back(p.default_text);
      } else {
        settings.emplace_back(std::vector<double>(p.default_numbers, p.default_numbers + p.default_count));
      }
    }
    for (const Setting& s : settings) {
      values.push_back(
          {sizeof(bramah_value), s.numbers.data(), static_cast<std::int64_t>(s.numbers.size()), s.text.c_str()});
    }
    if (type.configure(type.self, memory_, values.data()) != 0) throw std::runtime_error("configure failed");
    x.assign(size(type.nx), 0.0);
    v = a = x;
    z.assign(size(type.nz), 0.0);
    zdot = z;
    u.assign(size(type.nu), 0.0);
    lambda.assign(size(type.holonomic_count + type.nonholonomic_count), 0.0);
    make_patterns();
  }
  ~Probe() { type.destroy(type.self, memory_); }
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  [[nodiscard]] Rows rows() {
    Rows out;
    bramah_batch b = batch();
    out.f.resize(x.size()), out.g.resize(z.size()), out.c.resize(size(type.holonomic_count));
    out.r.resize(lambda.size()), out.s.resize(lambda.size()), out.y.resize(size(type.output_count));
    b.f = out.f.data(), b.g = out.g.data(), b.c = out.c.data(), b.r = out.r.data(), b.s = out.s.data(),
    b.y = out.y.data();
    if (type.evaluate(type.self, &b) != 0) throw std::runtime_error(b.message);
    if (const auto* s = static_cast<const bramah_switches*>(type.extension(type.self, BRAMAH_EXTENSION_SWITCHES))) {
      out.switches.resize(size(s->count));
      s->values(type.self, &b, out.switches.data());
    }
    return out;
  }
  struct Stored {
    double energy = 0.0, rate = 0.0;  // J; W, along v, a and zdot
  };
  [[nodiscard]] Stored stored() {
    Stored out;
    const bramah_batch b = batch();
    const bramah_direction along{
        sizeof(bramah_direction), v.data(), a.data(), nullptr, zdot.data(), nullptr, nullptr, nullptr};
    const auto* energy = static_cast<const bramah_energy*>(type.extension(type.self, BRAMAH_EXTENSION_ENERGY));
    if (energy->values(type.self, &b, &along, &out.energy, &out.rate) != 0) throw std::runtime_error(b.message);
    return out;
  }
  /// One partial; 0 outside the pattern.
  [[nodiscard]] double partial(int block, std::size_t row, std::size_t column) {
    std::vector<double> numbers(rows_[block].size());
    bramah_batch b = batch();
    b.partials[block] = numbers.data();
    if (type.evaluate(type.self, &b) != 0) throw std::runtime_error(b.message);
    for (auto e = size(starts_[block][column]); e < size(starts_[block][column + 1]); ++e) {
      if (size(rows_[block][e]) == row) return numbers[e];
    }
    return 0.0;
  }
  /// The pattern of a block, a line of 'x' and '.' per row.
  [[nodiscard]] std::vector<std::string> pattern(int block) const {
    const bramah_pattern& p = patterns_[block];
    std::vector<std::string> lines(size(p.rows), std::string(size(p.columns), '.'));
    for (std::size_t j = 0; j < size(p.columns); ++j) {
      for (auto e = size(p.start[j]); e < size(p.start[j + 1]); ++e) lines[size(p.row[e])][j] = 'x';
    }
    return lines;
  }
  /// What check() reports, "parameter: found; expected ...".
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> found;
    const auto report = [](void* context, const char* parameter, const char* what, const char* expected) {
      static_cast<std::vector<std::string>*>(context)->push_back(std::string(parameter) + ": " + what + "; expected " +
                                                                 expected);
    };
    type.check(type.self, memory_, report, &found);
    return found;
  }
  /// Own start values: x, then v, then z.
  [[nodiscard]] std::vector<double> start() const {
    std::vector<double> own_x, own_v, own_z;
    for (std::int32_t k = 0; k < type.variable_count; ++k) {
      (type.variables[k].family == BRAMAH_X ? own_x : own_z).push_back(type.variables[k].start);
    }
    own_v.assign(own_x.size(), 0.0);
    type.start(type.self, memory_, own_x.data(), own_v.data(), own_z.data());
    own_x.insert(own_x.end(), own_v.begin(), own_v.end());
    own_x.insert(own_x.end(), own_z.begin(), own_z.end());
    return own_x;
  }
  [[nodiscard]] double signal(double t, int from) const { return signals()->value(type.self, memory_, t, from); }
  [[nodiscard]] double next_breakpoint(double t) const { return signals()->next_breakpoint(type.self, memory_, t); }
  [[nodiscard]] std::vector<double> constants() const {
    const auto* table = static_cast<const bramah_constants*>(type.extension(type.self, BRAMAH_EXTENSION_CONSTANTS));
    std::vector<double> values(size(table->count), NAN);
    table->values(type.self, memory_, values.data());
    return values;
  }

  const bramah_type& type = type_of<C>();

 private:
  template <class I>
  static std::size_t size(I n) {
    return static_cast<std::size_t>(n);
  }
  [[nodiscard]] const bramah_signal* signals() const {
    return static_cast<const bramah_signal*>(type.extension(type.self, BRAMAH_EXTENSION_SIGNAL));
  }
  [[nodiscard]] bramah_batch batch() {
    bramah_batch b{};
    b.size = sizeof b;
    b.count = 1;
    b.instances = memory_;
    b.time = time;
    b.side = side;
    b.x = x.data(), b.v = v.data(), b.a = a.data(), b.z = z.data(), b.zdot = zdot.data(), b.u = u.data();
    b.lambda = lambda.data();
    b.patterns = patterns_;
    return b;
  }
  void make_patterns() {
    using detail::block_info;
    const auto rows_of = [&](detail::Group g) {
      return g == detail::F || g == detail::PULL ? x.size()
             : g == detail::G                    ? z.size()
             : g == detail::HOLONOMIC            ? size(type.holonomic_count)
             : g == detail::Y                    ? size(type.output_count)
                                                 : lambda.size();
    };
    std::vector<std::uint8_t> marks[BRAMAH_BLOCKS];
    std::uint8_t* mark[BRAMAH_BLOCKS];
    for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
      marks[b].assign(rows_of(block_info[b].rows) * detail::family_size(type, block_info[b].columns) + 1, 0);
      mark[b] = marks[b].data();
    }
    if (type.structure(type.self, memory_, mark) != 0) throw std::runtime_error("structure refused");
    for (int b = 0; b < BRAMAH_BLOCKS; ++b) {
      const std::size_t rows = rows_of(block_info[b].rows), columns = detail::family_size(type, block_info[b].columns);
      starts_[b].assign(1, 0);
      for (std::size_t j = 0; j < columns; ++j) {
        for (std::size_t i = 0; i < rows; ++i) {
          if (marks[b][i * columns + j] != 0) rows_[b].push_back(static_cast<std::int32_t>(i));
        }
        starts_[b].push_back(static_cast<std::int32_t>(rows_[b].size()));
      }
      patterns_[b] = {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns),
                      static_cast<std::int64_t>(rows_[b].size()), starts_[b].data(), rows_[b].data()};
    }
  }

  alignas(C) std::byte memory_[sizeof(C)];
  std::vector<std::int32_t> starts_[BRAMAH_BLOCKS], rows_[BRAMAH_BLOCKS];
  bramah_pattern patterns_[BRAMAH_BLOCKS] = {};
};

}  // namespace bramah::testing
