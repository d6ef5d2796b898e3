# Linked, privately, by everything that is compiled here; never exported: a plugin author chooses his own warnings.
add_library(bramah_warnings INTERFACE)
target_compile_options(bramah_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
  # GCC 12 sees overlapping copies in "text" + std::string(...) where there are none (its bug 105329).
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-restrict>)

# Checked standard containers where speed does not matter.
add_compile_definitions($<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS>)
