// Checkpoints of simulations as JSON: variables by name, numbers with all their digits.
#pragma once

#include <string>

#include "solve/simulate.hpp"
#include "system/scene.hpp"
#include "system/system.hpp"

namespace bramah {

std::string checkpoint_text(const System& system, const Checkpoint& checkpoint);

/// Reads it back, bit for bit. Throws SceneError where the text is no checkpoint, or one of another scene: every variable
/// that is missing or unknown is told.
Checkpoint read_checkpoint(const System& system, const Source& source);

}  // namespace bramah
