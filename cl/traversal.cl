// The two traversals over an array of rays: what `oclair bench traversal` times. Work item i of a launch takes ray base + i.
#include "traverse.h"

#define TRAVERSAL __kernel __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) void

TRAVERSAL closest_of_rays(SCENE_ARGUMENTS, __global const Ray *rays, __global Hit *hits, uint base, uint count) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  uint i = base + (uint)get_global_id(0);
  if (i >= count) return;
  Ray ray = rays[i];
  hits[i] = traverse_closest(&scene, &ray);
}

TRAVERSAL any_of_rays(SCENE_ARGUMENTS, __global const Ray *rays, __global uint *blocked, uint base, uint count) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  uint i = base + (uint)get_global_id(0);
  if (i >= count) return;
  Ray ray = rays[i];
  blocked[i] = traverse_any(&scene, &ray);
}
