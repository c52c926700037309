// Probes of the arithmetic that every kernel gets from the device and from the options of build_program.
#include "../cl/types.h"

__kernel void product_less(uint count, __global const float *x, __global const float *y, __global const float *z,
                           __global float *unfused, __global float *fused) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  unfused[i] = x[i] * y[i] - z[i];
  fused[i] = fma(x[i], y[i], -z[i]);
}

__kernel void classify(uint count, __global const float *x, __global uint *by_bits, __global uint *unequal_to_itself) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  by_bits[i] = (as_uint(x[i]) & 0x7f800000u) == 0x7f800000u;
  unequal_to_itself[i] = x[i] != x[i];
}

__kernel void minimum_maximum(uint count, __global const float *x, __global const float *y, __global float *least,
                              __global float *greatest) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  least[i] = fmin(x[i], y[i]);
  greatest[i] = fmax(x[i], y[i]);
}

// Kahan 1965: the correction vanishes if the compiler may reassociate.
__kernel void kahan_sum(uint count, float term, uint terms, __global float *result) {
  if (get_global_id(0) >= count) return;
  float sum = 0.0f, correction = 0.0f;
  for (uint k = 0; k < terms; ++k) {
    float y = term - correction;
    float t = sum + y;
    correction = (t - sum) - y;
    sum = t;
  }
  result[get_global_id(0)] = sum;
}

__kernel void divide(uint count, __global const float *x, __global const float *y, __global float *quotient) {
  size_t i = get_global_id(0);
  if (i < count) quotient[i] = x[i] / y[i];
}

__kernel void square_root(uint count, __global const float *x, __global float *root) {
  size_t i = get_global_id(0);
  if (i < count) root[i] = sqrt(x[i]);
}

__kernel void multiply(uint count, __global const float *x, __global const float *y, __global float *product) {
  size_t i = get_global_id(0);
  if (i < count) product[i] = x[i] * y[i];
}

// The functions of the language that kernels call.
__kernel void functions(uint count, __global const float *x, __global const float *y, __global const float *angle,
                        __global const float *base, __global float *roots, __global float *sines, __global float *arcs,
                        __global float *lengths, __global float *powers) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  roots[i] = rsqrt(fabs(x[i]));
  sines[i] = sin(angle[i]);
  arcs[i] = atan2(x[i], y[i]);
  lengths[i] = hypot(x[i], y[i]);
  powers[i] = powr(base[i], 2.4f);
}
