// Mode sets in journals: all of their digits, written and read back bit for bit.
#pragma once

#include <optional>

#include "io/json_writer.hpp"
#include "linear/track.hpp"
#include "system/scene.hpp"

namespace bramah {

/// Members of an open object; complex numbers as real and imaginary parts in turn, matrices by columns.
void write_mode_set(JsonWriter& json, const ModeSet& set);
/// None where the object has not what `write_mode_set` writes.
std::optional<ModeSet> read_mode_set(const Value& object);

}  // namespace bramah
