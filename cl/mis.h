// Multiple importance sampling: the power heuristic with exponent 2 (Veach 1995).
#ifndef OCLAIR_MIS_H
#define OCLAIR_MIS_H

#include "vector.h"

// Weight of the strategy with density a against one with density b: a^2 / (a^2 + b^2), by ratios, so that it neither
// overflows (a > 1.8e19) nor becomes 0/0 (both < 1e-23). Densities >= 0, infinity allowed; 0 when both are 0.
INLINE float mis_power(float a, float b) {
  if (!(a > 0.0f)) return 0.0f;
  if (a > b) {
    float r = b / a;
    return 1.0f / fma(r, r, 1.0f);
  }
  if (a == b) return 0.5f;
  float r = a / b;
  return r * r / fma(r, r, 1.0f);
}

#endif
