#include "solve/kkt.hpp"

#include <algorithm>
#include <utility>

#include "system/analysis_error.hpp"

namespace bramah {
namespace {
constexpr int refinements = 2;
}

Kkt::Kkt(const System& system, std::span<const Index> rows, std::vector<double> softness)
    : system_(system), rows_(rows.begin(), rows.end()), softness_(std::move(softness)) {
  const Index n = system.n(), nz = system.nz(), count = static_cast<Index>(rows_.size());
  size_ = n + count + nz;
  const std::vector<Index> x = shifted(n, 0), z = shifted(nz, n + count),
                           constraints = selected(system.m() + system.l(), rows_, n);
  const Term terms[] = {{BRAMAH_F_A, x, x, false, 0},
                        {BRAMAH_R_V, constraints, x, false, 0},
                        {BRAMAH_R_V, constraints, x, true, 0},
                        {BRAMAH_G_ZDOT, z, z, false, 0}};
  std::vector<Diagonal> diagonals;
  if (!softness_.empty()) diagonals.push_back({n, n, count, 1, softness_});
  plan_ = SparsePlan(system, size_, size_, terms, diagonals);
  lu_.analyze({size_, size_, plan_.start().data(), plan_.row().data(), plan_.values().data()});
  rhs_.resize(static_cast<std::size_t>(size_));
}

Request Kkt::needed() { return Request{}.blocks({BRAMAH_F_A, BRAMAH_R_V, BRAMAH_G_ZDOT}); }

void Kkt::factor(const Blocks& blocks) {
  const double weights[] = {1.0, -1.0};
  plan_.fill(blocks, weights);
  if (lu_.factor({size_, size_, plan_.start().data(), plan_.row().data(), plan_.values().data()})) return;
  const Index i = lu_.singular_column();
  const std::string name = unknown_component(i);
  const bool stores = i >= size_ - system_.nz();
  throw AnalysisError("dynamics",
                      unknown_name(i) + " is undefined: " +
                          (stores ? "nothing stores there" : "the mass matrix is singular") + " at this state",
                      stores ? "storage above zero for every first-order variable"
                             : "inertia for every motion that the constraints leave free",
                      stores ? "check what stores at " + name + ": a chamber may have no length at the start values"
                             : "give " + name + " mass and inertia, or a constraint that holds it",
                      name.empty() ? name : "/components/" + name);
}

void Kkt::solve(std::span<double> rhs, Index count) const {
  lu_.solve(rhs, count);
  if (softness_.empty()) return;
  const auto n = static_cast<std::size_t>(system_.n()), size = static_cast<std::size_t>(size_);
  // Each refinement leaves another factor of softness / sigma^2: the last correction's multipliers are its residual.
  refinement_.assign(rhs.begin(), rhs.end());
  for (int k = 0; k < refinements; ++k) {
    for (std::size_t column = 0; column < rhs.size(); column += size) {
      std::fill_n(refinement_.begin() + static_cast<std::ptrdiff_t>(column), n, 0.0);
      for (std::size_t i = 0; i < softness_.size(); ++i) refinement_[column + n + i] *= -softness_[i];
      std::fill(refinement_.begin() + static_cast<std::ptrdiff_t>(column + n + softness_.size()),
                refinement_.begin() + static_cast<std::ptrdiff_t>(column + size), 0.0);
    }
    lu_.solve(refinement_, count);
    for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] += refinement_[i];
  }
}

std::string Kkt::unknown_component(Index i) const {
  const Index n = system_.n(), count = static_cast<Index>(rows_.size());
  if (i < 0 || i >= size_) return "";
  if (i < n) return system_.component_name(system_.x[static_cast<std::size_t>(i)].component);
  if (i < n + count)
    return system_.component_name(system_.constraint(rows_[static_cast<std::size_t>(i - n)]).component);
  return system_.component_name(system_.z[static_cast<std::size_t>(i - n - count)].component);
}

std::string Kkt::unknown_name(Index i) const {
  const Index n = system_.n(), count = static_cast<Index>(rows_.size());
  if (i < 0 || i >= size_) return "an unknown";
  if (i < n) return "the acceleration of " + system_.x[static_cast<std::size_t>(i)].name;
  if (i < n + count) return "the multiplier " + system_.multiplier_name(rows_[static_cast<std::size_t>(i - n)]);
  return "the rate of " + system_.z[static_cast<std::size_t>(i - n - count)].name;
}

void Kkt::complete(State& state, Blocks& blocks) {
  const auto n = static_cast<std::size_t>(system_.n()), nz = static_cast<std::size_t>(system_.nz()),
             count = rows_.size();
  std::fill_n(state.a.begin(), n, 0.0);
  std::fill_n(state.zdot.begin(), nz, 0.0);
  std::fill(state.lambda.begin(), state.lambda.end(), 0.0);
  Request request = needed().rows("fgs");
  request.multiplier_forces = false;
  const Outcome outcome = blocks.evaluate(system_, state, request);
  if (!outcome.ok()) {
    throw AnalysisError("dynamics", outcome.message, "finite forces, storages and constraints",
                        "check the start values; a length or a volume may have reached zero");
  }
  factor(blocks);
  for (std::size_t i = 0; i < n; ++i) rhs_[i] = -blocks.f[i];
  for (std::size_t k = 0; k < count; ++k) rhs_[n + k] = -blocks.s[static_cast<std::size_t>(rows_[k])];
  for (std::size_t i = 0; i < nz; ++i) rhs_[n + count + i] = -blocks.g[i];
  solve(rhs_);
  std::copy_n(rhs_.begin(), n, state.a.begin());
  for (std::size_t k = 0; k < count; ++k) state.lambda[static_cast<std::size_t>(rows_[k])] = rhs_[n + k];
  std::copy_n(rhs_.begin() + static_cast<std::ptrdiff_t>(n + count), nz, state.zdot.begin());
}

}  // namespace bramah
