// A sparse matrix as others own it, compressed by columns.
#pragma once

#include <cstdint>

namespace bramah::sparse {

struct CscView {
  std::int64_t rows = 0, columns = 0;
  const std::int64_t* start = nullptr;  // (columns + 1)
  const std::int64_t* row = nullptr;    // ascending within a column
  const double* value = nullptr;
};

}  // namespace bramah::sparse
