// Reflectance of smooth interfaces for unpolarised light: the mean of the s and p polarisations.
#ifndef OCLAIR_FRESNEL_H
#define OCLAIR_FRESNEL_H

#include "features.h"
#include "vector.h"

// An interface as seen from the side of the incident ray.
typedef struct Interface {
  float eta;             // transmitted over incident refractive index
  float eta2;            // eta^2
  float eta2_minus_one;  // without the cancellation of eta * eta - 1
} Interface;

// eta is back over front index; front says on which side the incident ray is. From behind, the index is 1 / eta, and both
// sides follow from the one float without loss: 1 / eta^2 - 1 = -(eta^2 - 1) / eta^2.
INLINE Interface interface_from_eta(float eta, bool front) {
  Interface i;
  float eta2 = eta * eta;
  float eta2_minus_one = (eta - 1.0f) * (eta + 1.0f);
  i.eta = front ? eta : 1.0f / eta;
  i.eta2 = front ? eta2 : 1.0f / eta2;
  i.eta2_minus_one = front ? eta2_minus_one : -eta2_minus_one / eta2;
  return i;
}

typedef struct Fresnel {
  float reflectance;
  float transmittance;  // computed on its own: 1 - reflectance has no digits left at grazing incidence
  float cos_t;          // cosine of the transmitted angle, >= 0; 0 under total reflection
} Fresnel;

// Schlick 1994, eq. 15: r0 + (1 - r0)(1 - cos)^5, where cos is that of the larger angle, on the side of the thinner medium.
INLINE float fresnel_schlick(float cosine, float r0) {
  float x = fmax(1.0f - cosine, 0.0f), x2 = x * x;
  return fma(1.0f - r0, x2 * x2 * x, r0);
}

// Schlick's approximation in place of the exact equations. Angles and total reflection stay exact.
INLINE Fresnel fresnel_approximated(Fresnel exact, float cos_i, Interface i) {
  // Total reflection is told by cos_t: where nothing but the sign of the transmittance is used, LLVM 19 of PoCL 6.0 fails.
  if (!(exact.cos_t > 0.0f) || i.eta2_minus_one == 0.0f) return exact;
  float root = i.eta2_minus_one / ((i.eta + 1.0f) * (i.eta + 1.0f));  // (eta - 1)/(eta + 1)
  exact.reflectance = fresnel_schlick(i.eta < 1.0f ? exact.cos_t : cos_i, root * root);
  exact.transmittance = 1.0f - exact.reflectance;
  return exact;
}

// Exact Fresnel equations for cos_i in [0, 1]. Written in g = eta cos_t without a subtraction of nearly equal amplitudes: with
// c = cos_i, r_s = (c - g)/(c + g) = -(eta^2 - 1)/(c + g)^2 and r_p = (eta^2 c - g)/(eta^2 c + g), whose numerator is
// (eta^2 - 1)(eta^2 c^2 - s^2)/(eta^2 c + g). (Born and Wolf 1999, 1.5.2; the rearrangement is derived in docs/kernels.md.)
INLINE Fresnel fresnel_dielectric_exact(float cos_i, Interface i) {
  Fresnel f = {1.0f, 0.0f, 0.0f};
  float c = cos_i;
  if (i.eta2_minus_one == 0.0f) {
    f.reflectance = 0.0f;
    f.transmittance = 1.0f;
    f.cos_t = c;
    return f;
  }
  float sin2 = (1.0f - c) * (1.0f + c);
  float g2 = i.eta2 < 0.5f ? i.eta2 - sin2 : fma(c, c, i.eta2_minus_one);
  if (!(g2 > 0.0f)) return f;  // total internal reflection
  float g = sqrt(g2);
  float p = c + g;
  float q = fma(i.eta2, c, g);
  float inverse_p2 = 1.0f / (p * p);
  float inverse_q2 = 1.0f / (q * q);
  float rs = i.eta2_minus_one * inverse_p2;
  float rp = i.eta2_minus_one * fma(i.eta2 * c, c, -sin2) * inverse_q2;
  f.reflectance = 0.5f * fma(rs, rs, rp * rp);
  f.transmittance = 2.0f * c * g * fma(i.eta2, inverse_q2, inverse_p2);
  f.cos_t = g / i.eta;
  return f;
}

INLINE Fresnel fresnel_dielectric(float cos_i, Interface i) {
  Fresnel f = fresnel_dielectric_exact(cos_i, i);
  return APPROXIMATES(SCHLICK) ? fresnel_approximated(f, cos_i, i) : f;
}

// Exact Fresnel equations for a conductor with complex index eta + i k relative to the medium outside (Born and Wolf 1999,
// 14.2), cos_i = c in [0, 1], s = sin_i. With a + i b = sqrt((eta + i k)^2 - s^2), r_s = (c - (a + i b))/(c + (a + i b)) and
// r_p = r_s ((a + i b) c - s^2)/((a + i b) c + s^2). Moduli are sums of squares: their expanded form, modulus + c^2 - 2 a c,
// cancels where the index is near 1. hypot and the stable root of the quadratic keep it finite up to k = 1e19.
INLINE float fresnel_conductor_exact(float cos_i, float eta, float k) {
  float c = cos_i;
  float sin2 = (1.0f - c) * (1.0f + c);
  float real = eta < 0.7f ? fma(eta - k, eta + k, -sin2) : fma(c, c, fma(-k, k, (eta - 1.0f) * (eta + 1.0f)));  // a^2 - b^2
  float product = eta * k;                                                                                      // a b
  float larger = sqrt(0.5f * (hypot(real, 2.0f * product) + fabs(real)));
  float smaller = larger > 0.0f ? product / larger : 0.0f;
  float a = real >= 0.0f ? larger : smaller;
  float b = real >= 0.0f ? smaller : larger;
  float s_down = fma(a + c, a + c, b * b);
  float rs = s_down > 0.0f ? fma(a - c, a - c, b * b) / s_down : 0.0f;
  float up = fma(a, c, -sin2), down = fma(a, c, sin2), bc = b * c;
  float p_down = fma(down, down, bc * bc);
  float rp = p_down > 0.0f ? rs * (fma(up, up, bc * bc) / p_down) : rs;  // at normal incidence both are the same
  return 0.5f * (rs + rp);
}

// Reflectance at normal incidence: ((eta - 1)^2 + k^2)/((eta + 1)^2 + k^2).
INLINE float fresnel_conductor_normal(float eta, float k) {
  float below = hypot(eta - 1.0f, k), above = hypot(eta + 1.0f, k);
  float ratio = below / above;
  return ratio * ratio;
}

INLINE float fresnel_conductor(float cos_i, float eta, float k) {
  return APPROXIMATES(SCHLICK) ? fresnel_schlick(cos_i, fresnel_conductor_normal(eta, k)) : fresnel_conductor_exact(cos_i, eta, k);
}

INLINE float3 fresnel_conductor_rgb(float cos_i, float3 eta, float3 k) {
  return (float3)(fresnel_conductor(cos_i, eta.x, k.x), fresnel_conductor(cos_i, eta.y, k.y),
                  fresnel_conductor(cos_i, eta.z, k.z));
}

#endif
