// What large systems get instead of a dense Jacobian: the sparse descriptor form and selected modes.
#pragma once

#include "app/context.hpp"

namespace bramah {

/// `bramah modes` with a scene that selects; prints, writes and returns the exit code.
int run_selected_modes(const Context& context);
/// `bramah linearize` with "form": "descriptor".
int run_descriptor(const Context& context);

}  // namespace bramah
