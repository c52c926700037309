#include <iostream>
#include <memory>

#include "options.h"

namespace oclair {

Exit info(const InfoOptions& options) {
  std::cout << options.scene.string() << "\n";
  return Exit::success;
}

Command info_command(CLI::App& program) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App& line = *program.add_subcommand("info", "Says what a scene holds and what it requires");
  add_scene(line, options->scene, options->definitions);
  add_device(line, options->device);
  return {&line, [options] { return info(*options); }};
}

}  // namespace oclair
