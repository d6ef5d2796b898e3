#include "linear/track.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace bramah {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

constexpr double clear = 0.3;       // how far a share may be from 1
constexpr double coupled = 1e-5;    // root of a share below which modes that pass each other do not know of one another
constexpr double near_pass = 0.5;   // of the distance at either end: closer between them is a pass
constexpr double same = 1e-9;       // eigenvalues nearer than this, relative, are one
constexpr int deepest = 34;         // halvings of an interval
constexpr std::size_t window = 32;  // points whose vectors are kept at a time
constexpr std::size_t most_added = 64 * window;  // points in a window

MatrixXcd shares(const ModeSet& a, const ModeSet& b) {
  const MatrixXcd forth = a.left.adjoint() * b.right, back = b.left.adjoint() * a.right;
  return forth.cwiseProduct(back.transpose());
}

/// Of each mode its conjugate, itself for a real one.
std::vector<int> conjugates(const std::vector<Complex>& values) {
  std::vector<int> partner(values.size(), -1);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (partner[k] >= 0) continue;
    partner[k] = static_cast<int>(k);
    if (values[k].imag() == 0.0) continue;
    double nearest = HUGE_VAL;
    for (std::size_t j = 0; j < values.size(); ++j) {
      const double distance = std::abs(values[j] - std::conj(values[k]));
      if (values[j].imag() * values[k].imag() >= 0.0 || partner[j] >= 0 || distance >= nearest) continue;
      nearest = distance;
      partner[k] = static_cast<int>(j);
    }
    partner[static_cast<std::size_t>(partner[k])] = static_cast<int>(k);
  }
  return partner;
}

bool equal(Complex p, Complex q) { return std::abs(p - q) <= same * std::max(std::abs(p), std::abs(q)); }

/// Modes that belong together, each with a representative.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int k) {
    while (parent_[static_cast<std::size_t>(k)] != k) k = parent_[static_cast<std::size_t>(k)];
    return k;
  }
  void unite(int a, int b) { parent_[static_cast<std::size_t>(of(a))] = of(b); }

 private:
  std::vector<int> parent_;
};

/// The assignment of rows to columns with the largest sum; -1 where a row gets none. By the Hungarian method.
std::vector<int> best_assignment(const MatrixXd& gain) {
  const Index rows = gain.rows(), columns = std::max(gain.cols(), rows);
  const auto cost = [&](Index i, Index j) { return j < gain.cols() ? -gain(i, j) : 0.0; };
  const auto size = static_cast<std::size_t>(columns) + 1;
  std::vector<double> u(static_cast<std::size_t>(rows) + 1, 0.0), v(size, 0.0);
  std::vector<Index> owner(size, 0), way(size, 0);
  for (Index i = 1; i <= rows; ++i) {
    owner[0] = i;
    std::size_t at = 0;
    std::vector<double> least(size, HUGE_VAL);
    std::vector<bool> used(size, false);
    do {
      used[at] = true;
      const Index row = owner[at];
      double delta = HUGE_VAL;
      std::size_t next = 0;
      for (std::size_t j = 1; j < size; ++j) {
        if (used[j]) continue;
        const double reduced = cost(row - 1, static_cast<Index>(j) - 1) - u[static_cast<std::size_t>(row)] - v[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[j] = static_cast<Index>(at);
        }
        if (least[j] < delta) {
          delta = least[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j < size; ++j) {
        if (used[j]) {
          u[static_cast<std::size_t>(owner[j])] += delta;
          v[j] -= delta;
        } else {
          least[j] -= delta;
        }
      }
      at = next;
    } while (owner[at] != 0);
    while (at != 0) {
      const auto before = static_cast<std::size_t>(way[at]);
      owner[at] = owner[before];
      at = before;
    }
  }
  std::vector<int> to(static_cast<std::size_t>(rows), -1);
  for (std::size_t j = 1; j <= static_cast<std::size_t>(gain.cols()); ++j) {
    if (owner[j] > 0) to[static_cast<std::size_t>(owner[j] - 1)] = static_cast<int>(j) - 1;
  }
  return to;
}

/// Sets the halves of pairs right, upper to upper and the larger real mode to the upper half; finds branches.
void settle_pairs(const ModeSet& a, const ModeSet& b, ModeMatch& match) {
  const std::vector<int> conjugate_a = conjugates(a.values), conjugate_b = conjugates(b.values);
  const auto first_of = [](const std::vector<Complex>& values, int p, int q) {
    const Complex x = values[static_cast<std::size_t>(p)], y = values[static_cast<std::size_t>(q)];
    return x.imag() != y.imag() ? x.imag() > y.imag() : x.real() >= y.real();
  };
  std::vector<int> from(b.values.size(), -1);
  for (std::size_t k = 0; k < match.to.size(); ++k) {
    if (match.to[k] >= 0) from[static_cast<std::size_t>(match.to[k])] = static_cast<int>(k);
  }
  const auto together = [&](int k, int other) {  // both of a, and so are both of their targets
    int &j = match.to[static_cast<std::size_t>(k)], &i = match.to[static_cast<std::size_t>(other)];
    if (first_of(a.values, k, other) != first_of(b.values, j, i)) std::swap(j, i);
  };
  for (std::size_t k = 0; k < match.to.size(); ++k) {
    const int mode = static_cast<int>(k), partner = conjugate_a[k], target = match.to[k];
    if (target < 0) continue;
    const int target_partner = conjugate_b[static_cast<std::size_t>(target)];
    if (partner != mode) {
      if (partner < mode) continue;
      const int other = match.to[static_cast<std::size_t>(partner)];
      const bool to_pair = other >= 0 && target_partner == other;
      const bool to_reals = other >= 0 && target_partner == target &&
                            conjugate_b[static_cast<std::size_t>(other)] == other && other != target;
      if (!to_pair && !to_reals) {
        match.settled = false;
        continue;
      }
      together(mode, partner);
      if (to_reals) match.branches.emplace_back(mode, partner);
    } else if (target_partner != target) {
      const int other = from[static_cast<std::size_t>(target_partner)];
      if (other < 0 || conjugate_a[static_cast<std::size_t>(other)] != other) {
        match.settled = false;
      } else if (mode < other) {
        together(mode, other);
        match.branches.emplace_back(mode, other);
      }
    }
  }
}

/// Whether every group of modes that cannot be told apart keeps its space.
bool spaces_agree(const ModeSet& a, const ModeSet& b, const MatrixXcd& share, const ModeMatch& match, Groups& groups) {
  const std::vector<int> conjugate_a = conjugates(a.values), conjugate_b = conjugates(b.values);
  std::vector<int> from(b.values.size(), -1);
  for (std::size_t k = 0; k < match.to.size(); ++k) {
    groups.unite(static_cast<int>(k), conjugate_a[k]);
    if (match.to[k] >= 0) from[static_cast<std::size_t>(match.to[k])] = static_cast<int>(k);
  }
  const auto unite_sources = [&](std::size_t p, std::size_t q) {
    if (from[p] >= 0 && from[q] >= 0) groups.unite(from[p], from[q]);
  };
  for (std::size_t j = 0; j < from.size(); ++j) {
    unite_sources(j, static_cast<std::size_t>(conjugate_b[j]));
    for (std::size_t i = 0; i < j; ++i) {
      if (equal(b.values[i], b.values[j])) unite_sources(i, j);
    }
  }
  for (std::size_t k = 0; k < match.to.size(); ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      if (equal(a.values[i], a.values[k])) groups.unite(static_cast<int>(i), static_cast<int>(k));
    }
  }
  std::map<int, std::vector<int>> members;
  for (std::size_t k = 0; k < match.to.size(); ++k) {
    if (match.to[k] >= 0) members[groups.of(static_cast<int>(k))].push_back(static_cast<int>(k));
  }
  return std::all_of(members.begin(), members.end(), [&](const auto& entry) {
    Complex sum = 0.0;
    for (const int k : entry.second) {
      for (const int other : entry.second) sum += share(k, match.to[static_cast<std::size_t>(other)]);
    }
    return std::abs(sum / static_cast<double>(entry.second.size()) - 1.0) <= clear;
  });
}

/// Whether two modes pass each other closely that have a share in one another: then they may veer instead.
bool may_veer(const ModeSet& a, const ModeSet& b, const MatrixXcd& share, const ModeMatch& match, Groups& groups) {
  for (std::size_t k = 0; k < match.to.size(); ++k) {
    for (std::size_t i = 0; i < k; ++i) {
      const int j = match.to[k], h = match.to[i];
      if (j < 0 || h < 0 || groups.of(static_cast<int>(k)) == groups.of(static_cast<int>(i))) continue;
      const double strength =
          std::max(std::abs(share(static_cast<Index>(k), h)), std::abs(share(static_cast<Index>(i), j)));
      if (std::sqrt(strength) < coupled) continue;
      const Complex begin = a.values[k] - a.values[i];
      const Complex end = b.values[static_cast<std::size_t>(j)] - b.values[static_cast<std::size_t>(h)];
      const Complex step = end - begin;
      const double t =
          -(std::conj(step) * begin).real() / std::max(std::norm(step), std::numeric_limits<double>::min());
      if (t <= 0.0 || t >= 1.0) continue;
      if (std::abs(begin + t * step) < near_pass * std::min(std::abs(begin), std::abs(end))) return true;
    }
  }
  return false;
}

}  // namespace

ModeSet mode_set(const Spectrum& spectrum, const Partition& partition, const MatrixXd& motion) {
  const Index modes = spectrum.left.cols(), states = spectrum.right.rows();
  const auto independent = static_cast<Index>(partition.ai.size()),
             admissible = static_cast<Index>(partition.ad.size());
  const auto n = independent + admissible + static_cast<Index>(partition.d.size());
  const Index first_order = states - 2 * independent - admissible;
  ModeSet set;
  for (Index k = 0; k < modes; ++k) {
    const Mode& mode = spectrum.modes[static_cast<std::size_t>(k)];
    set.values.push_back(mode.eigenvalue);
    set.error.push_back(std::numeric_limits<double>::epsilon() * spectrum.norm * mode.condition);
  }
  set.zeros = spectrum.zero_count();
  set.right = motion.topLeftCorner(2 * n + first_order, states) * spectrum.right.leftCols(modes);
  set.left = MatrixXcd::Zero(2 * n + first_order, modes);
  Index row = 0;
  for (const auto i : partition.ai) set.left.row(i) = spectrum.left.row(row++);
  for (const auto i : partition.ai) set.left.row(n + i) = spectrum.left.row(row++);
  for (const auto i : partition.ad) set.left.row(i) = spectrum.left.row(row++);
  for (Index i = 0; i < first_order; ++i) set.left.row(2 * n + i) = spectrum.left.row(row++);
  return set;
}

ModeMatch match_modes(const ModeSet& a, const ModeSet& b) {
  const MatrixXcd share = shares(a, b);
  MatrixXd gain(share.rows(), share.cols());
  for (Index k = 0; k < gain.rows(); ++k) {
    for (Index j = 0; j < gain.cols(); ++j) {
      const Complex p = a.values[static_cast<std::size_t>(k)], q = b.values[static_cast<std::size_t>(j)];
      // Near a branch point shares of its modes grow beyond all bounds; of equal ones the nearest is taken.
      gain(k, j) = std::min(std::abs(share(k, j)), 1.0) - 1e-3 * std::abs(p - q) / (std::abs(p) + std::abs(q));
    }
  }
  ModeMatch match;
  match.to = best_assignment(gain);
  settle_pairs(a, b, match);
  Groups groups(a.values.size());
  match.settled = match.settled && spaces_agree(a, b, share, match, groups) && !may_veer(a, b, share, match, groups);
  return match;
}

namespace {

/// The vectors of `next` for one track each, where eigenvalues coincide those nearest to what the tracks had before.
void carry(ModeSet& last, const ModeSet& next, const std::vector<int>& to) {
  std::vector<bool> done(to.size(), false);
  for (std::size_t k = 0; k < to.size(); ++k) {
    if (done[k] || to[k] < 0) continue;
    std::vector<Index> tracks;
    for (std::size_t i = k; i < to.size(); ++i) {
      const bool is_same = i == k || (to[i] >= 0 && equal(next.values[static_cast<std::size_t>(to[i])],
                                                          next.values[static_cast<std::size_t>(to[k])]));
      if (!is_same || done[i]) continue;
      done[i] = true;
      tracks.push_back(static_cast<Index>(i));
    }
    const auto count = static_cast<Index>(tracks.size());
    MatrixXcd right(next.right.rows(), count), left(next.left.rows(), count), before(next.right.rows(), count);
    for (Index i = 0; i < count; ++i) {
      const Index mode = to[static_cast<std::size_t>(tracks[static_cast<std::size_t>(i)])];
      right.col(i) = next.right.col(mode);
      left.col(i) = next.left.col(mode);
      before.col(i) = last.right.col(tracks[static_cast<std::size_t>(i)]);
    }
    if (count > 1) {
      // The old vectors projected on the common space, and their duals. Left and right vectors of coincident eigenvalues
      // are orthogonal to one another only by chance.
      const MatrixXcd turn = left.adjoint() * before;
      const Eigen::FullPivLU<MatrixXcd> lu(turn), gram(left.adjoint() * right);
      if (std::min(lu.rcond(), gram.rcond()) > 1e-8) {
        right = right * gram.solve(turn);
        left = left * turn.adjoint().inverse();
      }
    }
    for (Index i = 0; i < count; ++i) {
      const Index track = tracks[static_cast<std::size_t>(i)];
      last.right.col(track) = right.col(i);
      last.left.col(track) = left.col(i);
      last.values[static_cast<std::size_t>(track)] =
          next.values[static_cast<std::size_t>(to[static_cast<std::size_t>(track)])];
    }
  }
}

struct Refined {
  double at;
  bool asked;
  std::optional<ModeSet> set;
  bool settled = false;  // the match with the next one
};

/// The next point with a spectrum; the size of the row where there is none.
std::size_t next_good(const std::vector<Refined>& row, std::size_t k) {
  do ++k;
  while (k < row.size() && !row[k].set);
  return k;
}

/// Halves what is not settled, all such intervals at once, until nothing is left to halve.
void refine(std::vector<Refined>& row, const EvaluateModes& evaluate) {
  for (int depth = 0; depth <= deepest; ++depth) {
    std::vector<double> middles;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::size_t next = next_good(row, k);
      if (!row[k].set || row[k].settled || next == row.size()) continue;
      row[k].settled = match_modes(*row[k].set, *row[next].set).settled;
      const double middle = row[k].at + 0.5 * (row[next].at - row[k].at);
      const bool can_split = next == k + 1 && middle != row[k].at && middle != row[next].at;
      if (row[k].settled || !can_split || row.size() + middles.size() >= most_added) continue;
      middles.push_back(middle);
      places.push_back(next);
    }
    if (middles.empty() || depth == deepest) return;
    std::vector<std::optional<ModeSet>> sets = evaluate(middles);
    for (std::size_t k = middles.size(); k-- > 0;)
      row.insert(row.begin() + static_cast<std::ptrdiff_t>(places[k]), {middles[k], false, std::move(sets[k])});
  }
}

}  // namespace

void ModeFollower::take(const ModeSet& next, Tracks::Point& point, std::vector<std::pair<int, int>>& branches) {
  if (last_.values.empty()) {
    last_ = next;
    point.mode.resize(next.values.size());
    std::iota(point.mode.begin(), point.mode.end(), 0);
  } else {
    const ModeMatch match = match_modes(last_, next);
    point.mode = match.to;
    carry(last_, next, match.to);
    branches = match.branches;
    // Modes that no track claims begin tracks of their own.
    std::vector<bool> claimed(next.values.size(), false);
    for (const int mode : match.to) {
      if (mode >= 0) claimed[static_cast<std::size_t>(mode)] = true;
    }
    for (std::size_t j = 0; j < claimed.size(); ++j) {
      if (claimed[j]) continue;
      const Index column = last_.right.cols();
      last_.values.push_back(next.values[j]);
      last_.right.conservativeResize(Eigen::NoChange, column + 1);
      last_.left.conservativeResize(Eigen::NoChange, column + 1);
      last_.right.col(column) = next.right.col(static_cast<Index>(j));
      last_.left.col(column) = next.left.col(static_cast<Index>(j));
      point.mode.push_back(static_cast<int>(j));
    }
  }
  point.zeros = next.zeros;
  for (const int mode : point.mode) {
    point.value.push_back(mode < 0 ? 0.0 : next.values[static_cast<std::size_t>(mode)]);
    point.error.push_back(mode < 0 || next.error.empty() ? 0.0 : next.error[static_cast<std::size_t>(mode)]);
  }
}

Tracks ModeFollower::follow(const std::vector<double>& values, const EvaluateModes& evaluate) {
  Tracks tracks;
  std::vector<Refined> row;  // the last good point of the window before, then this window
  constexpr auto unseen = static_cast<std::size_t>(-1);
  std::vector<std::size_t> seen;  // of each track: the last point where it had a mode
  for (std::size_t first = 0; first < values.size(); first += window) {
    const std::vector<double> asked(
        values.begin() + static_cast<std::ptrdiff_t>(first),
        values.begin() + static_cast<std::ptrdiff_t>(std::min(first + window, values.size())));
    std::vector<std::optional<ModeSet>> sets = evaluate(asked);
    const std::size_t old = row.size();
    for (std::size_t k = 0; k < asked.size(); ++k) row.push_back({asked[k], true, std::move(sets[k])});

    refine(row, evaluate);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::size_t next = next_good(row, k);
      if (row[k].set && !row[k].settled && next < row.size()) tracks.doubts.emplace_back(row[k].at, row[next].at);
    }
    for (std::size_t k = old; k < row.size(); ++k) {
      Tracks::Point point{row[k].at, row[k].asked, !row[k].set, 0, {}, {}, {}};
      if (row[k].set) {
        std::vector<std::pair<int, int>> branches;
        take(*row[k].set, point, branches);
        seen.resize(point.mode.size(), unseen);
        for (const auto& [one, other] : branches) {
          const std::size_t before = seen[static_cast<std::size_t>(one)];
          if (before == unseen || before != seen[static_cast<std::size_t>(other)]) continue;
          const bool splits = point.value[static_cast<std::size_t>(one)].imag() == 0.0;
          tracks.branches.push_back({before, tracks.points.size(), one, other, splits});
        }
        for (std::size_t i = 0; i < seen.size(); ++i) {
          if (point.mode[i] >= 0) seen[i] = tracks.points.size();
        }
      }
      tracks.points.push_back(std::move(point));
    }
    // The next window needs the last good point only.
    while (!row.empty() && !row.back().set) row.pop_back();
    if (row.size() > 1) row.erase(row.begin(), row.end() - 1);
  }
  return tracks;
}

double bracketed_root(const std::function<double(double)>& f, double a, double fa, double b, double fb,
                      double tolerance) {
  const double k1 = 0.2 / std::abs(b - a);
  const double half_tolerance = 0.5 * tolerance;
  const double n_half = std::ceil(std::log2(std::max(std::abs(b - a) / tolerance, 1.0)));
  for (double j = 0.0; std::abs(b - a) > tolerance; ++j) {
    const double width = b - a, middle = a + 0.5 * width;
    if (middle == a || middle == b) break;
    const double secant = (fb * a - fa * b) / (fb - fa);
    const double sigma = middle >= secant ? 1.0 : -1.0;
    const double delta = k1 * width * width;
    const double truncated = delta <= std::abs(middle - secant) ? secant + sigma * delta : middle;
    const double radius = std::max(half_tolerance * std::exp2(n_half + 1.0 - j) - 0.5 * std::abs(width), 0.0);
    double x = std::abs(truncated - middle) <= radius ? truncated : middle - sigma * radius;
    if (x == a || x == b || !std::isfinite(x)) x = middle;
    const double fx = f(x);
    if (fx == 0.0) return x;
    if ((fx > 0.0) == (fb > 0.0)) {
      b = x;
      fb = fx;
    } else {
      a = x;
      fa = fx;
    }
  }
  return std::abs(fa) < std::abs(fb) ? a : b;
}

}  // namespace bramah
