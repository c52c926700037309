// The film: exact sums. A sample is rounded once, to a multiple of 2^(exponent - FILM_FRACTION_BITS), and from there on the
// arithmetic is integer: the sum depends on the set of samples alone. docs/decisions/film.md derives the widths.
#ifndef OCLAIR_FILM_H
#define OCLAIR_FILM_H

#include "features.h"
#include "vector.h"

// A sample that the film takes: finite, not negative, below 2^(exponent + FILM_HEADROOM_BITS). By bits: no compiler flag can
// fold this away.
INLINE bool film_accepts(float x, int exponent) {
  uint bits = as_uint(x);
  uint limit_exponent = (uint)clamp(exponent + FILM_HEADROOM_BITS + 127, 1, 255);
  return bits == 0x80000000u || bits < (limit_exponent << 23);
}

// |x| = mantissa 2^result, for finite x.
INLINE int film_split(float x, ulong *mantissa) {
  uint bits = as_uint(x) & 0x7fffffffu;
  uint biased = bits >> 23;
  *mantissa = biased ? (bits & 0x7fffffu) | 0x800000u : bits;
  return (int)max(biased, 1u) - 150;
}

// sum += value 2^shift, rounded to nearest, ties up. sum has `limbs` 64-bit limbs, least significant first; value < 2^48.
INLINE void film_accumulate(__global ulong *sum, int limbs, ulong value, int shift) {
  if (shift < 0) {
    value = shift > -64 ? (value + (1ul << (-shift - 1))) >> -shift : 0ul;
    shift = 0;
  }
  int limb = shift >> 6;
  int bit = shift & 63;
  ulong low = value << bit;
  ulong high = bit ? value >> (64 - bit) : 0ul;
  ulong carry = 0;
  for (int i = limb; i < limbs; ++i) {
    ulong add = i == limb ? low : (i == limb + 1 ? high : 0ul);
    ulong before = sum[i];
    ulong after = before + add;
    ulong overflow = after < before;
    after += carry;
    overflow |= after < carry;
    sum[i] = after;
    carry = overflow;
  }
}

// Adds one sample to a pixel, or counts it as rejected: one bad sample must not spoil the pixel for ever.
INLINE void film_add(__global FilmPixel *pixel, __global FilmMoments *moments, float3 radiance, bool hit, int exponent) {
  float channel[3] = {radiance.x, radiance.y, radiance.z};
  if (!film_accepts(channel[0], exponent) || !film_accepts(channel[1], exponent) || !film_accepts(channel[2], exponent)) {
    pixel->rejected += 1;
    return;
  }
  pixel->hits += hit;
  ulong mantissa[3];
  int power[3];
  for (int c = 0; c < 3; ++c) {
    power[c] = film_split(channel[c], &mantissa[c]);
    film_accumulate(pixel->sum[c], 2, mantissa[c], power[c] - (exponent - FILM_FRACTION_BITS));
  }
  if (!HAS(MOMENTS)) return;
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b)
      film_accumulate(moments->product[MOMENT_INDEX(a, b)], 3, mantissa[a] * mantissa[b],
                      power[a] + power[b] - 2 * (exponent - FILM_MOMENT_FRACTION_BITS));
}

#endif
