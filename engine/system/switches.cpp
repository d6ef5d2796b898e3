#include "system/switches.hpp"

#include <cmath>

namespace bramah {
namespace {

const bramah_switches* switches_of(const bramah_type& type) {
  return extension<bramah_switches>(type, BRAMAH_EXTENSION_SWITCHES);
}

/// The numbers of instance `i`, `slots` of them.
void gather(const Vector& from, const std::vector<std::int32_t>& map, Index i, std::int32_t slots, Vector& to) {
  to.clear();
  for (std::int32_t j = 0; j < slots; ++j)
    to.push_back(from[static_cast<std::size_t>(map[static_cast<std::size_t>(i * slots + j)])]);
}

}  // namespace

Switches::Switches(const System& system) : system_(system) {
  for (const Group& group : system.groups) {
    const auto* switches = switches_of(*group.type);
    if (switches == nullptr) continue;
    for (Index i = 0; i < group.count; ++i) {
      for (std::int32_t k = 0; k < switches->count; ++k) {
        const bramah_row_info& info = switches->info[k];
        info_.push_back({group.component[static_cast<std::size_t>(i)], info.name,
                         switches->nominal[k] * system.scales.of(info.unit)});
      }
    }
  }
  values_.resize(info_.size());
}

const Vector& Switches::evaluate(const State& state) {
  std::size_t next = 0;
  for (const Group& group : system_.groups) {
    const bramah_type& type = *group.type;
    const auto* switches = switches_of(type);
    if (switches == nullptr) continue;
    for (Index i = 0; i < group.count; ++i) {
      gather(state.x, group.x, i, type.nx, x_);
      gather(state.v, group.x, i, type.nx, v_);
      gather(state.z, group.z, i, type.nz, z_);
      gather(state.z, group.u, i, type.nu, u_);
      bramah_batch batch{};
      batch.size = sizeof batch;
      batch.count = 1;
      batch.instances = group.instances.at(i);
      batch.time = state.t;
      batch.side = state.side;
      batch.x = x_.data();
      batch.v = v_.data();
      batch.z = z_.data();
      batch.u = u_.data();
      if (switches->values(type.self, &batch, &values_[next]) != 0) {
        for (std::int32_t k = 0; k < switches->count; ++k) values_[next + static_cast<std::size_t>(k)] = std::nan("");
      }
      next += static_cast<std::size_t>(switches->count);
    }
  }
  return values_;
}

}  // namespace bramah
