#include "signals.h"

#include <time.h>
#include <unistd.h>

#include <atomic>

namespace oclair {
namespace {

constexpr std::array<int, 4> caught = {SIGINT, SIGTERM, SIGUSR1, SIGPIPE};

// All that a handler touches: it may run at any instruction of any thread.
std::atomic<int> first_stop{0};
std::atomic<long long> first_stop_time{0};  // 0: not yet noted
std::atomic<bool> write_wanted{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<long long>::is_always_lock_free &&
              std::atomic<bool>::is_always_lock_free);

long long nanoseconds() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

extern "C" void on_stop(int signal) {
  const long long now = nanoseconds();
  int none = 0;
  if (first_stop.compare_exchange_strong(none, signal)) {
    first_stop_time = now;
  } else if (first_stop_time != 0 && now - first_stop_time > one_signal_nanoseconds) {
    ::signal(signal, SIG_DFL);
    raise(signal);  // blocked until this handler returns
  }
}

extern "C" void on_write(int) { write_wanted = true; }

extern "C" void on_bus_error(int signal, siginfo_t* info, void*) {
  if (info->si_code != BUS_ADRERR) {  // a fault of our own
    ::signal(signal, SIG_DFL);
    raise(signal);
    return;
  }
  constexpr char message[] =
      "oclair: memory: a page of a file cannot be read or written, expected a disk that works and has room; the checkpoint is as it was\n";
  (void)!write(STDERR_FILENO, message, sizeof message - 1);
  _exit(1);
}

}  // namespace

void expect_faults_of_disks() {
  ::signal(SIGXFSZ, SIG_IGN);
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO;
  sigemptyset(&action.sa_mask);
  sigaction(SIGBUS, &action, nullptr);
}

SignalHandlers::SignalHandlers() {
  first_stop = 0;
  first_stop_time = 0;
  write_wanted = false;
  for (std::size_t i = 0; i < caught.size(); ++i) sigaction(caught[i], nullptr, &before_[i]);
  take_back();
}

void SignalHandlers::take_back() const {
  expect_faults_of_disks();
  for (std::size_t i = 0; i < caught.size(); ++i) {
    struct sigaction action {};
    action.sa_handler = caught[i] == SIGPIPE ? SIG_IGN : caught[i] == SIGUSR1 ? on_write : on_stop;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    if (caught[i] == SIGUSR1 || caught[i] == SIGPIPE || before_[i].sa_handler != SIG_IGN) sigaction(caught[i], &action, nullptr);
  }
}

SignalHandlers::~SignalHandlers() {
  for (std::size_t i = 0; i < caught.size(); ++i) sigaction(caught[i], &before_[i], nullptr);
}

bool stop_requested() { return first_stop != 0; }
int stop_signal() { return first_stop; }
bool take_write_request() { return write_wanted.exchange(false); }

}  // namespace oclair
