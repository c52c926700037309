// The wide BVH over triangles and quadrics: Embree builds the tree, this lays it out as cl/types.h says.
#pragma once

#include <cstddef>
#include <cstdint>

#include "buffer_vector.h"
#include "scene.h"

namespace oclair {

struct Bvh {
  int width = 8;
  BufferVector<std::byte> nodes;   // BvhNode<width>; node 0 is the root
  BufferVector<std::byte> blocks;  // TriangleBlock<width>
  std::size_t node_count = 0;
  std::size_t block_count = 0;
  int depth = 0;                  // nodes on the longest way from the root to a leaf

  // Entries that traversal needs at most, (width - 1) depth + 1, rounded up to a power of two >= 64, so that few scenes
  // compile a kernel of their own.
  int stack_size() const;
};

// Boxes are padded by this, in canonical lengths, so that the plain slab test of cl/traverse.h never misses what the triangle
// test would hit. With u = 2^-24, |origin| <= 1 and |bound - origin| <= 2 per axis (camera_enter_scene), the slab's fma form
// errs by (|o| + 2 |b - o|) u = 5 u as a displacement of the plane, the sheared vertices of the triangle test by 10 u, and the padded
// bound itself is rounded by 1 u: 16 u in all; 24 u on a device that divides with the 2.5 ulp that OpenCL allows.
inline constexpr float box_padding = 0x1p-19f;

// width: 4 or 8. Throws Error(Exit::render_failed) if Embree cannot build it. An empty scene gives one node without children.
// All cores build; the arrays are the same for any number of them.
Bvh build_bvh(const Scene& scene, int width);

}  // namespace oclair
