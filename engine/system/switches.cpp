#include "system/switches.hpp"

namespace bramah {

Switches::Switches(const System& system) : functions_(system, BRAMAH_EXTENSION_SWITCHES) {
  functions_.for_each([&](const bramah_switches& of, Index component, std::int32_t k) {
    info_.push_back({component, of.info[k].name, of.nominal[k] * system.scales.of(of.info[k].unit)});
  });
}

}  // namespace bramah
