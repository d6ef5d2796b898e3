// Matrices for other programs: CSV with names, MATLAB level 5 MAT files, which Octave, SciPy and Julia read as well, and
// Matrix Market files of sparse ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace bramah {

/// A dense matrix as others own it, column after column.
struct DenseView {
  const double* data = nullptr;
  std::size_t rows = 0, columns = 0;
};

/// A header row `,COLUMN,...`, then a row `NAME,number,...` for each row of the matrix; 17 digits.
std::string csv_of(const DenseView& matrix, const std::vector<std::string>& rows,
                   const std::vector<std::string>& columns);

/// One entry of a sparse matrix, rows and columns counted from 0.
struct SparseEntry {
  std::int64_t row = 0, column = 0;
  double value = 0.0;
};

/// A Matrix Market file (coordinate real general), 17 digits.
std::string matrix_market(std::int64_t rows, std::int64_t columns, const std::vector<SparseEntry>& entries);

/// One variable of a MAT file: a matrix of doubles, or a list of names as a character matrix (one row each).
struct MatVariable {
  std::string name;
  DenseView matrix;
  std::vector<std::string> names;  // where not empty, this instead of the matrix
};

/// The bytes of an uncompressed MAT file of level 5, little-endian.
std::string mat_file(const std::vector<MatVariable>& variables);

}  // namespace bramah
