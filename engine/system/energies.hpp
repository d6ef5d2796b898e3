// What components store and what they bring in, at a state.
//
//   E_c                                     J   stored, as the component says (bramah.energy/1); 0 where it says nothing
//   P_c = dE_c/dt - (f_c . v + z . g_c)     W   power brought in: of pumps and drives positive, of friction negative
//   d(sum of E_c)/dt = sum of P_c               as the balances f = 0 and g = 0 are sums of f_c and g_c over components
//
// f_c contains the component's own D^T lambda, so that constraints that move by themselves bring in power as well. z . g_c
// runs over the kinds of first-order variables whose product with their balance is a power, such as pressures. Energies
// tell which: there the rate of the energy, E_z zdot, is z K zdot. What a source or a tank gives at its own pressure is
// power of that source.
#pragma once

#include <string>
#include <vector>

#include "system/blocks.hpp"

namespace bramah {

/// Whether components of this type say what they store.
bool says_energy(const bramah_type& type);

class Energies : private RowListener {
 public:
  explicit Energies(const System& system);

  /// Energies and powers at `state`. Without `reactions` its multipliers do not matter, and powers are right where no
  /// constraint moves by itself. Its accelerations and rates matter for components in `unsaid` only.
  Outcome evaluate(const State& state, bool reactions);

  [[nodiscard]] const Vector& energy() const { return energy_; }  // by component
  [[nodiscard]] const Vector& power() const { return power_; }
  /// Energy of motion, pressure and flow, J: the sum of (E_v . v + E_z . z) / 2.
  [[nodiscard]] double activity() const { return activity_; }
  /// Components that store something and do not say what: inertia or storage that is not in their energy. Empty before the
  /// first evaluation.
  [[nodiscard]] const std::vector<Index>& unsaid() const { return unsaid_; }

 private:
  struct Trial;
  void hear(const Group& group, Index first, const bramah_batch& batch) override;
  void examine(const State& state);
  void hear_trial(const Group& group, Index first, const bramah_batch& batch, Trial& trial);
  [[nodiscard]] std::size_t kind_of(const Group& group, Index instance, Index slot) const;
  /// Energies of the batch into energies_, their derivatives along `direction` into rates_; false where nothing is said.
  bool evaluate_energies(const bramah_type& type, const bramah_batch& batch, const bramah_direction& direction);

  const System& system_;
  Blocks blocks_;
  std::vector<std::size_t> kind_;    // of each place in State::z
  std::vector<Index> owner_;         // whose source it is, -1: a variable, or a number at rest
  std::vector<std::string> kinds_;   // of first-order variables
  std::vector<bool> carries_power_;  // by kind
  Trial* trial_ = nullptr;           // while components are examined
  bool examined_ = false;
  std::vector<Index> unsaid_;
  Vector energy_, power_, energies_, rates_;
  double activity_ = 0.0;
};

}  // namespace bramah
