#include "system/system.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>

#include "plugin/border.hpp"
#include "system/analysis_error.hpp"
#include "system/message.hpp"
#include "system/scene.hpp"
#include "system/units.hpp"

namespace bramah {
namespace {

constexpr unsigned char guard = 0xa5;

}  // namespace

Instances::Instances(const bramah_type& type, Index count)
    : type_(&type),
      memory_(static_cast<unsigned char*>(::operator new(
          type.instance_bytes* static_cast<std::size_t>(count) + guard_bytes, std::align_val_t(type.instance_align)))) {
}

Instances::Instances(Instances&& other) noexcept
    : type_(other.type_), memory_(other.memory_), constructed_(other.constructed_) {
  other.memory_ = nullptr;
  other.constructed_ = 0;
}

void* Instances::next() {
  std::memset(at(constructed_ + 1), guard, guard_bytes);
  return at(constructed_);
}

bool Instances::constructed() {
  const auto* behind = static_cast<const unsigned char*>(at(++constructed_));
  return std::all_of(behind, behind + guard_bytes, [](unsigned char byte) { return byte == guard; });
}

Instances::~Instances() {
  if (memory_ == nullptr) return;
  const AtBorder border("destroy", "an instance", *type_);
  for (Index i = 0; type_->destroy != nullptr && i < constructed_; ++i) type_->destroy(type_->self, at(i));
  ::operator delete(memory_, std::align_val_t(type_->instance_align));
}

Index System::spools() const {
  return std::count_if(z.begin(), z.end(), [](const Variable& v) { return v.kind == "spool"; });
}

double Scales::of(std::string_view unit) const {
  const std::optional<Unit> parsed = parse_unit(unit);
  if (!parsed) return 1.0;
  double m = parsed->twice[0], kg = parsed->twice[1], s = parsed->twice[2], product = 1.0;
  if (m == -2.0 && kg == 2.0) {  // a pressure, or one per time
    product = pressure / Scales().pressure;
    s += 4.0;
    m = kg = 0.0;
  }
  const auto power = [](double base, double twice) { return twice == 0.0 ? 1.0 : std::pow(base, 0.5 * twice); };
  return product * power(length, m) * power(mass, kg) * power(time, s);
}

double System::rate_nominal(Index i) const {
  return i < m() ? constraint(i).nominal / scales.time : constraint(i).nominal;
}

double System::multiplier_nominal(Index i) const { return scales.energy() / (rate_nominal(i) * scales.time); }

const Row& System::constraint(Index i) const {
  return i < m() ? holonomic[static_cast<std::size_t>(i)] : nonholonomic[static_cast<std::size_t>(i - m())];
}

double System::assembly_tolerance_of(const Row& row) const {
  return row.unit == "m" ? assembly_tolerance : rank_tolerance() * row.nominal;
}

std::string System::multiplier_name(Index i) const {
  const std::string& name = constraint(i).name;
  const std::size_t dot = name.find('.');
  return name.substr(0, dot + 1) + "lambda_" + name.substr(dot + 1);
}

std::string System::multiplier_unit(Index i) const {
  const std::string& unit = constraint(i).unit;
  if (unit == "m") return "N";
  if (unit == "rad") return "N.m";
  if (unit == "m/s") return "N";  // b is affine in v, so its multiplier is a force, too
  if (unit == "1") return "N.m";
  return "J/(" + unit + ")";
}

const std::string& System::component_name(Index component) const {
  return components[static_cast<std::size_t>(component)].name;
}

std::vector<bramah_value> parameter_values(const std::vector<std::vector<double>>& numbers,
                                           const std::vector<std::string>& texts) {
  std::vector<bramah_value> values;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    values.push_back(
        {sizeof(bramah_value), numbers[i].data(), static_cast<Index>(numbers[i].size()), texts[i].c_str()});
  }
  return values;
}

std::string parameter_unit(const bramah_type& type, const char* unit, const std::vector<std::string>& texts) {
  if (unit[0] != '@') return unit;
  for (std::int32_t i = 0; i < type.parameter_count; ++i) {
    if (std::string_view(type.parameters[i].name) == unit + 1) return texts[static_cast<std::size_t>(i)];
  }
  return "";
}

namespace {
Index find(const std::vector<Variable>& list, std::string_view name) {
  const auto it = std::find_if(list.begin(), list.end(), [&](const Variable& v) { return v.name == name; });
  return it == list.end() ? -1 : it - list.begin();
}
}  // namespace

Index System::find_x(std::string_view name) const { return find(x, name); }
Index System::find_z(std::string_view name) const { return find(z, name); }

State initial_state(const System& system, double t) {
  State state;
  state.t = t;
  const std::size_t x_size = system.x.size() + system.x_constants.size();
  state.x.resize(x_size);
  state.v.assign(x_size, 0.0);
  state.a.assign(x_size, 0.0);
  for (std::size_t i = 0; i < system.x.size(); ++i) {
    state.x[i] = system.x[i].start;
    state.v[i] = system.x[i].start_rate;
  }
  std::copy(system.x_constants.begin(), system.x_constants.end(), state.x.begin() + system.n());
  const std::size_t z_size = system.z.size() + system.inputs.size() + system.z_constants.size();
  state.z.resize(z_size);
  state.zdot.assign(z_size, 0.0);
  for (std::size_t i = 0; i < system.z.size(); ++i) state.z[i] = system.z[i].start;
  std::copy(system.z_constants.begin(), system.z_constants.end(), state.z.begin() + system.nz() + system.nu());
  state.lambda.assign(system.holonomic.size() + system.nonholonomic.size(), 0.0);
  apply_inputs(system, state);
  return state;
}

namespace {

[[noreturn]] void refuse_signal(const System& system, const InputSignal& input, double t, double value,
                                const std::string& expected) {
  const std::string why = take_fault(*input.type);
  throw AnalysisError("inputs",
                      "the signal " + input.name + " (" + input.type->name + ") gives " + digits(value, 17) +
                          " at t = " + digits(t, 17) + " s" + (why.empty() ? "" : ": " + why),
                      expected, "check its parameters; if they are sound this is a fault of its library",
                      pointer("/components", system.component_name(input.component)));
}

}  // namespace

void apply_inputs(const System& system, State& state) {
  for (std::size_t i = 0; i < system.inputs.size(); ++i) {
    const InputSignal& input = system.inputs[i];
    const AtBorder at("signal", input.name.c_str(), *input.type);
    double& value = state.z[system.z.size() + i];
    value = input.signal->value(input.type->self, input.instance, state.t, state.side);
    if (!std::isfinite(value)) refuse_signal(system, input, state.t, value, "a finite value");
  }
  for (const auto& [input, value] : state.held) state.z[system.z.size() + static_cast<std::size_t>(input)] = value;
}

bramah_batch batch_of(const Group& group, const State& state, Index first, Index count) {
  bramah_batch batch{};
  batch.size = sizeof batch;
  batch.count = count;
  batch.instances = group.instances.at(first);
  batch.time = state.t;
  batch.side = state.side;
  batch.patterns = group.pattern_views.data();
  return batch;
}

double next_breakpoint(const System& system, double t) {
  double next = HUGE_VAL;
  for (const InputSignal& input : system.inputs) {
    const AtBorder at("next_breakpoint", input.name.c_str(), *input.type);
    const double its = input.signal->next_breakpoint(input.type->self, input.instance, t);
    if (!(its > t)) refuse_signal(system, input, t, its, "a next breakpoint after this time, or infinity");
    next = std::min(next, its);
  }
  return next;
}

}  // namespace bramah
