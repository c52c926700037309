// Runs the real program and returns what it said.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

struct ProgramResult {
  int exit;  // 128 + the signal if one ended it
  std::string out, err;
};

// `meanwhile` is told the running process, and may do as it likes before its end is waited for.
ProgramResult run_oclair(const std::vector<std::string>& arguments, const std::function<void(pid_t)>& meanwhile = {});
bool has_ended(pid_t process);

// The same, but SIGKILL ends it after so many seconds, unless it has ended by itself.
ProgramResult run_oclair_for(double seconds, const std::vector<std::string>& arguments);

// The same as run_oclair with standard output to a file, which exists, or closed if no file is named; ProgramResult::out is
// empty.
ProgramResult run_oclair_into(const std::filesystem::path& out, const std::vector<std::string>& arguments);
