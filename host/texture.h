// Textures on the host, in double precision: what cl/texture.h does, for the powers of lights.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "scene.h"

namespace oclair {

// Texels as they lie in an image: one value in all three channels, or the three.
struct Texels {
  std::span<const std::byte> bytes;
  uint format, channels;
  bool srgb;

  glm::dvec3 at(std::size_t i) const;
};

Texels texels_of(const Image& image, bool srgb);
Texels texels_of(const Scene& scene, const Texture& texture);

// Where on a surface a texture is asked: barycentric coordinates (b1, b2) of a triangle of the scene, or only uv.
struct TexturePoint {
  glm::dvec2 uv;
  double b1 = 0.0, b2 = 0.0;
  uint primitive = NONE, face = 0;
};

// Without texture coordinates, the barycentric ones take their place.
TexturePoint point_on_triangle(const Scene& scene, const Shape& shape, uint primitive, double b1, double b2);

// reference: 1 + index into Scene::textures. Negative values count as 0, as in a light.
glm::dvec3 texture_value(const Scene& scene, uint reference, const TexturePoint& at);

}  // namespace oclair
