// Maps from the unit square to the domains that are sampled, each with its density. u in [0, 1 - 2^-24]^2.
#ifndef OCLAIR_WARP_H
#define OCLAIR_WARP_H

#include "vector.h"

// (cos, sin) of 2 pi u for u in [0, 1]. The nearest quarter turn is removed exactly; what is left lies in [-1/8, 1/8] turns,
// where minimax polynomials err by 5.6e-11 (cos) and 3.2e-9 (sin). Unlike sincos() it needs no reduction of large arguments.
INLINE float2 warp_circle(float u) {
  float quarter = rint(4.0f * u);
  float r = fma(quarter, -0.25f, u);
  float r2 = r * r;
  float s = r * fma(fma(fma(-75.393616f, r2, 81.592354f), r2, -41.341663f), r2, 6.2831855f);
  float c = fma(fma(fma(fma(59.20282f, r2, -85.4423f), r2, 64.93931f), r2, -19.739208f), r2, 1.0f);
  int k = (int)quarter & 3;
  float2 swapped = (k & 1) ? (float2)(-s, c) : (float2)(c, s);
  return (k & 2) ? -swapped : swapped;
}

// Uniform on the unit disk.
INLINE float2 warp_disk(float2 u) { return sqrt(u.x) * warp_circle(u.y); }

INLINE float warp_disk_pdf(void) { return INV_PI; }

// Cosine-weighted on the upper hemisphere. z = sqrt(1 - u) is never 0 (u <= 1 - 2^-24) and accurate to an ulp, where
// sqrt(1 - x^2 - y^2) would lose all digits at the rim.
INLINE float3 warp_cosine_hemisphere(float2 u) {
  float2 d = warp_disk(u);
  return (float3)(d.x, d.y, sqrt(1.0f - u.x));
}

INLINE float warp_cosine_hemisphere_pdf(float cos_theta) { return cos_theta > 0.0f ? cos_theta * INV_PI : 0.0f; }

// Uniform in the cone around +z whose half angle has 1 - cos = one_minus_cos in (0, 2]. With 2 it is the whole sphere.
INLINE float3 warp_cone(float2 u, float one_minus_cos) {
  float h = u.x * one_minus_cos;
  float2 d = sqrt(h * (2.0f - h)) * warp_circle(u.y);
  return (float3)(d.x, d.y, 1.0f - h);
}

INLINE float warp_cone_pdf(float one_minus_cos) { return 1.0f / (2.0f * PI * one_minus_cos); }

// Uniform on the unit sphere.
INLINE float3 warp_sphere(float2 u) { return warp_cone(u, 2.0f); }

INLINE float warp_sphere_pdf(void) { return 0.25f * INV_PI; }

// Uniform on a triangle: barycentric coordinates (b1, b2) of vertices 1 and 2. Low distortion, no square root (Heitz 2019).
INLINE float2 warp_triangle(float2 u) {
  float2 b = u.y > u.x ? (float2)(0.5f * u.x, u.y - 0.5f * u.x) : (float2)(u.x - 0.5f * u.y, 0.5f * u.y);
  return b;
}

#endif
