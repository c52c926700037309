// <bsdf> that hold others: twosided, mask, normalmap, bumpmap, blendbsdf. What they do is written into copies of the materials
// that they hold.
#pragma once

#include <set>
#include <string>

#include "bsdf_reader.h"

namespace oclair {

bool is_wrapper(const Element& element);
std::set<std::string> wrapper_types();

// Reads such an element with all that it holds. Throws Error(Exit::scene).
SurfaceMaterials read_wrapper(Document& document, std::uint32_t element, KnownBsdfs& known, World& world);

}  // namespace oclair
