#include "sparse/klu.hpp"

#include <klu.h>

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

}  // namespace

struct Klu::Data {
  klu_l_common common{};
  klu_l_symbolic* symbolic = nullptr;
  klu_l_numeric* numeric = nullptr;
  std::int64_t size = 0;

  Data() {
    klu_l_defaults(&common);
    common.ordering = 1;
    common.btf = 0;
  }
  ~Data() {
    klu_l_free_numeric(&numeric, &common);
    klu_l_free_symbolic(&symbolic, &common);
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
};

Klu::Klu() : data_(std::make_unique<Data>()) {}
Klu::~Klu() = default;
Klu::Klu(Klu&&) noexcept = default;
Klu& Klu::operator=(Klu&&) noexcept = default;

bool Klu::analyzed() const { return data_->symbolic != nullptr; }

void Klu::analyze(const CscView& matrix) {
  data_ = std::make_unique<Data>();
  data_->size = matrix.rows;
  if (matrix.rows == 0) return;
  data_->symbolic = klu_l_analyze(matrix.rows, indices(matrix.start), indices(matrix.row), &data_->common);
  // A structurally singular pattern is left to `factor`, which can name the column.
  if (data_->symbolic == nullptr && data_->common.status == KLU_OUT_OF_MEMORY) throw std::bad_alloc();
}

bool Klu::factor(const CscView& matrix) {
  Data& d = *data_;
  if (d.size == 0) return true;
  if (d.symbolic == nullptr) return false;
  if (d.numeric != nullptr) {
    const bool done = klu_l_refactor(indices(matrix.start), indices(matrix.row), writable(matrix.value), d.symbolic,
                                     d.numeric, &d.common) != 0;
    if (done && d.common.status == KLU_OK && klu_l_rcond(d.symbolic, d.numeric, &d.common) != 0 &&
        d.common.rcond > least_reciprocal_condition) {
      return true;
    }
    klu_l_free_numeric(&d.numeric, &d.common);
  }
  d.numeric = klu_l_factor(indices(matrix.start), indices(matrix.row), writable(matrix.value), d.symbolic, &d.common);
  if (d.common.status == KLU_OUT_OF_MEMORY) throw std::bad_alloc();
  if (d.numeric == nullptr || d.common.status == KLU_SINGULAR) {
    klu_l_free_numeric(&d.numeric, &d.common);
    return false;
  }
  return true;
}

std::int64_t Klu::singular_column() const { return data_->common.singular_col; }

void Klu::solve(std::span<double> rhs, std::int64_t count) const {
  if (data_->size == 0 || count == 0) return;
  klu_l_solve(data_->symbolic, data_->numeric, data_->size, count, rhs.data(), &data_->common);
}

void Klu::solve_transposed(std::span<double> rhs, std::int64_t count) const {
  if (data_->size == 0 || count == 0) return;
  klu_l_tsolve(data_->symbolic, data_->numeric, data_->size, count, rhs.data(), &data_->common);
}

double Klu::condition(const CscView& matrix) const {
  if (data_->size == 0) return 1.0;
  klu_l_condest(indices(matrix.start), writable(matrix.value), data_->symbolic, data_->numeric, &data_->common);
  return data_->common.condest;
}

}  // namespace bramah::sparse
