// The scene as the kernels read it: vectors of the structs of cl/types.h, in the canonical frame, byte for byte what is
// uploaded. Vectors that no feature of the scene reads stay empty, and no buffer is made of them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "../cl/features.h"
#include "frame.h"
#include "world.h"

namespace oclair {

struct Scene {
  CanonicalFrame frame;
  std::uint32_t features = 0;  // FEATURE_ bits

  // Input of the BVH, which keeps what it needs of them.
  std::vector<packed_float3> positions;
  std::vector<packed_uint3> triangles;      // indices into positions; each has a normal in float32
  std::uint64_t degenerate_primitives = 0;  // left out

  std::vector<Quadric> quadrics;
  std::vector<Shape> shapes;
  std::vector<uint> triangle_shape;
  std::vector<packed_uint3> triangle_vertices;  // with SMOOTH_NORMALS: indices into normals, 0 0 0 for flat shapes
  std::vector<packed_float3> normals;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<uint> light_cdf;
  std::vector<std::array<float, 2>> filter;
  Camera camera{};
  Settings settings{};
};

// Takes the world apart as it goes. Throws Error(Exit::scene) if the scene exceeds what the structs can number.
Scene place_scene(World world);

}  // namespace oclair
