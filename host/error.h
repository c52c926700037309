// The world's faults, as exceptions: one line that says where, what, and what was expected. main() catches them once and
// turns them into the exit code. Our own mistakes are asserts; expected absence is std::optional.
#pragma once

#include <stdexcept>
#include <string>

namespace oclair {

enum class Exit : int {
  success = 0,
  render_failed = 1,  // rendering or file output failed
  usage = 2,          // wrong command line
  scene = 3,          // the scene, or a file that it names, is missing or wrong
  device = 4,         // no such device, or a kernel does not compile or run
  stopped = 5,        // a render ended before its target, what it had is written; or tune measured nothing, or not all
  check_failed = 7,   // a self-test has failed, or images that were compared differ significantly
};

struct Error : std::runtime_error {
  Error(Exit exit_code, const std::string& message) : std::runtime_error(message), exit(exit_code) {}
  Exit exit;
};

// Text from a file or a command line as part of a message, which has one line.
inline std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return text;
}

}  // namespace oclair
