// Worlds made in code, so that the physics tests do not rest on the scene reader.
#pragma once

#include <cmath>
#include <map>
#include <random>

#include "../host/film.h"
#include "../host/render.h"
#include "../host/scene.h"
#include "kernel.h"
#include "meshes.h"

namespace oclair::test {

inline Material diffuse(double albedo) {
  Material m{};
  m.kind = MATERIAL_DIFFUSE;
  const float a = static_cast<float>(albedo);
  m.reflectance = {a, a, a};
  return m;
}

inline Material mirror(double reflectance) {
  Material m = diffuse(reflectance);
  m.kind = MATERIAL_MIRROR;
  return m;
}

inline Material dielectric(double eta) {
  Material m = diffuse(1.0);
  m.kind = MATERIAL_DIELECTRIC;
  m.transmittance = {1.0f, 1.0f, 1.0f};
  m.eta = static_cast<float>(eta);
  return m;
}

enum class Sides { front, both };

// A shape of one material, appended to the world. Emits on its front side if radiance > 0.
inline WorldShape& add_shape(World& world, const Material& material, Sides sides, double radiance = 0.0) {
  WorldShape& shape = world.shapes.emplace_back();
  shape.material_front = static_cast<uint>(world.materials.size());
  shape.material_back = sides == Sides::both ? shape.material_front : NONE;
  world.materials.push_back(material);
  if (radiance > 0.0) shape.radiance = glm::dvec3(radiance);
  return shape;
}

// A camera at `from` that looks at `to`, with the given half field of view, square pixels.
inline void look(World& world, glm::dvec3 from, glm::dvec3 to, glm::dvec3 up, double tan_half_fov, uint width, uint height) {
  const glm::dvec3 z = glm::normalize(to - from), x = glm::normalize(glm::cross(up, z)), y = glm::cross(z, x);
  world.camera.to_world = glm::dmat4(glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(from, 1));
  world.camera.tan_half_fov_x = tan_half_fov;
  world.film.width = world.film.crop_width = width;
  world.film.height = world.film.crop_height = height;
  world.film.filter = FilterKind::box;
  world.film.filter_radius = 0.5;
}

inline Film render(const World& world, uint samples) {
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  Renderer renderer = start_render(device(), scene, bvh);
  render_pass(renderer, samples);
  return read_film(renderer);
}

// Mean of all pixels and channels, and its standard error from the spread between pixels.
struct Estimate {
  double mean, error;
};

inline Estimate image_mean(const Film& film) {
  double sum = 0.0, squares = 0.0;
  const std::size_t n = film.pixels.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto rgb = pixel_mean(film, i);
    const double x = (rgb[0] + rgb[1] + rgb[2]) / 3.0;
    sum += x;
    squares += x * x;
  }
  const double mean = sum / static_cast<double>(n);
  const double variance = std::max(0.0, squares / static_cast<double>(n) - mean * mean);
  return {mean, std::sqrt(variance / static_cast<double>(n - 1))};
}

}  // namespace oclair::test
