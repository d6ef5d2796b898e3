#include "sparse/klu.hpp"

#include <klu.h>

#include <Eigen/Core>
#include <cmath>
#include <new>

namespace bramah::sparse {
namespace {

// SuiteSparse takes its matrices without const; it does not write to them.
template <class T>
T* writable(const T* p) {
  return const_cast<T*>(p);
}
SuiteSparse_long* indices(const std::int64_t* p) {
  static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));
  return reinterpret_cast<SuiteSparse_long*>(writable(p));
}

// A pivot that lost this factor against the largest entry of the matrix means that old pivots no longer serve.
constexpr double least_reciprocal_condition = 1e-14;

/// KLU's functions by scalar; complex numbers travel as pairs of doubles.
template <class Scalar>
struct Calls;
template <>
struct Calls<double> {
  static constexpr auto factor = klu_l_factor;
  static constexpr auto refactor = klu_l_refactor;
  static constexpr auto reciprocal_condition = klu_l_rcond;
  static constexpr auto condition = klu_l_condest;
  static constexpr auto solve = klu_l_solve;
  static constexpr auto free_numeric = klu_l_free_numeric;
  static int solve_transposed(klu_l_symbolic* s, klu_l_numeric* n, SuiteSparse_long size, SuiteSparse_long count,
                              double* rhs, klu_l_common* common) {
    return static_cast<int>(klu_l_tsolve(s, n, size, count, rhs, common));
  }
};
template <>
struct Calls<std::complex<double>> {
  static constexpr auto factor = klu_zl_factor;
  static constexpr auto refactor = klu_zl_refactor;
  static constexpr auto reciprocal_condition = klu_zl_rcond;
  static constexpr auto condition = klu_zl_condest;
  static constexpr auto solve = klu_zl_solve;
  static constexpr auto free_numeric = klu_zl_free_numeric;
  static int solve_transposed(klu_l_symbolic* s, klu_l_numeric* n, SuiteSparse_long size, SuiteSparse_long count,
                              double* rhs, klu_l_common* common) {
    return static_cast<int>(klu_zl_tsolve(s, n, size, count, rhs, 0, common));
  }
};

template <class Scalar>
double* doubles(const Scalar* values) {
  return reinterpret_cast<double*>(writable(values));
}

/// 1 for an even permutation, -1 for an odd one.
double parity(const SuiteSparse_long* permutation, std::int64_t size) {
  std::vector<char> seen(static_cast<std::size_t>(size), 0);
  double sign = 1.0;
  for (std::int64_t first = 0; first < size; ++first) {
    std::int64_t length = 0;
    for (std::int64_t i = first; seen[static_cast<std::size_t>(i)] == 0; i = permutation[i], ++length)
      seen[static_cast<std::size_t>(i)] = 1;
    if (length > 0 && length % 2 == 0) sign = -sign;
  }
  return sign;
}

/// L U = P R^-1 A S Q, of one block: columns of L begin with the diagonal, those of U end with it. `R`, with the sizes of
/// rows in it, and the sizes `S` of unknowns are in pivotal order. Pivots divide, as in KLU: products with reciprocals would not leave exact ones and zeros exact.
struct Factors {
  std::vector<SuiteSparse_long> L_start, L_row, U_start, U_row, P, Q;
  std::vector<double> L, U, R, S;
  std::vector<double> x;  // (n x width) row-major, in pivotal order

  void take(const klu_l_symbolic* symbolic, const klu_l_numeric* numeric, klu_l_common* common,
            const std::vector<double>& sizes, const std::vector<double>& row_sizes) {
    const auto n = static_cast<std::size_t>(numeric->n), l = static_cast<std::size_t>(numeric->lnz),
               u = static_cast<std::size_t>(numeric->unz);
    for (auto* list : {&L_start, &U_start}) list->resize(n + 1);
    for (auto* list : {&P, &Q}) list->resize(n);
    L_row.resize(l), L.resize(l);
    U_row.resize(u), U.resize(u);
    R.resize(n);
    klu_l_extract(writable(numeric), writable(symbolic), L_start.data(), L_row.data(), L.data(), U_start.data(),
                  U_row.data(), U.data(), nullptr, nullptr, nullptr, P.data(), Q.data(), R.data(), nullptr, common);
    S.assign(n, 1.0);
    for (std::size_t k = 0; k < n; ++k) {
      if (!sizes.empty()) S[k] = sizes[static_cast<std::size_t>(Q[k])];
      if (!row_sizes.empty()) R[k] *= row_sizes[static_cast<std::size_t>(P[k])];
    }
  }

  template <int width>
  void solve(double* b) {
    using Row = Eigen::Array<double, width, 1>;
    const auto row = [](auto* rows, std::int64_t i) { return Eigen::Map<Row>(rows + i * width); };
    const auto n = static_cast<std::int64_t>(P.size());
    x.resize(P.size() * width);
    double* const x_all = x.data();
    const SuiteSparse_long *p = P.data(), *q = Q.data();
    const SuiteSparse_long *l = L_start.data(), *l_row = L_row.data(), *u = U_start.data(), *u_row = U_row.data();
    const double *l_value = L.data(), *u_value = U.data(), *scale = R.data();
    for (std::int64_t k = 0; k < n; ++k) row(x_all, k) = row(b, p[k]) / scale[k];
    for (std::int64_t k = 0; k < n; ++k) {
      const Row x_k = row(x_all, k);
      if ((x_k == 0.0).all()) continue;  // most rows, at first, of what one coordinate moves
      for (auto e = l[k] + 1; e < l[k + 1]; ++e) row(x_all, l_row[e]) -= l_value[e] * x_k;
    }
    for (std::int64_t k = n; k-- > 0;) {
      const auto diagonal = u[k + 1] - 1;
      const Row x_k = row(x_all, k) / u_value[diagonal];
      for (auto e = u[k]; e < diagonal; ++e) row(x_all, u_row[e]) -= u_value[e] * x_k;
      row(b, q[k]) = x_k * S[static_cast<std::size_t>(k)];
    }
  }
};

}  // namespace

template <class Scalar>
struct BasicKlu<Scalar>::Data {
  klu_l_common common{};
  klu_l_symbolic* symbolic = nullptr;
  klu_l_numeric* numeric = nullptr;
  std::int64_t size = 0;
  bool fresh = false;
  Factors factors;
  bool taken = false;                             // whether `factors` are those of the last factorization
  std::vector<double> sizes, row_sizes, per_row;  // of unknowns, of rows, one over that; empty: all 1
  std::vector<Scalar> scaled;                     // the values of the matrix that is factored, where there are sizes

  Data() {
    klu_l_defaults(&common);
    common.ordering = 1;
    common.btf = 0;
  }
  ~Data() {
    Calls<Scalar>::free_numeric(&numeric, &common);
    klu_l_free_symbolic(&symbolic, &common);
  }
  void scale(const BasicCscView<Scalar>& matrix) {
    for (std::int64_t j = 0; j < size; ++j) {
      const double unknown = sizes[static_cast<std::size_t>(j)];
      const auto first = static_cast<std::size_t>(matrix.start[j]),
                 last = static_cast<std::size_t>(matrix.start[j + 1]);
      if (row_sizes.empty()) {
        for (std::size_t e = first; e < last; ++e) scaled[e] = matrix.value[e] * unknown;
      } else {
        for (std::size_t e = first; e < last; ++e)
          scaled[e] = matrix.value[e] * unknown * per_row[static_cast<std::size_t>(matrix.row[e])];
      }
    }
  }
  /// `count` right-hand sides, one after the other.
  void scale_rows(Scalar* rhs, std::int64_t count) const {
    for (std::int64_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < row_sizes.size(); ++i) rhs[k * size + static_cast<std::int64_t>(i)] *= per_row[i];
    }
  }
  void scale_unknowns(Scalar* x, std::int64_t count) const {
    for (std::int64_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < sizes.size(); ++i) x[k * size + static_cast<std::int64_t>(i)] *= sizes[i];
    }
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
};

template <class Scalar>
BasicKlu<Scalar>::BasicKlu() : data_(std::make_unique<Data>()) {}
template <class Scalar>
BasicKlu<Scalar>::~BasicKlu() = default;
template <class Scalar>
BasicKlu<Scalar>::BasicKlu(BasicKlu&&) noexcept = default;
template <class Scalar>
BasicKlu<Scalar>& BasicKlu<Scalar>::operator=(BasicKlu&&) noexcept = default;

template <class Scalar>
bool BasicKlu<Scalar>::analyzed() const {
  return data_->symbolic != nullptr;
}

template <class Scalar>
void BasicKlu<Scalar>::analyze(const View& matrix, std::vector<double> sizes, const std::vector<double>& row_sizes) {
  data_ = std::make_unique<Data>();
  data_->size = matrix.rows;
  if (!row_sizes.empty() && sizes.empty()) sizes.assign(row_sizes.size(), 1.0);
  data_->sizes = std::move(sizes);
  for (const double of_row : row_sizes) data_->per_row.push_back(1.0 / of_row);
  data_->row_sizes = row_sizes;
  if (!data_->sizes.empty()) data_->scaled.resize(static_cast<std::size_t>(matrix.start[matrix.columns]));
  if (matrix.rows == 0) return;
  data_->symbolic = klu_l_analyze(matrix.rows, indices(matrix.start), indices(matrix.row), &data_->common);
  // A structurally singular pattern is left to `factor`, which can name the column.
  if (data_->symbolic == nullptr && data_->common.status == KLU_OUT_OF_MEMORY) throw std::bad_alloc();
}

template <class Scalar>
bool BasicKlu<Scalar>::factor(const View& matrix) {
  using Call = Calls<Scalar>;
  Data& d = *data_;
  if (d.size == 0) return true;
  if (d.symbolic == nullptr) return false;
  d.taken = false;
  const Scalar* values = matrix.value;
  if (!d.sizes.empty()) {
    d.scale(matrix);
    values = d.scaled.data();
  }
  if (d.numeric != nullptr) {
    const bool done = Call::refactor(indices(matrix.start), indices(matrix.row), doubles(values), d.symbolic, d.numeric,
                                     &d.common) != 0;
    if (done && d.common.status == KLU_OK && Call::reciprocal_condition(d.symbolic, d.numeric, &d.common) != 0 &&
        d.common.rcond > least_reciprocal_condition) {
      d.fresh = false;
      return true;
    }
    Call::free_numeric(&d.numeric, &d.common);
  }
  d.fresh = true;
  d.numeric = Call::factor(indices(matrix.start), indices(matrix.row), doubles(values), d.symbolic, &d.common);
  if (d.common.status == KLU_OUT_OF_MEMORY) throw std::bad_alloc();
  if (d.numeric == nullptr || d.common.status == KLU_SINGULAR) {
    Call::free_numeric(&d.numeric, &d.common);
    return false;
  }
  return true;
}

template <class Scalar>
void BasicKlu<Scalar>::forget_pivots() {
  Calls<Scalar>::free_numeric(&data_->numeric, &data_->common);
}

template <class Scalar>
bool BasicKlu<Scalar>::fresh_pivots() const {
  return data_->fresh;
}

template <class Scalar>
std::int64_t BasicKlu<Scalar>::singular_column() const {
  return data_->common.singular_col;
}

template <class Scalar>
void BasicKlu<Scalar>::solve(std::span<Scalar> rhs, std::int64_t count) const {
  if (data_->size == 0 || count == 0) return;
  data_->scale_rows(rhs.data(), count);
  Calls<Scalar>::solve(data_->symbolic, data_->numeric, data_->size, count, doubles(rhs.data()), &data_->common);
  data_->scale_unknowns(rhs.data(), count);
}

template <class Scalar>
void BasicKlu<Scalar>::solve_block(std::span<Scalar> rhs) const requires std::same_as<Scalar, double> {
  Data& d = *data_;
  if (d.size == 0) return;
  if (!d.taken) d.factors.take(d.symbolic, d.numeric, &d.common, d.sizes, d.row_sizes);
  d.taken = true;
  d.factors.template solve<block>(doubles(rhs.data()));
}

template <class Scalar>
void BasicKlu<Scalar>::solve_transposed(std::span<Scalar> rhs, std::int64_t count) const {
  if (data_->size == 0 || count == 0) return;
  data_->scale_unknowns(rhs.data(), count);
  Calls<Scalar>::solve_transposed(data_->symbolic, data_->numeric, data_->size, count, doubles(rhs.data()),
                                  &data_->common);
  data_->scale_rows(rhs.data(), count);
}

template <class Scalar>
double BasicKlu<Scalar>::condition(const View& matrix) const {
  if (data_->size == 0) return 1.0;
  Calls<Scalar>::condition(indices(matrix.start), doubles(data_->sizes.empty() ? matrix.value : data_->scaled.data()),
                           data_->symbolic, data_->numeric, &data_->common);
  return data_->common.condest;
}

template <class Scalar>
Scalar BasicKlu<Scalar>::determinant_phase() const {
  const Data& d = *data_;
  if (d.size == 0) return 1.0;
  // P R^-1 A Q = L U with a unit L and positive row scales R; without block triangular form U is one block.
  const auto* diagonal = static_cast<const Scalar*>(d.numeric->Udiag);
  Scalar phase = parity(d.numeric->Pnum, d.size) * parity(d.symbolic->Q, d.size);
  for (std::int64_t k = 0; k < d.size; ++k) phase *= diagonal[k] / std::abs(diagonal[k]);
  return phase;
}

template class BasicKlu<double>;
template class BasicKlu<std::complex<double>>;

}  // namespace bramah::sparse
