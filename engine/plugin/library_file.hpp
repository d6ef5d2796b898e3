// What a library file says before it is loaded.
#pragma once

#include <filesystem>
#include <string>

namespace bramah {

/// What is missing at the end of an ELF file, or "". dlopen maps what the headers promise, and the process would die of
/// SIGBUS where the file ends before.
std::string cut_short(const std::filesystem::path& file);

/// The stamp that `bramah_add_plugin` gives to both files of a plugin, a hash of sources and flags; "" where there is none.
std::string stamp_of(const std::filesystem::path& file);

}  // namespace bramah
