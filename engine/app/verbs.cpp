#include "app/verbs.hpp"

#include <array>

namespace bramah {

std::span<const Verb* const> all_verbs() {
  static constexpr auto verbs = std::to_array<const Verb*>(
      {&verb_check, &verb_list, &verb_describe, &verb_equilibrium, &verb_simulate, &verb_linearize, &verb_modes,
       &verb_respond, &verb_sensitivity, &verb_sweep, &verb_critical, &verb_vary, &verb_compare, &verb_study});
  return verbs;
}

}  // namespace bramah
