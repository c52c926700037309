#include "../cl/oren_nayar.h"

// x, y, z: f times the cosine of wi; w: pi f of red.
__kernel void full(uint count, __global const Material *materials, __global const float4 *wo, __global const float4 *wi,
                   __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const float3 factor = oren_nayar_factor(&material, wo[i].xyz, wi[i].xyz);
  result[i] = (float4)(diffuse_eval(factor, wi[i].xyz), factor.x);
}

__kernel void fast(uint count, __global const Material *materials, __global const float4 *wo, __global const float4 *wi,
                   __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const float3 factor = oren_nayar_fast_factor(&material, wo[i].xyz, wi[i].xyz);
  result[i] = (float4)(diffuse_eval(factor, wi[i].xyz), factor.x);
}
