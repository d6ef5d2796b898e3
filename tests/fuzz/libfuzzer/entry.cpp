// The entry of libFuzzer, compiled once for each target.
#include "fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bramah::fuzz::BRAMAH_FUZZ_TARGET(data, size);
  return 0;
}
