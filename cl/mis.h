// Multiple importance sampling: the power heuristic with exponent 2 (Veach 1995).
#ifndef OCLAIR_MIS_H
#define OCLAIR_MIS_H

#include "features.h"
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

// Weight of light that a path has found by scattering with density `scattering` > 0 where sampling the lights has density `light`.
// With BSDF_SAMPLING it has all that it can find, and sampling the lights what no scattering can.
INLINE float mis_scattering_weight(float scattering, float light) {
  if (APPROXIMATES(BSDF_SAMPLING)) return 1.0f;
  return mis_power(scattering, light);
}

// And of light that was found by sampling the lights with density `light` > 0.
INLINE float mis_light_weight(float light, float scattering) {
  if (APPROXIMATES(BSDF_SAMPLING)) return scattering > 0.0f ? 0.0f : 1.0f;
  return mis_power(light, scattering);
}

#endif
