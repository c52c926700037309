// Reads a scene in the Mitsuba 3 XML format: the subset listed in docs/scenes.md. Everything else is refused.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "world.h"

namespace oclair {

// Values given on the command line for $name in the scene; they override <default>.
using Definitions = std::map<std::string, std::string>;

// Throws Error(Exit::scene) with "file:line: what, what was expected", or Error(Exit::usage) for a definition that the
// scene does not use.
World read_scene(const std::filesystem::path& file, const Definitions& definitions = {});

}  // namespace oclair
