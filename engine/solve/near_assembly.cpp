#include "solve/near_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "solve/assemble.hpp"
#include "sparse/rank_lu.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

constexpr double near = 2e-2;       // in nominals: angles given in whole degrees cannot tell such assemblies apart
constexpr double comparable = 4.0;  // times the way that the start values were moved
constexpr double towards = 0.25;    // of the way to the other assembly: the start values lie there; midway it is a half
constexpr double same = 1e-6;       // in nominals: a double root, told apart no better than to sqrt(eps)
constexpr double well_apart = 0.1;  // of a pivot relative to its row: the other assembly is not near
constexpr double takes_part = 0.1;  // of the largest share in u or w
constexpr int inverse_iterations = 4;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// C_x^T in nominals, without the rows of fixed coordinates, factored: its pivots are x_d and the independent rows of c.
class FreeRows {
 public:
  /// Coordinates that "start" gives are pivots where no others serve, if `given_last`.
  FreeRows(const System& system, const State& state, std::span<const Index> fixed, bool given_last = true) {
    Blocks blocks(system);
    if (!blocks.evaluate(system, state, Request{}.blocks({BRAMAH_C_X})).ok()) return;
    std::vector<Index> free = shifted(system.n(), 0);
    for (const Index i : fixed) free[at(i)] = -1;
    const std::vector<Index> rows = shifted(system.m(), 0);
    const Term term{BRAMAH_C_X, rows, free, true, 0};
    plan_ = SparsePlan(system, system.n(), system.m(), {&term, 1});
    const double one = 1.0;
    plan_.fill(blocks, {&one, 1});
    values_.assign(plan_.values().begin(), plan_.values().end());
    for (std::size_t e = 0; e < values_.size(); ++e) values_[e] *= system.x[at(plan_.row()[e])].nominal;
    std::vector<int> given;
    for (const Variable& x : system.x) given.push_back(given_last && x.start_given ? 1 : 0);
    sparse::RankLuOptions options;
    options.rank_tolerance = rank_tolerance_of(system);
    options.row_class = given;
    lu_.factor({plan_.rows(), plan_.columns(), plan_.start().data(), plan_.row().data(), values_.data()}, options);
  }
  [[nodiscard]] bool nearly_singular() const { return lu_.rank() > 0 && lu_.smallest_accepted() < well_apart; }
  [[nodiscard]] const std::vector<Index>& coordinates() const { return lu_.pivot_rows(); }
  [[nodiscard]] const std::vector<Index>& rows() const { return lu_.pivot_columns(); }
  [[nodiscard]] const std::vector<Index>& dependent_rows() const { return lu_.dependent_columns(); }

  /// u (n) and w (m) of the smallest singular value of C_xd, by inverse iteration; the value itself is returned.
  double smallest(Vector& u, Vector& w) const {
    u.resize(at(plan_.rows()));
    w.resize(at(plan_.columns()));
    for (std::size_t k = 0; k < w.size(); ++k) w[k] = std::sin(1.0 + static_cast<double>(k));  // orthogonal to nothing
    double sigma = 0.0;
    for (int k = 0; k < inverse_iterations; ++k) {
      normalize(w);
      lu_.solve_transposed(w, u);
      sigma = 1.0 / normalize(u);
      lu_.solve(u, w);
    }
    normalize(w);
    return sigma;
  }

  /// w (m) with w^T C_x = 0, for every dependent row.
  [[nodiscard]] std::vector<Vector> self_stresses() const {
    std::vector<Vector> result;
    const std::vector<sparse::Dependency> dependencies = lu_.dependencies();
    for (std::size_t k = 0; k < dependencies.size(); ++k) {
      Vector& w = result.emplace_back(at(plan_.columns()), 0.0);
      w[at(dependent_rows()[k])] = 1.0;
      for (const auto& [row, c] : dependencies[k]) w[at(row)] = -c;
    }
    return result;
  }
  /// u (n) with C_x u = 0, of largest entry 1, that moves all other coordinates by random shares.
  [[nodiscard]] Vector random_motion(std::mt19937_64& random) const {
    Vector others(at(plan_.rows()));
    for (double& share : others) share = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    for (const Index i : coordinates()) others[at(i)] = 0.0;
    Vector u = completed(others);
    double largest = 0.0;
    for (const double value : u) largest = std::max(largest, std::abs(value));
    for (double& value : u) value /= std::max(largest, 1e-300);
    return u;
  }
  /// Coordinates that have entries in the given rows.
  [[nodiscard]] std::vector<Index> joined_by(std::span<const Index> rows) const {
    std::vector<Index> result;
    for (const Index row : rows)
      result.insert(result.end(), plan_.row().begin() + plan_.start()[at(row)],
                    plan_.row().begin() + plan_.start()[at(row) + 1]);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }
  /// u (n) with C_x u = 0 that moves x_d and coordinate j.
  [[nodiscard]] Vector motion(Index j) const {
    Vector others(at(plan_.rows()), 0.0);
    others[at(j)] = 1.0;
    return completed(others);
  }

 private:
  /// u (n) with C_x u = 0 that moves the other coordinates as `others`, which is zero at x_d.
  [[nodiscard]] Vector completed(const Vector& others) const {
    Vector column(at(plan_.columns()), 0.0), u(at(plan_.rows()));
    for (Index row = 0; row < plan_.columns(); ++row) {
      for (Index e = plan_.start()[at(row)]; e < plan_.start()[at(row) + 1]; ++e)
        column[at(row)] -= values_[at(e)] * others[at(plan_.row()[at(e)])];
    }
    lu_.solve_transposed(column, u);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += others[i];
    return u;
  }
  static double normalize(Vector& vector) {
    double sum = 0.0;
    for (const double value : vector) sum += value * value;
    for (double& value : vector) value /= std::sqrt(sum);
    return std::sqrt(sum);
  }
  SparsePlan plan_;
  Vector values_;
  sparse::RankLu lu_;
};

/// c_xx(u, u) by rows, u in nominals: what s, quadratic in v, has beside its other terms. Zeros where it cannot be evaluated.
Vector second_order(const System& system, State state, const Vector& u) {
  Blocks blocks(system);
  std::fill(state.a.begin(), state.a.end(), 0.0);
  Vector bend(at(system.m()), 0.0);
  for (const double factor : {-1.0, 0.0, 1.0}) {
    for (std::size_t i = 0; i < u.size(); ++i) state.v[i] = factor * u[i] * system.x[i].nominal;
    if (!blocks.evaluate(system, state, Request{}.rows("s")).ok()) {
      std::fill(bend.begin(), bend.end(), 0.0);
      return bend;
    }
    for (std::size_t k = 0; k < bend.size(); ++k) bend[k] += (factor == 0.0 ? -1.0 : 0.5) * blocks.s[k];
  }
  return bend;
}

/// w^T c_xx(u, u).
double curvature(const System& system, const State& state, const Vector& u, const Vector& w) {
  const Vector bend = second_order(system, state, u);
  return std::inner_product(w.begin(), w.end(), bend.begin(), 0.0);
}

double distance(const System& system, const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < system.x.size(); ++i) sum += std::pow((a[i] - b[i]) / system.x[i].size, 2);
  return std::sqrt(sum);
}

/// Where `start` lies between two assemblies, as part of the way from `a` to `b`.
double part_of_way(const System& system, const Vector& a, const Vector& b, const Vector& start) {
  double along = 0.0;
  for (std::size_t i = 0; i < system.x.size(); ++i)
    along += (start[i] - a[i]) * (b[i] - a[i]) / std::pow(system.x[i].size, 2);
  return along / std::pow(distance(system, a, b), 2);
}

/// Members of `all` whose share is at least a tenth of the largest, in falling order; shares that are equal but for rounding
/// stay in the scene's order.
template <class Share>
std::vector<Index> largest(std::vector<Index> all, Share&& share) {
  std::sort(all.begin(), all.end());
  double most = 0.0;
  for (const Index i : all) most = std::max(most, share(i));
  const auto rank = [&](Index i) { return std::round(1e4 * share(i) / most); };
  std::stable_sort(all.begin(), all.end(), [&](Index a, Index b) { return rank(a) > rank(b); });
  const auto end = std::find_if(all.begin(), all.end(), [&](Index i) { return share(i) < takes_part * share(all[0]); });
  all.erase(end, all.end());
  return all;
}

/// Where Newton's method for the coordinates `moving` comes to rest from x + s u; true where all rows close there.
bool go_over(const System& system, State& state, std::span<const Index> moving, std::vector<Index> rows,
             const Vector& u, double s) {
  std::vector<Index> kept = shifted(system.n(), 0);
  for (const Index i : moving) {
    kept[at(i)] = -1;
    state.x[at(i)] += s * u[at(i)] * system.x[at(i)].nominal;
  }
  std::erase(kept, Index{-1});
  std::sort(rows.begin(), rows.end());
  Blocks blocks(system);
  try {
    if (!close_positions(system, state, rows, kept, blocks)) return false;
  } catch (const AnalysisError&) {  // beyond where the rows can be evaluated
    return false;
  }
  constexpr double closed = 1e-9;  // redundant rows are not among the independent ones
  for (std::size_t k = 0; k < blocks.c.size(); ++k) {
    if (!(std::abs(blocks.c[k]) < closed * system.holonomic[k].nominal)) return false;
  }
  return true;
}

/// From `a` to `b`, for those of `coordinates` that have a share in the distance.
std::vector<Move> moves(const System& system, const Vector& a, const Vector& b, std::span<const Index> coordinates) {
  std::vector<Move> result;
  const auto way = [&](Index i) { return std::abs(b[at(i)] - a[at(i)]) / system.x[at(i)].size; };
  for (const Index i : largest({coordinates.begin(), coordinates.end()}, way))
    result.emplace_back(i, b[at(i)] - a[at(i)]);
  return result;
}

}  // namespace

std::optional<NearAssembly> find_near_assembly(const System& system, const State& assembled, const Vector& start,
                                               std::span<const Index> fixed) {
  const FreeRows free(system, assembled, fixed);
  if (system.m() == 0 || !free.nearly_singular()) return std::nullopt;
  Vector u, w;
  const double sigma = free.smallest(u, w);
  NearAssembly result;
  result.moved = distance(system, assembled.x, start);
  const double limit = std::max(near, comparable * result.moved), bend = curvature(system, assembled, u, w);
  if (2.0 * sigma > 2.0 * limit * std::abs(bend)) return std::nullopt;  // by far, and an estimate
  State other = assembled;
  if (!go_over(system, other, free.coordinates(), free.rows(), u, -2.0 * sigma / bend)) return std::nullopt;
  result.distance = distance(system, assembled.x, other.x);
  if (result.distance < same || result.distance > limit) return std::nullopt;
  if (result.distance > std::max(near, result.moved) && part_of_way(system, assembled.x, other.x, start) < towards)
    return std::nullopt;

  result.coordinates = moves(system, assembled.x, other.x, free.coordinates());
  result.rows = largest(free.rows(), [&](Index k) { return std::abs(w[at(k)]); });
  for (Index i = 0; i < system.n(); ++i) {
    const bool dependent =
        std::find(free.coordinates().begin(), free.coordinates().end(), i) != free.coordinates().end();
    if (!dependent && (system.x[at(i)].start_given || std::find(fixed.begin(), fixed.end(), i) != fixed.end()))
      result.kept.push_back(i);
  }
  return result;
}

std::vector<Move> find_assemblies_on_either_side(const System& system, const State& stuck,
                                                 std::span<const Index> fixed) {
  const FreeRows free(system, stuck, fixed);
  Blocks blocks(system);
  if (free.dependent_rows().empty() || !blocks.evaluate(system, stuck, Request{}.rows("c")).ok()) return {};
  std::vector<bool> taken(at(system.n()), false);
  for (const std::span<const Index> list : {std::span<const Index>(free.coordinates()), fixed}) {
    for (const Index i : list) taken[at(i)] = true;
  }
  for (const Vector& w : free.self_stresses()) {
    const double open = std::inner_product(w.begin(), w.end(), blocks.c.begin(), 0.0);
    for (Index j = 0; j < system.n(); ++j) {
      if (taken[at(j)]) continue;
      const Vector u = free.motion(j);
      const double s2 = -2.0 * open / curvature(system, stuck, u, w);
      if (!std::isfinite(s2) || s2 <= same * same) continue;
      std::vector<Index> moving = free.coordinates();
      moving.push_back(j);
      State one = stuck, other = stuck;
      const std::vector<Index> rows = shifted(system.m(), 0);
      if (go_over(system, one, moving, rows, u, std::sqrt(s2)) &&
          go_over(system, other, moving, rows, u, -std::sqrt(s2)))
        return moves(system, stuck.x, one.x, moving);
    }
  }
  return {};
}

bool is_nearly_singular(const System& system, const State& state) {
  return system.m() > 0 && FreeRows(system, state, {}, false).nearly_singular();
}

std::optional<SingularPosition> find_singular_position(const System& system, const State& state) {
  constexpr int motions = 24;           // enough for both signs of a form that has them
  constexpr double cancels = 1e-6;      // of its terms: what rounding of the scene's data leaves of a sum that is zero
  constexpr double least_terms = 1e-9;  // of the rows' own sizes: terms that are rounding themselves
  constexpr double few_digits = 9.0;    // a linear model with fewer is told of
  if (system.m() == 0) return std::nullopt;
  const FreeRows free(system, state, {}, false);
  SingularPosition result;
  const auto found = [&](SingularPosition::Kind kind, const Vector& w) {
    result.kind = kind;
    std::vector<Index> rows = shifted(system.m(), 0);
    result.rows = largest(std::move(rows), [&](Index k) { return std::abs(w[at(k)]); });
    result.coordinates = free.joined_by(result.rows);
    return result;
  };
  const std::vector<Vector> stresses = free.self_stresses();
  std::vector<Vector> bends;
  std::mt19937_64 random(1);
  for (int k = 0; k < motions && !stresses.empty(); ++k)
    bends.push_back(second_order(system, state, free.random_motion(random)));
  for (const Vector& w : stresses) {
    double size = 0.0;
    for (std::size_t k = 0; k < w.size(); ++k) size += std::abs(w[k]) * system.holonomic[k].nominal;
    bool up = false, down = false;
    for (const Vector& bend : bends) {
      double sum = 0.0, terms = 0.0;
      for (std::size_t k = 0; k < w.size(); ++k) {
        sum += w[k] * bend[k];
        terms += std::abs(w[k] * bend[k]);
      }
      if (std::abs(sum) <= std::max(cancels * terms, least_terms * size)) continue;
      (sum > 0.0 ? up : down) = true;
    }
    if (up && down) return found(SingularPosition::Kind::bifurcation, w);
    if (up || down) return found(SingularPosition::Kind::locked, w);
  }
  if (!free.nearly_singular()) return std::nullopt;
  Vector u, w;
  const double sigma = free.smallest(u, w), bend = std::abs(curvature(system, state, u, w));
  // Positions are closed to rounding, which moves the machine by eps / sigma and its tangents by as much over sigma.
  result.digits = std::max(0.0, std::log10(sigma * sigma / std::numeric_limits<double>::epsilon()));
  if (result.digits >= few_digits || !(bend > std::sqrt(sigma))) return std::nullopt;
  result.distance = sigma / bend;
  return found(SingularPosition::Kind::near, w);
}

}  // namespace bramah
