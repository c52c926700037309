#include "../cl/traverse.h"

// Node i against ray i.
__kernel void intersect(uint count, __global const BvhNode *nodes, __global const Ray *rays, __global uint *mask, __global float *near) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Ray ray = rays[i];
  Slabs slabs = slabs_from_ray(&ray);
  Lanes lanes;
  mask[i] = node_intersect(nodes + i, &slabs, ray.t_min, ray.t_max, &lanes);
  for (uint lane = 0; lane < BVH_WIDTH; ++lane) near[i * BVH_WIDTH + lane] = lanes.lane[lane];
}

// Row i of lanes, -1 or 0, as lane_mask packs it, and the lowest that is set, where one is.
__kernel void pack(uint count, __global const int *lanes, __global uint *mask, __global uint *lowest) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  union {
    intw vector;
    int lane[BVH_WIDTH];
  } row;
  for (uint lane = 0; lane < BVH_WIDTH; ++lane) row.lane[lane] = lanes[i * BVH_WIDTH + lane];
  mask[i] = lane_mask(row.vector);
  lowest[i] = mask[i] ? lowest_lane(mask[i]) : BVH_WIDTH;
}
