// Materials and textures on their way to the device: only those that a shape uses, with the textures that they name.
#pragma once

#include <map>
#include <span>

#include "scene.h"

namespace oclair {

class MaterialPlacer {
 public:
  MaterialPlacer(const World& world, Scene& scene) : world_(world), scene_(scene) {}

  // What the next calls of material() and texture() are for: attributes are looked up in its mesh, whose triangles `faces` were
  // kept (indices into mesh.triangles).
  void begin_shape(const WorldShape& shape, std::span<const uint> faces);

  // Index into Scene::materials of that material of the world, NONE of NONE. Throws Error(Exit::scene) if it asks for an
  // attribute that the shape does not have.
  uint material(uint index);

  // 1 + index into Scene::textures of that texture of the world (1 + its index), 0 of 0.
  uint texture(uint reference);

  // 1 + index into Scene::textures of an image as it is.
  uint image(const Image& image, bool srgb);

  // Whether a shape of that material needs texture coordinates.
  bool needs_uv(uint material) const;
  bool texture_needs_uv(uint reference) const;

 private:
  // Of the material, or of what a blend of it comes down to; shared ones are asked once.
  bool any_texture(uint material, bool (MaterialPlacer::*holds)(uint) const) const;
  bool uses_attributes(uint material) const;
  bool is_attribute(uint reference) const;
  Texture attribute(const WorldTexture& source);
  ulong append(std::span<const std::byte> bytes);

  const World& world_;
  Scene& scene_;
  const WorldShape* shape_ = nullptr;
  std::span<const uint> faces_;
  std::map<uint, uint> materials_, textures_;              // of the world to those of the scene, the same for all shapes
  std::map<uint, uint> shape_materials_, shape_textures_;  // those that differ from shape to shape
  std::map<const Image*, ulong> images_;                   // offset of their texels
};

// Table of the decoded values of 8-bit sRGB (IEC 61966-2-1).
std::vector<float> srgb_table();

}  // namespace oclair
