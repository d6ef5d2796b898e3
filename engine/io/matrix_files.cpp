#include "io/matrix_files.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "io/json_writer.hpp"
#include "io/tables.hpp"

namespace bramah {
namespace {

static_assert(std::endian::native == std::endian::little, "MAT files are written in the byte order of the machine");

// Type and class numbers of the MAT-file format, level 5.
enum Type : std::uint32_t {
  type_int8 = 1,
  type_int32 = 5,
  type_uint16 = 4,
  type_uint32 = 6,
  type_double = 9,
  type_matrix = 14
};
enum Class : std::uint32_t { class_char = 4, class_double = 6 };

void put32(std::string& out, std::uint32_t value) {
  char bytes[4];
  std::memcpy(bytes, &value, 4);
  out.append(bytes, 4);
}

/// A tagged element, padded to eight bytes.
void put_element(std::string& out, Type type, const void* data, std::size_t bytes) {
  put32(out, type);
  put32(out, static_cast<std::uint32_t>(bytes));
  out.append(static_cast<const char*>(data), bytes);
  out.append((8 - bytes % 8) % 8, '\0');
}

void put_variable(std::string& out, const MatVariable& variable) {
  const bool text = !variable.names.empty();
  std::size_t width = 0;
  for (const std::string& name : variable.names) width = std::max(width, name.size());
  const std::int32_t dimensions[2] = {static_cast<std::int32_t>(text ? variable.names.size() : variable.matrix.rows),
                                      static_cast<std::int32_t>(text ? width : variable.matrix.columns)};
  const std::uint32_t flags[2] = {text ? class_char : class_double, 0};
  std::string body;
  put_element(body, type_uint32, flags, sizeof flags);
  put_element(body, type_int32, dimensions, sizeof dimensions);
  put_element(body, type_int8, variable.name.data(), variable.name.size());
  if (text) {
    std::vector<std::uint16_t> letters;  // column by column, blanks behind short names
    for (std::size_t column = 0; column < width; ++column) {
      for (const std::string& name : variable.names) {
        letters.push_back(column < name.size() ? static_cast<unsigned char>(name[column]) : std::uint16_t{' '});
      }
    }
    put_element(body, type_uint16, letters.data(), 2 * letters.size());
  } else {
    put_element(body, type_double, variable.matrix.data,
                sizeof(double) * variable.matrix.rows * variable.matrix.columns);
  }
  put32(out, type_matrix);
  put32(out, static_cast<std::uint32_t>(body.size()));
  out += body;
}

}  // namespace

std::string csv_of(const DenseView& matrix, const std::vector<std::string>& rows,
                   const std::vector<std::string>& columns) {
  std::string out;
  for (const std::string& column : columns) out += "," + csv_field(column);
  out += '\n';
  for (std::size_t i = 0; i < matrix.rows; ++i) {
    out += csv_field(rows[i]);
    for (std::size_t j = 0; j < matrix.columns; ++j) {
      out += ',' + exact_number(matrix.data[i + j * matrix.rows]);
    }
    out += '\n';
  }
  return out;
}

std::string matrix_market(std::int64_t rows, std::int64_t columns, const std::vector<SparseEntry>& entries) {
  std::string out = "%%MatrixMarket matrix coordinate real general\n" + std::to_string(rows) + ' ' +
                    std::to_string(columns) + ' ' + std::to_string(entries.size()) + '\n';
  for (const SparseEntry& entry : entries) {
    out +=
        std::to_string(entry.row + 1) + ' ' + std::to_string(entry.column + 1) + ' ' + exact_number(entry.value) + '\n';
  }
  return out;
}

std::string mat_file(const std::vector<MatVariable>& variables) {
  std::string out = "MATLAB 5.0 MAT-file, made by Bramah";
  out.resize(124, ' ');
  out += std::string("\x00\x01", 2);  // version 0x0100
  out += "IM";                        // little-endian
  for (const MatVariable& variable : variables) put_variable(out, variable);
  return out;
}

}  // namespace bramah
