#include "../cl/mirror.h"
#include "../cl/surface.h"
#include "../cl/traverse.h"

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

// Mirror reflections inside a closed scene: where the ray is after `bounces` of them. Its primitive is NONE if it got out.
__kernel void reflect(uint count, __global const BvhNode *nodes, __global const TriangleBlock *blocks,
                      __global const Quadric *quadrics, __global const Shape *shapes, __global const uint *triangle_shape,
                      uint bounces, __global Ray *rays) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.nodes = nodes, .blocks = blocks, .quadrics = quadrics, .shapes = shapes, .triangle_shape = triangle_shape};
  Ray ray = rays[i];
  for (uint n = 0; n < bounces; ++n) {
    Hit hit = traverse_closest(&scene, &ray);
    ray.skip = hit.primitive;
    if (hit.primitive == NONE) break;
    Surface s = surface_from_hit(&scene, &ray, hit);
    float3 w = renormalize(frame_to_world(s.frame, mirror_direction(frame_to_local(s.frame, -unpack3(ray.direction)))));
    ray.origin = pack3(surface_offset(s.position, s.error, s.geometric, w));
    ray.direction = pack3(w);
  }
  rays[i] = ray;
}
