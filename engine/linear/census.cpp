#include "linear/census.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sparse/rank_lu.hpp"
#include "system/analysis_error.hpp"

namespace bramah {
namespace {

/// T_k with columns in nominals and rows over their largest entry in P0, P1 or P2.
class Toeplitz {
 public:
  explicit Toeplitz(const Descriptor& descriptor)
      : d_(descriptor), row_scale_(static_cast<std::size_t>(d_.size()), 0.0) {
    each_entry([&](int, Index row, Index, double value) {
      double& largest = row_scale_[static_cast<std::size_t>(row)];
      largest = std::max(largest, std::abs(value));
    });
    for (double& scale : row_scale_) scale = scale > 0.0 ? 1.0 / scale : 1.0;
  }

  /// dim null T_k.
  Index nullity(int k, ZeroPrediction& pivots) {
    const Index size = d_.size();
    std::vector<Index> start = {0}, row;
    std::vector<double> value;
    for (int block = 0; block < k; ++block) {
      for (Index j = 0; j < size; ++j) {
        for (int power = 0; power < std::min(3, k - block); ++power) {
          const sparse::CscView P = d_.coefficient(power);
          for (Index e = P.start[j]; e < P.start[j + 1]; ++e) {
            if (P.value[e] == 0.0) continue;
            row.push_back((block + power) * size + P.row[e]);
            value.push_back(P.value[e] * scale(P.row[e], j));
          }
        }
        start.push_back(static_cast<Index>(row.size()));
      }
    }
    sparse::RankLu lu;
    lu.factor({k * size, k * size, start.data(), row.data(), value.data()});
    pivots.accepted = std::min(pivots.accepted, lu.smallest_accepted());
    pivots.refused = std::max(pivots.refused, lu.largest_refused());
    return k * size - lu.rank();
  }

 private:
  [[nodiscard]] double scale(Index row, Index column) const {
    return row_scale_[static_cast<std::size_t>(row)] * d_.nominal()[static_cast<std::size_t>(column)];
  }
  template <class Visit>
  void each_entry(Visit&& visit) const {
    for (int power = 0; power < 3; ++power) {
      const sparse::CscView P = d_.coefficient(power);
      for (Index j = 0; j < P.columns; ++j) {
        for (Index e = P.start[j]; e < P.start[j + 1]; ++e)
          visit(power, P.row[e], j, P.value[e] * d_.nominal()[static_cast<std::size_t>(j)]);
      }
    }
  }
  const Descriptor& d_;
  std::vector<double> row_scale_;
};

}  // namespace

Index ZeroPrediction::count() const { return std::accumulate(block_sizes.begin(), block_sizes.end(), Index{0}); }

ZeroPrediction predict_zeros(const Descriptor& descriptor) {
  ZeroPrediction prediction;
  Toeplitz toeplitz(descriptor);
  // Blocks of size k or more: dim null T_k - dim null T_(k-1).
  std::vector<Index> at_least;
  Index before = 0;
  for (int k = 1;; ++k) {
    const Index nullity = toeplitz.nullity(k, prediction);
    if (nullity == before) break;
    if (nullity > descriptor.states())
      throw AnalysisError("modes", "det P(s) is zero at every s",
                          "independent constraint rows, and mass for every motion that they leave free",
                          "run `bramah linearize` on the scene: it names what is redundant or without mass");
    at_least.push_back(nullity - before);
    before = nullity;
  }
  if (at_least.empty()) return prediction;
  prediction.block_sizes.assign(static_cast<std::size_t>(at_least.front()), 0);
  for (const Index count : at_least) {
    for (Index i = 0; i < count; ++i) ++prediction.block_sizes[static_cast<std::size_t>(i)];
  }
  return prediction;
}

}  // namespace bramah
