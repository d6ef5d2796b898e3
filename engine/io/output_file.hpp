// Files that appear under their name only when they are complete.
#pragma once

#include <cstdint>
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

  /// A series that is there and that no run can go on with.
  static WriteError other_columns(const std::filesystem::path& file) {
    return {file, "has other columns than this run", "choose another folder with --out"};
  }
  static WriteError fewer_rows(const std::filesystem::path& file, std::size_t rows) {
    return {file, "has fewer rows than the " + std::to_string(rows) + " that the checkpoint goes on from",
            "choose another folder with --out"};
  }

 private:
  std::filesystem::path file_;
  std::string found_, remedy_;
};

/// Writes to NAME.part beside the file; `commit` gives it its name. Without it the part is removed. A part is never opened
/// through a link, and what another run has left under its name is replaced.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);
  /// Goes on behind the first `bytes` of what is there: the part that a broken run has left, or else the file.
  OutputFile(std::filesystem::path file, std::uintmax_t bytes);
  /// What the second constructor would go on with; empty where there is nothing.
  static std::filesystem::path there_is(const std::filesystem::path& file);
  /// From here on the part stays where it is when writing fails.
  void keep_on_failure() { keep_ = true; }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  void write(std::string_view text);
  /// Replaces what stands at `offset`, and brings all that was written so far to the file.
  void overwrite(long offset, std::string_view text);
  /// Brings all that was written so far to the file.
  void flush();
  void commit();
  /// Removes the part, kept or not.
  void discard();
  /// Leaves the part where it is and says where: what a broken run has found so far is worth a look.
  std::filesystem::path leave_part();

 private:
  [[noreturn]] void fail(const std::string& what, int code);
  std::filesystem::path file_, part_;
  std::FILE* out_ = nullptr;
  bool keep_ = false;
};

/// A whole file at once.
void write_file(const std::filesystem::path& file, std::string_view text);
/// The folder and those around it, where they are missing, claimed for this process until it ends: WriteError where
/// another run writes into it. A run that died holds nothing. Where the file system cannot lock, a warning says so.
void make_folder(const std::filesystem::path& folder);

}  // namespace bramah
