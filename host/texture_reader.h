// <texture>: bitmap, checkerboard, mesh_attribute.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "document.h"
#include "world.h"

namespace oclair {

// Texture elements and image files that have been read; shared ones are held once.
struct KnownTextures {
  std::map<std::uint32_t, uint> elements;  // to 1 + index into World::textures
  std::map<std::string, std::shared_ptr<const Image>> images;
};

// Reads the element once; returns 1 + its index in World::textures. Throws Error(Exit::scene).
uint read_texture(Document& document, std::uint32_t element, KnownTextures& known, World& world);

// 1 + index of the texture that is nested in the element, or referred to, under that name; 0: none. It counts as used.
uint texture_property(Document& document, std::uint32_t element, const std::string& name, KnownTextures& known, World& world);

// The image file that the property `filename` of the element names. Throws Error(Exit::scene).
std::shared_ptr<const Image> image_property(Document& document, std::uint32_t element, KnownTextures& known, World& world);

}  // namespace oclair
