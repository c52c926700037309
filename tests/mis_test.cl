#include "../cl/mis.h"

__kernel void power(uint count, __global const float *a, __global const float *b, __global float *weight) {
  size_t i = get_global_id(0);
  if (i < count) weight[i] = mis_power(a[i], b[i]);
}

// Of light that can be found both ways: with a density > 0 by scattering, and by sampling the lights.
__kernel void strategies(uint count, __global const float* scattering, __global const float* light, __global float* by_scattering,
                         __global float* by_light) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  by_scattering[i] = mis_scattering_weight(scattering[i], light[i]);
  by_light[i] = mis_light_weight(light[i], scattering[i]);
}
