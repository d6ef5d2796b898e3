// From a component struct to the C border: tables, configuration, and the functions of a bramah_type.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "bramah/constraints.hpp"
#include "bramah/describe.hpp"
#include "bramah/evaluate.hpp"
#include "bramah/structure.hpp"

namespace bramah::detail {

template <class C>
concept HasBalance = requires(const C& c, const At<Real>& at, Rows<Real>& rows) {
  c.balance(at, rows);
};
template <class C>
concept HasHolonomic = requires(const C& c, const Positions<Real>& at, Values<Real>& rows) {
  c.holonomic(at, rows);
};
template <class C>
concept HasNonholonomic = requires(const C& c, const Motion<Real>& at, Values<Real>& rows) {
  c.nonholonomic(at, rows);
};
template <class C>
concept HasOutput = requires(const C& c, const At<Real>& at, Values<Real>& y) {
  c.output(at, y);
};
template <class C>
concept HasSwitches = requires(const C& c, const At<Real>& at, Values<Real>& y) {
  c.switches(at, y);
};
template <class C>
concept HasValidity = requires(const C& c, const At<Real>& at, Values<Real>& y) {
  c.validity(at, y);
};
template <class C>
concept HasEnergy = requires(const C& c, const At<Epsilon<Real>>& at) {
  { c.energy(at) } -> std::convertible_to<Epsilon<Real>>;
};
template <class C>
concept HasCheck = requires(const C& c, Faults& faults) {
  c.check(faults);
};
template <class C>
concept HasStart = requires(const C& c, Start& start) {
  c.start(start);
};
template <class C>
concept HasConstants = requires(const C& c, Parameter* values) {
  c.constants(values);
};
template <class C>
concept HasSignal = requires(const C& c) {
  { c.signal(0.0, 1) } -> std::convertible_to<Parameter>;
  { c.next_breakpoint(0.0) } -> std::convertible_to<double>;
};

/// A member of a law's name that cannot serve as that law is a mistake, not another function.
template <class C>
constexpr void check_laws() {
#define BRAMAH_LAW(name, serves, rule)                                                          \
  static_assert(serves || !(                                                                    \
                              requires { &C::template name<Real>; } || requires { &C::name; }), \
                "the law `" #name "` does not fit; write " rule)
  BRAMAH_LAW(balance, HasBalance<C>,
             "template <class T> void balance(const bramah::At<T>& at, bramah::Rows<T>& rows) const");
  BRAMAH_LAW(holonomic, HasHolonomic<C>,
             "template <class T> void holonomic(const bramah::Positions<T>& at, bramah::Values<T>& rows) const");
  BRAMAH_LAW(nonholonomic, HasNonholonomic<C>,
             "template <class T> void nonholonomic(const bramah::Motion<T>& at, bramah::Values<T>& rows) const");
  BRAMAH_LAW(output, HasOutput<C>,
             "template <class T> void output(const bramah::At<T>& at, bramah::Values<T>& y) const");
  BRAMAH_LAW(switches, HasSwitches<C>,
             "template <class T> void switches(const bramah::At<T>& at, bramah::Values<T>& s) const");
  BRAMAH_LAW(validity, HasValidity<C>,
             "template <class T> void validity(const bramah::At<T>& at, bramah::Values<T>& q) const");
  BRAMAH_LAW(energy, HasEnergy<C>, "template <class T> T energy(const bramah::At<T>& at) const");
  BRAMAH_LAW(check, HasCheck<C>, "void check(bramah::Faults& faults) const");
  BRAMAH_LAW(start, HasStart<C>, "void start(bramah::Start& start) const");
  BRAMAH_LAW(constants, HasConstants<C>, "void constants(bramah::Parameter* values) const");
  BRAMAH_LAW(signal, HasSignal<C>,
             "bramah::Parameter signal(double t, int side) const, and double next_breakpoint(double t) const");
  BRAMAH_LAW(next_breakpoint, HasSignal<C>,
             "double next_breakpoint(double t) const, and bramah::Parameter signal(double t, int side) const");
#undef BRAMAH_LAW
  static_assert(
      requires(C & c, Description & is) { c.describe(is); },
      "a component needs `void describe(bramah::Description& is)`");
  static_assert(!HasEnergy<C> || HasBalance<C> || HasHolonomic<C> || HasNonholonomic<C>,
                "the component says what it stores and has no law that stores it: is `balance` misspelt?");
}

/// Why an entry of the border failed that has no other way to say so: of the last exception in this thread.
inline std::string& last_fault() {
  static thread_local std::string text;
  return text;
}
/// To be called in a catch block.
inline void note_fault() noexcept {
  try {
    try {
      throw;
    } catch (const std::exception& error) {
      last_fault() = error.what();
    } catch (...) {
      last_fault() = "an exception that is no std::exception";
    }
  } catch (...) {  // no memory for its text
  }
}
inline const char* take_fault(const void* = nullptr) noexcept {
  static thread_local std::string told;
  told.swap(last_fault());
  last_fault().clear();
  return told.c_str();
}
/// `does()`, or `otherwise` with the exception noted.
template <class Does, class Result>
Result guarded(const Does& does, Result otherwise) noexcept {
  try {
    return does();
  } catch (...) {
    note_fault();
    return otherwise;
  }
}

/// What the border knows of one component type: its tables and the C struct that points into them.
struct TypeEntry {
  TypeTables tables;
  bramah_type type{};
  bramah_constants constants{};
  bramah_signal signal{};
  bramah_switches switches{};
  bramah_validity validity{};
  bramah_typical typical{};
  bramah_fault fault{};
  bramah_tangent tangent{};
  bramah_energy energy{};
};

template <class C>
struct Border {
  static const TypeEntry& entry(const void* self) { return *static_cast<const TypeEntry*>(self); }

  static int configure(const void* self, void* memory, const bramah_value* values) noexcept {
    return configure_moving(self, memory, values, nullptr);
  }
  static int configure_moving(const void* self, void* memory, const bramah_value* values,
                              const bramah_value* tangents) noexcept {
    try {
      C* component = new (memory) C{};
      Description is(entry(self).tables, values, tangents);
      component->describe(is);
      if (is.repeats()) return 0;
      component->~C();
      last_fault() = "describe says something else than when the library was loaded";
      return -1;
    } catch (...) {
      note_fault();
      return -1;
    }
  }
  static void destroy(const void*, void* instance) noexcept { static_cast<C*>(instance)->~C(); }

  static void check(const void*, const void* instance, bramah_report report, void* context) noexcept {
    if constexpr (HasCheck<C>) {
      try {
        Faults faults(report, context);
        static_cast<const C*>(instance)->check(faults);
      } catch (...) {
        note_fault();
        const std::string found = std::string("the component's check failed with an exception: ") + take_fault();
        report(context, nullptr, found.c_str(), "a check that reports faults");
      }
    }
  }
  static void start(const void* self, const void* instance, double* x, double* v, double* z) noexcept {
    start_values(self, instance, x, v, z, [](double& to, const Parameter& from) { to = from.value(); });
  }
  static void start_tangents(const void* self, const void* instance, double* x, double* v, double* z) noexcept {
    start_values(self, instance, x, v, z, [](double& to, const Parameter& from) { to = from.tangent(); });
  }
  template <class Give>
  static void start_values(const void* self, const void* instance, double* x, double* v, double* z,
                           const Give& give) noexcept {
    if constexpr (HasStart<C>) {
      const TypeTables& tables = entry(self).tables;
      const int own_x = tables.own_slots[BRAMAH_X], own_z = tables.own_slots[BRAMAH_Z];
      Parameter list[3][most_columns];  // own x, v, z
      double* const given[3] = {x, v, z};
      const int counts[3] = {tables.own_slots[BRAMAH_X], tables.own_slots[BRAMAH_X], tables.own_slots[BRAMAH_Z]};
      for (int f = 0; f < 3; ++f) std::copy_n(given[f], counts[f], list[f]);
      Start start(tables, list[0], list[1], list[2]);
      if (!guarded([&] { return static_cast<const C*>(instance)->start(start), true; }, false)) {
        std::fill_n(x, own_x, std::nan(""));
        std::fill_n(v, own_x, std::nan(""));
        std::fill_n(z, own_z, std::nan(""));
        return;
      }
      for (int f = 0; f < 3; ++f) {
        for (int k = 0; k < counts[f]; ++k) give(given[f][k], list[f][k]);
      }
    }
  }
  static int structure(const void* self, const void* instance, std::uint8_t* const* mark) noexcept {
    try {
      const bramah_type& type = entry(self).type;
      const C& component = *static_cast<const C*>(instance);
      Structure marks(type, mark);
      const char* refused = nullptr;
      if constexpr (HasBalance<C>) {
        refused =
            trace_rows(type, component, marks, balance_blocks, family_size(type, X), family_size(type, Z), balance_law);
      }
      if constexpr (HasHolonomic<C>) trace_holonomic(type, component, marks);
      if constexpr (HasNonholonomic<C>) {
        trace_nonholonomic(type, component, marks);
        check_affine(type, component);
      }
      if constexpr (HasOutput<C>) {
        const char* also = trace_rows(type, component, marks, output_blocks,
                                      static_cast<std::size_t>(type.output_count), 0, output_law);
        if (refused == nullptr) refused = also;
      }
      if constexpr (HasSwitches<C>) {
        trace_values(type, entry(self).tables.switches, "switching function",
                     [&](const At<Trace>& at, Values<Trace>& out) { component.switches(at, out); });
      }
      if constexpr (HasValidity<C>) {
        trace_values(type, entry(self).tables.limits, "limit",
                     [&](const At<Trace>& at, Values<Trace>& out) { component.validity(at, out); });
      }
      if (refused == nullptr) return 0;
      last_fault() = std::string("it couples what no block can hold: ") + refused;
      return -1;
    } catch (...) {
      note_fault();
      return -2;
    }
  }
  static int evaluate(const void* self, bramah_batch* b) noexcept {
    static constexpr bramah_direction still{
        sizeof(bramah_direction), nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr};
    return evaluate_as<Exact>(self, *b, still);
  }
  static int evaluate_tangents(const void* self, bramah_batch* b, const bramah_direction* along) noexcept {
    return evaluate_as<AlongDirection>(self, *b, *along);
  }
  template <class As>
  static int evaluate_as(const void* self, bramah_batch& b, const bramah_direction& along) noexcept {
    try {
      const bramah_type& type = entry(self).type;
      if (wanted(b, BRAMAH_L_X)) {
        std::memset(b.partials[BRAMAH_L_X], 0,
                    static_cast<std::size_t>(b.count * b.patterns[BRAMAH_L_X].count) * sizeof(double));
      }
      if constexpr (HasBalance<C>) {
        const auto nx = family_size(type, X), nz = family_size(type, Z);
        if (b.f != nullptr || b.g != nullptr || wants_any(b, BRAMAH_F_X, BRAMAH_G_U)) {
          evaluate_rows<C, As>(type, b, along, balance_blocks, nx, nz, b.f, b.g, balance_law);
        }
      } else {
        // Joints and volumes add nothing themselves; whoever sums the balances still reads their records.
        if (b.f != nullptr) std::memset(b.f, 0, static_cast<std::size_t>(b.count * type.nx) * sizeof(double));
        if (b.g != nullptr) std::memset(b.g, 0, static_cast<std::size_t>(b.count * type.nz) * sizeof(double));
      }
      if constexpr (HasHolonomic<C>) evaluate_holonomic<C, As>(type, b, along);
      if constexpr (HasNonholonomic<C>) evaluate_nonholonomic<C, As>(type, b, along);
      if constexpr (HasOutput<C>) {
        if (b.y != nullptr || wants_any(b, BRAMAH_Y_X, BRAMAH_Y_LAMBDA)) {
          const auto ny = static_cast<std::size_t>(type.output_count);
          evaluate_rows<C, As>(type, b, along, output_blocks, ny, 0, b.y, nullptr, output_law);
        }
      }
      return 0;
    } catch (const std::exception& error) {
      std::snprintf(b.message, sizeof b.message, "%s", error.what());
      return -1;
    } catch (...) {
      std::snprintf(b.message, sizeof b.message, "unknown exception");
      return -1;
    }
  }
  static bool wants_any(const bramah_batch& b, int first, int last) {
    for (int block = first; block <= last; ++block) {
      if (wanted(b, block)) return true;
    }
    return false;
  }

  static void constants(const void* self, const void* instance, double* values) noexcept {
    give_constants(self, instance, [values](int k, const Parameter& c) { values[k] = c.value(); });
  }
  static void constant_tangents(const void* self, const void* instance, double* values) noexcept {
    give_constants(self, instance, [values](int k, const Parameter& c) { values[k] = c.tangent(); });
  }
  template <class Give>
  static void give_constants(const void* self, const void* instance, const Give& give) noexcept {
    if constexpr (HasConstants<C>) {
      Parameter list[most_columns];
      const bool given = guarded([&] { return static_cast<const C*>(instance)->constants(list), true; }, false);
      for (int k = 0; k < entry(self).tables.constants; ++k) give(k, given ? list[k] : Parameter(std::nan("")));
    }
  }
  static double signal(const void*, const void* instance, double t, std::int32_t side) noexcept {
    if constexpr (HasSignal<C>) {
      return guarded([&] { return Parameter(static_cast<const C*>(instance)->signal(t, side)).value(); }, std::nan(""));
    }
    return 0.0;
  }
  static double signal_tangent(const void*, const void* instance, double t, std::int32_t side) noexcept {
    if constexpr (HasSignal<C>) {
      return guarded([&] { return Parameter(static_cast<const C*>(instance)->signal(t, side)).tangent(); },
                     std::nan(""));
    }
    return 0.0;
  }
  static double next_breakpoint(const void*, const void* instance, double t) noexcept {
    if constexpr (HasSignal<C>)
      return guarded([&]() -> double { return static_cast<const C*>(instance)->next_breakpoint(t); }, std::nan(""));
    return HUGE_VAL;
  }
  /// `law(component, at, out)` of every instance: `count` numbers each.
  template <class Law>
  static int state_values(const void* self, const bramah_batch* b, std::size_t count, double* values,
                          const Law& law) noexcept try {
    const auto* instances = static_cast<const C*>(b->instances);
    for (std::size_t i = 0; i < static_cast<std::size_t>(b->count); ++i) {
      Local<Real> local(entry(self).type, *b, bramah_direction{}, i);
      Real list[most_columns];
      Values<Real> out(list);
      law(instances[i], local.at(b->time, b->side), out);
      for (std::size_t k = 0; k < count; ++k) values[i * count + k] = list[k].value();
    }
    return 0;
  } catch (...) {
    note_fault();
    return -1;
  }
  static int switch_values(const void* self, const bramah_batch* b, double* values) noexcept {
    if constexpr (HasSwitches<C>) {
      return state_values(self, b, entry(self).tables.switches.size(), values,
                          [](const C& c, const At<Real>& at, Values<Real>& out) { c.switches(at, out); });
    }
    return 0;
  }
  static int validity_values(const void* self, const bramah_batch* b, double* values) noexcept {
    if constexpr (HasValidity<C>) {
      return state_values(self, b, entry(self).tables.limits.size(), values,
                          [](const C& c, const At<Real>& at, Values<Real>& out) { c.validity(at, out); });
    }
    return 0;
  }

  static int energy_values(const void* self, const bramah_batch* b, const bramah_direction* along, double* energy,
                           double* rate) noexcept try {
    if constexpr (HasEnergy<C>) {
      const auto* instances = static_cast<const C*>(b->instances);
      for (std::size_t i = 0; i < static_cast<std::size_t>(b->count); ++i) {
        Local<Epsilon<Real>> local(entry(self).type, *b, *along, i);
        const Epsilon<Real> E = instances[i].energy(local.at(b->time, b->side));
        energy[i] = E.v.value();
        rate[i] = E.d.value();
      }
    }
    return 0;
  } catch (...) {
    note_fault();
    return -1;
  }

  static const void* extension(const void* self, const char* id) noexcept {
    const TypeEntry& e = entry(self);
    if (HasConstants<C> && std::strcmp(id, BRAMAH_EXTENSION_CONSTANTS) == 0) return &e.constants;
    if (HasSignal<C> && std::strcmp(id, BRAMAH_EXTENSION_SIGNAL) == 0) return &e.signal;
    if (HasSwitches<C> && std::strcmp(id, BRAMAH_EXTENSION_SWITCHES) == 0) return &e.switches;
    if (HasValidity<C> && std::strcmp(id, BRAMAH_EXTENSION_VALIDITY) == 0) return &e.validity;
    if (HasEnergy<C> && std::strcmp(id, BRAMAH_EXTENSION_ENERGY) == 0) return &e.energy;
    if (std::strcmp(id, BRAMAH_EXTENSION_TANGENT) == 0) return &e.tangent;
    if (std::strcmp(id, BRAMAH_EXTENSION_TYPICAL) == 0) return &e.typical;
    if (std::strcmp(id, BRAMAH_EXTENSION_FAULT) == 0) return &e.fault;
    return nullptr;
  }
  static void fill_extensions(TypeEntry& e) {
    e.constants = {sizeof(bramah_constants), e.tables.constants, &Border::constants};
    e.signal = {sizeof(bramah_signal), &Border::signal, &Border::next_breakpoint};
    e.switches = {sizeof(bramah_switches), static_cast<std::int32_t>(e.tables.switches.size()),
                  e.tables.switches.data(), e.tables.switch_nominal.data(), &Border::switch_values};
    e.validity = {sizeof(bramah_validity), static_cast<std::int32_t>(e.tables.limits.size()), e.tables.limits.data(),
                  &Border::validity_values};
    e.typical = {sizeof(bramah_typical), e.tables.typical_lower.data(), e.tables.typical_upper.data()};
    e.fault = {sizeof(bramah_fault), &take_fault};
    e.energy = {sizeof(bramah_energy), &Border::energy_values};
    e.tangent = {sizeof(bramah_tangent),
                 e.tables.differentiable.data(),
                 &Border::configure_moving,
                 &Border::evaluate_tangents,
                 HasStart<C> ? &Border::start_tangents : nullptr,
                 HasConstants<C> ? &Border::constant_tangents : nullptr,
                 HasSignal<C> ? &Border::signal_tangent : nullptr};
  }
};

/// Fills `entry` for component C.
template <class C>
void describe_type(TypeEntry& entry) {
  check_laws<C>();
  C prototype{};
  Description is(entry.tables);
  prototype.describe(is);
  const TypeTables& t = entry.tables;
  const auto need = [&](bool said, bool written, const char* what, const char* law) {
    if (said && !written)
      throw std::logic_error(t.name + " declares " + what + " and has no method `" + law + "` that gives them");
    if (!said && written)
      throw std::logic_error(t.name + " has a method `" + law + "`, and describe declares no " + what + " for it");
  };
  need(!t.holonomic.empty(), HasHolonomic<C>, "holonomic rows", "holonomic");
  need(!t.nonholonomic.empty(), HasNonholonomic<C>, "nonholonomic rows", "nonholonomic");
  need(!t.outputs.empty(), HasOutput<C>, "outputs", "output");
  need(!t.switches.empty(), HasSwitches<C>, "switching functions", "switches");
  need(!t.limits.empty(), HasValidity<C>, "limits of validity", "validity");
  need(t.constants > 0, HasConstants<C>, "constants", "constants");
  need(t.signals > 0, HasSignal<C>, "signals", "signal");
  constexpr bool lawless = !HasBalance<C> && !HasHolonomic<C> && !HasNonholonomic<C> && !HasOutput<C>;
  if (lawless && t.variables.empty() && t.constants == 0 && t.signals == 0)
    throw std::logic_error(t.name + " has no law, owns no variable and gives nothing: is the name of a law misspelt?");
  const auto rows = static_cast<int>(t.holonomic.size() + t.nonholonomic.size());
  if (3 * t.slots(BRAMAH_X) + 2 * t.slots(BRAMAH_Z) + t.slots(BRAMAH_U) + rows > static_cast<int>(most_columns)) {
    throw std::length_error(t.name + " has more local variables than one component may have");
  }
  if (t.constants > static_cast<int>(most_columns) || t.switches.size() > most_columns ||
      t.limits.size() > most_columns) {
    throw std::length_error(t.name + " has more constants, switching functions or limits than one component may have");
  }
  const auto count = [](const auto& list) { return static_cast<std::int32_t>(list.size()); };
  entry.type = bramah_type{
      .size = sizeof(bramah_type),
      .name = t.name.c_str(),
      .doc = t.doc.c_str(),
      .parameters = t.parameters.data(),
      .ports = t.ports.data(),
      .variables = t.variables.data(),
      .terminals = t.terminals.data(),
      .holonomic = t.holonomic.data(),
      .nonholonomic = t.nonholonomic.data(),
      .outputs = t.outputs.data(),
      .parameter_count = count(t.parameters),
      .port_count = count(t.ports),
      .variable_count = count(t.variables),
      .terminal_count = count(t.terminals),
      .holonomic_count = count(t.holonomic),
      .nonholonomic_count = count(t.nonholonomic),
      .output_count = count(t.outputs),
      .nx = t.slots(BRAMAH_X),
      .nz = t.slots(BRAMAH_Z),
      .nu = t.slots(BRAMAH_U),
      .instance_bytes = sizeof(C),
      .instance_align = alignof(C),
      .self = &entry,
      .configure = &Border<C>::configure,
      .destroy = &Border<C>::destroy,
      .check = &Border<C>::check,
      .start = &Border<C>::start,
      .structure = &Border<C>::structure,
      .evaluate = &Border<C>::evaluate,
      .extension = &Border<C>::extension,
  };
  Border<C>::fill_extensions(entry);
}

template <class... Cs>
const bramah_library* library(const char* name, const char* version) noexcept try {
  struct Tables {
    TypeEntry entries[sizeof...(Cs)];
    const bramah_type* types[sizeof...(Cs)];
    bramah_library library;
  };
  static const std::unique_ptr<Tables> tables = [&] {
    auto made = std::make_unique<Tables>();
    std::size_t k = 0;
    (describe_type<Cs>(made->entries[k++]), ...);
    for (std::size_t i = 0; i < sizeof...(Cs); ++i) made->types[i] = &made->entries[i].type;
    made->library = {sizeof(bramah_library),
                     BRAMAH_ABI_EPOCH,
                     BRAMAH_ABI_MINOR,
                     name,
                     version,
                     __VERSION__,
                     made->types,
                     static_cast<std::int32_t>(sizeof...(Cs))};
    return made;
  }();
  return &tables->library;
} catch (...) {
  note_fault();
  return nullptr;  // no exception crosses the border; the engine asks for its text
}

}  // namespace bramah::detail

/// The one exported function of a library: BRAMAH_LIBRARY("valves", "1.0.0", ThrottleValve, CheckValve)
#define BRAMAH_LIBRARY(name, version, ...)                                                          \
  extern "C" __attribute__((visibility("default"))) const bramah_library* bramah_library_v1(void) { \
    return bramah::detail::library<__VA_ARGS__>(name, version);                                     \
  }                                                                                                 \
  extern "C" __attribute__((visibility("default"))) const char* bramah_library_fault_v1(void) {     \
    return bramah::detail::take_fault();                                                            \
  }
