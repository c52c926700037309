// A generated mesh as the files of a scene, for measurements of the whole program.
#pragma once

#include <filesystem>

#include "../world.h"

namespace oclair::bench {

// terrain.xml and terrain.ply (binary) in the directory: the world of world_of(), a film of `size` squared.
void write_terrain_scene(const Mesh& mesh, const std::filesystem::path& directory, unsigned size);

}  // namespace oclair::bench
