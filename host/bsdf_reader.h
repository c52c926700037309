// <bsdf>: diffuse, roughdiffuse, principled, conductor, dielectric, thindielectric, twosided.
#pragma once

#include <map>

#include "document.h"
#include "world.h"

namespace oclair {

// What a surface is made of, seen from each side: indices into World::materials, NONE absorbs.
struct SurfaceMaterials {
  uint front = NONE;
  uint back = NONE;
};

// BSDF elements that have been read; shared ones become one material.
using KnownBsdfs = std::map<std::uint32_t, SurfaceMaterials>;

// Reads the element once, appends its materials to the world. Throws Error(Exit::scene).
SurfaceMaterials read_bsdf(Document& document, std::uint32_t element, KnownBsdfs& known, World& world);

// A diffuse surface of that reflectance, for shapes that name no BSDF.
SurfaceMaterials add_diffuse(World& world, double reflectance);

}  // namespace oclair
