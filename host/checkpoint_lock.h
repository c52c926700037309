// One writer for a checkpoint: who renders into it holds its lock, from before it is read until the program ends.
#pragma once

#include <filesystem>

namespace oclair {

// The lock is that of the kernel on the file PATH.lock, so it ends with its process, whatever ends it; the file holds the
// process's number and machine for the message to a second one. A file system without locks gives none: then two renders
// would replace each other's checkpoint, but never break one.
class CheckpointLock {
 public:
  // Throws Error(Exit::render_failed), if another process holds it with which one.
  explicit CheckpointLock(const std::filesystem::path& checkpoint);
  CheckpointLock(const CheckpointLock&) = delete;
  CheckpointLock& operator=(const CheckpointLock&) = delete;
  ~CheckpointLock();  // removes the file

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace oclair
