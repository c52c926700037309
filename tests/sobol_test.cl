#include "../cl/sobol.h"

__kernel void scramble(uint count, __global const uint *digits, __global const uint *tree, __global uint *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = sobol_scramble(digits[i], tree[i]);
}

__kernel void scramble_and_reverse(uint count, __global const uint *digits, __global const uint *tree, __global uint *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = sobol_scramble_and_reverse(digits[i], tree[i]);
}

__kernel void points(uint count, __global const uint *index, __global const ulong *trees, __global uint2 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = sobol_point(index[i], trees[i]);
}

__kernel void second(uint count, __global const uint* digits, __global uint* result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = sobol_second(digits[i]);
}
