#include "../cl/rng.h"

__kernel void unit(uint count, __global const uint *bits, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = rng_unit(bits[i]);
}

__kernel void mixed(uint count, __global const ulong *z, __global ulong *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = rng_mix(z[i]);
}

__kernel void key(uint count, __global const ulong *seed, __global const uint *pixel, __global const ulong *sample,
                  __global ulong *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = rng_key(seed[i], pixel[i], sample[i]);
}

// The numbers of one dimension in both forms.
__kernel void draw(uint count, __global const ulong *keys, __global const uint *dimension, __global ulong *bits,
                   __global float2 *point) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  bits[i] = rng_bits(keys[i], dimension[i]);
  point[i] = rng_point(bits[i]);
}

__kernel void key_of_sample(uint count, ulong seed, __global const uint *pixel, ulong sample, __global ulong *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = rng_key(seed, pixel[i], sample);
}
