// Eigenvalues followed along a parameter by the shapes of their modes.
//
// The share of mode k of one spectrum in mode j of another is
//
//   c_kj = (w_k^H v_j) (w_j^H v_k),   sum of c_kj over j = 1 = sum over k     (all modes counted)
//
// with w^H v = 1 in each spectrum. It does not depend on how vectors or states are scaled. Between neighbouring points
// the assignment with the largest shares is taken, and points are added between them until it leaves no doubt: until
// every share is near 1, and no two modes pass each other that have a share in one another. What crosses without such a
// share crosses truly; what has one veers.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "linear/spectrum.hpp"

namespace bramah {

/// The nonzero modes of one spectrum, with vectors in variables that do not depend on the choice of states.
struct ModeSet {
  std::vector<std::complex<double>> values;
  std::vector<double> error;     // of each value: what rounding of the matrix does to it; may be empty
  Eigen::MatrixXcd right, left;  // (variables x modes), left^H right = 1
  Eigen::Index zeros = 0;        // zeros beside them
};
/// The modes of a reduced model in the variables x, v, z; `motion` is that of the Linearizer.
ModeSet mode_set(const Spectrum& spectrum, const Partition& partition, const Eigen::MatrixXd& motion);

struct ModeMatch {
  std::vector<int> to;  // of each mode of the first set: its mode in the second, -1: none is left
  bool settled = true;  // nothing to be gained from a point between
  /// Modes of the first set, a complex pair that becomes two real modes or two real modes that become a pair.
  std::vector<std::pair<int, int>> branches;
};
/// A pair that becomes real sends its upper half to the larger real mode, and back.
ModeMatch match_modes(const ModeSet& a, const ModeSet& b);

/// Eigenvalues along a parameter, a track each.
struct Tracks {
  struct Point {
    double at = 0.0;
    bool asked = true;    // false: added between points that were
    bool failed = false;  // there is no spectrum
    Eigen::Index zeros = 0;
    std::vector<int> mode;  // of each track: its place in the spectrum; -1: there is none, the eigenvalue is zero here
    std::vector<std::complex<double>> value;  // of each track
    std::vector<double> error;                // of each value
  };
  struct Branch {
    std::size_t before = 0, after = 0;  // between these points; there both tracks have a mode
    int first = 0, second = 0;
    bool splits = true;  // a pair becomes real; false: two real modes become a pair
  };
  std::vector<Point> points;  // in the order of the parameter
  std::vector<Branch> branches;
  std::vector<std::pair<double, double>> doubts;  // between these neighbours the assignment is a guess
};

/// Spectra at several values of the parameter; nothing where there is none. May work in parallel.
using EvaluateModes = std::function<std::vector<std::optional<ModeSet>>(const std::vector<double>&)>;

/// Follows modes; begun anew it numbers them as the first spectrum does, else as the last one that it has seen.
class ModeFollower {
 public:
  /// `values`: of the parameter, all ascending or all descending.
  Tracks follow(const std::vector<double>& values, const EvaluateModes& evaluate);
  [[nodiscard]] std::size_t count() const { return last_.values.size(); }

 private:
  void take(const ModeSet& next, Tracks::Point& point, std::vector<std::pair<int, int>>& branches);
  ModeSet last_;  // the latest vectors of each track
};

/// Where f, of opposite signs at the ends a and b, changes its sign, to the spacing of doubles or `tolerance`: the ITP
/// method (Oliveira and Takahashi 2020), which needs hardly more evaluations than bisection and mostly far fewer.
double bracketed_root(const std::function<double(double)>& f, double a, double fa, double b, double fb,
                      double tolerance);

}  // namespace bramah
