#include "options.h"

namespace oclair {

Exit devices() { return Exit::success; }

Command devices_command(CLI::App& program) {
  return {program.add_subcommand("devices", "Lists the OpenCL devices"), devices};
}

}  // namespace oclair
