#include "file_aside.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "error.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what, const std::string& expected) {
  throw Error(Exit::render_failed, path.string() + ": " + what + ", expected " + expected);
}

// Returns 0 or the errno of a disk that fails. A directory that may not be read, and a file system that does not write
// directories by request (EINVAL), keep what they can.
int flush_directory(const fs::path& directory) {
  const int descriptor = open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return 0;
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  return error == EIO ? error : 0;
}

}  // namespace

std::string system_message(int error) { return std::generic_category().message(error); }

FileAside::FileAside(const fs::path& path) : path_(path), target_(path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    fail(path, fs::is_directory(status) ? "is a directory" : "is not a regular file", "the name of a file");
  }
  if (fs::is_symlink(path, ignored)) target_ = fs::weakly_canonical(path, ignored);
  aside_ = target_;
  aside_ += "." + std::to_string(getpid()) + ".part";
  file_ = std::fopen(aside_.c_str(), "wb");
  if (!file_) fail(path, "cannot be created: " + system_message(errno), "a directory that exists and can be written");
}

FileAside::~FileAside() {
  if (file_) std::fclose(file_);
  if (!committed_) std::remove(aside_.c_str());
}

void FileAside::commit() {
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) fail_to_write(errno);
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail_to_write(errno);
  if (std::rename(aside_.c_str(), target_.c_str()) != 0) fail_to_write(errno);
  committed_ = true;
  if (const int error = flush_directory(target_.parent_path())) fail_to_write(error);
}

void FileAside::fail_to_write(int error) const {
  fail(path_, "cannot be written: " + system_message(error), "room for the whole file on a disk that can be written");
}

void require_writable(const fs::path& path) { FileAside{path}; }

}  // namespace oclair
