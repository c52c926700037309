#include "../cl/quadric.h"

// Semantics: bit 0 starts, bit 1 ends.
__kernel void intersect(uint count, __global const Quadric *quadrics, __global const Ray *rays, __global const uint *semantics, __global float *t) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Quadric quadric = quadrics[i];
  t[i] = quadric_intersect(&quadric, unpack3(rays[i].origin), unpack3(rays[i].direction), rays[i].t_min, rays[i].t_max, semantics[i] & 1u, semantics[i] & 2u);
}

// Local point to the quadric, its world position relative to the centre, and the normal there.
__kernel void project(uint count, __global const Quadric *quadrics, __global const packed_float3 *place, __global packed_float3 *projected,
                      __global packed_float3 *world, __global packed_float3 *back, __global packed_float3 *normal) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Quadric quadric = quadrics[i];
  float3 q = quadric_project(&quadric, unpack3(place[i]));
  projected[i] = pack3(q);
  float3 p = quadric_to_world(&quadric, q);
  world[i] = pack3(p);
  back[i] = pack3(quadric_to_local(&quadric, p));
  normal[i] = pack3(quadric_normal(&quadric, q));
}
