// Numbers of a state by name.
#pragma once

#include <span>

#include "system/blocks.hpp"
#include "system/options.hpp"

namespace bramah {

/// Values of `columns` at `state`; component outputs are evaluated into `blocks`.
void measure(const System& system, const State& state, std::span<const Measured> columns, Blocks& blocks,
             Vector& values);

}  // namespace bramah
