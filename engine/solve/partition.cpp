#include "solve/partition.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>
#include <map>

#include "sparse/rank_lu.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

// Below this many rows the order of declaration is cheap enough, and the row that a message calls redundant is the one
// declared last; above it the order is the fill-reducing one.
constexpr Index declaration_order_up_to = 2000;

}  // namespace

std::string row_names(const System& system, std::span<const Index> rows) {
  std::string text;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == 12) return text + ", ... (" + std::to_string(rows.size()) + " in all)";
    text += (k == 0 ? "" : ", ") + system.constraint(rows[k]).name;
  }
  return text;
}

Partition choose_partition(const System& system, const State& state, std::span<const Index> independent) {
  const Index n = system.n(), count = system.m() + system.l();
  Partition result;
  if (count == 0) {
    result.ai = shifted(n, 0);
    return result;
  }
  Blocks blocks(system);
  const Outcome outcome = blocks.evaluate(system, state, Request{}.blocks({BRAMAH_R_V}));
  if (!outcome.ok()) {
    throw AnalysisError("partition", outcome.message, "constraints that can be evaluated", "check the start values",
                        outcome.component < 0 ? "" : "/components/" + system.component_name(outcome.component));
  }
  const std::vector<Index> coordinates = shifted(n, 0), rows = shifted(count, 0);
  const Term term{BRAMAH_R_V, rows, coordinates, true, 0};
  SparsePlan transposed(system, n, count, {&term, 1});
  const double one = 1.0;
  transposed.fill(blocks, {&one, 1});

  // Columns of D^T are constraint rows, its rows are coordinates: scaled by their typical magnitude.
  Vector scaled(transposed.values().begin(), transposed.values().end());
  for (std::size_t e = 0; e < scaled.size(); ++e) {
    scaled[e] *= system.x[static_cast<std::size_t>(transposed.row()[e])].nominal;
  }
  std::vector<int> row_class(static_cast<std::size_t>(n), 0);
  for (const Index i : independent) row_class[static_cast<std::size_t>(i)] = 1;

  sparse::RankLu lu;
  sparse::RankLuOptions options;
  options.row_class = row_class;
  std::vector<Index> order = shifted(count, 0);
  if (count > declaration_order_up_to) {
    // Any order with the holonomic rows first will do; take COLAMD's within each kind.
    lu.factor({n, count, transposed.start().data(), transposed.row().data(), scaled.data()}, options);
    order.assign(lu.pivot_columns().begin(), lu.pivot_columns().end());
    order.insert(order.end(), lu.dependent_columns().begin(), lu.dependent_columns().end());
    std::stable_partition(order.begin(), order.end(), [&](Index row) { return row < system.m(); });
  }
  options.order = order;
  lu.factor({n, count, transposed.start().data(), transposed.row().data(), scaled.data()}, options);

  std::vector<bool> taken(static_cast<std::size_t>(n), false);
  std::vector<Index> nonholonomic_rows;
  for (Index k = 0; k < lu.rank(); ++k) {
    const auto position = static_cast<std::size_t>(k);
    const Index coordinate = lu.pivot_rows()[position], row = lu.pivot_columns()[position];
    taken[static_cast<std::size_t>(coordinate)] = true;
    (row < system.m() ? result.d : result.ad).push_back(coordinate);
    (row < system.m() ? result.rows : nonholonomic_rows).push_back(row);
  }
  for (Index i = 0; i < n; ++i) {
    if (!taken[static_cast<std::size_t>(i)]) result.ai.push_back(i);
  }
  std::vector<std::string> lost;
  for (const Index i : independent) {
    if (taken[static_cast<std::size_t>(i)]) lost.push_back(system.x[static_cast<std::size_t>(i)].name);
  }
  if (!lost.empty()) {
    std::string names, chosen;
    for (const std::string& name : lost) names += (names.empty() ? "" : ", ") + name;
    for (const Index i : result.ai) chosen += (chosen.empty() ? "" : ", ") + system.x[static_cast<std::size_t>(i)].name;
    const bool too_many = independent.size() > result.ai.size();
    throw AnalysisError(
        "partition", "the constraints tie " + names + " to the other coordinates that shall be independent",
        result.ai.empty() ? "no independent coordinate, since the mechanism cannot move"
        : result.ai.size() == 1
            ? std::string("one independent coordinate, which moves freely")
            : std::to_string(result.ai.size()) + " independent coordinates of which none determines another",
        result.ai.empty() ? std::string("remove \"independent\"")
                          : (too_many ? "prescribe fewer, for example: " : "prescribe others, for example: ") + chosen,
        "/linearize/independent");
  }
  // Rows in ascending order read better and keep the pattern of D; coordinates keep the order of declaration.
  std::sort(result.rows.begin(), result.rows.end());
  std::sort(nonholonomic_rows.begin(), nonholonomic_rows.end());
  result.holonomic = static_cast<Index>(result.rows.size());
  result.rows.insert(result.rows.end(), nonholonomic_rows.begin(), nonholonomic_rows.end());
  std::sort(result.d.begin(), result.d.end());
  std::sort(result.ad.begin(), result.ad.end());
  // Prescribed coordinates come first, in the order of the prescription.
  std::stable_sort(result.ai.begin(), result.ai.end(), [&](Index a, Index b) {
    const auto rank = [&](Index i) {
      return std::find(independent.begin(), independent.end(), i) - independent.begin();
    };
    return !independent.empty() && rank(a) < rank(b);
  });
  result.smallest_pivot = lu.smallest_accepted();
  result.largest_refused = lu.largest_refused();
  result.growth = lu.growth();
  for (std::size_t k = 0; k < lu.dependent_columns().size(); ++k) {
    RedundantRow redundant;
    redundant.row = lu.dependent_columns()[k];
    const std::vector<double> c = lu.dependency(k);
    for (std::size_t j = 0; j < c.size(); ++j) {
      if (std::abs(c[j]) > 1e-9) redundant.follows_from.emplace_back(lu.pivot_columns()[j], c[j]);
    }
    result.redundant.push_back(std::move(redundant));
  }
  return result;
}

std::vector<RedundantSet> describe_redundancy(const System& system, const Partition& partition) {
  // Redundant rows whose dependencies share a component form one set: union by components.
  std::vector<Index> parent(system.components.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
  };
  std::vector<bool> involved(system.components.size(), false);
  for (const RedundantRow& redundant : partition.redundant) {
    const Index own = system.constraint(redundant.row).component;
    involved[static_cast<std::size_t>(own)] = true;
    for (const auto& [row, unused] : redundant.follows_from) {
      const Index other = system.constraint(row).component;
      involved[static_cast<std::size_t>(other)] = true;
      parent[static_cast<std::size_t>(root(other))] = root(own);
    }
  }
  std::map<Index, RedundantSet> sets;
  for (std::size_t i = 0; i < involved.size(); ++i) {
    if (involved[i]) sets[root(static_cast<Index>(i))].components.push_back(static_cast<Index>(i));
  }
  for (const RedundantRow& redundant : partition.redundant)
    sets[root(system.constraint(redundant.row).component)].rows.push_back(redundant.row);

  std::vector<RedundantSet> result;
  for (auto& [unused, set] : sets) {
    std::map<std::string, std::vector<std::string>> by_type;
    for (const Index i : set.components) {
      const Component& component = system.components[static_cast<std::size_t>(i)];
      // A body's own norm row takes part in every rotation; it is no joint.
      if (component.type->port_count > 0 && component.type->variable_count == 0)
        by_type[component.type->name].push_back(component.name);
    }
    for (const auto& [type, names] : by_type) {
      set.text += (set.text.empty() ? "" : ", ") + std::to_string(names.size()) + " " + type + " (";
      for (std::size_t k = 0; k < names.size() && k < 8; ++k) set.text += (k == 0 ? "" : ", ") + names[k];
      set.text += names.size() > 8 ? ", ...)" : ")";
    }
    const std::size_t count = set.rows.size();
    const std::string& last = system.component_name(system.constraint(set.rows.back()).component);
    set.text += ": " + std::to_string(count) + " redundant row" + (count == 1 ? "" : "s") + " " +
                row_names(system, set.rows) + "; the others imply " + (count == 1 ? "it" : "them") + ". To be rid of " +
                (count == 1 ? "it" : "them") + ", replace " + last + " by a joint with " + std::to_string(count) +
                " constraint" + (count == 1 ? "" : "s") + " fewer";
    result.push_back(std::move(set));
  }
  return result;
}

void take_minimum_norm(const Partition& partition, Vector& lambda) {
  const auto count = static_cast<Eigen::Index>(partition.redundant.size());
  if (count == 0) return;
  // Null vectors of D^T: N_k = e(redundant k) - sum c e(others). Least norm removes their span:
  // lambda - N (N^T N)^-1 N^T lambda.
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(lambda.size()), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const RedundantRow& redundant = partition.redundant[static_cast<std::size_t>(k)];
    N(redundant.row, k) = 1.0;
    for (const auto& [row, c] : redundant.follows_from) N(row, k) -= c;
  }
  Eigen::Map<Eigen::VectorXd> l(lambda.data(), static_cast<Eigen::Index>(lambda.size()));
  l -= N * (N.transpose() * N).ldlt().solve(N.transpose() * l);
}

}  // namespace bramah
