#include "../cl/thin_dielectric.h"

__kernel void sample(uint count, __global const Material *materials, __global const float4 *wo, __global const float *u,
                     __global float4 *direction_pdf, __global float4 *weight_eta) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const Scatter s = thin_dielectric_sample(&material, wo[i].xyz, u[i]);
  direction_pdf[i] = (float4)(s.wi, s.pdf);
  weight_eta[i] = (float4)(s.weight, s.eta);
}
