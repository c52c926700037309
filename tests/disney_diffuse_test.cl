#include "../cl/disney_diffuse.h"

// x, y, z: f times the cosine of wi; w: pi f of red.
__kernel void evaluate(uint count, __global const Material *materials, __global const float4 *wo, __global const float4 *wi,
                       __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const float3 factor = disney_diffuse_factor(&material, wo[i].xyz, wi[i].xyz);
  result[i] = (float4)(diffuse_eval(factor, wi[i].xyz), factor.x);
}
