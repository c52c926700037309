// Real signals, sent to a child process of the test.
#include "../host/signals.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <functional>
#include <thread>

#include "faults.h"

namespace {

using namespace oclair;

void sleep_for(long long nanoseconds) { std::this_thread::sleep_for(std::chrono::nanoseconds(nanoseconds)); }

// True as soon as the condition is; false when it has not come in ten seconds.
bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 10000; ++i) {
    if (condition()) return true;
    sleep_for(1'000'000);
  }
  return condition();
}

// A child that runs `body` and exits with what it returns. `say` sends a byte to the test, which waits for it with `heard`.
class Child {
 public:
  explicit Child(const std::function<int(const std::function<void(char)>& say)>& body) {
    if (pipe(pipe_) != 0) throw std::runtime_error("pipe");
    pid_ = fork();
    if (pid_ == 0) {
      close(pipe_[0]);
      alarm(20);
      _exit(body([&](char byte) { (void)!write(pipe_[1], &byte, 1); }));
    }
    close(pipe_[1]);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { close(pipe_[0]); }

  void send(int signal) const { kill(pid_, signal); }
  char heard() const {
    char byte = 0;
    return read(pipe_[0], &byte, 1) == 1 ? byte : '\0';  // 0: the child is gone
  }
  int status() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    return status;
  }

 private:
  int pipe_[2];
  pid_t pid_;
};

void expect_exit(const Child& child, int code) {
  const int status = child.status();
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), code);
}

void expect_death_by(const Child& child, int signal) {
  const int status = child.status();
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), signal);
}

int wait_for_stop(const std::function<void(char)>& say) {
  const SignalHandlers handlers;
  if (stop_requested() || stop_signal() != 0) return 1;
  say('r');
  if (!comes_true(stop_requested)) return 2;
  say('s');
  const int code = 100 + stop_signal();
  comes_true([] { return false; });  // goes on until the second signal, or ten seconds
  return code;
}

TEST(signals_test, a_page_that_cannot_be_read_ends_the_program_with_a_message_and_exit_code_1) {
  const auto read_behind_the_end = [] {
    expect_faults_of_disks();
    std::FILE* const file = std::tmpfile();
    const auto* const page = static_cast<volatile char*>(mmap(nullptr, 1, PROT_READ, MAP_SHARED, fileno(file), 0));
    _exit(100 + *page);
  };
  EXPECT_EXIT(read_behind_the_end(), testing::ExitedWithCode(1), "^oclair: memory: a page of a file cannot be read or written, expected ");
  EXPECT_EXIT((expect_faults_of_disks(), raise(SIGBUS)), testing::KilledBySignal(SIGBUS), "");  // nobody's disk
}

TEST(signals_test, a_file_that_may_not_grow_is_an_error_and_no_signal_also_after_others_have_installed_handlers) {
  const Child child([](const auto&) {
    const test::FileSizeLimit full(1);
    const SignalHandlers handlers;
    signal(SIGXFSZ, SIG_DFL);
    handlers.take_back();
    std::FILE* const file = std::tmpfile();
    return write(fileno(file), "ab", 2) == 1 && write(fileno(file), "b", 1) < 0 && errno == EFBIG ? 7 : 8;
  });
  expect_exit(child, 7);
}

}  // namespace

TEST(signals_test, the_first_signal_asks_to_stop_and_the_second_ends_the_process_by_its_default_action) {
  for (const int first : {SIGINT, SIGTERM})
    for (const int second : {SIGINT, SIGTERM}) {
      const Child child(wait_for_stop);
      EXPECT_EQ(child.heard(), 'r');
      child.send(first);
      EXPECT_EQ(child.heard(), 's');
      sleep_for(2 * one_signal_nanoseconds);
      child.send(second);
      expect_death_by(child, second);
    }
}

TEST(signals_test, signals_that_come_together_are_one) {
  const Child child([](const auto& say) {
    const SignalHandlers handlers;
    say('r');
    if (!comes_true(stop_requested)) return 1;
    sleep_for(2 * one_signal_nanoseconds);
    return stop_signal() == SIGTERM ? 0 : 2;
  });
  EXPECT_EQ(child.heard(), 'r');
  child.send(SIGTERM);
  sleep_for(1'000'000);  // delivered: two pending signals of a kind would be one anyway
  child.send(SIGTERM);
  child.send(SIGINT);
  expect_exit(child, 0);
}

TEST(signals_test, each_request_for_the_files_is_taken_once) {
  const Child child([](const auto& say) {
    const SignalHandlers handlers;
    if (take_write_request()) return 1;
    for (int i = 0; i < 3; ++i) {
      say('r');
      if (!comes_true(take_write_request)) return 2;
      if (take_write_request()) return 3;
    }
    return stop_requested() ? 4 : 0;
  });
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(child.heard(), 'r');
    child.send(SIGUSR1);
  }
  expect_exit(child, 0);
}

TEST(signals_test, a_read_that_a_signal_interrupts_goes_on) {
  int data[2];
  ASSERT_EQ(pipe(data), 0);
  const Child child([&](const auto& say) {
    const SignalHandlers handlers;
    say('r');
    char byte = 0;
    if (read(data[0], &byte, 1) != 1) return 1;  // EINTR
    return byte == 'x' && take_write_request() && stop_requested() ? 0 : 2;
  });
  EXPECT_EQ(child.heard(), 'r');
  sleep_for(50'000'000);  // most likely in read() by now; if not, the test is weaker, not wrong
  child.send(SIGUSR1);
  child.send(SIGINT);
  sleep_for(50'000'000);
  EXPECT_EQ(write(data[1], "x", 1), 1);
  expect_exit(child, 0);
  close(data[0]);
  close(data[1]);
}

TEST(signals_test, afterwards_signals_do_what_they_did_before) {
  const Child child([](const auto& say) {
    { const SignalHandlers handlers; }
    say('r');
    comes_true([] { return false; });
    return 0;
  });
  EXPECT_EQ(child.heard(), 'r');
  child.send(SIGTERM);
  expect_death_by(child, SIGTERM);
}

TEST(signals_test, a_signal_that_was_ignored_stays_ignored) {
  const Child child([](const auto& say) {
    signal(SIGINT, SIG_IGN);
    const SignalHandlers handlers;
    say('r');
    if (!comes_true(stop_requested)) return 1;
    return stop_signal() == SIGTERM ? 0 : 2;
  });
  EXPECT_EQ(child.heard(), 'r');
  child.send(SIGINT);
  sleep_for(20'000'000);
  child.send(SIGTERM);
  expect_exit(child, 0);
}

TEST(signals_test, a_stop_that_an_earlier_object_was_asked_for_is_forgotten) {
  const Child child([](const auto& say) {
    {
      const SignalHandlers handlers;
      say('r');
      if (!comes_true(stop_requested)) return 1;
    }
    const SignalHandlers handlers;
    return stop_requested() || take_write_request() ? 2 : 0;
  });
  EXPECT_EQ(child.heard(), 'r');
  child.send(SIGUSR1);
  child.send(SIGTERM);
  expect_exit(child, 0);
}
