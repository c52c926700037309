// Random numbers as a function of (seed, pixel, sample, dimension): no state, so any split of the work gives the same image.
// The mixer is a bijection of 64 bits (Stafford's variant 13; Steele, Lea, Flood 2014, "Fast splittable pseudorandom number
// generators"), used counter-based.
#ifndef OCLAIR_RNG_H
#define OCLAIR_RNG_H

#include "vector.h"

#define RNG_GOLDEN 0x9E3779B97F4A7C15ul  // 2^64 / golden ratio: the Weyl increment of SplitMix64

// Dimensions of a path. The numbering does not depend on features: a specialised and a full kernel draw the same numbers.
enum {
  DIMENSION_FILM = 0,         // x: film x, y: film y
  DIMENSION_LENS = 1,
  DIMENSION_VERTEX = 2,       // first dimension of the first vertex
  DIMENSION_LIGHT = 0,        // x: which light, y: Russian roulette
  DIMENSION_LIGHT_POINT = 1,  // where on the light
  DIMENSION_SCATTER = 2,      // scattering direction; dielectric, x: reflect or refract
  DIMENSION_MATERIAL = 3,     // which material of a blend, whether a surface lets the path through
  DIMENSIONS_PER_VERTEX = 4,
  DIMENSION_REPLICA = 0x7fffffff  // beyond those of every path: for its replica
};

INLINE ulong rng_mix(ulong z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ul;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBul;
  return z ^ (z >> 31);
}

// Key of one camera path: distinct for all pixel < 2^31 and sample < 2^33 of one seed, because every step is a bijection.
INLINE ulong rng_key(ulong seed, uint pixel, ulong sample) {
  return rng_mix(rng_mix(seed + RNG_GOLDEN) ^ ((sample << 31) | pixel));
}

INLINE ulong rng_bits(ulong key, uint dimension) { return rng_mix(key + (dimension + 1u) * RNG_GOLDEN); }

// The top 24 bits as a float in [0, 1 - 2^-24]: 32 bits times 2^-32 would round up to 1.
INLINE float rng_unit(uint bits) { return (float)(bits >> 8) * 0x1p-24f; }

INLINE float2 rng_point(ulong bits) { return (float2)(rng_unit((uint)(bits >> 32)), rng_unit((uint)bits)); }

#endif
