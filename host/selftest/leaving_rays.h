// Rays that leave triangles of all sizes, at all places and angles.
#pragma once

#include <vector>

#include "../bvh.h"
#include "brute_force.h"
#include "meshes.h"

namespace oclair::test {

template <int WIDTH>
void fill_slots(const Bvh& bvh, std::vector<uint>& slot) {
  const auto* blocks = reinterpret_cast<const TriangleBlock<WIDTH>*>(bvh.blocks.data());
  for (std::size_t b = bvh.block_count; b-- > 0;)
    for (uint lane = WIDTH; lane-- > 0;) slot[blocks[b].primitive[lane]] = static_cast<uint>(WIDTH * b + lane);
}

// Where each triangle lies in the blocks.
inline std::vector<uint> slots(const Scene& scene, const Bvh& bvh) {
  std::vector<uint> slot(scene.triangles.size(), NONE);
  if (bvh.width == 4) fill_slots<4>(bvh, slot);
  else fill_slots<8>(bvh, slot);
  return slot;
}

// Hits at random places, vertices and edges of all triangles of the scene.
inline std::vector<Hit> hits_everywhere(const Scene& scene, const Bvh& bvh, std::size_t count, Random& random) {
  const std::vector<uint> slot = slots(scene, bvh);
  std::vector<Hit> hits;
  for (std::size_t i = 0; i < count; ++i) {
    const auto triangle = static_cast<uint>(i % scene.triangles.size());
    double b1 = random.unit(), b2 = random.unit();
    if (b1 + b2 > 1) b1 = 1 - b1, b2 = 1 - b2;
    if (i % 5 == 1) b1 = 0;
    if (i % 5 == 2) b2 = 1 - b1;
    if (i % 5 == 3) b1 *= 1e-6;
    hits.push_back({1.0f, static_cast<float>(b1), std::min(static_cast<float>(b2), 1.0f - static_cast<float>(b1)), triangle, slot[triangle]});
  }
  return hits;
}

inline Mesh triangles_in(const glm::dvec3& center, double scale, std::size_t count, Random& random) {
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 at = center + random.in_cube(scale);
    const double size = scale * random.log_between(1e-3, 1.0);
    add_triangle(mesh, at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size));
  }
  return mesh;
}

// Any direction; every fourth grazes the triangle, down to a cosine of 1e-4.
inline glm::dvec3 leaving_direction(const Scene& scene, const Hit& hit, std::size_t i, Random& random) {
  const glm::dvec3 direction = random.direction();
  if (i % 4 != 0) return direction;
  const Corners c = corners_of(scene, hit.primitive);
  const glm::dvec3 n = glm::normalize(glm::cross(unpacked(c[1]) - unpacked(c[0]), unpacked(c[2]) - unpacked(c[0])));
  return glm::normalize(glm::normalize(glm::cross(n, direction)) + random.sign() * random.log_between(1e-4, 1.0) * n);
}

}  // namespace oclair::test
