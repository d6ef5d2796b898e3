#include "solve/start.hpp"

#include "solve/assemble.hpp"
#include "solve/kkt.hpp"
#include "solve/redundancy.hpp"

namespace bramah {

State consistent_start(const System& system, const Options& options, double t) {
  State state = initial_state(system, t);
  assemble_positions(system, state, options.equilibrium.hold_x);
  assemble_velocities(system, state, options.equilibrium.hold_x);
  complete(system, state);
  return state;
}

void complete(const System& system, State& state) {
  const Partition partition = choose_partition(system, state);
  Blocks blocks(system);
  Kkt(system, partition.rows).complete(state, blocks);
  take_minimum_norm(partition, state.lambda);
}

State reference_state(const System& system, const Options& options, bool equilibrium, double t) {
  return equilibrium ? find_equilibrium(system, options.equilibrium, t).state : consistent_start(system, options, t);
}

}  // namespace bramah
