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

// The open file as a path, which linkat can give a name.
fs::path handle(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

int open_unnamed(const fs::path& directory) {
  const int descriptor = open(directory.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0 || access(handle(descriptor).c_str(), F_OK) == 0) return descriptor;
  close(descriptor);
  return -1;
}

// Tells make(name) names beside the target until it succeeds: two processes may have one number, on two machines or one
// after the other. Returns the name that it took, or the empty path with errno set.
template <typename Make>
fs::path new_name(const fs::path& target, Make make) {
  constexpr int MAX_TRIES = 1000;
  for (int i = 0; i < MAX_TRIES; ++i) {
    fs::path name = target;
    name += "." + std::to_string(getpid()) + (i > 0 ? "-" + std::to_string(i) : "") + ".part";
    if (make(name)) return name;
    if (errno != EEXIST) break;
  }
  return {};
}

// Returns 0 or the errno of a disk that fails. A directory that may not be read, and a file system that does not write
// directories by request (EINVAL), keep what they can.
int flush_directory(const fs::path& directory) {
  const int descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return 0;
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  return error == EIO ? error : 0;
}

}  // namespace

fs::path directory_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

std::string system_message(int error) { return std::generic_category().message(error); }

FileAside::FileAside(const fs::path& path) : path_(path), target_(path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    fail(path, fs::is_directory(status) ? "is a directory" : "is not a regular file", "the name of a file");
  }
  if (fs::is_symlink(path, ignored)) target_ = fs::weakly_canonical(path, ignored);
  int descriptor = open_unnamed(directory_of(target_));
  if (descriptor < 0) {
    aside_ = new_name(target_, [&](const fs::path& name) {
      descriptor = open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
      return descriptor >= 0;
    });
  }
  if (descriptor >= 0) file_ = fdopen(descriptor, "wb");
  if (!file_) fail(path, "cannot be created: " + system_message(errno), "a directory that exists and can be written");
}

FileAside::~FileAside() {
  if (file_) std::fclose(file_);
  if (!aside_.empty()) std::remove(aside_.c_str());
}

void FileAside::take_name() {
  if (!aside_.empty()) return;
  aside_ = new_name(target_, [&](const fs::path& name) {
    return linkat(AT_FDCWD, handle(fileno(file_)).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  });
  if (aside_.empty()) fail_to_write(errno);
}

void FileAside::commit() {
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) fail_to_write(errno);
  take_name();
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail_to_write(errno);
  if (std::rename(aside_.c_str(), target_.c_str()) != 0) fail_to_write(errno);
  aside_.clear();
  if (const int error = flush_directory(directory_of(target_))) fail_to_write(error);
}

void FileAside::fail_to_write(int error) const {
  fail(path_, "cannot be written: " + system_message(error), "room for the whole file on a disk that can be written");
}

void write_text(const std::filesystem::path& path, std::string_view text) {
  FileAside aside(path);
  if (std::fwrite(text.data(), 1, text.size(), aside.file()) != text.size()) aside.fail_to_write(errno);
  aside.commit();
}

void require_writable(const fs::path& path) { FileAside(path).take_name(); }

}  // namespace oclair
