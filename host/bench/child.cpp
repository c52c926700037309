#include "child.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <iostream>

#include "../error.h"
#include "timing.h"

namespace oclair::bench {
namespace {

struct Pipe {
  int read, write;
  Pipe() {
    int ends[2];
    if (pipe(ends) != 0) throw Error(Exit::render_failed, "no pipe: expected fewer open files");
    read = ends[0], write = ends[1];
  }
};

pid_t fork_or_throw() {
  std::cout.flush();  // or the child would write it again
  const pid_t child = fork();
  if (child < 0) throw Error(Exit::render_failed, "no process can be started: expected fewer processes, or more memory");
  return child;
}

bool write_all(int file, const void* data, std::size_t bytes) {
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t n = write(file, static_cast<const char*>(data) + done, bytes - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

bool read_all(int file, void* data, std::size_t bytes) {
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t n = read(file, static_cast<char*>(data) + done, bytes - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

// An answer: 0 or the exit code of an Error; the length of what follows; the result or the message.
void answer(int file, int code, const std::string& text) {
  const std::size_t length = text.size();
  if (!write_all(file, &code, sizeof code) || !write_all(file, &length, sizeof length) ||
      !write_all(file, text.data(), length))
    _exit(1);
}

template <class Run>
bool answer_with(int file, const Run& run) {
  try {
    answer(file, 0, run());
    return true;
  } catch (const Error& error) {
    answer(file, static_cast<int>(error.exit), error.what());
  } catch (const std::exception& error) {
    answer(file, static_cast<int>(Exit::render_failed), error.what());
  }
  return false;
}

std::string answer_from(int file) {
  int code = 0;
  std::size_t length = 0;
  if (!read_all(file, &code, sizeof code) || !read_all(file, &length, sizeof length))
    throw Error(Exit::render_failed, "a measuring process ended without a result");
  std::string text(length, '\0');
  if (!read_all(file, text.data(), length)) throw Error(Exit::render_failed, "a measuring process ended without a result");
  if (code != 0) throw Error(static_cast<Exit>(code), text);
  return text;
}

std::string bytes_of(double value) { return std::string(reinterpret_cast<const char*>(&value), sizeof value); }

}  // namespace

std::string in_child(const std::function<std::string()>& run) {
  const Pipe answers;
  const pid_t child = fork_or_throw();
  if (child == 0) {
    close(answers.read);
    answer_with(answers.write, run);
    std::cout.flush();
    _exit(0);
  }
  close(answers.write);
  const auto reap = [&] {
    close(answers.read);
    waitpid(child, nullptr, 0);
  };
  try {
    const std::string result = answer_from(answers.read);
    reap();
    return result;
  } catch (...) {
    reap();
    throw;
  }
}

Worker::Worker(const std::function<Actions()>& prepare) {
  const Pipe commands, answers;
  child_ = fork_or_throw();
  if (child_ == 0) {
    close(commands.write);
    close(answers.read);
    Actions actions;
    if (!answer_with(answers.write, [&] {
          actions = prepare();
          return std::string();
        }))
      _exit(1);
    for (unsigned char action; read_all(commands.read, &action, 1);)
      if (!answer_with(answers.write, [&] { return bytes_of(actions.at(action)()); })) _exit(1);
    _exit(0);
  }
  close(commands.read);
  close(answers.write);
  fcntl(commands.write, F_SETFD, FD_CLOEXEC);
  commands_ = commands.write, answers_ = answers.read;
  try {
    answer_from(answers_);
  } catch (...) {
    close(commands_);
    close(answers_);
    waitpid(child_, nullptr, 0);
    throw;
  }
}

Worker::~Worker() {
  close(commands_);  // its end of file ends the child
  close(answers_);
  waitpid(child_, nullptr, 0);
}

double Worker::run(unsigned char action) {
  if (!write_all(commands_, &action, 1)) throw Error(Exit::render_failed, "a measuring process has ended");
  const std::string bytes = answer_from(answers_);
  double value = 0.0;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

ProgramRun run_program(const std::vector<std::string>& arguments, const std::filesystem::path& pocl_cache) {
  int status = 0;
  rusage usage{};
  const double seconds = seconds_of([&] {
    const pid_t child = fork_or_throw();
    if (child == 0) {
      const int nowhere = open("/dev/null", O_RDWR);
      dup2(nowhere, STDOUT_FILENO);
      dup2(nowhere, STDERR_FILENO);
      if (!pocl_cache.empty()) setenv("POCL_CACHE_DIR", pocl_cache.c_str(), 1);
      std::vector<char*> argv = {const_cast<char*>("oclair")};
      for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
      argv.push_back(nullptr);
      execv("/proc/self/exe", argv.data());
      _exit(127);
    }
    wait4(child, &status, 0, &usage);
  });
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(Exit::render_failed,
                "oclair " + arguments[0] + " failed as a process of its own: expected it to render " + arguments[1]);
  const auto seconds_in = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds, seconds_in(usage.ru_utime) + seconds_in(usage.ru_stime), 1024.0 * static_cast<double>(usage.ru_maxrss)};
}

}  // namespace oclair::bench
