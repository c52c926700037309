// One writer for a checkpoint, whatever becomes of the others.
#include "../host/checkpoint_lock.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <optional>

#include "../host/error.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
namespace fs = std::filesystem;

std::string refusal(const fs::path& checkpoint) {
  try {
    const CheckpointLock lock(checkpoint);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    return error.what();
  }
  return "";
}

// Another process that holds the lock until it is told to end, or is killed.
class Holder {
 public:
  explicit Holder(const fs::path& checkpoint) {
    int ready[2], end[2];
    if (pipe(ready) != 0 || pipe(end) != 0) throw std::runtime_error("no pipe");
    child_ = fork();
    if (child_ == 0) {
      close(end[1]);
      std::optional<CheckpointLock> lock;
      try {
        lock.emplace(checkpoint);
      } catch (const Error&) {
        _exit(1);
      }
      char byte = 'x';
      if (write(ready[1], &byte, 1) != 1) _exit(1);
      if (read(end[0], &byte, 1) < 0) _exit(1);  // until the other end is closed
      lock.reset();
      _exit(0);
    }
    close(ready[1]);
    close(end[0]);
    end_ = end[1];
    char byte;
    EXPECT_EQ(read(ready[0], &byte, 1), 1);
    close(ready[0]);
  }
  ~Holder() {
    if (child_ > 0) finish();
  }

  pid_t process() const { return child_; }
  void finish() { stop([] {}); }
  void kill() {
    stop([this] { ::kill(child_, SIGKILL); });
  }

 private:
  void stop(const std::function<void()>& how) {
    how();
    close(end_);
    waitpid(child_, nullptr, 0);
    child_ = 0;
  }

  pid_t child_ = 0;
  int end_ = -1;
};

TEST(checkpoint_lock_test, a_second_holder_is_refused_and_told_which_process_is_the_first) {
  const TemporaryDirectory directory;
  const fs::path checkpoint = directory / "a.checkpoint";
  Holder holder(checkpoint);
  const std::string message = refusal(checkpoint);
  EXPECT_NE(message.find("a.checkpoint: is being written by process " + std::to_string(holder.process()) + " on "),
            std::string::npos)
      << message;
  EXPECT_NE(message.find(", expected one render for a checkpoint"), std::string::npos) << message;
  EXPECT_EQ(refusal(directory / "b.checkpoint"), "");
}

TEST(checkpoint_lock_test, one_process_cannot_hold_it_twice) {
  const TemporaryDirectory directory;
  const CheckpointLock lock(directory / "a");
  EXPECT_NE(refusal(directory / "a").find("process " + std::to_string(getpid())), std::string::npos);
}

TEST(checkpoint_lock_test, it_is_free_once_it_is_released_and_leaves_nothing) {
  const TemporaryDirectory directory;
  Holder holder(directory / "a");
  holder.finish();
  EXPECT_EQ(directory.names().size(), 0u);
  EXPECT_EQ(refusal(directory / "a"), "");
  EXPECT_EQ(directory.names().size(), 0u);
}

TEST(checkpoint_lock_test, the_lock_of_a_killed_process_is_no_obstacle) {
  const TemporaryDirectory directory;
  Holder holder(directory / "a");
  holder.kill();
  EXPECT_EQ(directory.names(), std::vector<std::string>{"a.lock"});
  EXPECT_EQ(refusal(directory / "a"), "");
  EXPECT_EQ(directory.names().size(), 0u);
}

TEST(checkpoint_lock_test, a_link_to_a_checkpoint_has_its_lock) {
  const TemporaryDirectory directory;
  fs::create_directory(directory / "far");
  std::ofstream(directory / "far/real") << "";
  fs::create_symlink("far/real", directory / "link");
  const CheckpointLock lock(directory / "link");
  EXPECT_NE(refusal(directory / "far/real"), "");
}

TEST(checkpoint_lock_test, a_checkpoint_that_is_replaced_stays_locked) {
  const TemporaryDirectory directory;
  const CheckpointLock lock(directory / "a");
  std::ofstream(directory / "new") << "new";
  fs::rename(directory / "new", directory / "a");
  EXPECT_NE(refusal(directory / "a"), "");
}

// Processes that come and go on one lock, which is removed each time: never do two hold it at once. Each holder makes a file
// that must not exist yet, and removes it.
TEST(checkpoint_lock_test, never_two_hold_it_at_once) {
  const TemporaryDirectory directory;
  const fs::path inside = directory / "inside";
  constexpr int processes = 4, rounds = 200;
  std::vector<pid_t> children;
  for (int i = 0; i < processes; ++i) {
    const pid_t child = fork();
    if (child != 0) {
      children.push_back(child);
      continue;
    }
    for (int held = 0; held < rounds;) {
      try {
        const CheckpointLock lock(directory / "a");
        std::FILE* const file = std::fopen(inside.c_str(), "wx");
        if (!file) _exit(1);
        std::fclose(file);
        std::remove(inside.c_str());
        ++held;
      } catch (const Error&) {
        sched_yield();
      }
    }
    _exit(0);
  }
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(directory.names().size(), 0u);
}

TEST(checkpoint_lock_test, a_directory_that_cannot_be_written_is_refused) {
  const TemporaryDirectory directory;
  EXPECT_NE(refusal(directory / "none/a").find("its lock cannot be created: No such file or directory"), std::string::npos);
  fs::create_directory(directory / "a.lock");
  EXPECT_NE(refusal(directory / "a").find("its lock cannot be created: Is a directory"), std::string::npos);
}

}  // namespace
