// Books of a hydraulic machine, kept beside the engine: oil of every volume and energy of the whole, from positions,
// velocities, pressures and the flows that components report.
//
// What a volume holds is told from the state and from one integral per chamber (c: compressibility of oil and barrel):
//
//   int (K pdot + Vdot) dt = sum K_hose [p] + sum (A c [l p] - A c int p ldot dt + A [l])       m^3
//   int p K pdot dt        = sum K_hose [p^2] / 2 + sum A c ([l p^2] - int p^2 ldot dt) / 2      J
//
// Chambers store no potential: the compressibility of the oil that enters is not counted in flows, so that the last
// integral depends on the path.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "solve/simulate.hpp"
#include "support/machine.hpp"

namespace bramah::testing {

struct OilAccount {
  std::string volume;
  double stored = 0.0;   // m^3, from the state
  double entered = 0.0;  // m^3, integral of the net inflow
  double passed = 0.0;   // m^3, integral of all flows by magnitude
};

struct EnergyAccount {
  double pumped = 0.0, loads = 0.0;  // J, put in by pumps and by given forces
  double dissipated = 0.0;           // J, in resistors, seals, dampers
  double stored = 0.0;               // J, kinetic, potential, springs, oil
};

class Ledger {
 public:
  explicit Ledger(const Machine& machine);

  /// Runs the scene twice: once for its steps, which are the panels of a Gauss quadrature, and once to add up. Both runs
  /// take the same steps, as outputs do not change them.
  Simulation keep(const SimulateOptions& options, const State& start);

  [[nodiscard]] std::vector<OilAccount> oil() const;
  /// All volumes together; flows between them cancel.
  [[nodiscard]] OilAccount all_oil() const;
  [[nodiscard]] EnergyAccount energy() const;

 private:
  // Places in State::z, State::x and among the outputs.
  struct Resistor {
    std::size_t a, b, flow;
  };
  struct Pipe {
    std::size_t a, b, Q;
    double R, L;
  };
  struct Valve {
    std::size_t pump, tank, A, B, U, flow_A, flow_B;
  };
  struct Hose {
    std::size_t volume;
    double K;
  };
  struct Cylinder {
    std::size_t stroke;
    struct Chamber {
      std::size_t p;
      double area, length_at_0, slope;  // length = length_at_0 + slope s
    };
    std::array<Chamber, 2> chambers;
    double c;
    std::array<double, 2> p_ldot, p2_ldot;  // integrals
  };
  struct Friction {
    std::size_t along, force;
  };
  struct Stop {
    std::size_t along, force, depth;
    double middle, stiffness;
  };
  struct Body {
    std::size_t frame;
    double mass, inertia;
    std::array<std::size_t, 2> gravity;
  };
  struct Bushing {  // between the ground and a body
    std::size_t body;
    std::array<double, 2> point_a, point_b, stiffness, damping;
  };
  struct Load {
    std::size_t body, magnitude;
    std::array<double, 2> point, direction;
  };

  void take_in(const Component& component);
  void add(const State& state, double weight);
  void move(std::size_t from, std::size_t to, double flow, double weight);
  [[nodiscard]] double held(std::size_t volume, const State& state, bool energy) const;
  [[nodiscard]] double mechanical(const State& state) const;

  const System& system_;
  Blocks blocks_;
  State start_, end_;
  std::vector<Resistor> resistors_;
  std::vector<Resistor> pumps_;  // from inlet to outlet
  std::vector<Pipe> pipes_;
  std::vector<Valve> valves_;
  std::vector<Hose> hoses_;
  std::vector<Cylinder> cylinders_;
  std::vector<Friction> frictions_;
  std::vector<Stop> stops_;
  std::vector<Body> bodies_;
  std::vector<Bushing> bushings_;
  std::vector<Load> loads_;
  Vector entered_, passed_;  // by place in State::z
  double pumped_ = 0.0, dissipated_ = 0.0, worked_ = 0.0;
  double stops_at_start_ = 0.0, stops_at_end_ = 0.0;
};

}  // namespace bramah::testing
