// Faults of disks, made without privileges.
#pragma once

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

namespace oclair::test {

// While it lives no file of this process can grow beyond some bytes: a full disk, without its errno.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    handler_ = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_;
  sighandler_t handler_;
};

// While it lives nothing can be created in a directory or removed from it, not by root either: root acts as a user without
// rights. The directory above it is opened to all.
class ReadOnlyDirectory {
 public:
  explicit ReadOnlyDirectory(const std::filesystem::path& directory) : directory_(directory), user_(geteuid()) {
    chmod(directory.parent_path().c_str(), 0755);
    chmod(directory.c_str(), 0555);
    if (user_ == 0 && seteuid(NOBODY) != 0) throw std::filesystem::filesystem_error("seteuid", std::error_code());
  }
  ReadOnlyDirectory(const ReadOnlyDirectory&) = delete;
  ReadOnlyDirectory& operator=(const ReadOnlyDirectory&) = delete;
  ~ReadOnlyDirectory() {
    if (user_ == 0 && seteuid(user_) != 0) std::abort();
    chmod(directory_.c_str(), 0755);
  }

 private:
  static constexpr uid_t NOBODY = 65534;
  std::filesystem::path directory_;
  uid_t user_;
};

}  // namespace oclair::test
