#include "../cl/environment.h"

#define MAP_ARGUMENTS                                                                                                                      \
  __global const Texture *textures, __global const uchar *texels, __global const float *srgb, __global const uint *environment_cdf, \
      __global const Settings *settings
#define MAP_SCENE {.textures = textures, .texels = texels, .srgb = srgb, .environment_cdf = environment_cdf, .settings = settings}

__kernel void radiance(uint count, MAP_ARGUMENTS, __global const packed_float3 *directions, __global packed_float3 *results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = MAP_SCENE;
  results[i] = pack3(environment_radiance(&scene, unpack3(directions[i])));
}

__kernel void density(uint count, MAP_ARGUMENTS, __global const packed_float3 *directions, __global float *results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = MAP_SCENE;
  results[i] = environment_pdf(&scene, unpack3(directions[i]));
}

__kernel void sample(uint count, MAP_ARGUMENTS, __global const ulong *bits, __global packed_float3 *directions, __global float *pdf) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = MAP_SCENE;
  float density;
  directions[i] = pack3(environment_sample(&scene, bits[i], &density));
  pdf[i] = density;
}
