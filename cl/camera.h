// The cameras: pinhole, thin lens and orthographic.
#ifndef OCLAIR_CAMERA_H
#define OCLAIR_CAMERA_H

#include "filter.h"
#include "sampler.h"
#include "warp.h"

// Moves a ray's origin forward to the box [-1, 1]^3 that holds the scene, if it lies outside: the conservative box test and the
// triangle test then work on coordinates below 1 + 2^-15, however far away the camera is. The way is computed to 3 u of its length:
// each step stops 16 u short, so that nothing in the box is passed over, from up to 2^25 away (there the rounding of the first stop
// takes the ray 2^-18 off its line); after three steps at most 2^-60 of the way is left. A ray that misses the box is moved beyond it.
INLINE void camera_enter_scene(Ray *ray) {
  float3 o = unpack3(ray->origin), d = unpack3(ray->direction);
  float3 reciprocal = 1.0f / copysign(fmax(fabs(d), (float3)(0x1p-40f)), d);
  float3 side = -copysign((float3)(1.0f + 0x1p-16f), d);
  for (int step = 0; step < 3; ++step) {
    float enter = max_component((side - o) * reciprocal);
    if (!(enter > 0.0f)) break;
    enter = fma(enter, -0x1p-20f, enter);
    o = fma(d, (float3)(enter), o);
    ray->t_max -= enter;
  }
  ray->origin = pack3(o);
}

// Ray through film position (x, y) in pixels, between the clip planes. lens: where on the lens, in [0, 1)^2. All rays through the
// lens that belong to one film position meet in the plane of focus.
INLINE Ray camera_ray(const Camera *camera, float x, float y, float2 lens) {
  float3 along = unpack3(camera->corner) + x * unpack3(camera->step_x) + y * unpack3(camera->step_y);
  float3 origin = unpack3(camera->origin);
  if (HAS(ORTHOGRAPHIC) && camera->orthographic) {
    origin += along;
    along = unpack3(camera->axis);
  } else if (HAS(THIN_LENS) && camera->aperture_radius > 0.0f) {
    float2 p = camera->aperture_radius * warp_disk(lens);
    float3 on_lens = normalize(unpack3(camera->step_x)) * p.x + normalize(unpack3(camera->step_y)) * p.y;
    origin += on_lens;
    along -= on_lens / camera->focus_distance;
  }
  float stretch = length(along);  // per unit of depth
  float3 d = along / stretch;
  Ray ray;
  ray.direction = pack3(d);
  ray.origin = pack3(fma(d, (float3)(camera->near_clip * stretch), origin));
  ray.t_max = fmin(((float)camera->far_clip - camera->near_clip) * stretch, INFINITE_DISTANCE);
  ray.skip = NONE;
  ray.target = NONE;
  ray.t_min = 0.0f;
  ray.passed = 0u;
  camera_enter_scene(&ray);
  return ray;
}

// Ray of a sample of the pixel (x, y) of the full film.
OUT_OF_LINE Ray camera_sample(const Scene *scene, uint x, uint y, const Sampler *sampler) {
  __global const Settings *settings = scene->settings;
  float2 u = sampler_2d(sampler, DIMENSION_FILM);
  float radius = settings->filter_radius;
  float2 center = (float2)((float)x + 0.5f, (float)y + 0.5f);
  float2 low = (float2)(settings->crop_x, settings->crop_y) - center;
  float2 high = low + (float2)(settings->crop_width, settings->crop_height);
  if (settings->sample_border) {
    low = (float2)(-radius);
    high = (float2)(radius);
  }
  float2 offset = (float2)(filter_sample(scene->filter, settings->filter_count, radius, low.x, high.x, u.x),
                           filter_sample(scene->filter, settings->filter_count, radius, low.y, high.y, u.y));
  Camera camera = *scene->camera;
  float2 lens = HAS(THIN_LENS) ? sampler_2d(sampler, DIMENSION_LENS) : (float2)(0.0f);
  return camera_ray(&camera, center.x + offset.x, center.y + offset.y, lens);
}

#endif
