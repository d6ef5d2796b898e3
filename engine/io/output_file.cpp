#include "io/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

namespace bramah {
namespace {

std::string remedy_for(int code) {
  if (code == ENOSPC || code == EDQUOT) return "make room, or choose another folder with --out";
  if (code == EACCES || code == EROFS || code == EPERM) return "choose a folder in which you may write with --out";
  return "choose another folder with --out";
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path file) : file_(std::move(file)), part_(file_.string() + ".part") {
  out_ = std::fopen(part_.c_str(), "wb");
  if (out_ == nullptr) fail("cannot be created", errno);
}

OutputFile::~OutputFile() {
  if (out_ == nullptr) return;
  std::fclose(out_);
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void OutputFile::fail(const std::string& what, int code) {
  if (out_ != nullptr) {
    std::fclose(out_);
    out_ = nullptr;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
  throw WriteError(file_, what + ": " + std::strerror(code), remedy_for(code));
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), out_) != text.size()) fail("cannot be written", errno);
}

void OutputFile::overwrite(long offset, std::string_view text) {
  if (std::fseek(out_, offset, SEEK_SET) != 0) fail("cannot be written", errno);
  write(text);
  if (std::fseek(out_, 0, SEEK_END) != 0 || std::fflush(out_) != 0) fail("cannot be written", errno);
}

void OutputFile::commit() {
  if (std::fflush(out_) != 0) fail("cannot be written", errno);
  std::FILE* out = out_;
  out_ = nullptr;
  const bool closed = std::fclose(out) == 0;
  std::error_code error;
  if (!closed) {
    const int code = errno;
    std::filesystem::remove(part_, error);
    fail("cannot be written", code);
  }
  std::filesystem::rename(part_, file_, error);
  if (!error) return;
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  throw WriteError(file_, "cannot be replaced: " + error.message(), remedy_for(error.value()));
}

std::filesystem::path OutputFile::leave_part() {
  std::fclose(out_);
  out_ = nullptr;
  return part_;
}

void write_file(const std::filesystem::path& file, std::string_view text) {
  OutputFile out(file);
  out.write(text);
  out.commit();
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder, error)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw WriteError(folder, "the folder cannot be made: " + error.message(), remedy_for(error.value()));
}

}  // namespace bramah
