#include "../cl/pixel.h"

// x, y, index, inside, stream of every index.
__kernel void pixels(uint count, __global const Settings *settings, __global uint *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Pixel p = pixel_from_index(settings, (uint)i);
  result[5 * i] = p.x;
  result[5 * i + 1] = p.y;
  result[5 * i + 2] = p.index;
  result[5 * i + 3] = p.inside;
  result[5 * i + 4] = pixel_stream(settings, p);
}

__kernel void pixels_at(uint count, __global const Settings *settings, __global const ulong *index, __global uint *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Pixel p = pixel_from_index(settings, index[i]);
  result[5 * i] = p.x;
  result[5 * i + 1] = p.y;
  result[5 * i + 2] = p.index;
  result[5 * i + 3] = p.inside;
  result[5 * i + 4] = pixel_stream(settings, p);
}
