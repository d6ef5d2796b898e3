#include "linear/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

#include "linear/block_form.hpp"
#include "linear/defective.hpp"
#include "linear/lapack.hpp"
#include "linear/staircase.hpp"
#include "system/analysis_error.hpp"

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

// A slow eigenvalue beside fast ones of its part is refined where QR's error bound takes more than this part of it.
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

void require_finite(const MatrixXd& A) {
  if (!A.allFinite())
    throw AnalysisError("modes", "a Jacobian with entries that are not finite", "a finite Jacobian",
                        "linearize at another state");
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

std::vector<Complex> plain_eigenvalues(const MatrixXd& A) {
  require_finite(A);
  return lapack::eigenvalues(A);
}

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
void find_defective(const BlockForm& form, const VectorXd& nominal, Spectrum& spectrum) {
  std::optional<InvariantSubspaces> subspaces;
  std::vector<Mode>& modes = spectrum.modes;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (modes[k].group >= 0 || !inseparable(modes, k)) continue;
    if (!subspaces)
      subspaces.emplace(form.triangular, form.zeros(),
                        doubt * std::numeric_limits<double>::epsilon() * form.triangular.norm());
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
    group->right = nominal.cast<Complex>().asDiagonal() * (form.right.cast<Complex>() * group->right);
    group->left = nominal.cwiseInverse().cast<Complex>().asDiagonal() * (form.left.cast<Complex>() * group->left);
    spectrum.defective.push_back(*std::move(group));
  }
}

/// Vectors of the nonzero eigenvalues, (n x their number), as columns of complex numbers.
MatrixXcd unpacked(const MatrixXd& packed, const std::vector<Complex>& eigenvalues) {
  MatrixXcd full(packed.rows(), packed.cols());
  for (Index k = 0; k < packed.cols(); ++k) {
    const double imaginary = eigenvalues[static_cast<std::size_t>(k)].imag();
    if (imaginary > 0.0) {
      full.col(k) = packed.col(k).cast<Complex>() + Complex(0, 1) * packed.col(k + 1);
    } else if (imaginary < 0.0) {
      full.col(k) = full.col(k - 1).conjugate();
    } else {
      full.col(k) = packed.col(k).cast<Complex>();
    }
  }
  return full;
}

/// What rounding may have moved the eigenvalues by, to first order: in the parts that they belong to, and to better values
/// where these are to be had.
class Refinement {
 public:
  /// `right`, `left`: vectors of A, one column for each of form.nonzero.
  Refinement(const MatrixXd& A, const BlockForm& form, const MatrixXcd& right, const MatrixXcd& left)
      : A_(A), form_(form), right_(right), left_(left), eigenvalues_(form.nonzero), moved_(eigenvalues_.size()) {}

  void run() {
    for (std::size_t k = 0; k < moved_.size(); ++k) moved_[k] = by_iteration(k);
    const std::vector<double> iterated = moved_;
    for (std::size_t k = 0; k < moved_.size(); ++k) {
      // Partners follow one another; they stay exact conjugates.
      if (k > 0 && eigenvalues_[k].imag() < 0.0) {
        eigenvalues_[k] = std::conj(eigenvalues_[k - 1]);
        moved_[k] = moved_[k - 1];
      } else {
        refine(k, iterated);
      }
    }
  }
  [[nodiscard]] Complex eigenvalue(std::size_t k) const { return eigenvalues_[k]; }
  [[nodiscard]] double moved(std::size_t k) const { return moved_[k]; }

 private:
  static constexpr double eps = std::numeric_limits<double>::epsilon();
  [[nodiscard]] const BlockForm::Part& part(std::size_t k) const { return form_.parts[form_.part_of[k]]; }

  /// Of the QR iteration: eps |P| condition, of the balanced part P with its zeros.
  [[nodiscard]] double by_iteration(std::size_t k) const {
    if (part(k).states.size() == 1) return eps * std::abs(eigenvalues_[k]);
    const std::vector<Index>& states = part(k).states;
    const VectorXd balance = form_.balance(states);
    const VectorXcd v = balance.cwiseInverse().asDiagonal() * right_(states, static_cast<Index>(k)),
                    w = balance.asDiagonal() * left_(states, static_cast<Index>(k));
    return eps * part(k).norm * v.norm() * w.norm() / std::abs(w.dot(v));
  }

  /// The quotient's error is of second order in what the iteration moved, over the distance to the next eigenvalue; what is
  /// left is rounding of the entries that the eigenvalue depends on.
  void refine(std::size_t k, const std::vector<double>& iterated) {
    if (!(moved_[k] > refine_above * std::abs(eigenvalues_[k])) || part(k).states.size() == 1) return;
    const auto first = static_cast<std::size_t>(part(k).first), last = first + static_cast<std::size_t>(part(k).count);
    const bool with_zeros = last - first < part(k).states.size();
    double gap = with_zeros ? std::abs(eigenvalues_[k]) : std::numeric_limits<double>::infinity(), worst = 0.0;
    for (std::size_t j = first; j < last; ++j) {
      worst = std::max(worst, iterated[j]);
      if (j != k) gap = std::min(gap, std::abs(form_.nonzero[j] - form_.nonzero[k]));
    }
    const double second = moved_[k] * worst / gap;
    if (!(second < moved_[k]) || moved_[k] > well_conditioned * eps * part(k).norm) return;
    const MatrixXd P = A_(part(k).states, part(k).states);
    const VectorXcd v = right_(part(k).states, static_cast<Index>(k)), w = left_(part(k).states, static_cast<Index>(k));
    const double refined = eps * w.cwiseAbs().dot(P.cwiseAbs() * v.cwiseAbs()) / std::abs(w.dot(v)) + second;
    if (!(refined < moved_[k])) return;
    eigenvalues_[k] = rayleigh_quotient(P, w, v);
    moved_[k] = refined;
  }

  const MatrixXd& A_;
  const BlockForm& form_;
  const MatrixXcd &right_, &left_;
  std::vector<Complex> eigenvalues_;
  std::vector<double> moved_;
};

/// One mode for each nonzero eigenvalue, states in nominals.
void add_modes(const MatrixXd& A, const BlockForm& form, const VectorXd& nominal, Spectrum& spectrum) {
  const Index n = A.rows(), rest = n - form.zeros();
  MatrixXd right, left;
  lapack::vectors(form.triangular, rest, right, left);
  const MatrixXcd V = unpacked(form.right * right, form.nonzero), W = unpacked(form.left * left, form.nonzero);
  Refinement refined(A, form, V, W);
  refined.run();
  spectrum.right = MatrixXcd::Zero(n, n);
  spectrum.left = MatrixXcd::Zero(n, rest);
  for (Index k = 0; k < rest; ++k) {
    const auto at = static_cast<std::size_t>(k);
    Mode mode;
    mode.eigenvalue = refined.eigenvalue(at);
    mode.rounding = doubt * refined.moved(at);
    VectorXcd v = V.col(k), w = W.col(k);
    const Complex product = w.dot(v);  // w^H v
    const bool parallel = std::abs(product) > 0.0;
    mode.condition = parallel ? w.norm() * v.norm() / std::abs(product) : std::numeric_limits<double>::infinity();
    mode.doubtful = std::abs(mode.eigenvalue) <= mode.rounding;
    Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    const Complex unit = v(largest);
    v /= unit;
    if (parallel) w *= std::conj(unit) / std::conj(product);
    spectrum.right.col(k) = nominal.cast<Complex>().asDiagonal() * v;
    spectrum.left.col(k) = nominal.cwiseInverse().cast<Complex>().asDiagonal() * w;
    spectrum.modes.push_back(std::move(mode));
  }
}

/// Jordan blocks, longest first: blocks of size >= k start at N^(k-1) null(N^k), nested. The first columns of a staircase
/// span the null spaces.
void add_zeros(const LinearModel& model, const BlockForm& form, const VectorXd& nominal, Spectrum& spectrum) {
  const Index z = form.zeros();
  const MatrixXd N = form.triangular.topLeftCorner(z, z);
  const auto longest = static_cast<int>(form.steps.size());
  std::vector<MatrixXd> powers = {MatrixXd::Identity(z, z)};
  while (static_cast<int>(powers.size()) < longest) powers.emplace_back(powers.back() * N);
  MatrixXd taken(z, 0);
  for (int k = longest; k >= 1; --k) {
    const auto step = form.steps.begin() + k;
    const Index count = *(step - 1) - (k < longest ? *step : 0),
                dimension = std::accumulate(form.steps.begin(), step, Index{0});
    if (count == 0) continue;
    MatrixXd starts = powers[static_cast<std::size_t>(k - 1)].leftCols(dimension);
    for (Index j = 0; j < starts.cols(); ++j) {
      const double norm = starts.col(j).norm();
      if (norm > 0.0) starts.col(j) /= norm;
    }
    const MatrixXd chosen = extend(taken, starts, count);
    const MatrixXd vectors = readable(form.right.leftCols(z) * chosen);
    for (Index j = 0; j < count; ++j) spectrum.zeros.push_back(classify(model, vectors.col(j), k, nominal));
    MatrixXd both(z, taken.cols() + count);
    both << taken, chosen;
    taken = both;
  }
  // Conserved sums: the left null space of A, each combined to few names.
  const MatrixXd left = readable(form.left_null_space());
  for (Index j = 0; j < left.cols(); ++j)
    spectrum.conserved.push_back(named(model, left.col(j), nominal.cwiseInverse()));
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
  spectrum.right.rightCols(z) = (nominal.asDiagonal() * form.right.leftCols(z)).cast<Complex>();
}

}  // namespace

Spectrum find_spectrum(const LinearModel& model) {
  const VectorXd nominal = nominals(model);
  const Index n = nominal.size();
  const VectorXd rounding = model.rounding.size() == n ? model.rounding : VectorXd::Zero(n);
  // The diagonal has no unit but 1/s, and takes no rounding.
  MatrixXd A = nominal.cwiseInverse().asDiagonal() * model.A * nominal.asDiagonal();
  A.diagonal() = model.A.diagonal();
  A = without_rounding(std::move(A), rounding);
  require_finite(A);
  const BlockForm form = find_block_form(A, rounding);
  Spectrum spectrum;
  spectrum.smallest_accepted = form.accepted;
  spectrum.largest_refused = form.refused;
  spectrum.norm = A.norm();
  add_modes(A, form, nominal, spectrum);
  find_defective(form, nominal, spectrum);
  for (std::size_t k = 0; k < spectrum.modes.size(); ++k) {
    Mode& mode = spectrum.modes[k];
    if (!mode.doubtful) continue;
    const VectorXd moves = nominal.cwiseInverse().cwiseProduct(spectrum.right.col(static_cast<Index>(k)).cwiseAbs());
    mode.cause = "numerically zero but unexplained: ranks say nonzero, rounding alone could make it; moves " +
                 joined(named(model, moves, nominal));
  }
  sort_modes(spectrum);
  if (form.zeros() > 0) add_zeros(model, form, nominal, spectrum);
  return spectrum;
}

}  // namespace bramah
