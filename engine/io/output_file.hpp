// Files that appear under their name only when they are complete.
#pragma once

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace bramah {

/// A file or folder that cannot be written: which, why, what to do.
class WriteError : public std::runtime_error {
 public:
  WriteError(std::filesystem::path file, std::string found, std::string remedy)
      : std::runtime_error(file.string() + ": " + found + "; " + remedy),
        file_(std::move(file)),
        found_(std::move(found)),
        remedy_(std::move(remedy)) {}
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] const std::string& remedy() const { return remedy_; }

 private:
  std::filesystem::path file_;
  std::string found_, remedy_;
};

/// Writes to NAME.part beside the file; `commit` gives it its name. Without it the part is removed.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  void write(std::string_view text);
  /// Replaces what stands at `offset`, and brings all that was written so far to the file.
  void overwrite(long offset, std::string_view text);
  void commit();
  /// Leaves the part where it is and says where: what a broken run has found so far is worth a look.
  std::filesystem::path leave_part();

 private:
  [[noreturn]] void fail(const std::string& what, int code);
  std::filesystem::path file_, part_;
  std::FILE* out_ = nullptr;
};

/// A whole file at once.
void write_file(const std::filesystem::path& file, std::string_view text);
/// The folder and those around it, where they are missing.
void make_folder(const std::filesystem::path& folder);

}  // namespace bramah
