// Whether another assembly lies close to the one that was found: the same joints, closed the other way.
//
// Some coordinates are taken as they are, x_k; the others, x_d, follow from independent rows of c. Where C_xd is nearly
// singular, with C_xd u = sigma w for unit vectors u and w, c changes along u like a parabola,
//
//   w^T c(x + s u) = sigma s + 1/2 s^2 w^T c_xx(u, u) + ...
//
// whose other root, s = -2 sigma / w^T c_xx(u, u), is where Newton's method for x_d starts from. What it finds is no
// estimate: all rows close there.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "system/system.hpp"

namespace bramah {

/// A coordinate and how far it moves (SI).
using Move = std::pair<Index, double>;

struct NearAssembly {
  double distance = 0.0;          // to the other assembly, in units of the nominals (Euclidean)
  double moved = 0.0;             // how far the assembly has moved the start values, alike
  std::vector<Move> coordinates;  // those that differ most, the largest share of the distance first
  std::vector<Index> rows;        // those that resist the way there least, by their share in w
  std::vector<Index> kept;        // of x_k those that are held or given: the same in both
};

/// Looks for it at `assembled`, to which the positions `start` were moved; `fixed` coordinates are kept, and of the others
/// those that "start" gives before all others. Reported are assemblies nearer than 1/50 nominal, about a degree, those that
/// are no farther away than the start values were, and those up to four times as far on whose side the start values lie.
std::optional<NearAssembly> find_near_assembly(const System& system, const State& assembled, const Vector& start,
                                               std::span<const Index> fixed);

/// Where Newton's method stays at `stuck` because nothing tells to which of two assemblies: sigma is zero there, and the
/// parabola has roots on either side, s = +-sqrt(-2 w^T c / w^T c_xx(u, u)). The moves to the one; those to the other are
/// opposite. Empty where this is not the reason.
std::vector<Move> find_assemblies_on_either_side(const System& system, const State& stuck,
                                                 std::span<const Index> fixed);

/// A position at which the rank of c drops, or almost: beside it the rows are independent.
struct SingularPosition {
  enum class Kind { bifurcation, locked, near };
  Kind kind = Kind::bifurcation;
  std::vector<Index> rows;         // that depend on each other here, the largest share first
  std::vector<Index> coordinates;  // that these rows join
  double distance = 0.0;           // near: how far away the singular position is, in nominals, an estimate
  double digits = 0.0;             // near: that linear models keep
};

/// Tells rows that repeat each other everywhere from those that do so at `state` only. A self-stress w, w^T C_x = 0, and
/// motions u, C_x u = 0, are constant in rank where w^T c_xx(u, u) = 0 for all u. With both signs the mechanism can go on in
/// two ways (bifurcation); with one it is locked in second order (Connelly, Whiteley 1996). Random motions of fixed seeds
/// tell which. Where no row was dropped, the smallest singular value tells how near such a position is.
std::optional<SingularPosition> find_singular_position(const System& system, const State& state);

/// Whether a pivot of the free rows at `state` is small: a tenth of its row.
bool is_nearly_singular(const System& system, const State& state);

}  // namespace bramah
