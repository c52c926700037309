#include "../cl/camera.h"

__kernel void rays(uint count, __global const Camera *camera, __global const float *x, __global const float *y, __global Ray *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Camera c = *camera;
  result[i] = camera_ray(&c, x[i], y[i], (float2)(0.0f));
}

__kernel void enter(uint count, __global Ray *rays) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Ray ray = rays[i];
  camera_enter_scene(&ray);
  rays[i] = ray;
}

// Sample i of the pixel (x, y).
__kernel void samples(uint count, __global const Camera *camera, __global const Settings *settings, __global const FilterEntry *filter, uint x, uint y,
                      __global Ray *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.camera = camera, .settings = settings, .filter = filter};
  const Sampler sampler = sampler_begin(settings, y * settings->film_width + x, i);
  result[i] = camera_sample(&scene, x, y, &sampler);
}
