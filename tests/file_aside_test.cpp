// Files that are replaced as a whole, and the faults of disks and directories.
#include "../host/file_aside.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "../host/error.h"
#include "faults.h"
#include "files.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;
using Names = std::vector<std::string>;

std::string failure(const std::function<void()>& attempt) {
  try {
    attempt();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    return error.what();
  }
  return "";
}

TEST(file_aside_test, the_target_is_the_old_file_until_the_commit) {
  const TemporaryDirectory directory;
  put(directory / "a", "old");
  FileAside aside(directory / "a");
  std::fputs("new", aside.file());
  std::fflush(aside.file());
  EXPECT_EQ(content(directory / "a"), "old");
  aside.commit();
  EXPECT_EQ(content(directory / "a"), "new");
  EXPECT_EQ(directory.names(), Names{"a"});
}

TEST(file_aside_test, without_a_commit_nothing_stays) {
  const TemporaryDirectory directory;
  { std::fputs("new", FileAside(directory / "a").file()); }
  EXPECT_EQ(directory.names(), Names{});
}

TEST(file_aside_test, a_killed_process_leaves_the_old_file_and_no_other) {
  const TemporaryDirectory directory;
  const int unnamed = open((directory / "").c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (unnamed < 0) GTEST_SKIP() << "the file system has no files without a name";
  close(unnamed);
  put(directory / "a", "old");
  const pid_t child = fork();
  if (child == 0) {
    FileAside aside(directory / "a");
    std::fputs("new", aside.file());
    std::fflush(aside.file());
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(content(directory / "a"), "old");
  EXPECT_EQ(directory.names(), Names{"a"});
}

// Two of one process stand for two processes of one number, on two machines.
TEST(file_aside_test, two_writers_of_a_target_do_not_write_into_one_file) {
  const TemporaryDirectory directory;
  FileAside first(directory / "a"), second(directory / "a");
  std::fputs("first, which is longer", first.file());
  std::fputs("second", second.file());
  first.commit();
  EXPECT_EQ(content(directory / "a"), "first, which is longer");
  second.commit();
  EXPECT_EQ(content(directory / "a"), "second");
  EXPECT_EQ(directory.names(), Names{"a"});
}

// What a killed process has left, on a file system where it leaves something.
TEST(file_aside_test, a_name_that_is_taken_is_no_obstacle) {
  const TemporaryDirectory directory;
  const std::string taken = "a." + std::to_string(getpid()) + ".part";
  put(directory / taken, "left");
  FileAside aside(directory / "a");
  std::fputs("new", aside.file());
  aside.commit();
  EXPECT_EQ(content(directory / "a"), "new");
  EXPECT_EQ(content(directory / taken), "left");
  EXPECT_EQ(directory.names(), (Names{"a", taken}));
}

TEST(file_aside_test, a_target_that_becomes_a_directory_is_refused_at_the_commit) {
  const TemporaryDirectory directory;
  FileAside aside(directory / "a");
  fs::create_directory(directory / "a");
  put(directory / "a/inside", "kept");
  EXPECT_NE(failure([&] { aside.commit(); }).find("a: cannot be written: Is a directory, expected "), std::string::npos);
  EXPECT_EQ(content(directory / "a/inside"), "kept");
}

TEST(file_aside_test, a_directory_that_goes_away_is_an_error) {
  const TemporaryDirectory directory;
  fs::create_directory(directory / "b");
  FileAside aside(directory / "b/a");
  fs::remove_all(directory / "b");
  EXPECT_NE(failure([&] { aside.commit(); }).find("a: cannot be written: No such file or directory, expected "),
            std::string::npos);
}

TEST(file_aside_test, a_file_that_cannot_be_written_is_refused_beforehand) {
  const TemporaryDirectory directory;
  EXPECT_NE(failure([&] { require_writable(directory / std::string(254, 'a')); }).find("File name too long"),
            std::string::npos);
  EXPECT_NE(failure([&] { require_writable(directory / "none/a"); }).find("No such file or directory"), std::string::npos);
  fs::create_directory(directory / "locked");
  const ReadOnlyDirectory locked(directory / "locked");
  EXPECT_NE(failure([&] { require_writable(directory / "locked/a"); }).find("cannot be created: Permission denied"),
            std::string::npos);
}

TEST(file_aside_test, a_new_file_has_the_permissions_that_the_user_wants) {
  const TemporaryDirectory directory;
  const mode_t before = umask(027);
  FileAside(directory / "a").commit();
  umask(before);
  EXPECT_EQ(fs::status(directory / "a").permissions(), fs::perms(0640));
}

}  // namespace
