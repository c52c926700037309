// The scene as the kernels read it: vectors of the structs of cl/types.h, in the canonical frame, byte for byte what is
// uploaded. Vectors that no feature of the scene reads stay empty, and no buffer is made of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "../cl/features.h"
#include "buffer_vector.h"
#include "frame.h"
#include "world.h"

namespace oclair {

struct Scene {
  CanonicalFrame frame;
  Features features = 0;
  Approximations approximations = 0;  // that the user asked for
  bool double_precision = false;      // path.cl computes in double
  bool exact_kernel = false;          // compiled for its features alone, not the smallest shared one (variant.h)

  // Input of the BVH, which keeps what it needs of them: a renderer does without.
  BufferVector<packed_float3> positions;
  BufferVector<packed_uint3> triangles;      // indices into positions; each has a normal in float32
  std::uint64_t degenerate_primitives = 0;  // left out

  std::vector<Quadric> quadrics;
  std::vector<Shape> shapes;
  BufferVector<uint> triangle_shape;
  BufferVector<packed_uint3> triangle_vertices;  // counted in the mesh; empty if nothing varies with the vertices
  BufferVector<packed_float3> normals;
  BufferVector<std::array<float, 2>> uvs;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<std::byte> texels;
  std::vector<float> srgb;  // decoded values of 8-bit sRGB, if a texture has such texels
  std::vector<Light> lights;
  std::vector<uint> light_cdf;
  std::vector<uint> environment_cdf;  // see cl/environment.h
  std::vector<FilterEntry> filter;
  Camera camera{};
  double camera_depth = 0.0;  // of Camera::origin along the axis, canonical: the rays of an orthographic camera begin late
  Settings settings{};
};

// Takes the world apart as it goes. Throws Error(Exit::scene) if the scene exceeds what the structs can number.
Scene place_scene(World world);

}  // namespace oclair
