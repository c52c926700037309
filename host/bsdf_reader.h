// <bsdf>: diffuse, roughdiffuse, principled, conductor, dielectric, thindielectric; those that hold others are in bsdf_wrapper.h.
#pragma once

#include <map>

#include "document.h"
#include "texture_reader.h"
#include "world.h"

namespace oclair {

// What a surface is made of, seen from each side: indices into World::materials, NONE absorbs.
struct SurfaceMaterials {
  uint front = NONE;
  uint back = NONE;
};

// BSDF elements that have been read, and their textures; shared ones become one material.
struct KnownBsdfs {
  std::map<std::uint32_t, SurfaceMaterials> elements;
  KnownTextures textures;
};

// Reads the element once, appends its materials to the world. Throws Error(Exit::scene).
SurfaceMaterials read_bsdf(Document& document, std::uint32_t element, KnownBsdfs& known, World& world);

// A diffuse surface of that reflectance, for shapes that name no BSDF.
SurfaceMaterials add_diffuse(World& world, double reflectance);

}  // namespace oclair
