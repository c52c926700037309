// Rays from inside closed meshes that are most likely to pass between two triangles.
#pragma once

#include "brute_force.h"

namespace oclair::test {

inline glm::dvec3 origin_inside(Random& random, std::size_t i) {
  glm::dvec3 o = 0.2 * random.in_cube();                   // the meshes reach out to 0.44 at least
  if (i % 4 == 1) o = glm::round(o * 16.0) / 16.0;      // dyadic: rays along axes and diagonals, exact zeros
  if (i % 4 == 2) o = glm::dvec3(0.0);
  if (i % 4 == 3) o = random.below(2) ? glm::dvec3(o.x, 0, 0) : glm::dvec3(o.x, o.y, -0.0);
  return o;
}

// At every vertex from `repeat` origins, at ten points of every edge, and anywhere.
inline std::vector<Ray> aimed_rays(const Scene& scene, std::size_t repeat, std::size_t random_count, Random& random) {
  std::vector<Ray> rays;
  for (const packed_float3& p : scene.positions)
    for (std::size_t k = 0; k < repeat; ++k) rays.push_back(ray_towards(origin_inside(random, rays.size()), unpacked(p)));
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const Corners c = corners_of(scene, t);
    for (int e = 0; e < 3; ++e)  // every edge from both its triangles
      for (int k = 0; k < 5; ++k) {
        const double s = k == 0 ? 0.5 : random.unit();
        rays.push_back(ray_towards(origin_inside(random, rays.size()), (1.0 - s) * unpacked(c[e]) + s * unpacked(c[(e + 1) % 3])));
      }
  }
  for (std::size_t i = 0; i < random_count; ++i) {
    const glm::dvec3 o = origin_inside(random, i);
    rays.push_back(ray_towards(o, o + random.direction()));
  }
  return rays;
}

}  // namespace oclair::test
