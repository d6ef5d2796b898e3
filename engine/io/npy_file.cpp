#include "io/npy_file.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>

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

NpyFile::NpyFile(const std::filesystem::path& file, const std::vector<std::string>& columns)
    : file_(file), columns_(columns.size()), last_count_(now()) {
  std::string header = "{'descr': [";
  for (const std::string& column : columns) header += "(" + quoted(column) + ", '<f8'), ";
  header += "], 'fortran_order': False, 'shape': (";
  // Version 3 of the format: a length of four bytes, UTF-8.
  constexpr std::size_t before = 12;
  count_at_ = static_cast<long>(before + header.size());
  header += padded(0) + ",), }";
  header.append(alignment - 1 - (before + header.size()) % alignment, ' ');
  header += '\n';
  std::string start("\x93NUMPY\x03\x00", 8);
  const auto length = static_cast<std::uint32_t>(header.size());
  for (unsigned shift = 0; shift < 32; shift += 8) start += static_cast<char>((length >> shift) & 0xFFU);
  file_.write(start + header);
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
