// Matrices for other programs: CSV with names, and MATLAB level 5 MAT files, which Octave, SciPy and Julia read as well.
#pragma once

#include <cstddef>
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

/// One variable of a MAT file: a matrix of doubles, or a list of names as a character matrix (one row each).
struct MatVariable {
  std::string name;
  DenseView matrix;
  std::vector<std::string> names;  // where not empty, this instead of the matrix
};

/// The bytes of an uncompressed MAT file of level 5, little-endian.
std::string mat_file(const std::vector<MatVariable>& variables);

}  // namespace bramah
