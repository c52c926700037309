// Runs the real program and returns what it said.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct ProgramResult {
  int exit;  // 128 + the signal if one ended it
  std::string out, err;
};

ProgramResult run_oclair(const std::vector<std::string>& arguments);

// The same, but SIGKILL ends it after so many seconds, unless it has ended by itself.
ProgramResult run_oclair_for(double seconds, const std::vector<std::string>& arguments);

// The same as run_oclair with standard output to a file, which exists, or closed if no file is named; ProgramResult::out is
// empty.
ProgramResult run_oclair_into(const std::filesystem::path& out, const std::vector<std::string>& arguments);
