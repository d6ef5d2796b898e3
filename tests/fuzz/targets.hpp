// What strangers feed in: each target takes any bytes, and must neither crash nor hang nor touch foreign memory. Refusing them
// with an error is success. libFuzzer calls one of them at a time (`./test --fuzz`); replay_test.cpp calls all of them on
// what was found before.
#pragma once

#include <cstddef>
#include <cstdint>

namespace bramah::fuzz {

/// A scene's text, through parsing, compiling and the state of its start values.
void scene(const std::uint8_t* data, std::size_t size);
/// A checkpoint of the overdamped four-bar.
void checkpoint(const std::uint8_t* data, std::size_t size);
/// The text behind --set, a line each, on the overdamped four-bar; lines that begin with "over " stand for --over.
void setting(const std::uint8_t* data, std::size_t size);
/// The tables of a library, made of the bytes, and a scene that uses its first type.
void tables(const std::uint8_t* data, std::size_t size);

}  // namespace bramah::fuzz
