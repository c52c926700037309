// <emitter>: area, point, spot, directional, constant, envmap.
#pragma once

#include "document.h"
#include "texture_reader.h"
#include "world.h"

namespace oclair {

// <emitter type="area"> of a shape: its radiance, W/(m^2 sr), or the texture of it. Throws Error(Exit::scene).
void read_area_light(Document& document, std::uint32_t element, KnownTextures& textures, World& world, WorldShape& shape);

// All others: appends the light to the world. Throws Error(Exit::scene).
void read_light(Document& document, std::uint32_t element, KnownTextures& textures, World& world);

}  // namespace oclair
