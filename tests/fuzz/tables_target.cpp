// A library whose tables are drawn from the bytes. Pointers lead to memory that is there and texts end, which nobody could
// check for a stranger; all else may be wrong: names, units, kinds, families, counts, sizes, limits, defaults, extensions.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <memory>
#include <string>

#include "bramah/abi.h"
#include "fuzz/targets.hpp"
#include "io/read_scene.hpp"
#include "system/analysis_error.hpp"
#include "system/compile.hpp"

namespace bramah::fuzz {
namespace {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  /// 0 where there are no more.
  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : std::uint8_t{0}; }
  /// Mostly `usual`: tables with one mistake come further than those with ten.
  template <class T>
  T mostly(T usual, std::initializer_list<T> others) {
    const std::uint8_t b = byte();
    if (b < 224 || others.size() == 0) return usual;
    return *(others.begin() + (b - 224) % static_cast<int>(others.size()));
  }
  const char* text(const char* usual) {
    static constexpr const char* unusual[] = {nullptr, "",   "a",    "x",      "\xff", "/",
                                              "@a",    "\n", "type", "energy", "a.b",  "~1"};
    const std::uint8_t b = byte();
    return b < 224 ? usual : unusual[(b - 224) % std::size(unusual)];
  }
  double number(double usual) { return mostly(usual, {0.0, -1.0, std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, 1e-320}); }
  std::int32_t count(std::int32_t usual) { return mostly(usual, {0, 1, 2, 3, -1, 2147483647, -2147483647}); }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

constexpr const char* kUnits[] = {"m", "N", "Pa", "1", "rad", "m^3/s", "furlong", "m^", "kg.m/s^2", "@unit"};
constexpr const char* kKinds[] = {"coordinate", "frame", "planar_frame", "pressure", "spool", "input", "nothing"};
constexpr const char* kNames[] = {"a", "b", "c", "d", "e", "f", "g", "h"};

constexpr std::size_t most = 4;  // entries of a list; one more stands behind them, of zeros

template <class Info>
using List = std::array<Info, most + 1>;

struct Tables {
  List<bramah_parameter_info> parameters{};
  List<bramah_port_info> ports{};
  List<bramah_variable_info> variables{};
  List<bramah_terminal_info> terminals{};
  List<bramah_row_info> holonomic{}, nonholonomic{}, outputs{}, switch_info{};
  List<bramah_limit_info> limit_info{};
  std::array<double, 64> numbers{};
  std::array<double, most + 1> nominals{};
  const char* choices[3] = {"on", "off", nullptr};
  bramah_switches switches{};
  bramah_validity validity{};
  bramah_constants constants{};
  bramah_signal signal{};
  bramah_energy energy{};
  bramah_type type{};
  const bramah_type* types[2] = {};
  bramah_library library{};
  std::uint8_t offered = 0;  // extensions
};

int configure(const void*, void*, const bramah_value*) { return 0; }
int structure(const void*, const void*, std::uint8_t* const*) { return 0; }
int evaluate(const void*, bramah_batch*) { return 0; }
int values(const void*, const bramah_batch*, double*) { return 0; }
void constants_of(const void*, const void*, double*) {}
double signal_of(const void*, const void*, double, std::int32_t) { return 0.0; }
double breakpoint_of(const void*, const void*, double) { return HUGE_VAL; }

const void* extension_of(const void* self, const char* id) {
  const auto& tables = *static_cast<const Tables*>(self);
  const auto offers = [&](int bit, const char* name) {
    return (tables.offered >> bit & 1) != 0 && std::strcmp(id, name) == 0;
  };
  if (offers(0, BRAMAH_EXTENSION_SWITCHES)) return &tables.switches;
  if (offers(1, BRAMAH_EXTENSION_VALIDITY)) return &tables.validity;
  if (offers(2, BRAMAH_EXTENSION_CONSTANTS)) return &tables.constants;
  if (offers(3, BRAMAH_EXTENSION_SIGNAL)) return &tables.signal;
  return nullptr;
}

void fill_rows(Bytes& bytes, List<bramah_row_info>& rows) {
  for (std::size_t k = 0; k < most; ++k)
    rows[k] = {bytes.mostly(sizeof(bramah_row_info), {std::size_t{0}, std::size_t{8}}), bytes.text(kNames[k]),
               bytes.text("doc"), bytes.text(kUnits[bytes.byte() % std::size(kUnits)])};
}

void fill(Bytes& bytes, Tables& t) {
  for (double& number : t.numbers) number = bytes.number(1.0);
  for (double& number : t.nominals) number = bytes.number(1.0);
  for (std::size_t k = 0; k < most; ++k) {
    bramah_parameter_info& p = t.parameters[k];
    p.size = bytes.mostly(sizeof p, {std::size_t{0}});
    p.name = bytes.text(kNames[k]);
    p.doc = bytes.text("doc");
    p.unit = bytes.text(kUnits[bytes.byte() % std::size(kUnits)]);
    p.kind = bytes.count(bytes.byte() % 6);
    p.required = bytes.byte() % 2;
    p.count = bytes.count(1);
    p.lower = bytes.number(-HUGE_VAL);
    p.upper = bytes.number(HUGE_VAL);
    p.default_numbers = bytes.mostly<const double*>(t.numbers.data(), {nullptr});
    p.default_count = bytes.mostly<std::int64_t>(1, {0, 2, 3, 60, -1});
    p.default_text = bytes.text("on");
    p.choices = bytes.mostly<const char* const*>(t.choices, {nullptr});
  }
  for (std::size_t k = 0; k < most; ++k) {
    bramah_port_info& p = t.ports[k];
    p = {bytes.mostly(sizeof p, {std::size_t{0}}),
         bytes.text(kNames[k + 4]),
         bytes.text("doc"),
         bytes.text(kKinds[bytes.byte() % std::size(kKinds)]),
         bytes.text(kUnits[bytes.byte() % std::size(kUnits)]),
         bytes.count(bytes.byte() % 3),
         bytes.count(1),
         bytes.byte() % 2,
         bytes.mostly<const double*>(t.numbers.data(), {nullptr})};
    bramah_variable_info& v = t.variables[k];
    v = {bytes.mostly(sizeof v, {std::size_t{0}}),
         bytes.text(kNames[k]),
         bytes.text("doc"),
         bytes.text(kUnits[bytes.byte() % std::size(kUnits)]),
         bytes.count(bytes.byte() % 2),
         bytes.number(1.0),
         bytes.number(0.0)};
    bramah_terminal_info& i = t.terminals[k];
    i = {bytes.mostly(sizeof i, {std::size_t{0}}),
         bytes.text(kNames[k]),
         bytes.text("doc"),
         bytes.text(kKinds[bytes.byte() % std::size(kKinds)]),
         bytes.text(kUnits[bytes.byte() % std::size(kUnits)]),
         bytes.count(bytes.byte() % 3),
         bytes.count(1),
         bytes.count(bytes.byte() % 3),
         bytes.count(0)};
    bramah_limit_info& l = t.limit_info[k];
    l.size = bytes.mostly(sizeof l, {std::size_t{0}});
    l.name = bytes.text(kNames[k]);
    l.doc = bytes.text("doc");
    l.unit = bytes.text(kUnits[bytes.byte() % std::size(kUnits)]);
    l.nominal = bytes.number(1.0);
    l.lowest = l.lower = bytes.number(-HUGE_VAL);
    l.upper = l.highest = bytes.number(1.0);
  }
  fill_rows(bytes, t.holonomic);
  fill_rows(bytes, t.nonholonomic);
  fill_rows(bytes, t.outputs);
  fill_rows(bytes, t.switch_info);
  t.offered = bytes.byte();
  t.switches = {.size = sizeof t.switches,
                .count = bytes.count(1),
                .info = t.switch_info.data(),
                .nominal = t.nominals.data(),
                .values = values};
  t.validity = {.size = sizeof t.validity, .count = bytes.count(1), .info = t.limit_info.data(), .values = values};
  t.constants = {.size = sizeof t.constants, .count = bytes.count(1), .values = constants_of};
  t.signal = {.size = sizeof t.signal, .value = signal_of, .next_breakpoint = breakpoint_of};
  bramah_type& type = t.type;
  type.size = bytes.mostly(sizeof type, {std::size_t{0}, std::size_t{16}, ~std::size_t{0}});
  type.self = &t;
  type.name = bytes.text("fuzz/t");
  type.doc = bytes.text("doc");
  type.parameters = t.parameters.data();
  type.parameter_count = bytes.count(bytes.byte() % 5);
  type.ports = t.ports.data();
  type.port_count = bytes.count(bytes.byte() % 5);
  type.variables = t.variables.data();
  type.variable_count = bytes.count(bytes.byte() % 5);
  type.terminals = t.terminals.data();
  type.terminal_count = bytes.count(bytes.byte() % 5);
  type.holonomic = t.holonomic.data();
  type.holonomic_count = bytes.count(bytes.byte() % 3);
  type.nonholonomic = t.nonholonomic.data();
  type.nonholonomic_count = bytes.count(bytes.byte() % 3);
  type.outputs = t.outputs.data();
  type.output_count = bytes.count(bytes.byte() % 3);
  // What the lists add up to, so that tables pass; or not.
  std::int32_t sum[3] = {};
  for (std::int32_t k = 0; k < std::min<std::int32_t>(type.port_count, most); ++k) {
    const bramah_port_info& p = t.ports[static_cast<std::size_t>(k)];
    if (p.family >= 0 && p.family < 3) sum[p.family] += std::clamp(p.slots, 0, 8);
  }
  for (std::int32_t k = 0; k < std::min<std::int32_t>(type.variable_count, most); ++k) {
    const std::int32_t family = t.variables[static_cast<std::size_t>(k)].family;
    if (family >= 0 && family < 2) ++sum[family];
  }
  type.nx = bytes.count(sum[0]);
  type.nz = bytes.count(sum[1]);
  type.nu = bytes.count(sum[2]);
  type.instance_bytes = bytes.mostly<std::size_t>(8, {0, 1, 24, 4096});
  type.instance_align = bytes.mostly<std::size_t>(8, {0, 1, 3, 64});
  type.configure = bytes.mostly(configure, {static_cast<decltype(&configure)>(nullptr)});
  type.structure = bytes.mostly(structure, {static_cast<decltype(&structure)>(nullptr)});
  type.evaluate = bytes.mostly(evaluate, {static_cast<decltype(&evaluate)>(nullptr)});
  type.extension = extension_of;
  t.types[0] = bytes.mostly<const bramah_type*>(&type, {nullptr});
  t.library = {.size = bytes.mostly(sizeof t.library, {std::size_t{0}, ~std::size_t{0}}),
               .epoch = bytes.mostly<std::uint32_t>(BRAMAH_ABI_EPOCH, {0U, 2U}),
               .minor = BRAMAH_ABI_MINOR,
               .name = bytes.text("fuzz"),
               .version = bytes.text("1"),
               .made_with = bytes.text("fuzz"),
               .types = t.types,
               .type_count = bytes.mostly<std::int32_t>(1, {0, 2, -1})};
}

}  // namespace

void tables(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const auto tables = std::make_unique<Tables>();
  fill(bytes, *tables);
  const auto registry = std::make_shared<Registry>();
  try {
    registry->add(&tables->library, "fuzz.so");
  } catch (const PluginError&) {
    return;
  }
  if (registry->find("fuzz/t") == nullptr) return;
  const Source source{"fuzz.json", R"({ "bramah": 1, "libraries": ["mechanics"], "components": {
    "m": { "type": "mechanics/mass", "mass": 1 }, "t": { "type": "fuzz/t", "a": 1, "b": 2, "c": "on", "e": "m.x" } } })"};
  try {
    const Compiled compiled = compile(read_scene_text(source.text, source.name), registry);
    initial_state(compiled.system);
  } catch (const SceneError& error) {
    render(source, error);
  } catch (const AnalysisError& error) {
    render(source, error);
  }
}

}  // namespace bramah::fuzz
