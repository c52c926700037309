#include "../cl/light.h"

__kernel void choose(uint count, __global const uint *cdf, uint lights, __global const uint *bits, __global uint *which) {
  size_t i = get_global_id(0);
  if (i < count) which[i] = distribution_select(cdf, lights, bits[i]);
}

typedef struct Result {
  packed_float3 direction;
  float distance;
  packed_float3 weight;
  float pdf;
  uint primitive;
} Result;

// Sample i of light which[i], seen from `from[i]`.
__kernel void sample(uint count, __global const Light *lights, __global const Quadric *quadrics, __global const Shape *shapes,
                     __global const uint *triangle_shape, __global const packed_uint3 *triangle_vertices, __global const float2 *uvs,
                     __global const Texture *textures, __global const uchar *texels, __global const float *srgb,
                     __global const uint *environment_cdf, __global const Settings *settings, __global const uint *which,
                     __global const packed_float3 *from, __global const float2 *u, __global Result *results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.lights = lights, .quadrics = quadrics, .shapes = shapes, .triangle_shape = triangle_shape,
                 .triangle_vertices = triangle_vertices, .uvs = uvs, .textures = textures, .texels = texels, .srgb = srgb,
                 .environment_cdf = environment_cdf, .settings = settings};
  Light light = lights[which[i]];
  ulong bits = (ulong)(u[i].x * 0x1p32f) << 32 | (ulong)(u[i].y * 0x1p32f);
  LightSample s = light_sample(&scene, &light, unpack3(from[i]), bits);
  Result r = {pack3(s.direction), s.distance, pack3(s.weight), s.pdf, s.primitive};
  results[i] = r;
}

__kernel void density(uint count, __global const Light *lights, __global const Quadric *quadrics, __global const uint *which,
                      __global const packed_float3 *from, __global const float *t, __global const float *cosine, __global float *pdf) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.lights = lights, .quadrics = quadrics};
  Light light = lights[which[i]];
  pdf[i] = light_pdf(&scene, &light, unpack3(from[i]), t[i], cosine[i]);
}

__kernel void falloff(uint count, __global const Light *lights, __global const packed_float3 *directions, __global float *share) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Light light = lights[i];
  share[i] = spot_falloff(&light, unpack3(directions[i]));
}

__kernel void part(uint count, __global const uint *parts, uint split, __global LightPart *results) {
  size_t i = get_global_id(0);
  if (i < count) results[i] = light_part(parts[i], split);
}

__kernel void part_at(uint count, __global const float *b1, __global const float *b2, uint split, __global uint *parts) {
  size_t i = get_global_id(0);
  if (i < count) parts[i] = light_part_at(b1[i], b2[i], split);
}
