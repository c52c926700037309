// The numbers of one camera path: where independent ones and Sobol points part.
#ifndef OCLAIR_SAMPLER_H
#define OCLAIR_SAMPLER_H

#include "features.h"
#include "rng.h"
#include "sobol.h"

typedef struct Sampler {
  ulong key;      // of the path
  ulong replica;  // of its replica: what is random about the nets
  uint index;     // of the sample in its replica
  bool sobol;
} Sampler;

// Sample number `sample` of a pixel, which is numbered as in pixel_stream.
INLINE Sampler sampler_begin(__global const Settings *settings, uint pixel, ulong sample) {
  Sampler s;
  s.key = rng_key(settings->seed, pixel, sample);
  s.index = (uint)sample % REPLICA_SAMPLES;
  bool known = HAS(SOBOL);
  s.sobol = known && settings->sampler == SAMPLER_SOBOL;
  s.replica = s.sobol ? rng_bits(rng_key(settings->seed, pixel, sample - s.index), DIMENSION_REPLICA) : 0ul;
  return s;
}

// Nets for the film, the lens and the first vertices of a path; what follows depends on so many numbers that a net in two of
// them brings nothing (docs/decisions/sampler.md).
#define SOBOL_VERTICES 2
#define SOBOL_DIMENSIONS (DIMENSION_VERTEX + SOBOL_VERTICES * DIMENSIONS_PER_VERTEX)

// 64 random bits, the coordinates of a point in 32 each. Of a Sobol point the first digits are those of its net, the others,
// in which the points of a replica have nothing to do with each other, are the independent ones.
OUT_OF_LINE ulong sampler_bits(const Sampler *s, uint dimension) {
  ulong bits = rng_bits(s->key, dimension);
  if (!HAS(SOBOL) || !s->sobol || dimension >= SOBOL_DIMENSIONS) return bits;
  uint2 point = sobol_point(s->index, rng_bits(s->replica, dimension));
  ulong digits = (ulong)point.x << 32 | point.y;
  return digits << (32 - REPLICA_BITS) | (bits & (0x100000001ul * (0xffffffffu >> REPLICA_BITS)));
}

INLINE float2 sampler_2d(const Sampler *s, uint dimension) { return rng_point(sampler_bits(s, dimension)); }

#endif
