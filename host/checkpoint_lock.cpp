#include "checkpoint_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "error.h"
#include "file_aside.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

std::string this_process() {
  char machine[256] = {};
  if (gethostname(machine, sizeof machine - 1) != 0) machine[0] = '\0';
  return "process " + std::to_string(getpid()) + " on " + machine;
}

std::string holder(int descriptor) {
  char text[300];
  const ssize_t count = pread(descriptor, text, sizeof text, 0);
  return count > 0 ? one_line(std::string(text, static_cast<std::size_t>(count))) : "another process";
}

// The file under that name is still the one that is open: its last holder may have removed it since.
bool is_at(const fs::path& file, int descriptor) {
  struct stat named {}, opened {};
  return stat(file.c_str(), &named) == 0 && fstat(descriptor, &opened) == 0 && named.st_dev == opened.st_dev &&
         named.st_ino == opened.st_ino;
}

}  // namespace

CheckpointLock::CheckpointLock(const fs::path& checkpoint) {
  std::error_code ignored;
  file_ = fs::is_symlink(checkpoint, ignored) ? fs::weakly_canonical(checkpoint, ignored) : checkpoint;
  file_ += ".lock";
  const auto fail = [&](const std::string& what, const std::string& expected) {
    if (descriptor_ >= 0) close(descriptor_);
    throw Error(Exit::render_failed, checkpoint.string() + ": " + what + ", expected " + expected);
  };
  for (;;) {
    descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (descriptor_ < 0)
      fail("its lock cannot be created: " + system_message(errno), "a directory that exists and can be written");
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) fail("is being written by " + holder(descriptor_), "one render for a checkpoint");
      if (errno != EINTR) return;
    } else if (is_at(file_, descriptor_)) {
      break;
    }
    close(descriptor_);
  }
  const std::string process = this_process();
  if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, process.data(), process.size(), 0) < 0) {
    // On a full disk the lock holds all the same, without a name.
  }
}

CheckpointLock::~CheckpointLock() {
  unlink(file_.c_str());  // while it is held: nobody else's can be removed
  close(descriptor_);
}

}  // namespace oclair
