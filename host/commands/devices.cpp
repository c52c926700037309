#include <iostream>

#include "../device.h"
#include "options.h"

namespace oclair {

Exit devices() {
  const std::vector<cl::Device> found = list_devices();
  if (found.empty()) open_device();  // says why nothing is there
  for (std::size_t i = 0; i < found.size(); ++i) std::cout << i << "  " << describe(found[i]) << "\n";
  return Exit::success;
}

Command devices_command(CLI::App& program) {
  return {program.add_subcommand("devices", "Lists the OpenCL devices"), devices};
}

}  // namespace oclair
