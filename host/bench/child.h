// Processes of their own: an OpenCL driver reads its settings once, and what one measurement leaves behind must not meet the
// next. To be forked before this process has touched OpenCL or Embree, and while it has one thread.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace oclair::bench {

// Runs in a child; returns what it returned, or throws the Error that it threw.
std::string in_child(const std::function<std::string()>& run);

// A child that keeps what `prepare` made and runs one of its actions when told to.
class Worker {
 public:
  using Actions = std::vector<std::function<double()>>;  // each returns a number: its seconds, say
  explicit Worker(const std::function<Actions()>& prepare);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker();

  double run(unsigned char action);  // throws the Error that it threw, there or in `prepare`

 private:
  pid_t child_;
  int commands_, answers_;
};

struct ProgramRun {
  double seconds;  // from its start to its end
  double cpu_seconds;
  double peak_bytes;  // most physical memory that it had at once
};

// The program that is running, with other arguments and in silence. pocl_cache: where PoCL keeps its kernels; empty: where
// it always does. Throws Error(Exit::render_failed) if it fails.
ProgramRun run_program(const std::vector<std::string>& arguments, const std::filesystem::path& pocl_cache);

}  // namespace oclair::bench
