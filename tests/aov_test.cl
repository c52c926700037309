#include "../cl/bsdf.h"

__kernel void albedo(uint count, __global const Material *materials, __global float4 *albedos) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  albedos[i] = (float4)(bsdf_albedo(&material), 0.0f);
}
