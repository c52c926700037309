// The film: exact sums. A sample is rounded once, to a multiple of 2^(exponent - FILM_FRACTION_BITS), and from there on the
// arithmetic is integer: the sum depends on the set of samples alone. docs/decisions/film.md derives the widths.
#ifndef OCLAIR_FILM_H
#define OCLAIR_FILM_H

#include "features.h"
#include "vector.h"

// A sample that the film takes: finite, not negative, below 2^(exponent + FILM_HEADROOM_BITS). By bits: no compiler flag can
// fold this away.
INLINE bool film_accepts(stored_float x, int exponent) {
  uint bits = as_uint(x);
  uint limit_exponent = (uint)clamp(exponent + FILM_HEADROOM_BITS + 127, 1, 255);
  return bits == 0x80000000u || bits < (limit_exponent << 23);
}

// |x| = mantissa 2^result, for finite x.
INLINE int film_split(stored_float x, ulong *mantissa) {
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

// The sample, scaled down so that no channel is above the limit, >= FLT_MIN: its hue stays. What is not finite or negative stays
// as it is, for the film to reject. Divided first: limit / largest may be below all floats.
INLINE float3 film_clamped(float3 radiance, float limit) {
  float largest = max_component(radiance);
  float least = fmin(fmin(radiance.x, radiance.y), radiance.z);
  return largest > limit && largest <= FLT_MAX && least >= 0.0f ? radiance / largest * limit : radiance;
}

// Adds one sample to a pixel, or counts it as rejected: one bad sample must not spoil the pixel for ever.
OUT_OF_LINE void film_add(__global FilmPixel *pixel, __global FilmMoments *moments, float3 radiance, bool hit, int exponent) {
  stored_float channel[3] = {radiance.x, radiance.y, radiance.z};
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

// a + b + *carry, and what it carries, 0 or 1.
INLINE ulong film_carry(ulong a, ulong b, ulong *carry) {
  ulong sum = a + b;
  ulong overflow = sum < a;
  sum += *carry;
  *carry = overflow | (sum < *carry);
  return sum;
}

INLINE void film_add_limbs(__global ulong *sum, ulong limb0, ulong limb1, ulong limb2) {
  ulong carry = 0;
  sum[0] = film_carry(sum[0], limb0, &carry);
  sum[1] = film_carry(sum[1], limb1, &carry);
  sum[2] = film_carry(sum[2], limb2, &carry);
}

// sum += (high 2^64 + low)^2 2^-SQUARE_SHIFT, rounded to nearest, ties up; high < 2^63. The sum has three limbs. (Of shifts
// over two limbs clang makes an intrinsic that oclgrind lacks: so the product of both halves is added twice, and the shifted
// square in two parts.)
#define SQUARE_SHIFT (2 * (FILM_FRACTION_BITS - FILM_SQUARE_FRACTION_BITS))
INLINE void film_add_square(__global ulong *sum, ulong low, ulong high) {
  ulong carry = 0;
  ulong limb0 = film_carry(low * low, 1ul << (SQUARE_SHIFT - 1), &carry);
  ulong limb1 = film_carry(mul_hi(low, low), high * low, &carry);
  ulong limb2 = film_carry(high * high, mul_hi(high, low), &carry);
  ulong limb3 = mul_hi(high, high) + carry;
  carry = 0;
  limb1 = film_carry(limb1, high * low, &carry);
  limb2 = film_carry(limb2, mul_hi(high, low), &carry);
  limb3 += carry;
  film_add_limbs(sum, limb0 >> SQUARE_SHIFT, limb1 >> SQUARE_SHIFT, limb2 >> SQUARE_SHIFT);
  film_add_limbs(sum, limb1 << (64 - SQUARE_SHIFT), limb2 << (64 - SQUARE_SHIFT), limb3 << (64 - SQUARE_SHIFT));
}

// After the sample of that number, rejected or not: the last one of a replica completes it. Its sum is what the pixel has
// gained since the replica before.
OUT_OF_LINE void film_end_sample(__global const FilmPixel *pixel, __global FilmErrors *errors, ulong sample) {
  if ((sample + 1ul) % REPLICA_SAMPLES != 0ul) return;
  for (int c = 0; c < 3; ++c) {
    ulong low = pixel->sum[c][0], high = pixel->sum[c][1];
    ulong low_before = errors->sum[c][0], high_before = errors->sum[c][1];
    film_add_square(errors->square[c], low - low_before, high - high_before - (low < low_before));
    errors->sum[c][0] = low;
    errors->sum[c][1] = high;
  }
}

#endif
