// Tables that an author has filled by hand, without the SDK that differentiates: do they keep their promises?
#pragma once

#include <vector>

#include "system/compile.hpp"
#include "system/diagnostic.hpp"

namespace bramah {

/// A warning for each type of the scene without exact derivatives of its own (`bramah.tangent/1`, which the SDK gives to
/// all types) whose partials are not those of its rows: the first component of the type is examined at its start values,
/// by differences. What passes says nothing about other states; `conforms` examines those.
std::vector<Diagnostic> examine_hand_written(const Compiled& compiled);

}  // namespace bramah
