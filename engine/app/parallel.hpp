// Independent work on all cores. The only door of oneTBB.
#pragma once

#include <cstddef>
#include <functional>

namespace bramah {

/// Calls work(0) ... work(count - 1), each once, in any order, on up to `threads` threads (0: as many as there are cores).
/// `work` must not throw.
void for_each_index(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace bramah
