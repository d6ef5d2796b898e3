// Numbers that components give for a state through an extension with `count` and `values`: switching functions, limits.
#pragma once

#include <cmath>

#include "plugin/border.hpp"
#include "system/system.hpp"

namespace bramah {

/// The local numbers of instance `i` of a group, `slots` of them, out of a state's vector.
inline void gather(const Vector& from, const std::vector<std::int32_t>& map, Index i, std::int32_t slots, Vector& to) {
  to.clear();
  for (std::int32_t j = 0; j < slots; ++j)
    to.push_back(from[static_cast<std::size_t>(map[static_cast<std::size_t>(i * slots + j)])]);
}

template <class Extension>
class StateFunctions {
 public:
  StateFunctions(const System& system, const char* id) : system_(system) {
    std::size_t count = 0;
    for (const Group& group : system.groups) {
      const auto* of = extension<Extension>(*group.type, id);
      extensions_.push_back(of);
      if (of != nullptr) count += static_cast<std::size_t>(of->count * group.count);
    }
    values_.resize(count);
  }

  /// Calls each(extension, component, k) for every number, in the order of `evaluate`.
  template <class Each>
  void for_each(const Each& each) const {
    for (std::size_t g = 0; g < extensions_.size(); ++g) {
      if (extensions_[g] == nullptr) continue;
      const Group& group = system_.groups[g];
      for (Index i = 0; i < group.count; ++i) {
        for (std::int32_t k = 0; k < extensions_[g]->count; ++k)
          each(*extensions_[g], group.component[static_cast<std::size_t>(i)], k);
      }
    }
  }

  /// Values at t, side, x, v, z and inputs of `state`; NaN where a component cannot tell.
  const Vector& evaluate(const State& state) {
    std::size_t next = 0;
    for (std::size_t g = 0; g < extensions_.size(); ++g) {
      if (extensions_[g] == nullptr) continue;
      const Group& group = system_.groups[g];
      const bramah_type& type = *group.type;
      const auto count = static_cast<std::size_t>(extensions_[g]->count);
      for (Index i = 0; i < group.count; ++i) {
        const std::string& name = system_.component_name(group.component[static_cast<std::size_t>(i)]);
        const AtBorder border("switches or limits", name.c_str(), type);
        gather(state.x, group.x, i, type.nx, x_);
        gather(state.v, group.x, i, type.nx, v_);
        gather(state.z, group.z, i, type.nz, z_);
        gather(state.z, group.u, i, type.nu, u_);
        bramah_batch batch = batch_of(group, state, i, 1);
        batch.x = x_.data();
        batch.v = v_.data();
        batch.z = z_.data();
        batch.u = u_.data();
        if (extensions_[g]->values(type.self, &batch, &values_[next]) != 0)
          std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(next), count, std::nan(""));
        next += count;
      }
    }
    return values_;
  }

 private:
  const System& system_;
  std::vector<const Extension*> extensions_;  // of each group
  Vector values_, x_, v_, z_, u_;
};

}  // namespace bramah
