// Worlds with lights, and light samples from the device.
#pragma once

#include "random.h"
#include "worlds.h"

namespace oclair::test {

struct LightResult {
  packed_float3 direction;
  float distance;
  packed_float3 weight;
  float pdf;
  cl_uint primitive;
};

using Square = std::array<float, 2>;  // a point of the unit square

// An absorbing box that makes the frame the identity scaled by 2^-1: half-extent 1.
inline void add_frame_box(World& world) { add_box(add_shape(world, diffuse(0.5), Sides::front).mesh, {-1, -1, -1}, {1, 1, 1}, true); }

inline std::vector<LightResult> sample_lights(const Scene& scene, const std::vector<cl_uint>& which, const std::vector<packed_float3>& from,
                                              const std::vector<Square>& u) {
  std::vector<LightResult> results(u.size());
  run("light_test.cl", "sample", u.size(), scene.lights, scene.quadrics, scene.shapes, scene.triangle_shape, scene.triangle_vertices, scene.uvs,
      scene.textures, scene.texels, scene.srgb, scene.environment_cdf, std::vector<Settings>{scene.settings}, which, from, u, out(results));
  return results;
}

inline std::vector<LightResult> sample_light(const Scene& scene, cl_uint light, const glm::dvec3& from, const std::vector<Square>& u) {
  return sample_lights(scene, std::vector<cl_uint>(u.size(), light), std::vector<packed_float3>(u.size(), packed(from)), u);
}

// Midpoints of an n x n grid.
inline std::vector<Square> grid(std::size_t n) {
  std::vector<Square> u;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) u.push_back({(static_cast<float>(i) + 0.5f) / static_cast<float>(n), (static_cast<float>(j) + 0.5f) / static_cast<float>(n)});
  return u;
}

inline std::vector<Square> random_squares(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Square> u(n);
  for (Square& s : u) s = {random.unit24(), random.unit24()};
  return u;
}

// Irradiance at a point from all lights: every light is given by its own quadrature, times its probability.
inline double irradiance(const Scene& scene, const glm::dvec3& canonical_from, const glm::dvec3& normal, std::size_t n) {
  double sum = 0.0;
  const std::vector<Square> u = grid(n);
  for (cl_uint light = 0; light < scene.lights.size(); ++light) {
    double part = 0.0;
    for (const LightResult& s : sample_light(scene, light, canonical_from, u))
      part += static_cast<double>(s.weight.x) * std::max(0.0, glm::dot(unpacked(s.direction), normal));
    sum += part / static_cast<double>(u.size()) * static_cast<double>(scene.lights[light].probability);
  }
  return sum;
}

}  // namespace oclair::test
