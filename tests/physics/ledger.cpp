#include "ledger.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <set>
#include <stdexcept>

namespace bramah::testing {
namespace {

using Pair = std::array<double, 2>;

/// One component: its numbers and the places of its variables by name.
class Part {
 public:
  Part(const System& system, const Component& component)
      : component_(component), type_(*component.type), group_(system.groups[std::size_t(component.group)]) {}

  [[nodiscard]] double number(const char* name, std::size_t element = 0) const {
    for (std::int32_t k = 0; k < type_.parameter_count; ++k) {
      if (std::strcmp(type_.parameters[k].name, name) == 0) return component_.numbers[std::size_t(k)][element];
    }
    throw std::out_of_range(component_.name + " has no parameter " + name);
  }
  [[nodiscard]] Pair pair(const char* name) const { return {number(name, 0), number(name, 1)}; }
  [[nodiscard]] std::size_t x(const char* name) const { return place(name, BRAMAH_X, group_.x, type_.nx); }
  [[nodiscard]] std::size_t z(const char* name) const { return place(name, BRAMAH_Z, group_.z, type_.nz); }
  [[nodiscard]] std::size_t u(const char* name) const { return place(name, BRAMAH_U, group_.u, type_.nu); }
  [[nodiscard]] std::size_t y(const char* name) const {
    for (std::int32_t k = 0; k < type_.output_count; ++k) {
      if (std::strcmp(type_.outputs[k].name, name) == 0)
        return std::size_t(group_.first_output[std::size_t(component_.position)] + k);
    }
    throw std::out_of_range(component_.name + " has no output " + name);
  }

 private:
  [[nodiscard]] std::size_t place(const char* name, int family, const std::vector<std::int32_t>& places,
                                  std::int32_t count) const {
    std::int32_t slot = 0;
    const auto found = [&] { return std::size_t(places[std::size_t(component_.position * count + slot)]); };
    for (std::int32_t k = 0; k < type_.port_count; ++k) {
      if (type_.ports[k].family != family) continue;
      if (std::strcmp(type_.ports[k].name, name) == 0) return found();
      slot += type_.ports[k].slots;
    }
    for (std::int32_t k = 0; k < type_.variable_count; ++k) {
      if (type_.variables[k].family != family) continue;
      if (std::strcmp(type_.variables[k].name, name) == 0) return found();
      ++slot;
    }
    throw std::out_of_range(component_.name + " has no variable " + name);
  }
  const Component& component_;
  const bramah_type& type_;
  const Group& group_;
};

Pair turned(double angle, const Pair& r) {
  return {std::cos(angle) * r[0] - std::sin(angle) * r[1], std::sin(angle) * r[0] + std::cos(angle) * r[1]};
}
Pair position(const State& s, std::size_t body, const Pair& point) {
  const Pair r = turned(s.x[body + 2], point);
  return {s.x[body] + r[0], s.x[body + 1] + r[1]};
}
Pair velocity(const State& s, std::size_t body, const Pair& point) {
  const Pair r = turned(s.x[body + 2], point);
  return {s.v[body] - s.v[body + 2] * r[1], s.v[body + 1] + s.v[body + 2] * r[0]};
}

// Types that neither hold nor turn over anything by themselves.
const std::set<std::string> silent = {"mechanics/ground",        "mechanics/gravity", "mechanics/planar_revolute",
                                      "mechanics/planar_stroke", "hydraulics/volume", "hydraulics/pressure_source",
                                      "signals/constant",        "signals/table"};

}  // namespace

Ledger::Ledger(const Machine& machine) : system_(machine.system()), blocks_(machine.system()) {
  for (const Component& component : system_.components) take_in(component);
}

void Ledger::take_in(const Component& component) {
  const Part part(system_, component);
  const std::string type = component.type->name;
  if (silent.contains(type)) return;
  if (type == "hydraulics/throttle" || type == "hydraulics/leakage" || type == "hydraulics/relief_valve" ||
      type == "hydraulics/check_valve" || type == "hydraulics/centre_path") {
    resistors_.push_back({part.z("a"), part.z("b"), part.y("flow")});
  } else if (type == "hydraulics/pump") {
    pumps_.push_back({part.z("inlet"), part.z("outlet"), part.y("flow")});
  } else if (type == "hydraulics/pipe") {
    const double d = part.number("d"), l = part.number("l"), area = std::numbers::pi * d * d / 4.0;
    pipes_.push_back({part.z("a"), part.z("b"), part.z("Q"),
                      128.0 * part.number("mu") * l / (std::numbers::pi * std::pow(d, 4)),
                      part.number("rho_oil") * l / area});
  } else if (type == "hydraulics/directional_valve") {
    valves_.push_back(
        {part.z("pump"), part.z("tank"), part.z("A"), part.z("B"), part.z("U"), part.y("flow_A"), part.y("flow_B")});
  } else if (type == "hydraulics/hose") {
    hoses_.push_back({part.z("volume"), part.number("V_h") * (1.0 / part.number("B_oil") + 1.0 / part.number("B_h"))});
  } else if (type == "hydraulics/cylinder") {
    const double D_2 = part.number("D_2"), D_3 = part.number("D_3"), dead = part.number("c_1") + part.number("c_2");
    const double A_2 = std::numbers::pi * D_2 * D_2 / 4.0, A_3 = A_2 - std::numbers::pi * D_3 * D_3 / 4.0;
    cylinders_.push_back(
        {part.x("stroke"),
         {{{part.z("piston_side"), A_2, -dead, 1.0}, {part.z("rod_side"), A_3, part.number("l") + dead, -1.0}}},
         1.0 / part.number("B_oil") + 1.0 / part.number("B_c"),
         {},
         {}});
  } else if (type == "friction/brown_mcphee" || type == "friction/stick_slip") {
    frictions_.push_back({part.x("along"), part.y("force")});
  } else if (type == "mechanics/end_stop") {
    stops_.push_back({part.x("along"), part.y("force"), part.y("depth"),
                      0.5 * (part.number("lower") + part.number("upper")), part.number("stiffness")});
  } else if (type == "mechanics/planar_body") {
    const std::size_t g = part.u("gravity");
    bodies_.push_back({part.x("x"), part.number("mass"), part.number("inertia"), {g, g + 1}});
  } else if (type == "mechanics/planar_bushing") {
    if (part.x("a") < std::size_t(system_.n())) throw std::invalid_argument("bushings on the ground only");
    bushings_.push_back(
        {part.x("b"), part.pair("point_a"), part.pair("point_b"), part.pair("stiffness"), part.pair("damping")});
  } else if (type == "mechanics/planar_force") {
    const Pair d = part.pair("direction");
    const double length = std::hypot(d[0], d[1]);
    loads_.push_back({part.x("on"), part.u("magnitude"), part.pair("point"), {d[0] / length, d[1] / length}});
  } else {
    throw std::invalid_argument("no book is kept of " + type);
  }
}

Simulation Ledger::keep(const SimulateOptions& options, const State& start) {
  std::vector<double> steps = {start.t};
  Observer pace;
  pace.progress = [&](double t, double) {
    steps.push_back(t);
    return true;
  };
  simulate(system_, options, start, pace);
  // Gauss with two points: steps are short against all that moves, as the error test sees to.
  const double node = 1.0 / std::numbers::sqrt3;
  SimulateOptions marked = options;
  marked.output_step = 0.0;
  marked.output_times.clear();
  std::vector<double> weights;
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const double middle = 0.5 * (steps[k - 1] + steps[k]), half = 0.5 * (steps[k] - steps[k - 1]);
    for (const int side : {-1, 1}) {
      const double t = middle + side * node * half;
      if (!marked.output_times.empty() && t <= marked.output_times.back()) continue;  // a step of a few ulp
      marked.output_times.push_back(t);
      weights.push_back(half);
    }
  }
  entered_.assign(start.z.size(), 0.0);
  passed_ = entered_;
  std::size_t next = 0;
  bool first = true;
  Observer bookkeeper;
  bookkeeper.output = [&](const State& state) {
    end_ = state;
    if (first) start_ = state;
    first = false;
    if (next < weights.size() && state.t == marked.output_times[next]) add(state, weights[next++]);
  };
  Simulation simulation = simulate(system_, marked, start, bookkeeper);
  if (next != weights.size()) throw std::logic_error("the second run passed over times of the first");
  const auto in_stops = [&](const State& state) {
    blocks_.evaluate(system_, state, Request{}.rows("y"));
    double sum = 0.0;
    for (const Stop& stop : stops_) sum += 0.5 * stop.stiffness * blocks_.y[stop.depth] * blocks_.y[stop.depth];
    return sum;
  };
  stops_at_start_ = in_stops(start_);
  stops_at_end_ = in_stops(end_);
  return simulation;
}

void Ledger::move(std::size_t from, std::size_t to, double flow, double weight) {
  entered_[from] -= weight * flow;
  entered_[to] += weight * flow;
  passed_[from] += weight * std::abs(flow);
  passed_[to] += weight * std::abs(flow);
}

void Ledger::add(const State& state, double weight) {
  blocks_.evaluate(system_, state, Request{}.rows("y"));
  const Vector &y = blocks_.y, &z = state.z;
  const auto resist = [&](std::size_t from, std::size_t to, double flow) {
    move(from, to, flow, weight);
    dissipated_ += weight * flow * (z[from] - z[to]);
  };
  for (const Resistor& r : resistors_) resist(r.a, r.b, y[r.flow]);
  for (const Valve& v : valves_) {
    const bool ahead = z[v.U] > 0.0;
    resist(ahead ? v.pump : v.tank, v.A, y[v.flow_A]);
    resist(ahead ? v.tank : v.pump, v.B, y[v.flow_B]);
  }
  for (const Pipe& p : pipes_) {
    move(p.a, p.b, z[p.Q], weight);
    dissipated_ += weight * p.R * z[p.Q] * z[p.Q];
  }
  for (const Resistor& p : pumps_) {
    move(p.a, p.b, y[p.flow], weight);
    pumped_ += weight * y[p.flow] * (z[p.b] - z[p.a]);
  }
  for (Cylinder& cylinder : cylinders_) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double p = z[cylinder.chambers[k].p], ldot = cylinder.chambers[k].slope * state.v[cylinder.stroke];
      cylinder.p_ldot[k] += weight * p * ldot;
      cylinder.p2_ldot[k] += weight * p * p * ldot;
    }
  }
  for (const Friction& f : frictions_) dissipated_ += weight * y[f.force] * state.v[f.along];
  for (const Stop& stop : stops_) {
    const double speed = state.v[stop.along], away = state.x[stop.along] < stop.middle ? 1.0 : -1.0;
    dissipated_ -= weight * speed * (y[stop.force] - stop.stiffness * y[stop.depth] * away);
  }
  for (const Bushing& b : bushings_) {
    const Pair v = velocity(state, b.body, b.point_b);
    dissipated_ += weight * (b.damping[0] * v[0] * v[0] + b.damping[1] * v[1] * v[1]);
  }
  for (const Load& load : loads_) {
    const Pair v = velocity(state, load.body, load.point);
    worked_ += weight * z[load.magnitude] * (load.direction[0] * v[0] + load.direction[1] * v[1]);
  }
}

/// What `volume` holds at `state`, apart from the integrals: oil in m^3, or its energy in J.
double Ledger::held(std::size_t volume, const State& state, bool energy) const {
  const double p = state.z[volume];
  double sum = 0.0;
  for (const Hose& hose : hoses_) {
    if (hose.volume == volume) sum += hose.K * (energy ? 0.5 * p * p : p);
  }
  for (const Cylinder& cylinder : cylinders_) {
    for (const auto& chamber : cylinder.chambers) {
      if (chamber.p != volume) continue;
      const double l = chamber.length_at_0 + chamber.slope * state.x[cylinder.stroke];
      sum += chamber.area * (energy ? 0.5 * cylinder.c * l * p * p : cylinder.c * l * p + l);
    }
  }
  return sum;
}

std::vector<OilAccount> Ledger::oil() const {
  std::vector<OilAccount> accounts;
  for (std::size_t i = 0; i < system_.z.size(); ++i) {
    if (system_.z[i].kind != "pressure") continue;
    double stored = held(i, end_, false) - held(i, start_, false);
    for (const Cylinder& cylinder : cylinders_) {
      for (std::size_t k = 0; k < 2; ++k) {
        const auto& chamber = cylinder.chambers[k];
        if (chamber.p == i) stored -= chamber.area * cylinder.c * cylinder.p_ldot[k];
      }
    }
    accounts.push_back({system_.z[i].name, stored, entered_[i], passed_[i]});
  }
  return accounts;
}

OilAccount Ledger::all_oil() const {
  OilAccount all{"all volumes", 0.0, 0.0, 0.0};
  for (const OilAccount& account : oil()) all.stored += account.stored;
  // What sources and tanks gave; they lie behind the variables.
  for (std::size_t i = system_.z.size(); i < entered_.size(); ++i) {
    all.entered -= entered_[i];
    all.passed += passed_[i];
  }
  return all;
}

double Ledger::mechanical(const State& state) const {
  double sum = 0.0;
  for (const Body& body : bodies_) {
    const double vx = state.v[body.frame], vy = state.v[body.frame + 1], w = state.v[body.frame + 2];
    sum += 0.5 * body.mass * (vx * vx + vy * vy) + 0.5 * body.inertia * w * w;
    for (std::size_t k = 0; k < 2; ++k) sum -= body.mass * state.z[body.gravity[k]] * state.x[body.frame + k];
  }
  for (const Bushing& b : bushings_) {
    const Pair r = position(state, b.body, b.point_b);
    for (std::size_t k = 0; k < 2; ++k) sum += 0.5 * b.stiffness[k] * std::pow(r[k] - b.point_a[k], 2);
  }
  for (const Pipe& pipe : pipes_) sum += 0.5 * pipe.L * state.z[pipe.Q] * state.z[pipe.Q];
  return sum;
}

EnergyAccount Ledger::energy() const {
  double stored = mechanical(end_) - mechanical(start_) + stops_at_end_ - stops_at_start_;
  for (std::size_t i = 0; i < system_.z.size(); ++i) {
    if (system_.z[i].kind == "pressure") stored += held(i, end_, true) - held(i, start_, true);
  }
  // What tanks took, at their pressure.
  for (std::size_t i = system_.z.size(); i < entered_.size(); ++i) stored += end_.z[i] * entered_[i];
  for (const Cylinder& cylinder : cylinders_) {
    for (std::size_t k = 0; k < 2; ++k) stored -= 0.5 * cylinder.chambers[k].area * cylinder.c * cylinder.p2_ldot[k];
  }
  return {pumped_, worked_, dissipated_, stored};
}

}  // namespace bramah::testing
