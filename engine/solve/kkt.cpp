#include "solve/kkt.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "system/analysis_error.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {
// Corrections of one solution relative to it. Where the first one is `r`, the next is about `r^2`.
constexpr double rounding = 1e-16;
constexpr double shrinks = 0.1;  // a correction that shrinks less than this is the last: the rest is noise or singular
constexpr int most_refinements = 8;
constexpr int soft_refinements = 2;  // at singular positions corrections do not shrink, and more would have no bound
// A first correction of softness, 1e-10 / sigma^2, below which rounding, 1e-16 / sigma^2, needs none: it is about 1e-12.
constexpr double well_conditioned = 1e-6;
}  // namespace

Kkt::Kkt(const System& system, std::span<const Index> rows, std::vector<double> softness)
    : system_(system), rows_(rows.begin(), rows.end()), softness_(std::move(softness)) {
  const Index n = system.n(), nz = system.nz(), count = static_cast<Index>(rows_.size());
  size_ = n + count + nz;
  const double time = system.scales.time;
  for (const Variable& variable : system.x) sizes_.push_back(variable.nominal / (time * time));
  for (const Index row : rows_) sizes_.push_back(system.multiplier_nominal(row));
  for (const Variable& variable : system.z) sizes_.push_back(variable.nominal / time);
  const std::vector<Index> x = shifted(n, 0), z = shifted(nz, n + count),
                           constraints = selected(system.m() + system.l(), rows_, n);
  const Term terms[] = {{BRAMAH_F_A, x, x, false, 0},
                        {BRAMAH_R_V, constraints, x, false, 0},
                        {BRAMAH_R_V, constraints, x, true, 0},
                        {BRAMAH_G_ZDOT, z, z, false, 0}};
  std::vector<Diagonal> diagonals;
  if (!softness_.empty()) diagonals.push_back({n, n, count, 1, softness_});
  plan_ = SparsePlan(system, size_, size_, terms, diagonals);
  lu_.analyze({size_, size_, plan_.start().data(), plan_.row().data(), plan_.values().data()}, sizes_);
  for (Vector* vector : {&rhs_, &correction_, &terms_}) vector->resize(static_cast<std::size_t>(size_));
  diagonal_.assign(static_cast<std::size_t>(size_), -1);
  for (Index j = 0; j < size_; ++j) {
    for (Index e = plan_.start()[static_cast<std::size_t>(j)]; e < plan_.start()[static_cast<std::size_t>(j) + 1];
         ++e) {
      if (plan_.row()[static_cast<std::size_t>(e)] == j) diagonal_[static_cast<std::size_t>(j)] = e;
    }
  }
  sum_.resize(static_cast<std::size_t>(size_));
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
                      name.empty() ? name : pointer("/components", name));
}

void Kkt::solve(std::span<double> rhs, Index count) const {
  const auto size = static_cast<std::size_t>(size_);
  given_.assign(rhs.begin(), rhs.end());
  lu_.solve(rhs, count);
  for (std::size_t column = 0; column < rhs.size(); column += size) {
    const std::span<double> solution = rhs.subspan(column, size);
    uncertainty_ = softness_.empty() || !remove_softness(solution)
                       ? refine(solution, std::span(given_).subspan(column, size))
                       : 0.0;
    if (uncertainty_ > few_digits) ++imprecise_;
  }
}

/// Corrects what softness leaves, with no residual to evaluate: it is the softness times the last correction's
/// multipliers. False, and `solution` as it was, where the matrix is not well conditioned.
bool Kkt::remove_softness(std::span<double> solution) const {
  std::copy(solution.begin(), solution.end(), correction_.begin());
  const auto rows = correction_.begin() + static_cast<std::ptrdiff_t>(system_.n());
  for (int k = 0; k < soft_refinements; ++k) {
    std::fill(correction_.begin(), rows, 0.0);
    for (std::size_t i = 0; i < softness_.size(); ++i) rows[static_cast<std::ptrdiff_t>(i)] *= -softness_[i];
    std::fill(rows + static_cast<std::ptrdiff_t>(softness_.size()), correction_.end(), 0.0);
    lu_.solve(correction_);
    const double now = relative_correction(solution);
    if (k == 0 && !(now < well_conditioned)) return false;
    for (std::size_t i = 0; i < solution.size(); ++i) solution[i] += correction_[i];
    if (now * now <= rounding) break;
  }
  return true;
}

/// Returns the last correction relative to the solution, 0 where the next one would be rounding.
double Kkt::refine(std::span<double> solution, std::span<const double> rhs) const {
  double before = 1.0;
  std::array<double, 3> least{};
  for (int k = 1; k <= most_refinements; ++k) {
    find_residual(solution, rhs);
    if (k == 1) least = sizes_of_terms();
    lu_.solve(correction_);
    const double now = relative_correction(solution, least);
    const int always = softness_.empty() ? 1 : soft_refinements;
    if (k > always && !(now < before)) return before;
    for (std::size_t i = 0; i < solution.size(); ++i) solution[i] += correction_[i];
    if (now * now <= rounding * before) return 0.0;
    if (k >= always && !(now <= shrinks * before)) return now;
    before = now;
  }
  return before;
}

/// Sets `correction_` to rhs - A solution, A without softness.
void Kkt::find_residual(std::span<const double> solution, std::span<const double> rhs) const {
  std::copy(rhs.begin(), rhs.end(), sum_.begin());
  std::fill(terms_.begin(), terms_.end(), 0.0);
  const Index *start = plan_.start().data(), *row = plan_.row().data();
  const double* value = plan_.values().data();
  for (std::size_t j = 0; j < solution.size(); ++j) {
    if (solution[j] == 0.0) continue;
    const long double x = solution[j];
    const double size = std::abs(solution[j]);
    for (Index e = start[j]; e < start[j + 1]; ++e) {
      const auto i = static_cast<std::size_t>(row[e]);
      sum_[i] -= value[e] * x;
      terms_[i] = std::max(terms_[i], std::abs(value[e]) * size);
    }
  }
  const auto n = static_cast<std::size_t>(system_.n());
  for (std::size_t i = 0; i < softness_.size(); ++i)
    sum_[n + i] -= static_cast<long double>(softness_[i]) * solution[n + i];
  for (std::size_t i = 0; i < solution.size(); ++i) correction_[i] = static_cast<double>(sum_[i]);
}

/// What the largest terms of `terms_` would give alone, as accelerations, multipliers and rates in their sizes. At rest
/// accelerations are what rounding of the multipliers leaves, and have no size of their own.
std::array<double, 3> Kkt::sizes_of_terms() const {
  const auto n = static_cast<std::size_t>(system_.n()), rows = rows_.size();
  const double* value = plan_.values().data();
  std::array<double, 3> sizes{};
  double work = 0.0, arm = 0.0;  // of terms along the coordinates' nominals
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (i >= n && i < n + rows) continue;
    if (i < n) work = std::max(work, terms_[i] * system_.x[i].nominal);
    const double diagonal = diagonal_[i] >= 0 ? std::abs(value[diagonal_[i]]) : 0.0;
    double& size = sizes[i < n ? 0 : 2];
    if (diagonal > 0.0) size = std::max(size, terms_[i] / (diagonal * sizes_[i]));
  }
  const Index *start = plan_.start().data(), *row = plan_.row().data();
  for (std::size_t j = n; j < n + rows; ++j) {
    for (Index e = start[j]; e < start[j + 1]; ++e) {
      const auto i = static_cast<std::size_t>(row[e]);
      if (i < n) arm = std::max(arm, std::abs(value[e]) * system_.x[i].nominal * sizes_[j]);
    }
  }
  if (arm > 0.0) sizes[1] = work / arm;
  return sizes;
}

/// The largest of `correction_` relative to the largest of `solution` or the size that it has at least: of accelerations,
/// multipliers and rates, in their sizes.
double Kkt::relative_correction(std::span<const double> solution, const std::array<double, 3>& least) const {
  const auto n = static_cast<std::size_t>(system_.n());
  const std::size_t ends[] = {n, n + rows_.size(), solution.size()};
  double result = 0.0;
  std::size_t i = 0;
  for (std::size_t group = 0; group < 3; ++group) {
    double correction = 0.0, size = least[group];
    for (; i < ends[group]; ++i) {
      correction = std::max(correction, std::abs(correction_[i]) / sizes_[i]);
      size = std::max(size, std::abs(solution[i]) / sizes_[i]);
    }
    if (correction > 0.0) result = std::max(result, correction / std::max(size, correction));
  }
  return result;
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
  if (!std::all_of(rhs_.begin(), rhs_.end(), [](double value) { return std::isfinite(value); })) {
    const Outcome partials = blocks.check_partials(system_);
    if (!partials.ok())
      throw AnalysisError("dynamics", partials.message, "finite masses and constraint gradients",
                          "check the start values, or the law of that component",
                          pointer("/components", system_.component_name(partials.component)));
  }
  std::copy_n(rhs_.begin(), n, state.a.begin());
  for (std::size_t k = 0; k < count; ++k) state.lambda[static_cast<std::size_t>(rows_[k])] = rhs_[n + k];
  std::copy_n(rhs_.begin() + static_cast<std::ptrdiff_t>(n + count), nz, state.zdot.begin());
}

}  // namespace bramah
