#include "io/output_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
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
  ::unlink(part_.c_str());  // of a dead run: a living one holds the folder
  const int descriptor = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  out_ = descriptor < 0 ? nullptr : ::fdopen(descriptor, "wb");
  if (out_ == nullptr) fail("cannot be created", errno);
}

OutputFile::OutputFile(std::filesystem::path file, std::uintmax_t bytes)
    : file_(std::move(file)), part_(file_.string() + ".part") {
  const std::filesystem::path before = there_is(file_);
  std::error_code error;
  if (before == file_) std::filesystem::rename(file_, part_, error);
  if (error) fail("cannot be continued", error.value());
  const int descriptor = ::open(part_.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor >= 0 && ::ftruncate(descriptor, static_cast<off_t>(bytes)) == 0) out_ = ::fdopen(descriptor, "r+b");
  if (out_ == nullptr || std::fseek(out_, 0, SEEK_END) != 0) fail("cannot be continued", errno);
}

std::filesystem::path OutputFile::there_is(const std::filesystem::path& file) {
  const std::filesystem::path part = file.string() + ".part";
  std::error_code ignored;
  for (const std::filesystem::path& one : {part, file}) {
    if (std::filesystem::is_regular_file(std::filesystem::symlink_status(one, ignored))) return one;
  }
  return {};
}

OutputFile::~OutputFile() {
  if (out_ == nullptr) return;
  std::fclose(out_);
  std::error_code ignored;
  if (!keep_) std::filesystem::remove(part_, ignored);
}

void OutputFile::fail(const std::string& what, int code) {
  if (out_ != nullptr) {
    std::fclose(out_);
    out_ = nullptr;
    std::error_code ignored;
    if (!keep_) std::filesystem::remove(part_, ignored);
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

void OutputFile::flush() {
  if (std::fflush(out_) != 0) fail("cannot be written", errno);
}

void OutputFile::commit() {
  flush();
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

void OutputFile::discard() {
  std::fclose(out_);
  out_ = nullptr;
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
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

namespace {

/// Folders of this process, each with its locked file; released when the process ends, however it does.
class Claims {
 public:
  ~Claims() {
    for (const auto& [file, descriptor] : held_) {
      ::unlink(file.c_str());
      ::close(descriptor);
    }
  }
  void claim(const std::filesystem::path& folder) {
    std::error_code ignored;
    const std::string file = (std::filesystem::canonical(folder, ignored) / ".bramah.lock").string();
    if (held_.contains(file)) return;
    for (;;) {
      const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
      if (descriptor < 0) return;  // the folder cannot be written into, which the first file will say
      if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        const int code = errno;
        std::string holder(64, '\0');
        const ssize_t length = ::read(descriptor, holder.data(), holder.size());
        ::close(descriptor);
        if (code != EWOULDBLOCK) {
          std::fprintf(stderr, "warning: %s cannot be locked (%s): let no other run write into this folder\n",
                       file.c_str(), std::strerror(code));
          return;
        }
        holder.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
        throw WriteError(folder, "is in use by another run" + (holder.empty() ? holder : ", process " + holder),
                         "wait for its end, or choose another folder with --out");
      }
      // The one before may have removed its file between our open and our lock.
      struct stat mine = {}, there = {};
      if (::fstat(descriptor, &mine) == 0 && ::stat(file.c_str(), &there) == 0 && mine.st_ino == there.st_ino) {
        const std::string id = std::to_string(::getpid());
        if (::ftruncate(descriptor, 0) != 0 || ::write(descriptor, id.data(), id.size()) < 0) errno = 0;
        held_.emplace(file, descriptor);
        return;
      }
      ::close(descriptor);
    }
  }

 private:
  std::map<std::string, int> held_;
};

void claim(const std::filesystem::path& folder) {
  static Claims claims;
  claims.claim(folder);
}

}  // namespace

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder, error)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw WriteError(folder, "the folder cannot be made: " + error.message(), remedy_for(error.value()));
  claim(folder);
}

}  // namespace bramah
