// A table of doubles in NumPy's format, written row by row: one record per row, a named column per quantity.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/output_file.hpp"

namespace bramah {

/// `numpy.load(file)["crank.angle"]` is a column. The count of rows in the header is brought up to date every second, so
/// that the part that a killed run leaves behind can be read as well.
class NpyFile {
 public:
  NpyFile(const std::filesystem::path& file, const std::vector<std::string>& columns);
  /// Goes on behind the first `rows` rows of what is there, whose columns must be these. WriteError where they are not.
  NpyFile(const std::filesystem::path& file, const std::vector<std::string>& columns, std::size_t rows);
  void flush() { write_count(); }
  void keep_on_failure() { file_.keep_on_failure(); }
  void row(std::span<const double> values);
  void commit();
  std::filesystem::path leave_part();

 private:
  /// The file's beginning, with a count of rows at `count_at`.
  static std::string header_of(const std::vector<std::string>& columns, std::size_t rows, long& count_at);
  static std::uintmax_t bytes_of(const std::filesystem::path& file, const std::vector<std::string>& columns,
                                 std::size_t rows);
  void write_count();
  OutputFile file_;
  std::size_t columns_, rows_ = 0;
  long count_at_ = 0;  // where the header has the count of rows
  double last_count_;  // when it was written, s
};

}  // namespace bramah
