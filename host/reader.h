// Reads a scene in the Mitsuba 3 XML format: the subset listed in docs/scenes.md. Everything else is refused.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "world.h"

namespace oclair {

// Values given on the command line for $name in the scene; they override <default>.
using Definitions = std::map<std::string, std::string>;

// What the command line says about a scene, beside its definitions.
struct ReadOptions {
  std::optional<glm::uvec2> film_size;           // instead of the film's; the scene must not have a crop window then
  std::function<void(const char*)> begin_phase;  // told "parse" and "meshes" as they begin
};

// Throws Error(Exit::scene) with "file:line: what, what was expected", or Error(Exit::usage) for a definition that the
// scene does not use or a film size that it does not allow.
World read_scene(const std::filesystem::path& file, const Definitions& definitions = {}, const ReadOptions& options = {});

}  // namespace oclair
