// Signals that a running render answers. The first SIGINT or SIGTERM asks it to stop at the next good place; a second one ends
// the process at once, by the signal's default action: no file is broken by that, since each is written aside and renamed.
// SIGUSR1 asks for the files now. SIGPIPE is ignored: who stops reading the progress does not end the render. System calls that a
// signal interrupts go on (SA_RESTART).
#pragma once

#include <signal.h>

#include <array>

namespace oclair {

// While one lives, the signals are caught; afterwards they do what they did before. A SIGINT or SIGTERM that was ignored stays
// ignored (a shell's background job, nohup). One at a time.
class SignalHandlers {
 public:
  SignalHandlers();
  SignalHandlers(const SignalHandlers&) = delete;
  SignalHandlers& operator=(const SignalHandlers&) = delete;
  ~SignalHandlers();

  // Catches the signals again: LLVM, in a driver that compiles, installs handlers of its own for them.
  void take_back() const;

 private:
  std::array<struct sigaction, 4> before_;
};

// Of a full or failing disk: writing beyond what the user allows a file (ulimit -f) fails instead of ending the process, and a page of a
// mapped file that cannot be read or written ends it with a message and exit code 1. For the whole program; take_back does it again.
void expect_faults_of_disks();

bool stop_requested();
int stop_signal();          // SIGINT or SIGTERM; 0: none has come
bool take_write_request();  // true once for each SIGUSR1, or for several of them

// Signals that come closer together are one: `timeout` of coreutils sends its signal to the process and then to its group.
inline constexpr long long one_signal_nanoseconds = 100'000'000;

}  // namespace oclair
