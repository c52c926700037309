#include "../cl/fresnel.h"

// What the option chooses, and the exact equations beside it: reflectance, transmittance, cosine of the transmitted direction.
__kernel void dielectric(uint count, __global const float *cosine, __global const float *eta, __global const uint *front,
                         __global float4 *chosen, __global float4 *exact) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Interface between = interface_from_eta(eta[i], front[i] != 0);
  const Fresnel a = fresnel_dielectric(cosine[i], between), b = fresnel_dielectric_exact(cosine[i], between);
  chosen[i] = (float4)(a.reflectance, a.transmittance, a.cos_t, 0.0f);
  exact[i] = (float4)(b.reflectance, b.transmittance, b.cos_t, 0.0f);
}

__kernel void conductor(uint count, __global const float *cosine, __global const float *eta, __global const float *k,
                        __global float *chosen, __global float *exact) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  chosen[i] = fresnel_conductor(cosine[i], eta[i], k[i]);
  exact[i] = fresnel_conductor_exact(cosine[i], eta[i], k[i]);
}
