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
__kernel void sample(uint count, __global const Light *lights, __global const Quadric *quadrics, __global const uint *which,
                     __global const packed_float3 *from, __global const float2 *u, __global Result *results) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.lights = lights, .quadrics = quadrics};
  Light light = lights[which[i]];
  LightSample s = light_sample(&scene, &light, unpack3(from[i]), u[i]);
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
