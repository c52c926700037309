#include "program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>

namespace {

std::string content(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int byte; (byte = std::fgetc(file)) != EOF;) text.push_back(static_cast<char>(byte));
  std::fclose(file);
  return text;
}

// Runs in the child; does not return.
[[noreturn]] void become_oclair(const std::vector<std::string>& arguments) {
  std::vector<char*> argv = {const_cast<char*>("oclair")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  execv(OCLAIR_PROGRAM, argv.data());
  _exit(127);
}

// `connect_out` runs in the child and gives it its standard output.
template <typename ConnectOut>
ProgramResult run(const std::vector<std::string>& arguments, ConnectOut connect_out,
                  const std::function<void(pid_t)>& meanwhile = {}) {
  std::FILE* const err = std::tmpfile();
  if (!err) throw std::runtime_error("no temporary file");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    connect_out();
    dup2(fileno(err), STDERR_FILENO);
    become_oclair(arguments);
  }
  if (meanwhile) meanwhile(child);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), "", content(err)};
}

}  // namespace

ProgramResult run_oclair(const std::vector<std::string>& arguments, const std::function<void(pid_t)>& meanwhile) {
  std::FILE* const out = std::tmpfile();
  if (!out) throw std::runtime_error("no temporary file");
  ProgramResult result = run(arguments, [&] { dup2(fileno(out), STDOUT_FILENO); }, meanwhile);
  result.out = content(out);
  return result;
}

bool has_ended(pid_t process) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

ProgramResult run_oclair_for(double seconds, const std::vector<std::string>& arguments) {
  return run_oclair(arguments, [seconds](pid_t process) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    while (Clock::now() < end && !has_ended(process)) std::this_thread::sleep_for(std::chrono::microseconds(500));
    kill(process, SIGKILL);
  });
}

ProgramResult run_oclair_into(const std::filesystem::path& out, const std::vector<std::string>& arguments) {
  return run(arguments, [&] {
    close(STDOUT_FILENO);
    if (!out.empty() && open(out.c_str(), O_WRONLY) != STDOUT_FILENO) _exit(127);
  });
}
