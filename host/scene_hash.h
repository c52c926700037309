// Tells scenes apart: what a checkpoint belongs to.
#pragma once

#include <string>

#include "reader.h"

namespace oclair {

// XXH3 of 128 bits over the names and contents of all files of the scene, in the order in which they are first read, and its
// definitions. Where they lie and what the scene's own file is called does not matter. 32 hexadecimal digits.
std::string scene_hash(const World& world, const Definitions& definitions);

}  // namespace oclair
