// The machine that is measured on.
#pragma once

#include <string>

namespace oclair::bench {

std::string cpu_model();     // with the number of cores that this process may use
unsigned core_count();       // that this process may use
std::string load_average();  // runnable tasks in the last minute, all processes

// All threads that are started from now on run on the core where this one runs, and PoCL has one worker. Before the first
// OpenCL call.
void use_one_core();

}  // namespace oclair::bench
