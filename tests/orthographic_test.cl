#include "../cl/camera.h"

__kernel void rays(uint count, __global const Camera *camera, __global const float *x, __global const float *y,
                   __global Ray *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Camera c = *camera;
  result[i] = camera_ray(&c, x[i], y[i], (float2)(0.0f));
}
