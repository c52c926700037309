// Worlds made in code, so that the physics tests do not rest on the scene reader.
#pragma once

#include <cmath>
#include <map>
#include <random>

#include "../host/film.h"
#include "../host/render.h"
#include "../host/scene.h"
#include "kernel.h"

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

inline void add_triangle(Mesh& mesh, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const auto first = static_cast<unsigned>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
}

// Parallelogram origin, origin + x, origin + x + y, origin + y; its front is where x cross y points.
inline void add_quad(Mesh& mesh, glm::dvec3 origin, glm::dvec3 x, glm::dvec3 y) {
  const auto first = static_cast<unsigned>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {origin, origin + x, origin + x + y, origin + y});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

// Axis-aligned box [low, high] with its front outside, or inside.
inline void add_box(Mesh& mesh, glm::dvec3 low, glm::dvec3 high, bool inside = false) {
  const glm::dvec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  const auto face = [&](glm::dvec3 o, glm::dvec3 a, glm::dvec3 b) { inside ? add_quad(mesh, o, b, a) : add_quad(mesh, o, a, b); };
  face(low, y, x);
  face(low + z, x, y);
  face(low, z, y);
  face(low + x, y, z);
  face(low, x, z);
  face(low + y, z, x);
}

// Closed sphere-like mesh: an icosahedron, each triangle split into 4 `levels` times, radii displaced by up to `displacement`.
inline Mesh icosphere(int levels, double displacement, unsigned seed) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  Mesh mesh;
  mesh.positions = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8}, {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<unsigned, unsigned>, unsigned> middle;
    const auto split = [&](unsigned a, unsigned b) {
      const auto [at, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<unsigned>(mesh.positions.size()));
      if (fresh) mesh.positions.push_back(mesh.positions[a] + mesh.positions[b]);
      return at->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : mesh.triangles) {
      const unsigned ab = split(t.x, t.y), bc = split(t.y, t.z), ca = split(t.z, t.x);
      finer.insert(finer.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
    for (glm::dvec3& p : mesh.positions) p = glm::normalize(p);
  }
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-displacement, displacement);
  for (glm::dvec3& p : mesh.positions) p = glm::normalize(p) * (1.0 + shift(random));
  return mesh;
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
