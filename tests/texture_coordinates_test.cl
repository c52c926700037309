#include "../cl/surface.h"

typedef struct Result {
  packed_float3 position, dp_du, dp_dv;
  float u, v, b1, b2;
  uint primitive, face;
} Result;

// Where textures are asked at given hits, and the derivatives of the position there.
__kernel void coordinates(uint count, __global const TriangleBlock *blocks, __global const Quadric *quadrics, __global const Shape *shapes,
                          __global const uint *triangle_shape, __global const packed_uint3 *triangle_vertices, __global const float2 *uvs,
                          __global const packed_float3 *normals, __global const Ray *rays, __global const Hit *hits,
                          __global Result *results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.blocks = blocks, .quadrics = quadrics, .shapes = shapes, .triangle_shape = triangle_shape,
                 .triangle_vertices = triangle_vertices, .uvs = uvs, .normals = normals};
  Ray ray = rays[i];
  Surface s = surface_from_hit(&scene, &ray, hits[i]);
  Result r = {pack3(s.position), pack3(s.dp_du), pack3(s.dp_dv), s.at.uv.x, s.at.uv.y, s.at.b1, s.at.b2, s.at.primitive, s.at.face};
  results[i] = r;
}
