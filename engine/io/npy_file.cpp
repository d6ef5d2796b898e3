#include "io/npy_file.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>

namespace bramah {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is written as memory has it");
constexpr std::size_t count_width = 20, alignment = 64;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string padded(std::size_t count) {
  std::string text = std::to_string(count);
  return std::string(count_width - text.size(), ' ') + text;
}

/// A Python literal.
std::string quoted(const std::string& name) {
  std::string text = "'";
  for (const char c : name) {
    if (c == '\'' || c == '\\') text += '\\';
    text += c;
  }
  return text + "'";
}

}  // namespace

std::string NpyFile::header_of(const std::vector<std::string>& columns, std::size_t rows, long& count_at) {
  std::string header = "{'descr': [";
  for (const std::string& column : columns) header += "(" + quoted(column) + ", '<f8'), ";
  header += "], 'fortran_order': False, 'shape': (";
  // Version 3 of the format: a length of four bytes, UTF-8.
  constexpr std::size_t before = 12;
  count_at = static_cast<long>(before + header.size());
  header += padded(rows) + ",), }";
  header.append(alignment - 1 - (before + header.size()) % alignment, ' ');
  header += '\n';
  std::string start("\x93NUMPY\x03\x00", 8);
  const auto length = static_cast<std::uint32_t>(header.size());
  for (unsigned shift = 0; shift < 32; shift += 8) start += static_cast<char>((length >> shift) & 0xFFU);
  return start + header;
}

NpyFile::NpyFile(const std::filesystem::path& file, const std::vector<std::string>& columns)
    : file_(file), columns_(columns.size()), last_count_(now()) {
  file_.write(header_of(columns, 0, count_at_));
}

/// Bytes of the header and of `rows` records, after a look at what is there.
std::uintmax_t NpyFile::bytes_of(const std::filesystem::path& file, const std::vector<std::string>& columns,
                                 std::size_t rows) {
  const std::filesystem::path there = OutputFile::there_is(file);
  long count_at = 0;
  const std::string header = header_of(columns, 0, count_at);
  const auto count = static_cast<std::size_t>(count_at);
  std::ifstream in(there, std::ios::binary);
  std::string begin(header.size(), ' ');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.replace(count, count_width, header, count, count_width);
  if (!in || begin != header) throw WriteError::other_columns(there);
  const std::uintmax_t bytes = header.size() + std::uintmax_t{rows} * columns.size() * sizeof(double);
  std::error_code ignored;
  if (std::filesystem::file_size(there, ignored) < bytes) throw WriteError::fewer_rows(there, rows);
  return bytes;
}

NpyFile::NpyFile(const std::filesystem::path& file, const std::vector<std::string>& columns, std::size_t rows)
    : file_(file, bytes_of(file, columns, rows)), columns_(columns.size()), rows_(rows), last_count_(now()) {
  header_of(columns, rows, count_at_);
}

void NpyFile::row(std::span<const double> values) {
  file_.write({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  ++rows_;
  if (now() - last_count_ > 1.0) write_count();
}

void NpyFile::write_count() {
  file_.overwrite(count_at_, padded(rows_));
  last_count_ = now();
}

void NpyFile::commit() {
  write_count();
  file_.commit();
}

std::filesystem::path NpyFile::leave_part() {
  write_count();
  return file_.leave_part();
}

}  // namespace bramah
