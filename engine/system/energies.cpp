#include "system/energies.hpp"

#include <algorithm>
#include <cmath>

#include "plugin/border.hpp"

namespace bramah {
namespace {

// What an energy has to match: terms to this part of their sum.
constexpr double matching = 1e-9;

const bramah_energy* energy_of(const bramah_type& type) {
  return extension<bramah_energy>(type, BRAMAH_EXTENSION_ENERGY);
}

bramah_direction direction(const double* x, const double* v, const double* z) {
  return {sizeof(bramah_direction), x, v, nullptr, z, nullptr, nullptr, nullptr};
}

}  // namespace

bool says_energy(const bramah_type& type) { return energy_of(type) != nullptr; }

/// Work of the inertia of each component, and of its storage by kind of variable; what its energy says of them.
struct Energies::Trial {
  explicit Trial(std::size_t components, std::size_t kinds)
      : width(1 + kinds), taken(components * width), size(components * width), said(components * width) {}
  std::size_t width;  // motion, then the kinds
  double sign = 1.0;
  Vector taken, size, said;
  Vector z;  // of one kind
};

Energies::Energies(const System& system)
    : system_(system), blocks_(system), energy_(system.components.size()), power_(system.components.size()) {
  const std::size_t places = system.z.size() + system.inputs.size() + system.z_constants.size();
  owner_.assign(places, -1);
  const auto kind = [&](const std::string& name) {
    const auto at = static_cast<std::size_t>(std::find(kinds_.begin(), kinds_.end(), name) - kinds_.begin());
    if (at == kinds_.size()) kinds_.push_back(name);
    return at;
  };
  for (const Variable& z : system.z) kind_.push_back(kind(z.kind));
  kind_.resize(places, 0);
  // What is no variable has the kind of the ports that read it.
  for (const Group& group : system.groups) {
    const bramah_type& type = *group.type;
    for (Index i = 0; i < group.count; ++i) {
      Index slot = 0;
      for (std::int32_t p = 0; p < type.port_count; ++p) {
        if (type.ports[p].family != BRAMAH_Z) continue;
        for (std::int32_t k = 0; k < type.ports[p].slots; ++k, ++slot) {
          const auto place = static_cast<std::size_t>(group.z[static_cast<std::size_t>(i * type.nz + slot)]);
          if (place >= system.z.size()) kind_[place] = kind(type.ports[p].kind);
        }
      }
    }
  }
  for (std::size_t c = 0; c < system.components.size(); ++c) {
    const Component& component = system.components[c];
    if (component.input >= 0) owner_[static_cast<std::size_t>(system.nz() + component.input)] = static_cast<Index>(c);
    const auto* constants = extension<bramah_constants>(*component.type, BRAMAH_EXTENSION_CONSTANTS);
    if (component.z_constants < 0 || constants == nullptr) continue;
    std::fill_n(owner_.begin() + component.z_constants, constants->count, static_cast<Index>(c));
  }
  carries_power_.assign(kinds_.size() + 1, false);
}

std::size_t Energies::kind_of(const Group& group, Index instance, Index slot) const {
  return kind_[static_cast<std::size_t>(group.z[static_cast<std::size_t>(instance * group.type->nz + slot)])];
}

bool Energies::evaluate_energies(const bramah_type& type, const bramah_batch& batch,
                                 const bramah_direction& direction) {
  const bramah_energy* stored = energy_of(type);
  if (stored == nullptr) return false;
  energies_.resize(static_cast<std::size_t>(batch.count));
  rates_.resize(energies_.size());
  const AtBorder border("energy", "a component", type, batch.count);
  if (stored->values(type.self, &batch, &direction, energies_.data(), rates_.data()) == 0) return true;
  std::fill(energies_.begin(), energies_.end(), std::nan(""));
  std::fill(rates_.begin(), rates_.end(), std::nan(""));
  return true;
}

void Energies::hear(const Group& group, Index first, const bramah_batch& batch) {
  if (trial_ != nullptr) return hear_trial(group, first, batch, *trial_);
  const bramah_type& type = *group.type;
  for (Index i = 0; i < batch.count; ++i) {
    double& power = power_[static_cast<std::size_t>(group.component[static_cast<std::size_t>(first + i)])];
    for (Index j = i * type.nx; batch.f != nullptr && j < (i + 1) * type.nx; ++j) power -= batch.f[j] * batch.v[j];
    for (Index j = 0; batch.g != nullptr && j < type.nz; ++j) {
      if (!carries_power_[kind_of(group, first + i, j)]) continue;
      const double taken = batch.z[i * type.nz + j] * batch.g[i * type.nz + j];
      power -= taken;
      const Index owner =
          owner_[static_cast<std::size_t>(group.z[static_cast<std::size_t>((first + i) * type.nz + j)])];
      if (owner >= 0) power_[static_cast<std::size_t>(owner)] += taken;
    }
  }
  if (!evaluate_energies(type, batch, direction(batch.v, batch.a, batch.zdot))) return;
  for (Index i = 0; i < batch.count; ++i) {
    const auto component = static_cast<std::size_t>(group.component[static_cast<std::size_t>(first + i)]);
    energy_[component] = energies_[static_cast<std::size_t>(i)];
    power_[component] += rates_[static_cast<std::size_t>(i)];
  }
  evaluate_energies(type, batch, direction(nullptr, batch.v, batch.z));
  for (Index i = 0; i < batch.count; ++i) activity_ += 0.5 * rates_[static_cast<std::size_t>(i)];
}

Outcome Energies::evaluate(const State& state, bool reactions) {
  if (!examined_) examine(state);
  std::fill(energy_.begin(), energy_.end(), 0.0);
  std::fill(power_.begin(), power_.end(), 0.0);
  activity_ = 0.0;
  Request request = Request{}.rows("fg");
  request.multiplier_forces = reactions;
  request.listener = this;
  Outcome outcome = blocks_.evaluate(system_, state, request);
  for (std::size_t c = 0; outcome.ok() && c < energy_.size(); ++c) {
    if (std::isfinite(energy_[c]) && std::isfinite(power_[c])) continue;
    outcome.status = Outcome::Status::recoverable;
    outcome.component = static_cast<Index>(c);
    outcome.message = "the energy of " + system_.component_name(outcome.component) + " is not finite";
  }
  return outcome;
}

/// Which kinds of variables carry power, and who stores without a word. With accelerations a = v and rates zdot = z the
/// inertia of a component takes v . M v and its storage z . K z; its energy has to say E_v . v and E_z . z.
void Energies::examine(const State& state) {
  Trial trial(system_.components.size(), kinds_.size());
  trial_ = &trial;
  State moving = state;
  const auto some = [](double nominal, std::size_t i) { return nominal * (0.6 + 0.4 * std::sin(1.0 + double(i))); };
  for (std::size_t i = 0; i < system_.x.size(); ++i) moving.v[i] = some(system_.x[i].nominal, i);
  for (std::size_t i = 0; i < system_.z.size(); ++i) {
    if (moving.z[i] == 0.0) moving.z[i] = some(system_.z[i].nominal, i);
  }
  const auto pass = [&](double sign, double share) {
    trial.sign = sign;
    for (std::size_t i = 0; i < system_.x.size(); ++i) moving.a[i] = share * moving.v[i];
    for (std::size_t i = 0; i < system_.z.size(); ++i) moving.zdot[i] = share * moving.z[i];
    Request request = Request{}.rows("fg");
    request.multiplier_forces = false;
    request.listener = this;
    return blocks_.evaluate(system_, moving, request).ok();
  };
  const bool evaluated = pass(1.0, 1.0) && pass(-1.0, 0.0);
  trial_ = nullptr;
  examined_ = true;
  const auto matches = [&](std::size_t k) {
    return std::abs(trial.taken[k] - trial.said[k]) <= matching * (std::abs(trial.said[k]) + trial.size[k]);
  };
  for (std::size_t c = 0; c < system_.components.size(); ++c) {
    for (std::size_t kind = 0; kind + 1 < trial.width; ++kind)
      carries_power_[kind] = carries_power_[kind] || trial.said[c * trial.width + 1 + kind] != 0.0;
  }
  for (std::size_t c = 0; c < system_.components.size(); ++c) {
    bool said = evaluated && matches(c * trial.width);
    for (std::size_t kind = 0; kind + 1 < trial.width; ++kind)
      said = said && (!carries_power_[kind] || matches(c * trial.width + 1 + kind));
    if (!said) unsaid_.push_back(static_cast<Index>(c));
  }
}

void Energies::hear_trial(const Group& group, Index first, const bramah_batch& batch, Trial& trial) {
  const bramah_type& type = *group.type;
  const auto place = [&](Index i) {
    return static_cast<std::size_t>(group.component[static_cast<std::size_t>(first + i)]) * trial.width;
  };
  for (Index i = 0; i < batch.count; ++i) {
    const auto add = [&](std::size_t k, double work) {
      trial.taken[place(i) + k] += trial.sign * work;
      trial.size[place(i) + k] += std::abs(work);
    };
    for (Index j = i * type.nx; batch.f != nullptr && j < (i + 1) * type.nx; ++j) add(0, batch.f[j] * batch.v[j]);
    for (Index j = 0; batch.g != nullptr && j < type.nz; ++j)
      add(1 + kind_of(group, first + i, j), batch.g[i * type.nz + j] * batch.z[i * type.nz + j]);
  }
  if (trial.sign < 0.0) return;  // said once
  for (std::size_t k = 0; k < trial.width; ++k) {
    trial.z.assign(static_cast<std::size_t>(batch.count * type.nz), 0.0);
    for (Index j = 0; k > 0 && j < batch.count * type.nz; ++j) {
      if (kind_of(group, first + j / type.nz, j % type.nz) + 1 == k) trial.z[static_cast<std::size_t>(j)] = batch.z[j];
    }
    if (!evaluate_energies(type, batch, direction(nullptr, k == 0 ? batch.v : nullptr, trial.z.data()))) return;
    for (Index i = 0; i < batch.count; ++i) trial.said[place(i) + k] += rates_[static_cast<std::size_t>(i)];
  }
}

}  // namespace bramah
