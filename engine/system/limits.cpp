#include "system/limits.hpp"

#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {

Limits::Limits(const System& system) : system_(system), functions_(system, BRAMAH_EXTENSION_VALIDITY) {
  std::size_t of = 0;
  functions_.for_each([&](const bramah_validity& validity, Index component, std::int32_t k) {
    const bramah_limit_info& limit = validity.info[k];
    const auto add = [&](double bound, bool lower, bool ends) {
      if (!std::isfinite(bound)) return;
      info_.push_back({component, limit.name, limit.unit, limit.doc, bound, lower, ends,
                       limit.nominal * system.scales.of(limit.unit), of});
    };
    add(limit.lowest, true, true);
    add(limit.highest, false, true);
    if (limit.lower > limit.lowest) add(limit.lower, true, false);
    if (limit.upper < limit.highest) add(limit.upper, false, false);
    ++of;
  });
  inside_.resize(info_.size());
}

const Vector& Limits::evaluate(const State& state) {
  const Vector& values = functions_.evaluate(state);
  for (std::size_t k = 0; k < info_.size(); ++k) {
    const double way = values[info_[k].of] - info_[k].bound;
    inside_[k] = info_[k].lower ? way : -way;
  }
  return inside_;
}

bool Limits::is_outside(std::size_t k) const {
  constexpr double rounding = 1e-12;  // of the nominal: what counts as on the bound
  return inside_[k] < -rounding * info_[k].nominal;
}

std::string Limits::text(std::size_t k, double inside) const {
  const Info& limit = info_[k];
  const double value = limit.bound + (limit.lower ? inside : -inside);
  const std::string who = "the " + limit.doc + ", " + system_.component_name(limit.component) + "." + limit.name + ", ";
  if (std::abs(inside) < 1e-6 * limit.nominal) return who + "reaches " + with_unit(limit.bound, limit.unit, 6);
  return who + "is " + with_unit(value, limit.unit, 6) + ", " + (limit.lower ? "below " : "above ") +
         with_unit(limit.bound, limit.unit, 6);
}

AnalysisError Limits::error(const std::string& analysis, const State& state, std::size_t k) {
  const Vector& inside = evaluate(state);
  const Info& limit = info_[k];
  const std::string& name = system_.component_name(limit.component);
  std::vector<std::string> others;
  for (std::size_t j = 0; j < info_.size(); ++j) {
    if (j != k && info_[j].ends && is_outside(j)) others.push_back(text(j, inside[j]));
  }
  return {analysis,
          "at t = " + digits(state.t, 9) + " s " + text(k, inside[k]) + ": the law of " + name + " ends there" +
              (others.empty() ? "" : "; so does that of others: " + list_of(others)),
          std::string(limit.lower ? "at least " : "at most ") + with_unit(limit.bound, limit.unit, 6),
          "check the parameters of " + name + " and the start values, or add what keeps the machine from going there",
          pointer("/components", name)};
}

std::vector<std::pair<std::size_t, std::string>> Limits::passed(const State& state) {
  std::vector<std::pair<std::size_t, std::string>> list;
  const Vector& inside = evaluate(state);
  for (std::size_t k = 0; k < info_.size(); ++k) {
    if (!info_[k].ends && is_outside(k)) list.emplace_back(k, text(k, inside[k]));
  }
  return list;
}

void Limits::require(const std::string& analysis, const State& state) {
  evaluate(state);
  for (std::size_t k = 0; k < info_.size(); ++k) {
    if (info_[k].ends && is_outside(k)) throw error(analysis, state, k);
  }
}

void require_within_limits(const System& system, const std::string& analysis, const State& state) {
  Limits(system).require(analysis, state);
}

}  // namespace bramah
