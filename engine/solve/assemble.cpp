#include "solve/assemble.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "solve/near_assembly.hpp"
#include "solve/redundancy.hpp"
#include "sparse/klu.hpp"
#include "system/analysis_error.hpp"
#include "system/message.hpp"
#include "system/scene.hpp"

namespace bramah {
namespace {

// Redundant rows make C W C^T singular. Subtracting this much on its diagonal keeps the factorization alive; Newton's
// method only loses a digit per step by it, and the solution is untouched.
constexpr double regularization = 1e-11;
constexpr int most_iterations = 100;
constexpr double position_tolerance = 1e-14;  // of the size of a row, times that of the terms
constexpr double velocity_tolerance = 1e-10;  // of the size of its rate alike
// Of the weights of rates that nobody gave: small beside 1, and no smaller than the factorization bears.
constexpr double follows = 1e-8;

/// Solves  min |W^-1 d|  subject to  D d = -residual  through  [W^-2 D^T; D -eps I].
class NearestPoint {
 public:
  /// `rows`: those of the block that shall close. Where `given` names coordinates, all others follow these.
  NearestPoint(const System& system, std::span<const Index> rows, int block, std::span<const Index> fixed,
               std::span<const Index> given = {})
      : n_(system.n()), rows_(rows.begin(), rows.end()), weights_(system.x.size(), given.empty() ? 1.0 : follows) {
    for (const Index i : given) weights_[static_cast<std::size_t>(i)] = 1.0;
    for (std::size_t i = 0; i < weights_.size(); ++i) weights_[i] /= system.x[i].size * system.x[i].size;
    std::vector<Index> free = shifted(n_, 0);
    for (const Index i : fixed) free[static_cast<std::size_t>(i)] = -1;  // their columns of D vanish
    const auto count = static_cast<Index>(rows.size());
    size_ = n_ + count;
    const Index all = block == BRAMAH_C_X ? system.m() : system.m() + system.l();
    const std::vector<Index> constraints = selected(all, rows, n_);
    const Term terms[] = {{block, constraints, free, false, 0}, {block, constraints, free, true, 0}};
    Vector squares;
    for (const Index row : rows) squares.push_back(std::pow(system.constraint(row).nominal, 2));
    const Diagonal diagonals[] = {{0, 0, n_, 0, weights_}, {n_, n_, count, 1, squares}};
    plan_ = SparsePlan(system, size_, size_, terms, diagonals);
    Vector sizes;  // of the correction, and of its multipliers
    for (const Variable& variable : system.x) sizes.push_back(variable.nominal);
    for (const Index row : rows) sizes.push_back(1.0 / system.constraint(row).nominal);
    lu_.analyze({size_, size_, plan_.start().data(), plan_.row().data(), plan_.values().data()}, std::move(sizes));
    rhs_.resize(static_cast<std::size_t>(size_));
  }
  [[nodiscard]] const std::vector<Index>& rows() const { return rows_; }
  /// The correction d (n), or an empty span where the matrix cannot be factored.
  std::span<const double> solve(const Blocks& blocks, const Vector& residual) {
    const double weights[] = {1.0, -regularization};
    plan_.fill(blocks, weights);
    if (!lu_.factor({size_, size_, plan_.start().data(), plan_.row().data(), plan_.values().data()})) return {};
    std::fill_n(rhs_.begin(), n_, 0.0);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      rhs_[static_cast<std::size_t>(n_) + k] = -residual[static_cast<std::size_t>(rows_[k])];
    lu_.solve(rhs_);
    return {rhs_.data(), static_cast<std::size_t>(n_)};
  }

 private:
  Index n_, size_ = 0;
  std::vector<Index> rows_;
  std::vector<double> weights_;
  SparsePlan plan_;
  sparse::Klu lu_;
  Vector rhs_;
};

std::string place_of(const System& system, const Outcome& outcome) {
  return outcome.component < 0 ? "" : pointer("/components", system.component_name(outcome.component));
}

std::string names_of(const System& system, std::span<const Index> coordinates) {
  std::string names;
  for (const Index i : coordinates) names += (names.empty() ? "" : ", ") + system.x[static_cast<std::size_t>(i)].name;
  return names;
}

double largest_of(const Vector& rows) {
  double largest = 0.0;
  for (const double row : rows) largest = std::max(largest, std::abs(row));
  return largest;
}

/// Rows of c over their sizes, rows of r over those of their rates.
double part_of(const System& system, const Vector& c, std::size_t row) {
  return std::abs(c[row]) / system.constraint(static_cast<Index>(row)).nominal;
}
double rate_part_of(const System& system, const Vector& r, std::size_t row) {
  return std::abs(r[row]) / system.rate_nominal(static_cast<Index>(row));
}

/// The first of the rows that are largest over their size but for rounding: messages shall not depend on the last digit.
template <class PartOf>
Index worst(const System& system, const Vector& rows, PartOf&& part) {
  double largest = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) largest = std::max(largest, part(system, rows, i));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (part(system, rows, i) >= (1.0 - 1e-6) * largest) return static_cast<Index>(i);
  }
  return -1;
}

/// The row that is open most and those that are half as open, for contradictions spread over all rows that take part.
std::string open_rows(const System& system, const Vector& c, Index most) {
  const Row& first = system.constraint(most);
  const double gap = std::abs(c[static_cast<std::size_t>(most)]);
  std::string others;
  int count = 0;
  for (Index i = 0; i < system.m(); ++i) {
    if (i == most || std::abs(c[static_cast<std::size_t>(i)]) < 0.5 * gap || system.constraint(i).unit != first.unit)
      continue;
    if (++count <= 5) others += ", " + system.constraint(i).name;
  }
  if (count > 5) others += ", ... (" + std::to_string(count + 1) + " in all)";
  return (count == 0 ? "the constraint " : "the constraints ") + first.name + others +
         (count == 0 ? " stays" : " stay") + " open by " + (count == 0 ? "" : "up to ") + with_unit(gap, first.unit);
}

/// What rounding of positions is relative to, in the machine's own sizes: machines may be far away.
double position_scale(const System& system, const State& state) {
  double scale = 1.0;
  for (std::size_t i = 0; i < system.x.size(); ++i) scale = std::max(scale, std::abs(state.x[i]) / system.x[i].nominal);
  return scale;
}

/// What Newton's method may leave of a row, of its size.
double closed(const System& system, const State& state) {
  return 1e3 * position_tolerance * position_scale(system, state);
}

/// What rounding of rates is relative to.
double rate_scale(const System& system, const State& state) {
  double scale = 1.0;
  for (std::size_t i = 0; i < system.x.size(); ++i)
    scale = std::max(scale, std::abs(state.v[i]) * system.scales.time / system.x[i].nominal);
  return scale;
}

/// The largest row of c over its size.
double size_of(const System& system, const Vector& c, std::span<const Index> rows) {
  double largest = 0.0;
  for (const Index row : rows) largest = std::max(largest, part_of(system, c, static_cast<std::size_t>(row)));
  return largest;
}

/// The largest row of r over the size of its rate.
double rate_size_of(const System& system, const Vector& r, std::span<const Index> rows) {
  double largest = 0.0;
  for (const Index row : rows) largest = std::max(largest, rate_part_of(system, r, static_cast<std::size_t>(row)));
  return largest;
}

/// Whether holding is to blame: the same start values with all coordinates free.
bool closes_without_holding(const System& system, State state, const Vector& start) {
  state.x = start;
  try {
    assemble_positions(system, state);
  } catch (const AnalysisError&) {
    return false;
  }
  return true;
}

/// Start values midway between two assemblies: nothing tells which is meant. Throws, or returns where this is not what
/// keeps the assembly open.
void look_for_two_sides(const System& system, const State& stuck, std::span<const Index> fixed) {
  const std::vector<Move> way = find_assemblies_on_either_side(system, stuck, fixed);
  if (way.empty()) return;
  std::vector<std::string> ways;
  for (const auto& [i, by] : way) {
    const Variable& x = system.x[static_cast<std::size_t>(i)];
    ways.push_back(x.name + " by " + with_unit(by, x.unit));
  }
  const Variable& first = system.x[static_cast<std::size_t>(way.front().first)];
  throw AnalysisError(
      "assembly",
      "the start values lie midway between two assemblies: one moves " + list_of(ways) + ", the other the other way",
      "start values that are nearer to one of them",
      "move the start value of " + first.name + " to the side that is meant",
      pointer("/components", system.component_name(first.component)));
}

/// Joints that support the same directions and demand different things there: the rows that are independent at the start
/// values close, one that repeats them does not. Throws, or returns where this is not what keeps the assembly open.
void look_for_contradiction(const System& system, State state, const Vector& start, std::span<const Index> fixed) {
  state.x = start;
  const Partition partition = choose_partition(system, state);
  const std::vector<RedundantSet> sets = describe_redundancy(system, state, partition);
  Blocks blocks(system);
  const std::span<const Index> independent(partition.rows.data(), static_cast<std::size_t>(partition.holonomic));
  if (sets.empty() || !close_positions(system, state, independent, fixed, blocks)) return;
  const Row& open = system.constraint(worst(system, blocks.c, part_of));
  const std::string& joint = system.component_name(open.component);
  const auto set = std::find_if(sets.begin(), sets.end(), [&](const RedundantSet& s) {
    return std::binary_search(s.components.begin(), s.components.end(), open.component);
  });
  if (set == sets.end()) return;
  throw AnalysisError("assembly",
                      set->joints + " are redundant and inconsistent: when the others close, " + open.name +
                          " stays open by " + with_unit(largest_of(blocks.c), open.unit),
                      "joints that agree where they support the same direction",
                      "correct the points and axes of " + joint + " or of the others, or replace " + joint +
                          " by a joint that leaves this direction free",
                      pointer("/components", joint));
}

/// The correction of v, repeated until it no longer helps; the largest |r| that is left of the rows that shall close, over
/// the size of its rate. Linear
/// in v: this is rounding or a contradiction.
double close_velocities(const System& system, State& state, NearestPoint& nearest, Blocks& blocks) {
  const Request request = Request{}.rows("r").blocks({BRAMAH_R_V});
  const double scale = rate_scale(system, state);
  double before = HUGE_VAL;
  for (int iteration = 0;; ++iteration) {
    const Outcome outcome = blocks.evaluate(system, state, request);
    if (!outcome.ok()) {
      throw AnalysisError("assembly", outcome.message, "constraints that can be evaluated at the start values",
                          "check the start values", place_of(system, outcome));
    }
    const double residual = rate_size_of(system, blocks.r, nearest.rows());
    if (residual <= 1e-15 * scale || residual >= 0.5 * before || iteration == most_iterations) return residual;
    before = residual;
    const std::span<const double> step = nearest.solve(blocks, blocks.r);
    for (std::size_t i = 0; i < step.size(); ++i) state.v[i] += step[i];
  }
}

/// Coordinates of components that have mass at `state`: of a body all, although its Euler parameters have no mass along
/// their norm. The others, like a length that is only measured, have no say in the start.
std::vector<Index> with_mass(const System& system, const State& state, Blocks& blocks) {
  std::vector<Index> all = shifted(system.n(), 0);
  const Term terms[] = {{BRAMAH_F_A, all, all, false, 0}};
  SparsePlan mass(system, system.n(), system.n(), terms);
  if (!blocks.evaluate(system, state, Request{}.blocks({BRAMAH_F_A})).ok()) return all;
  const double weights[] = {1.0};
  mass.fill(blocks, weights);
  std::vector<bool> has_mass(system.components.size());
  for (const Index i : all) {
    const auto first = mass.values().begin() + mass.start()[static_cast<std::size_t>(i)];
    const auto last = mass.values().begin() + mass.start()[static_cast<std::size_t>(i) + 1];
    if (std::any_of(first, last, [](double value) { return value != 0.0; }))
      has_mass[static_cast<std::size_t>(system.x[static_cast<std::size_t>(i)].component)] = true;
  }
  std::vector<Index> heavy;
  for (const Index i : all) {
    if (has_mass[static_cast<std::size_t>(system.x[static_cast<std::size_t>(i)].component)]) heavy.push_back(i);
  }
  return heavy;
}

/// True where the rates that are not given can follow those that are, which stay to the last bit: those without mass
/// alone where this is enough, or else all.
bool follow(const System& system, State& state, std::span<const Index> fixed, std::span<const Index> given,
            std::span<const Index> rows, Blocks& blocks) {
  constexpr double exactly = 1e-3;  // of what is tolerated: what is given may be contradictory beyond rounding
  std::vector<Index> kept(fixed.begin(), fixed.end());
  kept.insert(kept.end(), given.begin(), given.end());
  const Vector start = state.v;
  const auto closes = [&](std::span<const Index> held, std::span<const Index> leading) {
    NearestPoint nearest(system, rows, BRAMAH_R_V, held, leading);
    if (close_velocities(system, state, nearest, blocks) <= exactly * velocity_tolerance * rate_scale(system, state))
      return true;
    state.v = start;
    return false;
  };
  const std::vector<Index> heavy = with_mass(system, state, blocks);
  if (heavy.size() == static_cast<std::size_t>(system.n())) return closes(kept, {});
  std::vector<Index> all_heavy(kept);
  all_heavy.insert(all_heavy.end(), heavy.begin(), heavy.end());
  return closes(all_heavy, {}) || closes(kept, heavy);
}

}  // namespace

bool close_positions(const System& system, State& state, std::span<const Index> rows, std::span<const Index> fixed,
                     Blocks& blocks, std::span<const Index> given) {
  NearestPoint nearest(system, rows, BRAMAH_C_X, fixed, given);
  const Request request = Request{}.rows("c").blocks({BRAMAH_C_X});
  const auto evaluate = [&] {
    const Outcome outcome = blocks.evaluate(system, state, request);
    if (!outcome.ok()) {
      throw AnalysisError("assembly", outcome.message, "constraints that can be evaluated at the start values",
                          "move the start values: two points may coincide", place_of(system, outcome));
    }
  };
  evaluate();
  double residual = size_of(system, blocks.c, rows);
  const double scale = position_scale(system, state);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (residual <= position_tolerance * scale) return true;
    const std::span<const double> step = nearest.solve(blocks, blocks.c);
    if (step.empty()) break;
    const Vector before = state.x;
    double factor = 1.0;
    bool better = false;
    for (int half = 0; half < 12 && !better; ++half, factor *= 0.5) {
      for (std::size_t i = 0; i < step.size(); ++i) state.x[i] = before[i] + factor * step[i];
      for (const Index i : fixed) state.x[static_cast<std::size_t>(i)] = before[static_cast<std::size_t>(i)];
      evaluate();
      better = size_of(system, blocks.c, rows) < residual;
    }
    if (!better) {  // rounding, or a contradiction
      state.x = before;
      evaluate();
      break;
    }
    residual = size_of(system, blocks.c, rows);
  }
  return residual <= closed(system, state);
}

namespace {

bool within_tolerance(const System& system, const Vector& c) {
  for (Index i = 0; i < system.m(); ++i) {
    if (std::abs(c[static_cast<std::size_t>(i)]) > system.assembly_tolerance_of(system.constraint(i))) return false;
  }
  return true;
}

/// Joints that repeat each other but for rounding of their data. `state` is where the squares of what stays open are least;
/// from there the independent rows close. False, and `state` as it was, where more stays open than is tolerated.
bool leave_rounding(const System& system, State& state, std::span<const Index> fixed, std::span<const Index> given,
                    Blocks& blocks) {
  if (!within_tolerance(system, blocks.c)) return false;
  const Vector least_squares = state.x;
  const Partition partition = choose_partition(system, state);
  const std::span<const Index> independent(partition.rows.data(), static_cast<std::size_t>(partition.holonomic));
  if (close_positions(system, state, independent, fixed, blocks, given) && within_tolerance(system, blocks.c))
    return true;
  state.x = least_squares;
  return false;
}

/// Where `given` names coordinates, all others follow these.
void assemble(const System& system, State& state, std::span<const Index> fixed, std::span<const Index> given) {
  const Vector start = state.x;
  Blocks blocks(system);
  if (close_positions(system, state, shifted(system.m(), 0), fixed, blocks, given) ||
      leave_rounding(system, state, fixed, given, blocks))
    return;
  const Index row = worst(system, blocks.c, part_of);
  const Row& open = system.constraint(row);
  const std::string gap = open_rows(system, blocks.c, row);
  look_for_two_sides(system, state, fixed);
  if (!fixed.empty() && closes_without_holding(system, state, start)) {
    throw AnalysisError(
        "assembly",
        "with " + names_of(system, fixed) + " held at the start values, " + gap + "; without, all constraints close",
        "held coordinates whose start values agree with each other",
        "hold fewer coordinates, or correct their start values", "/hold");
  }
  look_for_contradiction(system, state, start, fixed);
  throw AnalysisError("assembly", gap, "lengths, points and start values with which all constraints can be closed",
                      "check the lengths and points of " + system.component_name(open.component) +
                          " and of what it joins, or move the start values nearer to the assembled position",
                      pointer("/components", system.component_name(open.component)));
}

/// True where the coordinates that are not `given` close all rows alone; else `state` is as it was.
bool others_close(const System& system, State& state, std::span<const Index> fixed, std::span<const Index> given) {
  const Vector start = state.x;
  std::vector<Index> kept(fixed.begin(), fixed.end());
  kept.insert(kept.end(), given.begin(), given.end());
  Blocks blocks(system);
  try {
    if (close_positions(system, state, shifted(system.m(), 0), kept, blocks)) return true;
  } catch (const AnalysisError&) {  // on the way only: the assembly of all coordinates has another
  }
  state.x = start;
  return false;
}

}  // namespace

void assemble_positions(const System& system, State& state, std::span<const Index> fixed) {
  if (system.m() > 0) assemble(system, state, fixed, {});
}

void assemble_start_positions(const System& system, State& state, std::span<const Index> fixed) {
  if (system.m() == 0) return;
  Blocks blocks(system);
  std::vector<Index> leading = with_mass(system, state, blocks);
  for (Index i = 0; i < system.n(); ++i) {
    if (system.x[static_cast<std::size_t>(i)].position_given()) leading.push_back(i);
  }
  std::sort(leading.begin(), leading.end());
  leading.erase(std::unique(leading.begin(), leading.end()), leading.end());
  if (leading.size() == static_cast<std::size_t>(system.n()) || others_close(system, state, fixed, leading))
    leading.clear();
  assemble(system, state, fixed, leading);
}

namespace {

/// Rows that repeat each other but for rounding of their data ask for rates that differ by as much of the motion.
bool rates_within_tolerance(const System& system, const State& state, const Vector& r) {
  double speed = 0.0;  // nominals per second
  for (std::size_t i = 0; i < system.x.size(); ++i) speed = std::max(speed, std::abs(state.v[i]) / system.x[i].nominal);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Row& row = system.constraint(static_cast<Index>(i));
    if (std::abs(r[i]) > speed * system.assembly_tolerance_of(row)) return false;
  }
  return true;
}

/// Where rates are `given` and not fixed, they are changed as little as possible.
void assemble_rates(const System& system, State& state, std::span<const Index> fixed, std::span<const Index> given,
                    Blocks& blocks) {
  const std::vector<Index> rows = shifted(system.m() + system.l(), 0);
  NearestPoint nearest(system, rows, BRAMAH_R_V, fixed, given);
  if (close_velocities(system, state, nearest, blocks) <= velocity_tolerance * rate_scale(system, state)) return;
  if (rates_within_tolerance(system, state, blocks.r)) {
    NearestPoint of_independent(system, choose_partition(system, state).rows, BRAMAH_R_V, fixed, given);
    static_cast<void>(close_velocities(system, state, of_independent, blocks));
    return;
  }
  const Index row = worst(system, blocks.r, rate_part_of);
  const Row& moving = system.constraint(row);
  const std::string rate = "the constraint " + moving.name + " opens at a rate of " +
                           digits(std::abs(blocks.r[static_cast<std::size_t>(row)])) +
                           (moving.unit == "1" ? " 1/s" : " " + moving.unit + "/s");
  throw AnalysisError(
      "assembly", (fixed.empty() ? "" : "with the start rates of " + names_of(system, fixed) + " held, ") + rate,
      "start rates that the constraints allow",
      fixed.empty() ? "change the start rates, or the driver that demands this one"
                    : "hold fewer coordinates, or correct their start rates",
      fixed.empty() ? pointer("/components", system.component_name(moving.component)) : std::string("/hold"));
}

}  // namespace

void assemble_velocities(const System& system, State& state, std::span<const Index> fixed) {
  if (system.m() + system.l() == 0) return;
  Blocks blocks(system);
  assemble_rates(system, state, fixed, {}, blocks);
}

void assemble_start_velocities(const System& system, State& state, std::span<const Index> fixed,
                               std::span<const Index> given) {
  if (system.m() + system.l() == 0) return;
  Blocks blocks(system);
  if (follow(system, state, fixed, given, shifted(system.m() + system.l(), 0), blocks)) return;
  assemble_rates(system, state, fixed, given, blocks);
}

bool leaves_rounding(const System& system, const State& state, const Vector& c) {
  return size_of(system, c, shifted(system.m(), 0)) > closed(system, state);
}

void close_independent_rows(const System& system, State& state, const Partition& partition, Blocks& blocks) {
  if (partition.rows.empty()) return;
  const std::span<const Index> holonomic(partition.rows.data(), static_cast<std::size_t>(partition.holonomic));
  if (!close_positions(system, state, holonomic, {}, blocks)) assemble_positions(system, state);
  NearestPoint nearest(system, partition.rows, BRAMAH_R_V, {});
  if (close_velocities(system, state, nearest, blocks) > velocity_tolerance * rate_scale(system, state))
    assemble_velocities(system, state);
}

Violation constraint_violation(const System& system, const State& state, Blocks& blocks) {
  Violation violation;
  blocks.evaluate(system, state, Request{}.rows("cr"));
  violation.position_row = worst(system, blocks.c, part_of);
  violation.velocity_row = worst(system, blocks.r, rate_part_of);
  violation.position = largest_of(blocks.c);
  violation.velocity = largest_of(blocks.r);
  return violation;
}

}  // namespace bramah
