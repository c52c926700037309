#include "../cl/film.h"

// Work item i adds samples [i * per_pixel, (i + 1) * per_pixel) to pixel place[i], each `repeat` times.
__kernel void add(uint count, __global const uint *place, __global const packed_float3 *samples, uint per_pixel, uint repeat, int exponent,
                  __global FilmPixel *pixels, __global FilmMoments *moments) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  for (uint k = 0; k < per_pixel; ++k)
    for (uint r = 0; r < repeat; ++r)
      film_add(pixels + place[i], moments + place[i], unpack3(samples[i * per_pixel + k]), (k & 1u) == 0u, exponent);
}

// The same for samples that follow each other from number `first` on: `errors` gets the replicas that they complete.
__kernel void add_in_replicas(uint count, __global const packed_float3 *samples, uint per_pixel, ulong first, int exponent,
                              __global FilmPixel *pixels, __global FilmErrors *errors) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  for (uint k = 0; k < per_pixel; ++k) {
    film_add(pixels + i, 0, unpack3(samples[i * per_pixel + k]), true, exponent);
    film_end_sample(pixels + i, errors + i, first + k);
  }
}

__kernel void accepts(uint count, __global const float *x, __global const int *exponent, __global uint *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = film_accepts(x[i], exponent[i]);
}

__kernel void accumulate(uint count, __global ulong *sums, uint limbs, __global const ulong *value, __global const int *shift) {
  size_t i = get_global_id(0);
  if (i < count) film_accumulate(sums + i * limbs, (int)limbs, value[i], shift[i]);
}

__kernel void split(uint count, __global const float* x, __global ulong* mantissa, __global int* power) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  ulong m;
  power[i] = film_split(x[i], &m);
  mantissa[i] = m;
}

// carry: what comes in, then what goes on.
__kernel void carries(uint count, __global const ulong* a, __global const ulong* b, __global ulong* carry,
                      __global ulong* sum) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  ulong c = carry[i];
  sum[i] = film_carry(a[i], b[i], &c);
  carry[i] = c;
}

// Three limbs to each of three.
__kernel void add_limbs(uint count, __global ulong* sums, __global const ulong* limbs) {
  size_t i = get_global_id(0);
  if (i < count) film_add_limbs(sums + 3 * i, limbs[3 * i], limbs[3 * i + 1], limbs[3 * i + 2]);
}

__kernel void add_square(uint count, __global ulong* sums, __global const ulong* low, __global const ulong* high) {
  size_t i = get_global_id(0);
  if (i < count) film_add_square(sums + 3 * i, low[i], high[i]);
}

// And whether the film takes it then, at an exponent beyond which no float is too large.
__kernel void clamped(uint count, __global const packed_float3* samples, __global const float* limit,
                      __global packed_float3* result, __global uint* accepted) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float3 x = film_clamped(unpack3(samples[i]), limit[i]);
  result[i] = pack3(x);
  accepted[i] = film_accepts(x.x, 128) && film_accepts(x.y, 128) && film_accepts(x.z, 128);
}
