#include "../cl/sampler.h"

// The bits of one dimension; independent: those of rng_bits.
__kernel void draw(uint count, __global const Settings *settings, __global const uint *pixel, __global const ulong *sample,
                   __global const uint *dimension, __global ulong *bits, __global ulong *independent) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Sampler sampler = sampler_begin(settings, pixel[i], sample[i]);
  bits[i] = sampler_bits(&sampler, dimension[i]);
  independent[i] = rng_bits(rng_key(settings->seed, pixel[i], sample[i]), dimension[i]);
}

__kernel void dimensions(uint count, __global uint *sobol) {
  if (get_global_id(0) < count) sobol[0] = SOBOL_DIMENSIONS;
}

// The same as a point.
__kernel void points(uint count, __global const Settings* settings, __global const uint* pixel, __global const ulong* sample,
                     __global const uint* dimension, __global float2* point) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Sampler sampler = sampler_begin(settings, pixel[i], sample[i]);
  point[i] = sampler_2d(&sampler, dimension[i]);
}
