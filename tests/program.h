// Runs the real program and returns what it said.
#pragma once

#include <string>
#include <vector>

struct ProgramResult {
  int exit;  // 128 + the signal if one ended it
  std::string out, err;
};

ProgramResult run_oclair(const std::vector<std::string>& arguments);
