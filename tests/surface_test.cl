#include "../cl/surface.h"

typedef struct Result {
  packed_float3 position, error, geometric, shading;
  uint shape, front;
} Result;

// The surface at given hits.
__kernel void surfaces(uint count, __global const TriangleBlock *blocks, __global const Quadric *quadrics, __global const Shape *shapes,
                       __global const uint *triangle_shape, __global const packed_uint3 *triangle_vertices,
                       __global const packed_float3 *normals, __global const Ray *rays, __global const Hit *hits, __global Result *results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.blocks = blocks, .quadrics = quadrics, .shapes = shapes, .triangle_shape = triangle_shape,
                 .triangle_vertices = triangle_vertices, .normals = normals};
  Ray ray = rays[i];
  Surface s = surface_from_hit(&scene, &ray, hits[i]);
  Result r = {pack3(s.position), pack3(s.error), pack3(s.geometric), pack3(s.frame.z), s.shape, s.front};
  results[i] = r;
}
