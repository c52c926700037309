#include "../cl/distribution.h"

__kernel void choose(uint count, __global const uint *cdf, uint items, __global const uint *bits, __global uint *which, __global float *rest,
                     __global float *probability) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float where;
  which[i] = distribution_sample(cdf, items, bits[i], &where);
  rest[i] = where;
  probability[i] = distribution_probability(cdf, items, which[i]);
}

__kernel void widths(uint count, __global const uint *cdf, __global ulong *width) {
  size_t i = get_global_id(0);
  if (i < count) width[i] = distribution_width(cdf, count, (uint)i);
}
