#include "../cl/mis.h"

__kernel void power(uint count, __global const float *a, __global const float *b, __global float *weight) {
  size_t i = get_global_id(0);
  if (i < count) weight[i] = mis_power(a[i], b[i]);
}
