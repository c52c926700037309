#include "../cl/aov.h"

typedef struct Found {
  packed_float3 position, normal;
  float u, v;
  uint material, primitive, front, passes;
  AovPixel sum;
} Found;

// The first surface along ray i, decided by the random numbers of sample[i] of pixel[i] or by none, and what it alone adds
// up to.
__kernel void first_surfaces(uint count, SCENE_ARGUMENTS, __global const Ray* rays, __global const uint* pixel,
                             __global const ulong* sample, uint by_chance, __global Found* results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Sampler sampler = sampler_begin(settings, pixel[i], sample[i]);
  PathState path = path_begin(&scene, 0u, 0u, &sampler);
  path.ray = rays[i];
  FirstSurface first = aov_first_surface(&scene, &path, &sampler, by_chance != 0u);
  Found found = {.primitive = first.primitive, .material = NONE, .passes = path.passes};
  if (first.primitive != NONE) {
    found.position = pack3(first.surface.position);
    found.normal = pack3(first.surface.frame.z);
    found.u = first.surface.at.uv.x;
    found.v = first.surface.at.uv.y;
    found.material = first.material;
    found.front = first.surface.front;
    aov_add(&scene, &found.sum, &path, first);
  }
  results[i] = found;
}

// Pixel i of the film, row by row.
INLINE Pixel pixel_of(__global const Settings* settings, uint i) {
  Pixel pixel = {i % settings->film_width, i / settings->film_width, i, true};
  return pixel;
}

__kernel void primitives(uint count, SCENE_ARGUMENTS, __global uint* results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = SCENE_FROM_ARGUMENTS;
  results[i] = aov_primitive(&scene, pixel_of(settings, (uint)i));
}

__kernel void pixels(uint count, SCENE_ARGUMENTS, __global AovPixel* results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = SCENE_FROM_ARGUMENTS;
  results[i] = aov_pixel(&scene, pixel_of(settings, (uint)i));
}
