#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <new>

#include "commands/commands.h"
#include "signals.h"

namespace oclair {
namespace {

Exit run(int argc, char** argv) {
  CLI::App program("A physically based path tracer whose kernels are OpenCL C.", "oclair");
  program.set_version_flag("--version", "oclair " OCLAIR_VERSION);
  const Command commands[] = {render_command(program), merge_command(program), info_command(program), devices_command(program),
                              bench_command(program), tune_command(program), selftest_command(program),
                              compare_command(program)};
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    program.exit(help_or_version);
    return Exit::success;
  } catch (const CLI::ParseError& error) {
    throw Error(Exit::usage, std::string(error.what()) + " (see oclair --help)");
  }
  for (const Command& command : commands) {
    if (command.line->parsed()) return command.run();
  }
  throw Error(Exit::usage, "a command is required: render, merge, info, devices, bench, tune, selftest or compare (see oclair --help)");
}

// A closed standard stream is one that nobody reads. Its number must not go to the next file that is opened, by the OpenCL driver say.
void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", O_RDWR);  // takes the lowest free number: this one
  }
}

// What is in the buffer is written now, while a failure can still be told.
void flush_results() {
  if (!std::cout.flush())
    throw Error(Exit::render_failed, "standard output: cannot be written, expected room for the results");
}

int report(Exit exit, const std::string& message) {
  std::cerr << "oclair: " << message << "\n";
  return static_cast<int>(exit);
}

}  // namespace
}  // namespace oclair

int main(int argc, char** argv) {
  using namespace oclair;
  open_closed_streams();
  expect_faults_of_disks();
  try {
    const Exit exit = run(argc, argv);
    flush_results();
    return static_cast<int>(exit);
  } catch (const Error& error) {
    return report(error.exit, error.what());
  } catch (const std::bad_alloc&) {
    return report(Exit::render_failed, "out of memory; a smaller film or scene, or a larger machine, is needed");
  } catch (const std::exception& error) {
    return report(Exit::render_failed, error.what());
  }
}
