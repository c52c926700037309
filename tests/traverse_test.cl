#include "../cl/traverse.h"

__kernel void closest(uint count, __global const BvhNode *nodes, __global const TriangleBlock *blocks, __global const Quadric *quadrics,
                      __global const Ray *rays, __global Hit *hits) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.nodes = nodes, .blocks = blocks, .quadrics = quadrics};
  Ray ray = rays[i];
  hits[i] = traverse_closest(&scene, &ray);
}

__kernel void occluded(uint count, __global const BvhNode *nodes, __global const TriangleBlock *blocks, __global const Quadric *quadrics,
                  __global const Ray *rays, __global uint *blocked) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.nodes = nodes, .blocks = blocks, .quadrics = quadrics};
  Ray ray = rays[i];
  blocked[i] = traverse_any(&scene, &ray);
}
