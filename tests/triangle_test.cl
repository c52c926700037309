#include "../cl/triangle.h"

// Which lanes of block i own their hits by ray i.
__kernel void owners(uint count, __global const TriangleBlock *blocks, __global const Ray *rays, __global uint *mask) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Ray ray = rays[i];
  Shear shear = shear_from_ray(&ray);
  uint owned = 0;
  for (uint lane = 0; lane < BVH_WIDTH; ++lane) owned |= (uint)triangle_owns_hit(blocks + i, lane, &shear) << lane;
  mask[i] = owned;
}

// Block i against ray i; t, b1, b2 of every lane.
__kernel void intersect(uint count, __global const TriangleBlock *blocks, __global const Ray *rays, __global uint *mask,
                        __global float *t, __global float *b1, __global float *b2) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Ray ray = rays[i];
  Shear shear = shear_from_ray(&ray);
  Lanes lane_t, lane_b1, lane_b2;
  lane_t.vector = lane_b1.vector = lane_b2.vector = (floatw)(0.0f);
  mask[i] = triangle_block_intersect(blocks + i, &shear, ray.t_max, i & 1u, &lane_t, &lane_b1, &lane_b2);
  for (uint lane = 0; lane < BVH_WIDTH; ++lane) {
    t[i * BVH_WIDTH + lane] = lane_t.lane[lane];
    b1[i * BVH_WIDTH + lane] = lane_b1.lane[lane];
    b2[i * BVH_WIDTH + lane] = lane_b2.lane[lane];
  }
}
