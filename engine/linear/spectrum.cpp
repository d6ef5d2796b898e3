#include "linear/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

#include "linear/defective.hpp"
#include "linear/staircase.hpp"
#include "system/analysis_error.hpp"

// LAPACK has no C header of its own; this is its published calling sequence.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" void dgeevx_(const char* balanc, const char* jobvl, const char* jobvr, const char* sense, const int* n,
                        double* a, const int* lda, double* wr, double* wi, double* vl, const int* ldvl, double* vr,
                        const int* ldvr, int* ilo, int* ihi, double* scale, double* abnrm, double* rconde,
                        double* rcondv, double* work, const int* lwork, int* iwork, int* info);

namespace bramah {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

// How far above its first-order error bound eps |A| condition a computed eigenvalue may sit and still be called doubtful.
constexpr double doubt = 50.0;
// Components of a vector below this part of its largest are rounding.
constexpr double negligible = 1e-7;

// A slow eigenvalue beside fast ones is refined where QR's error bound takes more than this part of it.
constexpr double refine_above = 1e-12;
// The quotient's error grows with the square of the condition.
constexpr double well_conditioned = 1e5;
// Vectors of a defective eigenvalue are parallel but for a root of rounding.
constexpr double nearly_parallel = 1e4;

/// w^H A v / w^H v in extended precision: its error is second order in those of the vectors, and rounding is relative to
/// the terms of the row rather than to the norm of A.
Complex rayleigh_quotient(const MatrixXd& A, const VectorXcd& w, const VectorXcd& v) {
  using Long = std::complex<long double>;
  Long above = 0.0L, below = 0.0L;
  for (Index j = 0; j < A.cols(); ++j) {
    const Long vj(v(j).real(), v(j).imag());
    Long sum = 0.0L;
    for (Index i = 0; i < A.rows(); ++i) {
      if (A(i, j) != 0.0) sum += Long(w(i).real(), -w(i).imag()) * static_cast<long double>(A(i, j));
    }
    above += sum * vj;
    below += Long(w(j).real(), -w(j).imag()) * vj;
  }
  const Long quotient = above / below;
  return {static_cast<double>(quotient.real()), static_cast<double>(quotient.imag())};
}

struct Eigensystem {
  std::vector<Complex> values;
  MatrixXcd right, left;
  double norm = 0.0;
};

Eigensystem eigensystem(MatrixXd A, bool vectors) {
  Eigensystem result;
  const auto n = static_cast<int>(A.rows());
  if (n == 0) return result;
  if (!A.allFinite())
    throw AnalysisError("modes", "a Jacobian with entries that are not finite", "a finite Jacobian",
                        "linearize at another state");
  const auto size = static_cast<std::size_t>(n);
  std::vector<double> wr(size), wi(size), scale(size), rconde(size), rcondv(size);
  MatrixXd vl(vectors ? n : 1, vectors ? n : 1), vr(vectors ? n : 1, vectors ? n : 1);
  const auto ld = static_cast<int>(vl.rows());
  std::vector<int> iwork(2 * size);
  const char* job = vectors ? "V" : "N";
  int ilo = 0, ihi = 0, info = 0, lwork = -1;
  double optimal = 0.0;
  const auto call = [&](double* work) {
    dgeevx_("B", job, job, "N", &n, A.data(), &n, wr.data(), wi.data(), vl.data(), &ld, vr.data(), &ld, &ilo, &ihi,
            scale.data(), &result.norm, rconde.data(), rcondv.data(), work, &lwork, iwork.data(), &info);
  };
  call(&optimal);
  lwork = static_cast<int>(optimal);
  std::vector<double> work(static_cast<std::size_t>(lwork));
  call(work.data());
  if (info != 0)
    throw AnalysisError("modes", "the QR iteration did not converge", "eigenvalues of the Jacobian",
                        "check the model's scales");
  for (std::size_t k = 0; k < size; ++k) result.values.emplace_back(wr[k], wi[k]);
  if (!vectors) return result;
  const auto complex = [&](const MatrixXd& packed) {
    MatrixXcd full(n, n);
    for (int k = 0; k < n; ++k) {
      const double imaginary = wi[static_cast<std::size_t>(k)];
      if (imaginary > 0.0) {
        full.col(k) = packed.col(k).cast<Complex>() + Complex(0, 1) * packed.col(k + 1);
      } else if (imaginary < 0.0) {
        full.col(k) = full.col(k - 1).conjugate();
      } else {
        full.col(k) = packed.col(k).cast<Complex>();
      }
    }
    return full;
  };
  result.right = complex(vr);
  result.left = complex(vl);
  return result;
}

VectorXd nominals(const LinearModel& model) {
  VectorXd nominal(model.A.rows());
  for (Index i = 0; i < nominal.size(); ++i) nominal(i) = model.states[static_cast<std::size_t>(i)].nominal;
  return nominal;
}

/// The columns of B combined so that each has a 1 where all others have 0: as few names as possible in each.
MatrixXd readable(const MatrixXd& B) {
  if (B.cols() == 0) return B;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(B.transpose());
  MatrixXd square(B.cols(), B.cols());
  for (Index k = 0; k < B.cols(); ++k) square.row(k) = B.row(qr.colsPermutation().indices()(k));
  return B * square.inverse();
}

MatrixXd null_space(const MatrixXd& M) {
  if (M.cols() == 0) return M;
  const Eigen::JacobiSVD<MatrixXd> svd(M, Eigen::ComputeFullV);
  const VectorXd& s = svd.singularValues();
  const double limit = 1e-9 * std::max(1.0, s.size() > 0 ? s(0) : 0.0);
  Index rank = 0;
  while (rank < s.size() && s(rank) > limit) ++rank;
  return svd.matrixV().rightCols(M.cols() - rank);
}

/// Columns of `candidates` that are independent of `taken` and of each other.
MatrixXd extend(const MatrixXd& taken, const MatrixXd& candidates, Index count) {
  MatrixXd rest = candidates;
  if (taken.cols() > 0) {
    const MatrixXd Q =
        Eigen::HouseholderQR<MatrixXd>(taken).householderQ() * MatrixXd::Identity(taken.rows(), taken.cols());
    rest -= Q * (Q.transpose() * rest);
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(rest);
  MatrixXd chosen(candidates.rows(), count);
  for (Index k = 0; k < count; ++k) chosen.col(k) = candidates.col(qr.colsPermutation().indices()(k));
  return chosen;
}

std::vector<std::pair<std::string, double>> named(const LinearModel& model, const VectorXd& vector,
                                                  const VectorXd& scale) {
  std::vector<std::pair<std::string, double>> list;
  const double largest = vector.cwiseAbs().maxCoeff();
  for (Index i = 0; i < vector.size(); ++i) {
    if (std::abs(vector(i)) > negligible * largest)
      list.emplace_back(model.states[static_cast<std::size_t>(i)].name, vector(i) * scale(i));
  }
  return list;
}

std::string joined(const std::vector<std::pair<std::string, double>>& list) {
  std::string text;
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (k == 8) return text + ", ... (" + std::to_string(list.size()) + " in all)";
    text += (k == 0 ? "" : ", ") + list[k].first;
  }
  return text;
}

/// What kind of zero moves along `v` (in nominals) in a Jordan block of `size`.
ZeroBlock classify(const LinearModel& model, const VectorXd& v, int size, const VectorXd& nominal) {
  ZeroBlock block;
  block.size = size;
  block.moves = named(model, v, nominal);
  bool positions = false, dependent = false, pressures = false;
  const double largest = v.cwiseAbs().maxCoeff();
  std::vector<std::pair<std::string, double>> volumes;
  for (Index i = 0; i < v.size(); ++i) {
    if (std::abs(v(i)) <= negligible * largest) continue;
    const std::string& kind = model.states[static_cast<std::size_t>(i)].kind;
    positions = positions || kind == "x_ai" || kind == "x_ad" || kind == "x";
    dependent = dependent || kind == "x_ad";
    if (kind == "pressure") {
      pressures = true;
      volumes.emplace_back(model.states[static_cast<std::size_t>(i)].name, v(i));
    }
  }
  const std::string names = joined(block.moves);
  if (pressures) {
    block.kind = "trapped oil volume";
    std::vector<std::pair<std::string, double>> others;
    for (const auto& entry : block.moves) {
      if (std::none_of(volumes.begin(), volumes.end(), [&](const auto& volume) { return volume.first == entry.first; }))
        others.push_back(entry);
    }
    block.cause = "trapped oil: " + joined(volumes) + (volumes.size() == 1 ? " shifts" : " shift together") +
                  (others.empty() ? "" : " with " + joined(others));
  } else if (positions && size >= 2) {
    block.kind = dependent ? "nonholonomic drift" : "rigid-body or cyclic coordinate";
    block.cause = (dependent ? "drift along nonholonomic rows: " : "nothing holds ") + names +
                  " (Jordan block of size " + std::to_string(size) + ")";
  } else if (positions) {
    block.kind = dependent ? "nonholonomic drift" : "cyclic coordinate";
    block.cause = (dependent ? "drift along nonholonomic rows: " : "nothing restores ") + names;
  } else {
    block.kind = "pure integrator";
    block.cause = "integrates without return: " + names;
  }
  return block;
}

}  // namespace

Index Spectrum::zero_count() const {
  return std::count_if(modes.begin(), modes.end(), [](const Mode& m) { return m.zero; });
}

Index Spectrum::unstable_count() const {
  return std::count_if(modes.begin(), modes.end(), [](const Mode& m) { return m.eigenvalue.real() > m.rounding; });
}

MatrixXd participation(const Spectrum& spectrum) {
  MatrixXd shares = spectrum.left.conjugate().cwiseProduct(spectrum.right.leftCols(spectrum.left.cols())).cwiseAbs();
  for (Index k = 0; k < shares.cols(); ++k)
    shares.col(k) /= std::max(shares.col(k).sum(), std::numeric_limits<double>::min());
  return shares;
}

std::vector<Complex> plain_eigenvalues(const MatrixXd& A) { return eigensystem(A, false).values; }

std::vector<Complex> plain_eigenvalues(const LinearModel& model) {
  const VectorXd nominal = nominals(model);
  return plain_eigenvalues(MatrixXd(nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal()));
}

namespace {

/// By decreasing real part, those that rounding explains taken for zero; then by frequency.
void sort_modes(Spectrum& spectrum) {
  std::vector<std::size_t> order(spectrum.modes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t k) {
    const Mode& mode = spectrum.modes[k];
    const double real = mode.eigenvalue.real();
    return std::tuple(std::abs(real) <= mode.rounding ? 0.0 : -real, std::abs(mode.eigenvalue.imag()),
                      -mode.eigenvalue.imag());
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  const Spectrum from = spectrum;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto to = static_cast<Index>(k), column = static_cast<Index>(order[k]);
    spectrum.modes[k] = from.modes[order[k]];
    spectrum.right.col(to) = from.right.col(column);
    spectrum.left.col(to) = from.left.col(column);
  }
}

/// Whether rounding hides the distance of mode k to another one that is as badly conditioned.
bool inseparable(const std::vector<Mode>& modes, std::size_t k) {
  if (!(modes[k].condition > nearly_parallel)) return false;
  for (std::size_t j = 0; j < modes.size(); ++j) {
    const double distance = std::abs(modes[j].eigenvalue - modes[k].eigenvalue);
    if (j != k && distance <= std::min(modes[j].rounding, modes[k].rounding)) return true;
  }
  return false;
}

/// Groups of modes that are one eigenvalue. What rounding moves them by is known of the group only: as single ones they
/// have no condition.
void find_defective(const Staircase& stairs, const VectorXd& nominal, Spectrum& spectrum) {
  std::optional<InvariantSubspaces> subspaces;
  std::vector<Mode>& modes = spectrum.modes;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (modes[k].group >= 0 || !inseparable(modes, k)) continue;
    if (!subspaces)
      subspaces.emplace(stairs.triangular, stairs.zeros(),
                        doubt * std::numeric_limits<double>::epsilon() * spectrum.norm);
    std::optional<DefectiveGroup> group = subspaces->defective_group(modes[k].eigenvalue);
    if (!group) continue;
    std::vector<std::size_t> nearest(modes.size());
    std::iota(nearest.begin(), nearest.end(), std::size_t{0});
    std::stable_sort(nearest.begin(), nearest.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(modes[a].eigenvalue - group->mean) < std::abs(modes[b].eigenvalue - group->mean);
    });
    for (std::size_t j = 0; j < static_cast<std::size_t>(group->size); ++j) {
      Mode& mode = modes[nearest[j]];
      mode.group = static_cast<int>(spectrum.defective.size());
      mode.rounding = group->rounding;
      mode.doubtful = std::abs(mode.eigenvalue) <= mode.rounding;
    }
    group->right = nominal.cast<Complex>().asDiagonal() * (stairs.Q.cast<Complex>() * group->right);
    group->left = nominal.cwiseInverse().cast<Complex>().asDiagonal() * (stairs.Q.cast<Complex>() * group->left);
    spectrum.defective.push_back(*std::move(group));
  }
}

}  // namespace

Spectrum find_spectrum(const LinearModel& model) {
  const VectorXd nominal = nominals(model);
  const Index n = nominal.size();
  const VectorXd row_rounding = model.rounding.size() == n ? model.rounding : VectorXd::Zero(n);
  const MatrixXd A =
      without_rounding(nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal(), row_rounding);
  Spectrum spectrum;
  if (!A.allFinite())
    throw AnalysisError("modes", "a Jacobian with entries that are not finite", "a finite Jacobian",
                        "linearize at another state");
  const Staircase stairs = find_staircase(A, row_rounding);
  const Index z = stairs.zeros(), rest = n - z;
  spectrum.smallest_accepted = stairs.accepted;
  spectrum.largest_refused = stairs.refused;
  const Eigensystem inner = eigensystem(stairs.triangular.bottomRightCorner(rest, rest), true);
  spectrum.norm = A.norm();

  // Vectors of A from those of the block: Q [y; v] with (lambda - A_zz) y = A_zr v, and Q [0; w].
  spectrum.right = MatrixXcd::Zero(n, n);
  spectrum.left = MatrixXcd::Zero(n, rest);
  for (Index k = 0; k < rest; ++k) {
    Mode mode;
    mode.eigenvalue = inner.values[static_cast<std::size_t>(k)];
    VectorXcd v(n), w = VectorXcd::Zero(n);
    v.tail(rest) = inner.right.col(k);
    w.tail(rest) = inner.left.col(k);
    if (z > 0) {
      const MatrixXcd shifted =
          mode.eigenvalue * MatrixXcd::Identity(z, z) - stairs.triangular.topLeftCorner(z, z).cast<Complex>();
      v.head(z) = shifted.triangularView<Eigen::Upper>().solve(
          stairs.triangular.topRightCorner(z, rest).cast<Complex>() * v.tail(rest));
    }
    v = stairs.Q.cast<Complex>() * v;
    w = stairs.Q.cast<Complex>() * w;
    const Complex product = w.dot(v);  // w^H v
    mode.condition =
        std::abs(product) > 0.0 ? w.norm() * v.norm() / std::abs(product) : std::numeric_limits<double>::infinity();
    const double rounding = std::numeric_limits<double>::epsilon() * spectrum.norm * mode.condition;
    // Near a defective zero w^H v vanishes, and with it all that the quotient could tell.
    if (rounding > refine_above * std::abs(mode.eigenvalue) && mode.condition < well_conditioned)
      mode.eigenvalue = rayleigh_quotient(A, w, v);
    // Partners follow one another; they stay exact conjugates.
    if (mode.eigenvalue.imag() < 0.0 && k > 0) mode.eigenvalue = std::conj(spectrum.modes.back().eigenvalue);
    mode.rounding = doubt * rounding;
    mode.doubtful = std::abs(mode.eigenvalue) <= mode.rounding;
    Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    const Complex unit = v(largest);
    v /= unit;
    w *= std::conj(unit) / std::conj(product);
    spectrum.right.col(k) = nominal.cast<Complex>().asDiagonal() * v;
    spectrum.left.col(k) = nominal.cwiseInverse().cast<Complex>().asDiagonal() * w;
    spectrum.modes.push_back(std::move(mode));
  }
  find_defective(stairs, nominal, spectrum);
  for (Index k = 0; k < rest; ++k) {
    Mode& mode = spectrum.modes[static_cast<std::size_t>(k)];
    if (!mode.doubtful) continue;
    mode.cause = "numerically zero but unexplained: ranks say nonzero, rounding alone could make it; moves " +
                 joined(named(model, nominal.cwiseInverse().cwiseProduct(spectrum.right.col(k).cwiseAbs()), nominal));
  }
  sort_modes(spectrum);
  if (z == 0) return spectrum;

  // Jordan blocks: starting vectors of blocks of size >= k are A_zz^(k-1) null(A_zz^k), nested; longest first.
  const MatrixXd nilpotent = stairs.triangular.topLeftCorner(z, z);
  const std::vector<int> sizes = stairs.block_sizes();
  MatrixXd taken(z, 0);
  for (int k = sizes.front(); k >= 1; --k) {
    const Index count = std::count(sizes.begin(), sizes.end(), k);
    if (count == 0) continue;
    MatrixXd power = MatrixXd::Identity(z, z);
    for (int j = 1; j < k; ++j) power = power * nilpotent;
    MatrixXd starts = power * null_space(power * nilpotent);
    for (Index j = 0; j < starts.cols(); ++j) {
      const double norm = starts.col(j).norm();
      if (norm > 0.0) starts.col(j) /= norm;
    }
    const MatrixXd chosen = extend(taken, starts, count);
    const MatrixXd vectors = readable(stairs.Q.leftCols(z) * chosen);
    for (Index j = 0; j < count; ++j) spectrum.zeros.push_back(classify(model, vectors.col(j), k, nominal));
    MatrixXd both(z, taken.cols() + count);
    both << taken, chosen;
    taken = both;
  }
  // Conserved sums: the left null space of A, each combined to few names.
  const Staircase transposed = find_staircase(A.transpose());
  const Index conserved = transposed.steps.empty() ? 0 : transposed.steps.front();
  const MatrixXd left = readable(transposed.Q.leftCols(conserved));
  for (Index j = 0; j < conserved; ++j) spectrum.conserved.push_back(named(model, left.col(j), nominal.cwiseInverse()));
  for (const ZeroBlock& block : spectrum.zeros) {
    for (int j = 0; j < block.size; ++j) {
      Mode mode;
      mode.eigenvalue = 0.0;
      mode.zero = true;
      mode.condition = std::numeric_limits<double>::infinity();
      if (block.size == 1) mode.condition = 1.0;
      mode.cause = block.cause;
      spectrum.modes.push_back(mode);
    }
  }
  spectrum.right.rightCols(z) = (nominal.asDiagonal() * stairs.Q.leftCols(z)).cast<Complex>();
  return spectrum;
}

}  // namespace bramah
