// <shape>: obj, ply, rectangle, cube, sphere, disk, cylinder, with the BSDF and the area light on it.
#pragma once

#include <optional>
#include <set>

#include "bsdf_reader.h"
#include "document.h"
#include "texture_reader.h"
#include "world.h"

namespace oclair {

// What shapes share with each other while a scene is read.
struct ShapeContext {
  KnownBsdfs bsdfs;
  KnownTextures textures;
  std::optional<SurfaceMaterials> default_materials[2];  // of shapes that do not emit, and that do
  std::set<std::uint32_t> used_lights;                   // area lights that lie on a shape
  std::uint64_t triangle_count = 0;
};

// Appends the shape, its materials and its warnings to the world. Throws Error(Exit::scene).
void read_shape(Document& document, std::uint32_t element, ShapeContext& context, World& world);

}  // namespace oclair
