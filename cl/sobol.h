// Owen-scrambled Sobol points: 2^REPLICA_BITS points of the unit square such that each rectangle of that part of its area
// whose sides are dyadic intervals holds exactly one of them, (0, m, 2)-nets (Sobol 1967; Niederreiter 1992), randomised so
// that each point is uniform (Owen 1995). As in Burley 2020, "Practical Hash-based Owen Scrambling", every pair of dimensions
// has a net of its own in an order of its own. With so few points a scrambling is not hashed digit by digit: it is a binary
// tree of random bits, which fits a word.
#ifndef OCLAIR_SOBOL_H
#define OCLAIR_SOBOL_H

#include "vector.h"

#if REPLICA_BITS != 4
#error "sobol.h is written for nets of 16 points"
#endif

// Owen's scrambling of m = REPLICA_BITS binary digits, the first one highest: a digit is flipped or not by a bit for the
// digits before it. Bit 1 of the tree is for the first digit, bits 2 and 3 for the second one, and so on; the lowest 2^m bits
// of the word are read.
INLINE uint sobol_scramble(uint digits, uint tree) {
  uint flips = 0;
  for (uint level = 0; level < REPLICA_BITS; ++level)
    flips = flips << 1 | (tree >> ((digits | REPLICA_SAMPLES) >> (REPLICA_BITS - level)) & 1u);
  return digits ^ flips;
}

// The same, the first digit lowest in what is returned. (Of a reversal by itself clang makes an intrinsic that oclgrind lacks.)
INLINE uint sobol_scramble_and_reverse(uint digits, uint tree) {
  uint reversed = 0;
  for (uint level = 0; level < REPLICA_BITS; ++level) {
    uint flip = tree >> ((digits | REPLICA_SAMPLES) >> (REPLICA_BITS - level));
    reversed |= ((digits >> (REPLICA_BITS - 1 - level) ^ flip) & 1u) << level;
  }
  return reversed;
}

// Digits of the second coordinate from those of the first: a product with Pascal's triangle modulo 2, whose entry (k, j) is 1
// if the bits of k are among those of j (Lucas).
INLINE uint sobol_second(uint digits) {
  digits ^= digits << 1 & 10u;
  return digits ^ (digits << 2 & 12u);
}

// Point `index` of the net that 48 random bits choose: the order and both coordinates are scrambled. m digits of each
// coordinate.
INLINE uint2 sobol_point(uint index, ulong trees) {
  uint digits = sobol_scramble_and_reverse(index, (uint)trees);
  return (uint2)(sobol_scramble(digits, (uint)(trees >> REPLICA_SAMPLES)),
                 sobol_scramble(sobol_second(digits), (uint)(trees >> 2 * REPLICA_SAMPLES)));
}

#endif
