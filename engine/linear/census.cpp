#include "linear/census.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sparse/rank_lu.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

// A singular value of F(0) that counts as zero, its rows and columns over the terms that they are sums of. As in RankLu.
constexpr double rank_tolerance = 1e-9;

// Entries of a vector below this part of its largest may be rounding.
constexpr double negligible = 1e-5;

/// |V|, entries that may be rounding as large as they may be.
MatrixXd bound(const MatrixXd& V) {
  MatrixXd size = V.cwiseAbs();
  for (Index j = 0; j < size.cols() && size.rows() > 0; ++j)
    size.col(j) = size.col(j).cwiseMax(negligible * size.col(j).maxCoeff());
  return size;
}

/// F(s) = F_0 + s F_1 + ..., and beside each entry the size of the terms that it is the sum of: what rounding is
/// relative to.
struct Series {
  std::vector<MatrixXd> value, size;
};

/// P0, P1, P2 in the machine's time with columns in nominals, and rows over their largest entry in any of them.
std::vector<SparseMatrix> scaled_coefficients(const Descriptor& d) {
  std::vector<SparseMatrix> P;
  VectorXd largest = VectorXd::Zero(d.size());
  const Eigen::Map<const VectorXd> nominal(d.nominal().data(), d.size());
  for (int power = 0; power < 3; ++power) {
    const sparse::CscView from = d.coefficient(power);
    const Index entries = from.start[from.columns];
    P.emplace_back(Eigen::Map<const SparseMatrix>(from.rows, from.columns, entries, from.start, from.row, from.value) *
                   (nominal * std::pow(d.time(), -power)).asDiagonal());
    P.back().prune(0.0, 0.0);
    P.back().makeCompressed();
    for (Index j = 0; j < P.back().cols(); ++j) {
      for (SparseMatrix::InnerIterator entry(P.back(), j); entry; ++entry)
        largest(entry.row()) = std::max(largest(entry.row()), std::abs(entry.value()));
    }
  }
  const VectorXd scale = (largest.array() > 0.0).select(largest.cwiseInverse(), 1.0);
  for (SparseMatrix& coefficient : P) coefficient = scale.asDiagonal() * coefficient;
  return P;
}

/// What is singular in P at s = 0.
class SingularPart {
 public:
  explicit SingularPart(const Descriptor& descriptor) : P_(scaled_coefficients(descriptor)) {
    const SparseMatrix& P0 = P_[0];
    lu_.factor({P0.rows(), P0.cols(), P0.outerIndexPtr(), P0.innerIndexPtr(), P0.valuePtr()});
    const Index nullity = P0.cols() - lu_.rank();
    Z_ = MatrixXd::Zero(P0.cols(), nullity);
    W_ = MatrixXd::Zero(P0.rows(), nullity);
    const std::vector<sparse::Dependency> dependencies = lu_.dependencies();
    for (Index k = 0; k < nullity; ++k) {
      const auto which = static_cast<std::size_t>(k);
      Z_(lu_.dependent_columns()[which], k) = 1.0;
      for (const auto& [column, coefficient] : dependencies[which]) Z_(column, k) = -coefficient;
    }
    std::vector<bool> taken(static_cast<std::size_t>(P0.rows()), false);
    for (const Index row : lu_.pivot_rows()) taken[static_cast<std::size_t>(row)] = true;
    const SparseMatrix by_rows = P0.transpose();
    Index k = 0;
    for (Index row = 0; row < P0.rows(); ++row) {
      if (taken[static_cast<std::size_t>(row)]) continue;
      const VectorXd entries = by_rows.col(row);
      VectorXd y(P0.rows());
      lu_.solve_transposed({entries.data(), static_cast<std::size_t>(entries.size())},
                           {y.data(), static_cast<std::size_t>(y.size())});
      W_.col(k) = -y;
      W_(row, k++) = 1.0;
    }
  }
  [[nodiscard]] Index nullity() const { return Z_.cols(); }
  [[nodiscard]] double accepted() const { return lu_.smallest_accepted(); }
  [[nodiscard]] double refused() const { return lu_.largest_refused(); }

  /// The first `terms` of F.
  [[nodiscard]] Series series(int terms) const {
    const SparseMatrix P1 = P_[1].cwiseAbs(), P2 = P_[2].cwiseAbs();
    Series F;
    MatrixXd before = MatrixXd::Zero(Z_.rows(), Z_.cols()), now = Z_;
    for (int j = 0; j < terms; ++j) {
      const MatrixXd rows = P_[1] * now + P_[2] * before;
      F.value.emplace_back(W_.transpose() * rows);
      F.size.emplace_back(bound(W_).transpose() * (P1 * bound(now) + P2 * bound(before)));
      before = now;
      for (Index k = 0; k < rows.cols(); ++k) {
        const auto size = static_cast<std::size_t>(rows.rows());
        lu_.solve({rows.col(k).data(), size}, {now.col(k).data(), size});
      }
      now = -now;
    }
    return F;
  }

 private:
  std::vector<SparseMatrix> P_;
  sparse::RankLu lu_;
  MatrixXd Z_, W_;
};

/// Rows, then columns, of all terms over what the first term is made of.
void equilibrate(Series& F) {
  const auto inverse = [](const VectorXd& v) -> VectorXd { return (v.array() > 0.0).select(v.cwiseInverse(), 1.0); };
  const VectorXd row = inverse(F.size.front().rowwise().maxCoeff());
  const VectorXd column = inverse((row.asDiagonal() * F.size.front()).colwise().maxCoeff().transpose());
  for (std::vector<MatrixXd>* terms : {&F.value, &F.size}) {
    for (MatrixXd& term : *terms) term = (row.asDiagonal() * term * column.asDiagonal()).eval();
  }
}

/// What is singular in F at s = 0, in the place of F: one term less; rows and columns as many as dim null F(0), which is
/// returned.
Index reduce(Series& F, ZeroPrediction& pivots) {
  equilibrate(F);
  const Eigen::JacobiSVD<MatrixXd> svd(F.value.front(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const VectorXd& sigma = svd.singularValues();
  Index rank = 0;
  for (Index i = 0; i < sigma.size(); ++i) {
    if (sigma(i) > rank_tolerance) {
      pivots.accepted = std::min(pivots.accepted, sigma(i));
      ++rank;
    } else {
      pivots.refused = std::max(pivots.refused, sigma(i));
    }
  }
  const Index nullity = sigma.size() - rank;
  const MatrixXd Z = svd.matrixV().rightCols(nullity), W = svd.matrixU().rightCols(nullity);
  const MatrixXd G = svd.matrixV().leftCols(rank) * sigma.head(rank).cwiseInverse().asDiagonal() *
                     svd.matrixU().leftCols(rank).transpose();
  Series next;
  std::vector<MatrixXd> Y = {Z};
  for (std::size_t j = 1; j < F.value.size(); ++j) {
    MatrixXd rows = MatrixXd::Zero(G.cols(), nullity), size = rows;
    for (std::size_t i = 1; i <= j; ++i) {
      rows += F.value[i] * Y[j - i];
      size += F.size[i] * bound(Y[j - i]);
    }
    next.value.emplace_back(W.transpose() * rows);
    next.size.emplace_back(bound(W).transpose() * size);
    Y.emplace_back(-(G * rows));
  }
  F = std::move(next);
  return nullity;
}

[[noreturn]] void always_singular() {
  throw AnalysisError("modes", "det P(s) is zero at every s",
                      "independent constraint rows, and mass for every motion that they leave free",
                      "run `bramah linearize` on the scene: it names what is redundant or without mass");
}

}  // namespace

Index ZeroPrediction::count() const { return std::accumulate(block_sizes.begin(), block_sizes.end(), Index{0}); }

ZeroPrediction predict_zeros(const Descriptor& descriptor) {
  const SingularPart singular(descriptor);
  ZeroPrediction prediction;
  // Blocks are rarely longer than 3; a term of the series serves one size.
  for (int terms = 3;; terms *= 2) {
    prediction = {{}, singular.accepted(), singular.refused()};
    prediction.block_sizes.assign(static_cast<std::size_t>(singular.nullity()), 1);
    Index longer = singular.nullity();
    Series F = singular.series(longer > 0 ? terms : 0);
    while (longer > 0 && !F.value.empty()) {
      longer = reduce(F, prediction);
      for (Index i = 0; i < longer; ++i) ++prediction.block_sizes[static_cast<std::size_t>(i)];
      if (prediction.count() > descriptor.states()) always_singular();
    }
    if (longer == 0) return prediction;
  }
}

namespace {

/// Sizes of the blocks that are foretold and not found; empty where a found one was not foretold.
std::vector<int> missing_blocks(const ZeroPrediction& predicted, const Spectrum& spectrum) {
  std::vector<int> missing = predicted.block_sizes;
  for (const ZeroBlock& block : spectrum.zeros) {
    const auto found = std::find(missing.begin(), missing.end(), block.size);
    if (found == missing.end()) return {};
    missing.erase(found);
  }
  return missing;
}

ZeroBlock block_along(const LinearModel& model, const Eigen::VectorXcd& vector, int size) {
  constexpr double share = 1e-3;  // of the largest move, in nominals
  ZeroBlock block{size, "zero by ranks of the unreduced matrices", "", {}};
  VectorXd moves(vector.size());
  for (Index i = 0; i < moves.size(); ++i)
    moves(i) = std::abs(vector(i)) / model.states[static_cast<std::size_t>(i)].nominal;
  block.cause = block.kind + ", which rounding blurs in the reduced one; moves";
  for (Index i = 0; i < moves.size(); ++i) {
    if (moves(i) <= share * moves.maxCoeff()) continue;
    const std::string& name = model.states[static_cast<std::size_t>(i)].name;
    block.cause += (block.moves.empty() ? " " : ", ") + name;
    block.moves.emplace_back(name, vector(i).real());
  }
  return block;
}

}  // namespace

void settle_doubtful(const LinearModel& model, const ZeroPrediction& predicted, Spectrum& spectrum) {
  const std::vector<int> missing = missing_blocks(predicted, spectrum);
  std::vector<Index> kept, doubtful, zeros;
  for (std::size_t k = 0; k < spectrum.modes.size(); ++k) {
    const Mode& mode = spectrum.modes[k];
    (mode.zero ? zeros : mode.doubtful ? doubtful : kept).push_back(static_cast<Index>(k));
  }
  const int wanted = std::accumulate(missing.begin(), missing.end(), 0);
  if (wanted == 0 || wanted != static_cast<int>(doubtful.size())) return;

  std::size_t next = 0;
  for (const int size : missing) {
    const ZeroBlock block = block_along(model, spectrum.right.col(doubtful[next]), size);
    for (int j = 0; j < size; ++j) {
      Mode& mode = spectrum.modes[static_cast<std::size_t>(doubtful[next++])];
      mode.eigenvalue = 0.0;
      mode.zero = true;
      mode.doubtful = false;
      mode.cause = block.cause;
    }
    spectrum.zeros.push_back(block);
  }
  const Spectrum from = spectrum;
  spectrum.left.resize(from.left.rows(), static_cast<Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k) spectrum.left.col(static_cast<Index>(k)) = from.left.col(kept[k]);
  kept.insert(kept.end(), zeros.begin(), zeros.end());
  kept.insert(kept.end(), doubtful.begin(), doubtful.end());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    spectrum.modes[k] = from.modes[static_cast<std::size_t>(kept[k])];
    spectrum.right.col(static_cast<Index>(k)) = from.right.col(kept[k]);
  }
}

}  // namespace bramah
