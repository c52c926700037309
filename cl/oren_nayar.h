// Oren-Nayar diffuse reflection of rough surfaces (Oren and Nayar 1994): the full model with interreflection, and the
// qualitative one that is often used in its place. Algebraic: no tangent of an angle near 90 degrees, no azimuth at the pole.
// Local frame, wo.z > 0; sigma, in radians, is the standard deviation of the slope angle of the facets.
#ifndef OCLAIR_OREN_NAYAR_H
#define OCLAIR_OREN_NAYAR_H

#include "diffuse.h"

// What both models need of two directions. alpha is the larger, beta the smaller of the two angles to the normal.
typedef struct OrenNayarAngles {
  float cos_azimuth;       // of the difference of the azimuths; 0 where one direction is the normal
  float sin_alpha;
  float tan_beta;          // at most 1 / the larger cosine, which is what keeps it finite
  float sum;               // sin_alpha sin_beta cos_azimuth = wi.wo - cos_i cos_o
  float larger_cosine;     // cos beta
} OrenNayarAngles;

INLINE OrenNayarAngles oren_nayar_angles(float3 wo, float3 wi) {
  OrenNayarAngles a;
  float sin_o = length(wo.xy), sin_i = length(wi.xy);
  float product = sin_o * sin_i;
  a.sum = dot(wo.xy, wi.xy);
  a.cos_azimuth = product >= FLT_MIN ? clamp(a.sum / product, -1.0f, 1.0f) : 0.0f;
  a.larger_cosine = fmax(wo.z, wi.z);
  a.sin_alpha = fmax(sin_o, sin_i);
  a.tan_beta = a.larger_cosine >= FLT_MIN ? fmin(sin_o, sin_i) / a.larger_cosine : 0.0f;
  return a;
}

// pi f of the qualitative model (eq. 30).
INLINE float3 oren_nayar_fast_factor(const Material *material, float3 wo, float3 wi) {
  float sigma2 = (float)material->roughness * material->roughness;
  float a = 1.0f - 0.5f * sigma2 / (sigma2 + REAL(0.33));
  float b = REAL(0.45) * sigma2 / (sigma2 + REAL(0.09));
  OrenNayarAngles angles = oren_nayar_angles(wo, wi);
  float t = angles.larger_cosine >= FLT_MIN ? fmax(angles.sum, 0.0f) / angles.larger_cosine : 0.0f;
  return unpack3(material->reflectance) * fma(b, t, a);
}

// pi f of the full model (eqs. 27 to 29): single scattering L1 and twofold interreflection L2. From sigma 0.67 on
// the fit dips below 0 for dark surfaces where both directions graze on opposite sides: there it is 0.
INLINE float3 oren_nayar_factor(const Material *material, float3 wo, float3 wi) {
  float sigma2 = (float)material->roughness * material->roughness;
  OrenNayarAngles angles = oren_nayar_angles(wo, wi);
  float sin_o = length(wo.xy), sin_i = length(wi.xy);
  float theta_o = atan2(sin_o, wo.z), theta_i = atan2(sin_i, wi.z);
  float alpha = fmax(theta_o, theta_i), beta = fmin(theta_o, theta_i);
  float beta2 = 2.0f * INV_PI * beta;
  float rough = sigma2 / (sigma2 + REAL(0.09));
  float c1 = 1.0f - 0.5f * sigma2 / (sigma2 + REAL(0.33));
  float c2 = REAL(0.45) * rough * (angles.cos_azimuth >= 0.0f ? angles.sin_alpha : angles.sin_alpha - beta2 * beta2 * beta2);
  float ab = 4.0f * INV_PI * INV_PI * alpha * beta;
  float c3 = 0.125f * rough * ab * ab;
  float tan_half = (sin_o + sin_i) / fmax(wo.z + wi.z, FLT_MIN);  // tan((alpha + beta)/2)
  float single = c1 + angles.cos_azimuth * c2 * angles.tan_beta + (1.0f - fabs(angles.cos_azimuth)) * c3 * tan_half;
  float twofold = REAL(0.17) * sigma2 / (sigma2 + REAL(0.13)) * (1.0f - angles.cos_azimuth * beta2 * beta2);
  float3 albedo = unpack3(material->reflectance);
  return fmax(albedo * single + albedo * albedo * twofold, 0.0f);
}

#endif
