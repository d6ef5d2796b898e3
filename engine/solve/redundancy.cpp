#include "solve/redundancy.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "sparse/klu.hpp"
#include "system/message.hpp"

namespace bramah {
namespace {

using Wrench = Eigen::Matrix<double, 6, 1>;  // force (N) and moment (N.m) on a body at its frame, ground axes
using Gram = Eigen::Matrix<double, 6, 6>;
using Direction = Eigen::Vector3d;

constexpr double no_share = 1e-7;  // of a direction or a rank against 1: far above rounding, far below a real one
constexpr std::size_t most_names = 8;

/// "a, b, c"; long lists are cut.
std::string list_of(const std::vector<std::string>& names, const char* last = ", ") {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k == most_names) return text + ", ... (" + std::to_string(names.size()) + " in all)";
    text += (k == 0 ? "" : k + 1 == names.size() ? last : ", ") + names[k];
  }
  return text;
}

/// Where the frames of bodies begin among the coordinates: for each coordinate of one, its first.
struct Frames {
  explicit Frames(const System& system) : first(system.x.size(), -1) {
    for (std::size_t i = 0; i < system.x.size();) {
      const std::string& kind = system.x[i].kind;
      const std::size_t slots = kind == "frame" ? 7 : kind == "planar_frame" ? 3 : 1;
      if (slots > 1) std::fill_n(first.begin() + static_cast<std::ptrdiff_t>(i), slots, static_cast<Index>(i));
      i += slots;
    }
  }
  std::vector<Index> first;
};

/// What a unit multiplier of constraint rows does to bodies.
class Reactions {
 public:
  Reactions(const System& system, const State& state) : system_(system), state_(state), frames_(system) {
    Blocks blocks(system);
    blocks.evaluate(system, state, Request{}.blocks({BRAMAH_R_V}));
    const std::vector<Index> coordinates = shifted(system.n(), 0), rows = shifted(system.m() + system.l(), 0);
    const Term term{BRAMAH_R_V, rows, coordinates, true, 0};
    gradients_ = SparsePlan(system, system.n(), system.m() + system.l(), {&term, 1});
    const double one = 1.0;
    gradients_.fill(blocks, {&one, 1});
  }
  /// The frame of a body that `row` acts on, the first of them; -1 where there is none.
  [[nodiscard]] Index frame_of(Index row) const {
    for (Index e = begin(row); e < begin(row + 1); ++e) {
      const Index frame = frames_.first[coordinate(e)];
      if (frame >= 0) return frame;
    }
    return -1;
  }
  [[nodiscard]] Wrench on(Index frame, Index row) const {
    Eigen::Matrix<double, 7, 1> Q = Eigen::Matrix<double, 7, 1>::Zero();
    for (Index e = begin(row); e < begin(row + 1); ++e) {
      if (frames_.first[coordinate(e)] != frame) continue;
      Q(static_cast<Index>(coordinate(e)) - frame) = gradients_.values()[static_cast<std::size_t>(e)];
    }
    Wrench w = Wrench::Zero();
    const auto first = static_cast<std::size_t>(frame);
    if (system_.x[first].kind == "planar_frame") {
      w << Q(0), Q(1), 0.0, 0.0, 0.0, Q(2);
      return w;
    }
    // omega = 2 E edot in ground axes, hence M = E Q_e / 2.
    const double *e = &state_.x[first + 3], *q = Q.data() + 3;
    w << Q(0), Q(1), Q(2), 0.5 * (-e[1] * q[0] + e[0] * q[1] - e[3] * q[2] + e[2] * q[3]),
        0.5 * (-e[2] * q[0] + e[3] * q[1] + e[0] * q[2] - e[1] * q[3]),
        0.5 * (-e[3] * q[0] - e[2] * q[1] + e[1] * q[2] + e[0] * q[3]);
    return w;
  }

 private:
  [[nodiscard]] Index begin(Index row) const { return gradients_.start()[static_cast<std::size_t>(row)]; }
  [[nodiscard]] std::size_t coordinate(Index e) const {
    return static_cast<std::size_t>(gradients_.row()[static_cast<std::size_t>(e)]);
  }
  const System& system_;
  const State& state_;
  Frames frames_;
  SparsePlan gradients_;  // (n x m + l), D^T
};

/// "x", "y", "z" or the numbers, with the first one that is not zero positive.
std::string axis_name(Direction d) {
  d.normalize();
  for (const Index k : {0, 1, 2}) {
    if (std::abs(d(k)) > 1.0 - no_share) return {"xyz"[k]};
  }
  for (Index k = 0; k < 3; ++k) {
    if (std::abs(d(k)) < no_share) d(k) = 0.0;
  }
  const Index lead = d(0) != 0.0 ? 0 : d(1) != 0.0 ? 1 : 2;
  if (d(lead) < 0.0) d = -d;
  return "(" + digits(d(0)) + ", " + digits(d(1)) + ", " + digits(d(2)) + ")";
}

/// A space of directions: its dimension, and the axis that spans it (1) or is normal to it (2).
struct Directions {
  int dimension = 0;
  Direction axis = Direction::Zero();
  explicit Directions(const Eigen::Matrix3d& gram) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(gram);
    const double largest = solver.eigenvalues()(2);
    if (!(largest > 0.0)) return;
    for (Index k = 0; k < 3; ++k) dimension += solver.eigenvalues()(k) > no_share * largest ? 1 : 0;
    axis = solver.eigenvectors().col(dimension == 1 ? 2 : 0);
  }
};

/// Forces and moments of self-stresses at a joint. Moments: those that come without a force, for they do not depend on
/// the point.
struct Clamping {
  Directions force, moment;
  explicit Clamping(const Gram& gram) : force(gram.topLeftCorner<3, 3>()), moment(pure_moments(gram)) {}

  static Eigen::Matrix3d pure_moments(const Gram& gram) {
    // Schur complement: what is left of the moments when those that belong to forces are taken out.
    const Eigen::Matrix3d F = gram.topLeftCorner<3, 3>(), M = gram.bottomRightCorner<3, 3>(),
                          C = gram.bottomLeftCorner<3, 3>();
    Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> inverse;
    inverse.setThreshold(no_share);
    inverse.compute(F);
    const Eigen::Matrix3d rest = M - C * inverse.pseudoInverse() * C.transpose();
    return rest.trace() > no_share * (F.trace() + M.trace()) ? rest : Eigen::Matrix3d::Zero();
  }
  [[nodiscard]] std::string loads() const {
    return joined(told(force, "a force along ", "forces normal to ", "any force"),
                  told(moment, "a moment about ", "moments normal to ", "any moment"));
  }
  [[nodiscard]] std::string freedoms() const {
    return joined(told(force, "along ", "normal to ", "in every direction"),
                  told(moment, "about ", "about axes normal to ", "about every axis"));
  }
  /// Normal of the plane in which bodies move that are supported twice against leaving it.
  [[nodiscard]] std::optional<Direction> plane() const {
    if (force.dimension == 1 && moment.dimension == 2 && parallel(force.axis, moment.axis)) return force.axis;
    return std::nullopt;
  }
  /// The axis on which bodies are guided twice.
  [[nodiscard]] std::optional<Direction> line() const {
    const bool across = force.dimension == 3 || (force.dimension == 2 && parallel(force.axis, moment.axis));
    if (across && moment.dimension == 2) return moment.axis;
    return std::nullopt;
  }
  [[nodiscard]] bool in_plane(const Direction& normal) const {
    const bool across = force.dimension == 3 || (force.dimension == 2 && std::abs(force.axis.dot(normal)) < no_share) ||
                        (force.dimension == 1 && parallel(force.axis, normal));
    return across && (moment.dimension == 3 || (moment.dimension == 2 && parallel(moment.axis, normal)));
  }

 private:
  static bool parallel(const Direction& a, const Direction& b) { return std::abs(a.dot(b)) > 1.0 - no_share; }
  static std::string told(const Directions& d, const char* one, const char* two, const char* all) {
    return d.dimension == 0 ? "" : d.dimension == 3 ? all : (d.dimension == 1 ? one : two) + axis_name(d.axis);
  }
  static std::string joined(const std::string& a, const std::string& b) {
    return a + (a.empty() || b.empty() ? "" : " and ") + b;
  }
};

/// A body's own rows take part in every rotation; it is no joint.
bool is_joint(const Component& component) {
  return component.type->port_count > 0 && component.type->variable_count == 0;
}

class Describer {
 public:
  Describer(const System& system, const State& state, const Partition& partition)
      : system_(system), partition_(partition), reactions_(system, state) {}

  std::vector<RedundantSet> sets() {
    std::vector<Index> parent(system_.components.size());
    std::iota(parent.begin(), parent.end(), Index{0});
    const auto root = [&](Index i) {
      while (parent[static_cast<std::size_t>(i)] != i) {
        parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
        i = parent[static_cast<std::size_t>(i)];
      }
      return i;
    };
    // Redundant rows whose dependencies share a joint belong together.
    for (const RedundantRow& redundant : partition_.redundant) {
      for (const auto& [row, unused] : redundant.follows_from) {
        if (joint(row)) parent[static_cast<std::size_t>(root(component(row)))] = root(component(redundant.row));
      }
    }
    std::map<Index, std::vector<const RedundantRow*>> members;
    for (const RedundantRow& redundant : partition_.redundant)
      members[root(component(redundant.row))].push_back(&redundant);
    std::vector<RedundantSet> result;
    result.reserve(members.size());
    for (const auto& [unused, rows] : members) result.push_back(set_of(rows));
    std::sort(result.begin(), result.end(),
              [](const auto& a, const auto& b) { return a.components.front() < b.components.front(); });
    return result;
  }

 private:
  [[nodiscard]] Index component(Index row) const { return system_.constraint(row).component; }
  [[nodiscard]] bool joint(Index row) const {
    return is_joint(system_.components[static_cast<std::size_t>(component(row))]);
  }

  /// A multiplier of one self-stress.
  struct Share {
    Index row;
    std::size_t stress;
    double multiplier;
  };
  using Joints = std::map<Index, std::vector<Share>>;  // by component

  [[nodiscard]] RedundantSet set_of(const std::vector<const RedundantRow*>& redundant) const {
    RedundantSet set;
    Joints joints, relaxed;  // all shares; those of self-stresses that end when the joint loses its redundant rows
    for (std::size_t k = 0; k < redundant.size(); ++k) {
      const Index own = component(redundant[k]->row);
      set.rows.push_back(redundant[k]->row);
      joints[own].push_back({redundant[k]->row, k, 1.0});
      relaxed[own].push_back({redundant[k]->row, k, 1.0});
      for (const auto& [row, c] : redundant[k]->follows_from) {
        if (joint(row)) joints[component(row)].push_back({row, k, -c});
        if (component(row) == own) relaxed[own].push_back({row, k, -c});
      }
    }
    for (const auto& [index, unused] : joints) set.components.push_back(index);
    const std::optional<Clamping> clamping = clamping_of(relaxed.begin()->second);
    set.joints = counted_by_type(set.components);
    if (clamping) {
      set.geometry = geometry(*clamping, joints);
      set.undetermined = clamping->loads();
      if (relaxed.size() > 1) set.undetermined += " in " + name(relaxed.begin()->first) + ", and so on";
    }
    set.remedy = remedy(relaxed, joints);
    return set;
  }

  [[nodiscard]] const std::string& name(Index index) const { return system_.component_name(index); }

  [[nodiscard]] std::string counted_by_type(const std::vector<Index>& components) const {
    std::map<std::string, std::vector<std::string>> by_type;
    for (const Index i : components)
      by_type[system_.components[static_cast<std::size_t>(i)].type->name].push_back(name(i));
    std::string text;
    for (const auto& [type, names] : by_type)
      text += (text.empty() ? "" : " and ") + std::to_string(names.size()) + " " + type + " (" + list_of(names) + ")";
    return text;
  }

  /// What the joints have in common, where it has a name.
  [[nodiscard]] std::string geometry(const Clamping& clamping, const Joints& joints) const {
    const auto all = [&](const auto& holds) {
      return std::all_of(joints.begin(), joints.end(), [&](const auto& entry) {
        const std::optional<Clamping> other = clamping_of(entry.second);
        return !other || holds(*other);
      });
    };
    if (const auto normal = clamping.plane()) {
      if (all([&](const Clamping& other) { return other.in_plane(*normal); }))
        return "in one plane, normal to " + axis_name(*normal);
    }
    if (const auto axis = clamping.line()) {
      if (all([&](const Clamping& other) { return other.line() && axis_name(*other.line()) == axis_name(*axis); }))
        return "on one axis, along " + axis_name(*axis);
    }
    return "";
  }

  /// What the joint carries in self-stresses.
  [[nodiscard]] std::optional<Clamping> clamping_of(const std::vector<Share>& shares) const {
    Index frame = -1;
    for (const Share& share : shares) {
      if (frame < 0) frame = reactions_.frame_of(share.row);
    }
    if (frame < 0) return std::nullopt;
    std::map<std::size_t, Wrench> wrenches;
    for (const Share& share : shares) {
      wrenches.try_emplace(share.stress, Wrench::Zero()).first->second +=
          share.multiplier * reactions_.on(frame, share.row);
    }
    Gram gram = Gram::Zero();
    for (auto& [unused, w] : wrenches) {
      if (w.norm() > 0.0) w.normalize();
      gram += w * w.transpose();
    }
    return Clamping(gram);
  }

  /// How many self-stresses end when the joint is taken out.
  [[nodiscard]] static std::size_t freed_by(const std::vector<Share>& shares, std::size_t stresses) {
    std::map<Index, Index> place;
    for (const Share& share : shares) place.emplace(share.row, static_cast<Index>(place.size()));
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(static_cast<Index>(place.size()), static_cast<Index>(stresses));
    for (const Share& share : shares) N(place.at(share.row), static_cast<Index>(share.stress)) = share.multiplier;
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    qr.setThreshold(no_share);
    qr.compute(N);
    return static_cast<std::size_t>(qr.rank());
  }

  [[nodiscard]] std::string remedy(const Joints& relaxed, const Joints& joints) const {
    std::vector<std::string> parts;
    for (const auto& [index, shares] : relaxed) {
      std::set<std::size_t> stresses;
      for (const Share& share : shares) stresses.insert(share.stress);
      const std::optional<Clamping> clamping = clamping_of(shares);
      parts.push_back(static_cast<std::int32_t>(stresses.size()) == rows_of(index) ? "leave out " + name(index)
                      : clamping ? "free " + name(index) + " " + clamping->freedoms()
                                 : "take " + std::to_string(stresses.size()) + " rows from " + name(index));
    }
    std::string text = list_of(parts, " and ");
    if (relaxed.size() > 1) return text;
    const Index own = relaxed.begin()->first;
    std::size_t count = 0;
    for (const Share& share : relaxed.begin()->second) count = std::max(count, share.stress + 1);
    std::vector<std::string> others;
    for (const auto& [index, shares] : joints) {
      if (index != own && freed_by(shares, count) == count) others.push_back(name(index));
    }
    return text + (others.empty() ? "" : "; as much in " + list_of(others, " or ") + " would do");
  }
  [[nodiscard]] std::int32_t rows_of(Index index) const {
    const bramah_type& type = *system_.components[static_cast<std::size_t>(index)].type;
    return type.holonomic_count + type.nonholonomic_count;
  }

  const System& system_;
  const Partition& partition_;
  Reactions reactions_;
};

}  // namespace

std::vector<RedundantSet> describe_redundancy(const System& system, const State& state, const Partition& partition) {
  if (partition.redundant.empty()) return {};
  return Describer(system, state, partition).sets();
}

void take_minimum_norm(const System& system, const Partition& partition, Vector& lambda) {
  if (partition.redundant.empty()) return;
  // Null vectors of D^T: N_k = e(redundant k) - sum c e(others). The nearest point without their span, lambda = S^2 w with
  // sizes S, solves
  //   [ S^2  N ] [ w  ]   [ lambda_0 ]
  //   [ N^T  0 ] [ mu ] = [ 0        ]
  const auto rows = static_cast<Index>(lambda.size()), count = static_cast<Index>(partition.redundant.size());
  std::vector<std::vector<std::pair<Index, double>>> columns(static_cast<std::size_t>(rows + count));
  Vector squares;
  for (Index i = 0; i < rows; ++i) {
    const double per_time = i < system.m() ? 1.0 : system.sizes.time;
    squares.push_back(std::pow(system.constraint(i).size * per_time, -2));
    columns[static_cast<std::size_t>(i)].emplace_back(i, squares.back());
  }
  for (Index k = 0; k < count; ++k) {
    const RedundantRow& redundant = partition.redundant[static_cast<std::size_t>(k)];
    const auto put = [&](Index row, double value) {
      columns[static_cast<std::size_t>(row)].emplace_back(rows + k, value);
      columns[static_cast<std::size_t>(rows + k)].emplace_back(row, value);
    };
    put(redundant.row, 1.0);
    for (const auto& [row, c] : redundant.follows_from) put(row, -c);
  }
  std::vector<Index> start = {0}, row;
  Vector value, rhs(lambda);
  for (auto& column : columns) {
    std::sort(column.begin(), column.end());
    for (const auto& [i, entry] : column) {
      row.push_back(i);
      value.push_back(entry);
    }
    start.push_back(static_cast<Index>(row.size()));
  }
  rhs.resize(static_cast<std::size_t>(rows + count), 0.0);
  const sparse::CscView matrix{rows + count, rows + count, start.data(), row.data(), value.data()};
  sparse::Klu lu;
  lu.analyze(matrix);
  if (!lu.factor(matrix)) return;  // never: N has full rank, since the redundant rows are its identity
  lu.solve(rhs);
  for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] = squares[i] * rhs[i];
}

}  // namespace bramah
