#include "../cl/material.h"

// Which material a path comes upon at (u, v), and the textures there.
__kernel void selected(uint count, __global const Material *materials, __global const Texture *textures, __global const uchar *texels,
                       uint index, __global const float2 *uvs, __global const uint *bits, __global uint *which) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.materials = materials, .textures = textures, .texels = texels};
  TexturePoint at = {uvs[i], 0.0f, 0.0f, NONE, 0u};
  which[i] = material_select(&scene, index, &at, bits[i]);
}

__kernel void looked_up(uint count, __global const Material *materials, __global const Texture *textures, __global const uchar *texels,
                        __global const float2 *uvs, __global float *transparencies, __global Material *found) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.materials = materials, .textures = textures, .texels = texels};
  TexturePoint at = {uvs[i], 0.0f, 0.0f, NONE, 0u};
  transparencies[i] = material_transparency(&scene, (uint)i, &at);
  found[i] = material_at(&scene, (uint)i, &at);
}
