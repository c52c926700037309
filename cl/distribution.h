// Choosing one of many by given weights: distributions as 32-bit integers, made by host/distribution.cpp.
#ifndef OCLAIR_DISTRIBUTION_H
#define OCLAIR_DISTRIBUTION_H

#include "vector.h"

// First i with bits < cdf[i]: item i is chosen by the numbers from cdf[i - 1] on and below cdf[i], never one of zero width. The last
// entry counts as 2^32.
INLINE uint distribution_select(__global const uint *cdf, uint count, uint bits) {
  uint low = 0, high = count - 1;
  while (low < high) {
    uint middle = low + (high - low) / 2;
    if (bits < cdf[middle]) high = middle;
    else low = middle + 1;
  }
  return low;
}

// How many of the 2^32 numbers choose item i.
INLINE ulong distribution_width(__global const uint *cdf, uint count, uint i) {
  ulong begin = i == 0u ? 0ul : cdf[i - 1u];
  return (i + 1u == count ? 0x100000000ul : cdf[i]) - begin;
}

INLINE float distribution_probability(__global const uint *cdf, uint count, uint i) {
  return (float)distribution_width(cdf, count, i) * 0x1p-32f;
}

// Chooses by 32 random bits; *rest in (0, 1) is where in the item's share they lie, in the middle of their unit of it: a number to go on
// with. (A float has but 24 bits: items of less than 2^-24 would be passed over, or chosen too often.)
INLINE uint distribution_sample(__global const uint *cdf, uint count, uint bits, float *rest) {
  uint i = distribution_select(cdf, count, bits);
  uint begin = i == 0u ? 0u : cdf[i - 1u];
  *rest = fmin(((float)(bits - begin) + 0.5f) / distribution_width(cdf, count, i), 1.0f - 0x1p-24f);
  return i;
}

#endif
