// The stages of path.h, each as a kernel of its own over arrays of paths: what a schedule for wide GPUs would launch, and what
// tests reach one by one. One path per pixel of the tile-ordered range [base, base + global size). tests/stages_image checks that
// running them in a loop gives the megakernel's film, bit for bit.
#include "path.h"
#include "pixel.h"

#define STAGE __kernel __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) void

INLINE Sampler sampler_of(__global const Settings *settings, Pixel pixel, ulong sample) {
  return sampler_begin(settings, pixel_stream(settings, pixel), sample);
}

STAGE camera_rays(SCENE_ARGUMENTS, __global PathState *paths, uint base, ulong sample) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(settings, base + (uint)get_global_id(0));
  const Sampler sampler = sampler_of(settings, pixel, sample);
  PathState path = path_begin(&scene, pixel.x, pixel.y, &sampler);
  if (!pixel.inside) path.alive = 0;
  paths[get_global_id(0)] = path;
}

STAGE closest_hits(SCENE_ARGUMENTS, __global const PathState *paths, __global Hit *hits) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  PathState path = paths[get_global_id(0)];
  if (path.alive) hits[get_global_id(0)] = traverse_closest(&scene, &path.ray);
}

// A path that is not alive leaves a shadow ray that brings nothing.
STAGE shade(SCENE_ARGUMENTS, __global PathState *paths, __global const Hit *hits, __global ShadowRay *shadows, uint base,
            ulong sample) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(settings, base + (uint)get_global_id(0));
  const Sampler sampler = sampler_of(settings, pixel, sample);
  PathState path = paths[get_global_id(0)];
  if (!path.alive) {
    shadows[get_global_id(0)].contribution = pack3((float3)(0.0f));
    return;
  }
  shadows[get_global_id(0)] = path_shade(&scene, &path, hits[get_global_id(0)], &sampler);
  paths[get_global_id(0)] = path;
}

STAGE shadow_rays(SCENE_ARGUMENTS, __global PathState *paths, __global const ShadowRay *shadows, uint base, ulong sample) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(settings, base + (uint)get_global_id(0));
  const Sampler sampler = sampler_of(settings, pixel, sample);
  ShadowRay shadow = shadows[get_global_id(0)];
  if (!path_has_shadow_ray(&shadow)) return;
  PathState path = paths[get_global_id(0)];
  uint rays = 0;
  path_add_light(&path, &shadow, path_visibility(&scene, &shadow, &sampler, &rays));
  paths[get_global_id(0)] = path;
}

STAGE accumulate(SCENE_ARGUMENTS, __global const PathState *paths, __global FilmPixel *film, __global FilmMoments *moments,
                 __global FilmErrors *errors, uint base, ulong sample) {
  const Scene scene = SCENE_FROM_ARGUMENTS;
  const Pixel pixel = pixel_from_index(scene.settings, base + (uint)get_global_id(0));
  if (!pixel.inside) return;
  PathState path = paths[get_global_id(0)];
  film_add(film + pixel.index, HAS(MOMENTS) ? moments + pixel.index : 0, path_sample(&path, settings), path.hit_anything,
           settings->film_exponent);
  film_end_sample(film + pixel.index, errors + pixel.index, sample);
}
