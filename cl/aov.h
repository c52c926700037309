// The first surface that the camera sees, without its light: what the layers of --aov say of a pixel. "First" is as path.h has
// it: the camera ray goes through masks and through lights that are hidden; mirrors and glass are surfaces like others.
#ifndef OCLAIR_AOV_H
#define OCLAIR_AOV_H

#include "path.h"
#include "pixel.h"

// In place of random bits: a mask lets through where more than half of the light goes through, of a blend the heavier material
// counts (of blends within blends, one that is always the same).
#define AOV_NO_CHANCE 0x8000000080000000ul

typedef struct FirstSurface {
  Surface surface;
  uint material;   // NONE: absorbs everything
  uint primitive;  // NONE: there is no surface
} FirstSurface;

// By the very random numbers of the path of that sampler, or by none. Out of line: it is asked for in two places.
OUT_OF_LINE FirstSurface aov_first_surface(const Scene *scene, PathState *path, const Sampler *sampler, bool by_chance) {
  FirstSurface first;
  while (path->passes < HARD_DEPTH) {
    Hit hit = traverse_closest(scene, &path->ray);
    first.primitive = hit.primitive;
    if (hit.primitive == NONE) return first;
    first.surface = surface_from_hit(scene, &path->ray, hit);
    Shape shape = scene->shapes[first.surface.shape];
    first.material = first.surface.front ? shape.material_front : shape.material_back;
    bool passes = shape.first_light != NONE && path_hides_lights(scene, path);
    if (!passes && first.material != NONE) {
      const TexturePoint *at = &first.surface.at;
      ulong bits = by_chance ? path_surface_bits(sampler, 0u, path->passes, false) : AOV_NO_CHANCE;
      first.material = material_select(scene, first.material, at, (uint)(bits >> 32));
      passes = HAS(OPACITY) && rng_unit((uint)bits) < path_transparency(scene, path->ray, hit, first.material, *at);
    }
    if (!passes) return first;
    path_pass_through(path, hit);
  }
  first.primitive = NONE;
  return first;
}

// What --aov primitive shows: the ray through the middle of the pixel and of the lens.
INLINE uint aov_primitive(const Scene *scene, Pixel pixel) {
  Camera camera = *scene->camera;
  Sampler sampler = sampler_begin(scene->settings, pixel_stream(scene->settings, pixel), 0ul);
  PathState path = path_begin(scene, pixel.x, pixel.y, &sampler);
  path.ray = camera_ray(&camera, pixel.x + 0.5f, pixel.y + 0.5f, (float2)(0.0f));
  return aov_first_surface(scene, &path, &sampler, false).primitive;
}

INLINE void aov_add(const Scene *scene, AovPixel *sum, const PathState *path, FirstSurface first) {
  float3 direction = unpack3(path->ray.direction);
  float3 albedo = (float3)(0.0f);
  if (first.material != NONE) {
    Material material = material_at(scene, first.material, &first.surface.at);
    albedo = bsdf_albedo(&material);
    if (HAS_TANGENTS) first.surface.frame = normal_map_frame(scene, &material, &first.surface, -direction);
  }
  sum->hits += 1u;
  sum->albedo = pack3(unpack3(sum->albedo) + albedo);
  sum->normal = pack3(unpack3(sum->normal) + first.surface.frame.z);
  sum->depth += dot(first.surface.position - unpack3(scene->camera->origin), unpack3(scene->camera->axis));
  if (!HAS_TEXTURES) return;
  sum->u += first.surface.at.uv.x;
  sum->v += first.surface.at.uv.y;
}

// Samples 0, 1, ... in this order, whatever is rendered of the image: the sums have the same bits however the work is split.
INLINE AovPixel aov_pixel(const Scene *scene, Pixel pixel) {
  __global const Settings *settings = scene->settings;
  AovPixel sum = {{0.0f, 0.0f, 0.0f}, 0u, {0.0f, 0.0f, 0.0f}, aov_primitive(scene, pixel), 0.0f, 0.0f, 0.0f, pixel.index};
  for (ulong sample = 0; sample < AOV_SAMPLES; ++sample) {
    Sampler sampler = sampler_begin(settings, pixel_stream(settings, pixel), sample);
    PathState path = path_begin(scene, pixel.x, pixel.y, &sampler);
    FirstSurface first = aov_first_surface(scene, &path, &sampler, true);
    if (first.primitive != NONE) aov_add(scene, &sum, &path, first);
  }
  return sum;
}

#endif
