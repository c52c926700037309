// Traces rays on the device through a scene, and by brute force in double.
#pragma once

#include "../host/bvh.h"
#include "brute_force.h"
#include "worlds.h"

namespace oclair::test {

// A scene of bare triangles, in canonical coordinates already: no frame, nothing dropped.
inline Scene scene_of(const std::vector<Corners>& triangles) {
  Scene scene;
  scene.features = FEATURE_TRIANGLES;
  for (const Corners& corners : triangles) {
    const uint first = static_cast<uint>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
    scene.triangles.push_back({first, first + 1, first + 2});
  }
  return scene;
}

inline World world_of(const Mesh& mesh) {
  World world;
  add_shape(world, diffuse(0.5), Sides::both).mesh = mesh;
  return world;
}

// `stack`: STACK_SIZE to compile with; 0 means what the tree asks for.
inline KernelOptions trace_options(const Scene& scene, const Bvh& bvh, int stack = 0) {
  return {scene.features, bvh.width, stack > 0 ? stack : bvh.stack_size()};
}

inline std::vector<Hit> trace_closest(const Scene& scene, const Bvh& bvh, const std::vector<Ray>& rays, int stack = 0) {
  std::vector<Hit> hits(rays.size());
  run_with(trace_options(scene, bvh, stack), "traverse_test.cl", "closest", rays.size(), bvh.nodes, bvh.blocks, scene.quadrics, rays, out(hits));
  return hits;
}

inline std::vector<cl_uint> trace_any(const Scene& scene, const Bvh& bvh, const std::vector<Ray>& rays, int stack = 0) {
  std::vector<cl_uint> blocked(rays.size());
  run_with(trace_options(scene, bvh, stack), "traverse_test.cl", "occluded", rays.size(), bvh.nodes, bvh.blocks, scene.quadrics, rays, out(blocked));
  return blocked;
}

}  // namespace oclair::test
