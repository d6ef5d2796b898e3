// A sparse matrix as others own it, compressed by columns.
#pragma once

#include <cstdint>

namespace bramah::sparse {

template <class Scalar>
struct BasicCscView {
  std::int64_t rows = 0, columns = 0;
  const std::int64_t* start = nullptr;  // (columns + 1)
  const std::int64_t* row = nullptr;    // ascending within a column
  const Scalar* value = nullptr;
};
using CscView = BasicCscView<double>;

}  // namespace bramah::sparse
