// The film's reconstruction filter, sampled instead of splatted: each sample belongs to one pixel, with weight 1, at a place
// drawn with the filter as density (Ernst, Stamminger, Greiner 2006). In the mean it is the filtered image.
//
// The filter is separable and given as a table of piecewise linear density over [-radius, radius]: entry i is that at
// -radius + 2 radius i / (count - 1); the last integral is 1. Exact for box and tent.
#ifndef OCLAIR_FILTER_H
#define OCLAIR_FILTER_H

#include "scene.h"

// Integral of the density up to x in [-radius, radius].
INLINE float filter_cdf(__global const FilterEntry *table, uint count, float radius, float x) {
  float width = 2.0f * radius / (count - 1);
  float position = clamp((x + radius) / width, 0.0f, (float)(count - 1));
  uint i = min((uint)position, count - 2);
  float s = position - i;
  float f0 = table[i].density, f1 = table[i + 1].density;
  return fma(width * s, fma(0.5f * s, f1 - f0, f0), table[i].integral);
}

// Inverse of filter_cdf: the x with integral c in [0, 1].
INLINE float filter_inverse(__global const FilterEntry *table, uint count, float radius, float c) {
  // The last entry whose integral is at most c, but for the very last: one step further than where the search begins, in the mean.
  uint i = table[min((uint)(c * (count - 1)), count - 2)].first;
  while (i < count - 2 && table[i + 1].integral <= c) ++i;
  float width = 2.0f * radius / (count - 1);
  float f0 = table[i].density, f1 = table[i + 1].density;
  float area = fmax(c - table[i].integral, 0.0f) / width;
  // Root of (f1 - f0)/2 s^2 + f0 s = area without cancellation.
  float root = f0 + sqrt(fmax(fma(2.0f * area, f1 - f0, f0 * f0), 0.0f));
  float s = root > 0.0f ? fmin(2.0f * area / root, 1.0f) : 0.0f;
  return fma(i + s, width, -radius);
}

// Offset from the centre of a pixel, in [-radius, radius], inside [low, high]: what is left of the filter at the film's edge.
INLINE float filter_sample(__global const FilterEntry *table, uint count, float radius, float low, float high, float u) {
  float c0 = low <= -radius ? 0.0f : filter_cdf(table, count, radius, low);
  float c1 = high >= radius ? 1.0f : filter_cdf(table, count, radius, high);
  return clamp(filter_inverse(table, count, radius, fma(u, c1 - c0, c0)), fmax(low, -radius), fmin(high, radius));
}

#endif
