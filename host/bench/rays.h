// The rays that traversals are measured with, made from the camera of a scene. Where a ray starts on a surface, it starts
// `surface_gap` off it, so that every traversal sees the same ray without having to leave a primitive out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "../scene.h"

namespace oclair::bench {

inline constexpr double surface_gap = 0x1p-15;  // canonical length: 16 times what traversals in float32 need at most
inline constexpr double ao_distance = 0.25;     // canonical length
inline constexpr uint rays_across = 512;        // of the camera: that many squared, in tiles of TILE_WIDTH squared

struct RaySet {
  std::string name;
  bool any_hit;
  bool coherent;  // neighbours in the set have similar origins and directions
  std::vector<Ray> rays;
};

// Traces a ray to its nearest triangle; a robust traversal that is not the one under test.
using Trace = std::function<std::vector<Hit>(const std::vector<Ray>&)>;

// Through the pixels of the scene's camera, its lens closed, moved forward to [-1, 1]^3.
std::vector<Ray> camera_rays(const Scene& scene);

// primary; diffuse: a cosine-distributed bounce from each primary hit; shadow: from there to points of a square below the
// top of the scene; ao: cosine-distributed, of length ao_distance. A ray that misses has no bounce.
std::vector<RaySet> ray_sets(const Scene& scene, const Trace& trace);

}  // namespace oclair::bench
