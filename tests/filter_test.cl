#include "../cl/filter.h"

__kernel void cdf(uint count, __global const FilterEntry *table, uint entries, float radius, __global const float *x, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = filter_cdf(table, entries, radius, x[i]);
}

__kernel void inverse(uint count, __global const FilterEntry *table, uint entries, float radius, __global const float *c, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = filter_inverse(table, entries, radius, c[i]);
}

__kernel void sample(uint count, __global const FilterEntry *table, uint entries, float radius, float low, float high, __global const float *u,
                     __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = filter_sample(table, entries, radius, low, high, u[i]);
}
