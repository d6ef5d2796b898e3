#include "solve/partition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sparse/rank_lu.hpp"
#include "system/analysis_error.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

// Closed loops are taken in the order of declaration, which follows the machine and keeps coordinates of bodies declared
// first independent; where it fills the factors by more than this, COLAMD's order is taken.
constexpr Index most_fill = 30;
constexpr double no_share = 1e-9;  // a smaller coefficient of a dependency is rounding

/// The transpose of D with its rows, the coordinates, scaled by their nominals: one column per constraint row.
struct ScaledTranspose {
  ScaledTranspose(const System& system, const State& state) {
    Blocks blocks(system);
    const Outcome outcome = blocks.evaluate(system, state, Request{}.blocks({BRAMAH_R_V}));
    if (!outcome.ok()) {
      throw AnalysisError(
          "partition", outcome.message, "constraints that can be evaluated", "check the start values",
          outcome.component < 0 ? "" : pointer("/components", system.component_name(outcome.component)));
    }
    const std::vector<Index> coordinates = shifted(system.n(), 0), rows = shifted(system.m() + system.l(), 0);
    const Term term{BRAMAH_R_V, rows, coordinates, true, 0};
    plan = SparsePlan(system, system.n(), system.m() + system.l(), {&term, 1});
    const double one = 1.0;
    plan.fill(blocks, {&one, 1});
    values.assign(plan.values().begin(), plan.values().end());
    for (std::size_t e = 0; e < values.size(); ++e)
      values[e] *= system.x[static_cast<std::size_t>(plan.row()[e])].nominal;
  }
  [[nodiscard]] sparse::CscView view() const {
    return {plan.rows(), plan.columns(), plan.start().data(), plan.row().data(), values.data()};
  }
  SparsePlan plan;
  Vector values;
};

/// The factorization that decides everything: holonomic rows first, of these the ones without fill before all others.
void factor(sparse::RankLu& lu, const sparse::CscView& D_transposed, Index m, sparse::RankLuOptions options) {
  const sparse::Singletons found = sparse::find_singletons(D_transposed, m, options);
  std::vector<Index> order = found.columns;
  order.insert(order.end(), found.others.begin(), found.others.end());
  for (Index row = m; row < D_transposed.columns; ++row) order.push_back(row);
  options.order = order;
  options.late = m;
  options.most_entries = most_fill * (D_transposed.start[D_transposed.columns] + D_transposed.columns);
  if (lu.factor(D_transposed, options)) return;

  std::vector<bool> waits(static_cast<std::size_t>(D_transposed.columns), false);
  for (const Index row : found.others) waits[static_cast<std::size_t>(row)] = true;
  auto next = order.begin() + static_cast<std::ptrdiff_t>(found.columns.size());
  for (const Index row : sparse::fill_reducing_order(D_transposed)) {
    if (waits[static_cast<std::size_t>(row)]) *next++ = row;
  }
  options.most_entries = std::numeric_limits<Index>::max();
  lu.factor(D_transposed, options);
}

/// Norms of the columns of D^T in nominals, the rows of D.
Vector row_norms(const ScaledTranspose& D) {
  Vector norms;
  const sparse::CscView view = D.view();
  for (Index row = 0; row < view.columns; ++row) {
    double sum = 0.0;
    for (Index e = view.start[row]; e < view.start[row + 1]; ++e) sum += view.value[e] * view.value[e];
    norms.push_back(std::sqrt(sum));
  }
  return norms;
}

/// Self-stresses as a matrix: a row for each, a column for every constraint row that has a share in one.
class Stresses {
 public:
  void add(Index row, Index stress, double share) { entries_.push_back({row, {stress, share}}); }
  void compress(Index count) {
    std::sort(entries_.begin(), entries_.end());
    count_ = count;
    for (const auto& [row, entry] : entries_) {
      if (rows_.empty() || rows_.back() != row) {
        rows_.push_back(row);
        start_.push_back(static_cast<Index>(stress_.size()));
      }
      stress_.push_back(entry.first);
      share_.push_back(entry.second);
    }
    start_.push_back(static_cast<Index>(stress_.size()));
  }
  [[nodiscard]] sparse::CscView view() const {
    return {count_, static_cast<Index>(rows_.size()), start_.data(), stress_.data(), share_.data()};
  }
  /// The constraint rows, one per column.
  [[nodiscard]] const std::vector<Index>& rows() const { return rows_; }

 private:
  std::vector<std::pair<Index, std::pair<Index, double>>> entries_;  // row, (self-stress, share)
  Index count_ = 0;
  std::vector<Index> rows_, start_, stress_;
  Vector share_;
};

/// Of the rows `from` ... `to` that imply each other those declared last become the redundant ones: the pivot columns of
/// their self-stresses, when these are taken backwards. Rows with a small share in a self-stress are kept: without them the
/// others would hardly be independent.
std::vector<RedundantRow> declared_last(const std::vector<RedundantRow>& redundant, Index from, Index to,
                                        const Vector& norms) {
  constexpr double safe_exchange = 1e-3;  // no row in place of one that it hardly depends on
  constexpr double least_share = 0.1;     // of the largest of its self-stress
  std::vector<RedundantRow> result;
  Stresses all, candidates;
  Index count = 0;
  for (const RedundantRow& r : redundant) {
    if (r.row < from || r.row >= to) {
      result.push_back(r);
      continue;
    }
    const auto weight = [&](Index row, double share) { return std::abs(share) * norms[static_cast<std::size_t>(row)]; };
    const auto may_go = [&](Index row) { return row >= from && row < to; };
    double largest = weight(r.row, 1.0);
    for (const auto& [row, c] : r.follows_from) largest = may_go(row) ? std::max(largest, weight(row, c)) : largest;
    const auto add = [&](Index row, double share) {
      all.add(row, count, share);
      if (may_go(row) && weight(row, share) >= least_share * largest) candidates.add(row, count, share);
    };
    add(r.row, 1.0);
    for (const auto& [row, c] : r.follows_from) add(row, -c);
    ++count;
  }
  if (count == 0) return result;
  all.compress(count);
  candidates.compress(count);
  std::vector<Index> order(candidates.rows().size());
  std::iota(order.rbegin(), order.rend(), Index{0});
  sparse::RankLu lu;
  lu.factor(candidates.view(), {.rank_tolerance = safe_exchange, .order = order});
  if (lu.rank() < count) return redundant;
  // All of them with the redundant ones first, so that the others are told in these.
  std::vector<bool> taken(all.rows().size(), false);
  order.clear();
  for (const Index column : lu.pivot_columns()) {
    const auto place =
        std::lower_bound(all.rows().begin(), all.rows().end(), candidates.rows()[static_cast<std::size_t>(column)]);
    order.push_back(place - all.rows().begin());
    taken[static_cast<std::size_t>(order.back())] = true;
  }
  for (std::size_t column = 0; column < taken.size(); ++column) {
    if (!taken[column]) order.push_back(static_cast<Index>(column));
  }
  lu.factor(all.view(), {.order = order});
  if (lu.rank() < count || std::any_of(lu.pivot_columns().begin(), lu.pivot_columns().end(),
                                       [&](Index column) { return !taken[static_cast<std::size_t>(column)]; }))
    return redundant;
  std::vector<RedundantRow> exchanged(static_cast<std::size_t>(count));
  std::vector<std::size_t> place(all.rows().size());
  for (std::size_t k = 0; k < exchanged.size(); ++k) {
    const auto column = static_cast<std::size_t>(lu.pivot_columns()[k]);
    place[column] = k;
    exchanged[k].row = all.rows()[column];
  }
  const std::vector<sparse::Dependency> dependencies = lu.dependencies();
  for (std::size_t k = 0; k < dependencies.size(); ++k) {
    const Index row = all.rows()[static_cast<std::size_t>(lu.dependent_columns()[k])];
    for (const auto& [column, c] : dependencies[k]) {
      if (std::abs(c) > no_share) exchanged[place[static_cast<std::size_t>(column)]].follows_from.emplace_back(row, -c);
    }
  }
  result.insert(result.end(), std::make_move_iterator(exchanged.begin()), std::make_move_iterator(exchanged.end()));
  return result;
}

std::vector<RedundantRow> redundant_rows(const sparse::RankLu& lu, Index m, const Vector& norms) {
  std::vector<RedundantRow> result;
  const std::vector<sparse::Dependency> dependencies = lu.dependencies();
  for (std::size_t k = 0; k < dependencies.size(); ++k) {
    RedundantRow& redundant = result.emplace_back();
    redundant.row = lu.dependent_columns()[k];
    for (const auto& [row, c] : dependencies[k]) {
      if (std::abs(c) > no_share) redundant.follows_from.emplace_back(row, c);
    }
  }
  // A nonholonomic row cannot take the place of a holonomic one.
  result = declared_last(result, 0, m, norms);
  result = declared_last(result, m, static_cast<Index>(norms.size()), norms);
  for (RedundantRow& r : result) std::sort(r.follows_from.begin(), r.follows_from.end());
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  return result;
}

std::string names_of(const System& system, const std::vector<Index>& coordinates) {
  std::string text;
  for (const Index i : coordinates) text += (text.empty() ? "" : ", ") + system.x[static_cast<std::size_t>(i)].name;
  return text;
}

/// Prescribed coordinates that the factorization has put elsewhere.
std::vector<Index> missing_from(const std::vector<Index>& list, const std::vector<Index>& prescribed) {
  std::vector<Index> missing;
  for (const Index i : prescribed) {
    if (std::find(list.begin(), list.end(), i) == list.end()) missing.push_back(i);
  }
  return missing;
}

void check_independent(const System& system, const Partition& chosen, const std::vector<Index>& prescribed) {
  const std::vector<Index> lost = missing_from(chosen.ai, prescribed);
  if (lost.empty()) return;
  const std::size_t count = chosen.ai.size();
  throw AnalysisError(
      "partition",
      "the constraints tie " + names_of(system, lost) + " to the other coordinates that shall be independent",
      count == 0   ? std::string("no independent coordinate, since the mechanism cannot move")
      : count == 1 ? std::string("one independent coordinate, which moves freely")
                   : std::to_string(count) + " independent coordinates of which none determines another",
      count == 0 ? std::string("remove \"independent\"")
                 : (prescribed.size() > count ? "prescribe fewer, for example: " : "prescribe others, for example: ") +
                       names_of(system, chosen.ai),
      "/linearize/independent");
}

void check_admissible(const System& system, const Partition& chosen, const std::vector<Index>& prescribed) {
  const std::vector<Index> lost = missing_from(chosen.ad, prescribed);
  if (lost.empty()) return;
  const std::size_t count = chosen.ad.size();
  throw AnalysisError(
      "partition",
      names_of(system, lost) + " cannot be admissible dependent" + (prescribed.size() > 1 ? " beside the others" : "") +
          ": no nonholonomic constraint gives " + (lost.size() == 1 ? "its rate" : "their rates"),
      count == 0   ? std::string("none, since no nonholonomic constraint is independent")
      : count == 1 ? std::string("one coordinate, whose rate the nonholonomic constraint gives")
                   : std::to_string(count) + " coordinates, whose rates the nonholonomic constraints give",
      count == 0 ? std::string("remove \"admissible_dependent\"")
                 : (prescribed.size() > count ? "prescribe fewer, for example: " : "prescribe others, for example: ") +
                       names_of(system, chosen.ad),
      "/linearize/admissible_dependent");
}

/// Prescribed coordinates first, in the order of the prescription.
void put_first(std::vector<Index>& list, const std::vector<Index>& prescribed) {
  auto next = list.begin();
  for (const Index i : prescribed) {
    const auto at = std::find(next, list.end(), i);
    std::rotate(next, at, at + 1);
    ++next;
  }
}

}  // namespace

double rank_tolerance_of(const System& system) {
  return std::max(sparse::RankLuOptions{}.rank_tolerance, system.rank_tolerance());
}

std::vector<Index> left_out_by(const Partition& partition) {
  std::vector<Index> rows;
  for (const RedundantRow& r : partition.redundant) rows.push_back(r.row);
  return rows;
}

std::string row_names(const System& system, std::span<const Index> rows) {
  std::string text;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == 12) return text + ", ... (" + std::to_string(rows.size()) + " in all)";
    text += (k == 0 ? "" : ", ") + system.constraint(rows[k]).name;
  }
  return text;
}

Partition choose_partition(const System& system, const State& state, const Prescribed& prescribed) {
  const Index n = system.n(), m = system.m(), count = m + system.l();
  Partition result;
  sparse::RankLu lu;
  if (count > 0) {
    const ScaledTranspose D(system, state);
    // While holonomic rows are eliminated, all prescribed coordinates wait; nonholonomic rows then take admissible ones
    // first and independent ones last.
    std::vector<int> holonomic_class(static_cast<std::size_t>(n), 0), nonholonomic_class = holonomic_class;
    for (const Index i : prescribed.admissible_dependent) {
      holonomic_class[static_cast<std::size_t>(i)] = 1;
      nonholonomic_class[static_cast<std::size_t>(i)] = -1;
    }
    for (const Index i : prescribed.independent)
      holonomic_class[static_cast<std::size_t>(i)] = nonholonomic_class[static_cast<std::size_t>(i)] = 1;
    sparse::RankLuOptions options;
    options.rank_tolerance = rank_tolerance_of(system);
    options.row_class = holonomic_class;
    options.late_row_class = nonholonomic_class;
    factor(lu, D.view(), m, options);
    result.redundant = redundant_rows(lu, m, row_norms(D));
  }

  std::vector<bool> dependent(static_cast<std::size_t>(n), false), redundant(static_cast<std::size_t>(count), false);
  for (const RedundantRow& r : result.redundant) redundant[static_cast<std::size_t>(r.row)] = true;
  for (Index k = 0; k < lu.rank(); ++k) {
    const auto position = static_cast<std::size_t>(k);
    const Index coordinate = lu.pivot_rows()[position];
    dependent[static_cast<std::size_t>(coordinate)] = true;
    (lu.pivot_columns()[position] < m ? result.d : result.ad).push_back(coordinate);
  }
  // Rows in ascending order read better and keep the pattern of D; coordinates keep the order of declaration.
  for (Index row = 0; row < count; ++row) {
    if (!redundant[static_cast<std::size_t>(row)]) result.rows.push_back(row);
  }
  for (Index i = 0; i < n; ++i) {
    if (!dependent[static_cast<std::size_t>(i)]) result.ai.push_back(i);
  }
  std::sort(result.d.begin(), result.d.end());
  std::sort(result.ad.begin(), result.ad.end());
  result.holonomic = static_cast<Index>(result.d.size());
  check_independent(system, result, prescribed.independent);
  check_admissible(system, result, prescribed.admissible_dependent);
  put_first(result.ai, prescribed.independent);
  put_first(result.ad, prescribed.admissible_dependent);
  result.smallest_pivot = lu.smallest_accepted();
  result.largest_refused = lu.largest_refused();
  result.growth = lu.growth();
  return result;
}

}  // namespace bramah
