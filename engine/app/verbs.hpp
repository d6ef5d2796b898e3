// The verbs of the program: one file each.
#pragma once

#include <span>

#include "app/arguments.hpp"

namespace bramah {

struct Verb {
  const char* name;
  const char* argument;                    // "SCENE", "TYPE", or "" where there is none
  const char* brief;                       // for the list of verbs
  const char* help;                        // what it does, an example, what it prints
  int (*run)(const Arguments& arguments);  // the exit code
  std::span<const char* const> options{};  // of its own, beside those of every verb
};

extern const Verb verb_check, verb_list, verb_describe, verb_equilibrium, verb_simulate, verb_linearize, verb_modes,
    verb_respond, verb_sensitivity, verb_sweep, verb_critical, verb_vary, verb_compare, verb_study;

/// In the order in which a newcomer needs them.
std::span<const Verb* const> all_verbs();

}  // namespace bramah
