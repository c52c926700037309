#include "rng.h"

__kernel void unit(uint count, __global const uint *bits, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = rng_unit(bits[i]);
}
