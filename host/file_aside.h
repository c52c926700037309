// A file that is replaced as a whole: it is written aside, in the directory of its target, then renamed. Whatever fails, at
// any moment, a reader of the target sees the old file or the new one, and never a part. Failures are
// Error(Exit::render_failed).
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace oclair {

// The file that is written until commit() gives it its name; without a commit nothing of it stays. Where the file system can
// (not NFS), it has no name at all until then, so that even a killed process leaves nothing; elsewhere it is called
// TARGET.PROCESS.part. A target that is a link stays one: what it points to is replaced.
class FileAside {
 public:
  explicit FileAside(const std::filesystem::path& path);
  FileAside(const FileAside&) = delete;
  FileAside& operator=(const FileAside&) = delete;
  ~FileAside();

  std::FILE* file() const { return file_; }

  // The bytes reach the disk before the name does, and then the name: what was committed is there after a loss of power.
  void commit();

  [[noreturn]] void fail_to_write(int error) const;

 private:
  friend void require_writable(const std::filesystem::path& path);
  void take_name();

  std::filesystem::path path_, target_;
  std::filesystem::path aside_;  // empty while the file has no name
  std::FILE* file_ = nullptr;
};

// The whole of it.
void write_text(const std::filesystem::path& path, std::string_view text);

// Throws if the file could not be written now; for a failure before a long render instead of after it.
void require_writable(const std::filesystem::path& path);

// In which a file lies.
std::filesystem::path directory_of(const std::filesystem::path& file);

// "No space left on device", of an errno.
std::string system_message(int error);

}  // namespace oclair
