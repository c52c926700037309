// What render and info do alike: from the scene file to what a device needs.
#pragma once

#include <functional>
#include <ostream>

#include "../bvh.h"
#include "commands.h"

namespace oclair {

// Reads the scene, says its warnings on `log`, and lets the command line override it.
World load_world(const std::filesystem::path& file, const Definitions& definitions, std::ostream& log);

// "1.5 MiB": for memory.
std::string format_bytes(std::size_t bytes);

}  // namespace oclair
