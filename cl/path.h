// The path tracer: camera ray, then at each vertex emission, next-event estimation and a scattered ray, both strategies
// joined by multiple importance sampling (Kajiya 1986; Veach 1997). Each stage is a function; the megakernel (path.cl) calls
// them in a loop, stages.cl makes each a kernel of its own.
#ifndef OCLAIR_PATH_H
#define OCLAIR_PATH_H

#include "bsdf.h"
#include "camera.h"
#include "film.h"
#include "light.h"
#include "material.h"
#include "normal_map.h"
#include "traverse.h"

#define HARD_DEPTH 4096u  // no path is longer: light trapped in a lossless box ends here (docs/kernels.md)
#define ROULETTE_MIN REAL(0.05)
#define ROULETTE_MAX REAL(0.95)

INLINE uint dimension_of_vertex(uint depth, uint which) { return DIMENSION_VERTEX + depth * DIMENSIONS_PER_VERTEX + which; }

INLINE PathState path_begin(const Scene *scene, uint x, uint y, const Sampler *sampler) {
  PathState path;
  path.ray = camera_sample(scene, x, y, sampler);
  path.throughput = pack3((float3)(1.0f));
  path.radiance = pack3((float3)(0.0f));
  path.eta = 1.0f;
  path.pdf = 0.0f;
  path.depth = 0;
  path.passes = 0;
  path.hit_anything = 0;
  path.alive = scene->settings->max_depth > 0u;
  return path;
}

// Emitted light that the path's own ray found, weighted against light sampling, which could have found it too.
INLINE void path_add_emission(PathState *path, float3 emitted, float light_pdf) {
  float weight = path->pdf > 0.0f ? mis_scattering_weight(path->pdf, light_pdf) : 1.0f;
  path->radiance = pack3(unpack3(path->radiance) + unpack3(path->throughput) * emitted * weight);
}

INLINE bool path_hides_lights(const Scene *scene, const PathState *path) {
  bool known = HAS(HIDDEN_EMITTERS);
  return known && scene->settings->hide_emitters && path->depth == 0u;
}

INLINE void path_escape(const Scene *scene, PathState *path) {
  __global const Settings *settings = scene->settings;
  path->alive = 0;
  bool known = HAS_ENVIRONMENT;
  bool lit = known && settings->environment_probability > 0.0f;  // the kernel may know more than the scene has
  if (!lit || path_hides_lights(scene, path)) return;
  path->hit_anything |= path->depth == 0u;
  float3 radiance = unpack3(settings->environment);
  float pdf = warp_sphere_pdf();
  if (HAS(ENVIRONMENT_MAP) && settings->environment_texture != 0u) {
    float3 d = unpack3(path->ray.direction);
    radiance = environment_radiance(scene, d);
    pdf = path->pdf > 0.0f ? environment_pdf(scene, d) : 0.0f;
  }
  path_add_emission(path, radiance, settings->environment_probability * pdf);
}

INLINE void path_emission(const Scene *scene, PathState *path, Hit hit, const Surface *surface, Shape shape) {
  if (!HAS_AREA_LIGHTS || shape.first_light == NONE || !surface->front) return;
  uint index = shape.first_light;
  if (!(hit.primitive & QUADRIC_BIT)) {
    index += (hit.primitive - shape.first_triangle) * shape.light_split * shape.light_split;
    if (HAS(TEXTURED_LIGHTS)) index += light_part_at(hit.b1, hit.b2, shape.light_split);
  }
  Light light = scene->lights[index];
  float cosine = dot(surface->geometric, -unpack3(path->ray.direction));
  float pdf = path->pdf > 0.0f ? light_pdf(scene, &light, unpack3(path->ray.origin), hit.t, cosine) : 0.0f;
  path_add_emission(path, light_radiance(scene, &light, &surface->at), pdf);
}

// The ray goes on behind what it hit, as if that were not there. It keeps its origin, so that nothing behind is passed over,
// however near it lies: every t is computed as it was before.
INLINE void path_pass(Ray *ray, Hit hit) {
  ray->t_min = hit.t;
  ray->passed = hit.primitive;
}

INLINE void path_pass_through(PathState *path, Hit hit) {
  path_pass(&path->ray, hit);
  path->passes += 1u;
  if (path->passes >= HARD_DEPTH) path->alive = 0;
}

// Share of the light that goes through the hit. Of the triangles that meet where the ray runs along their edge or through their vertex,
// all of which are hit, only one is in its way.
OUT_OF_LINE float path_transparency(const Scene *scene, Ray ray, Hit hit, uint material, TexturePoint at) {
  float share = material_transparency(scene, material, &at);
  bool at_edge = HAS(TRIANGLES) && !(hit.primitive & QUADRIC_BIT) && fmin(fmin(hit.b1, hit.b2), 1.0f - hit.b1 - hit.b2) < 0x1p-20f;
  if (!at_edge || share == 0.0f) return share;
  const Shear shear = shear_from_ray(&ray);
  return triangle_owns_hit(scene->blocks + hit.slot / BVH_WIDTH, hit.slot % BVH_WIDTH, &shear) ? share : 1.0f;
}

// Random bits of surface number `passes` that a path or a shadow ray of that depth meets: which material of a blend, and whether it
// lets the path through. A shadow ray decides for itself: its product of transparencies is right in the mean only if it does not
// depend on what the path has met, which may be the same surface.
INLINE ulong path_surface_bits(const Sampler *sampler, uint depth, uint passes, bool shadow) {
  return rng_mix(rng_bits(sampler->key, dimension_of_vertex(depth, DIMENSION_MATERIAL)) + (2ul * passes + shadow) * RNG_GOLDEN);
}

// Next-event estimation: the shadow ray to a point of a light chosen by power.
INLINE ShadowRay path_shadow_ray(const Scene *scene, const PathState *path, const Surface *surface, uint primitive,
                                 const Material *material, float3 wo, const Sampler *sampler) {
  ShadowRay shadow;
  shadow.contribution = pack3((float3)(0.0f));
  __global const Settings *settings = scene->settings;
  if (!HAS_LIGHTS || settings->light_count == 0u) return shadow;
  uint which = distribution_select(scene->light_cdf, settings->light_count,
                            (uint)(sampler_bits(sampler, dimension_of_vertex(path->depth, DIMENSION_LIGHT)) >> 32));
  Light light = scene->lights[which];
  // The very point from which a scattered ray on this side starts: both strategies then see the light from the same place.
  float3 origin = surface_offset(surface->position, surface->error, surface->geometric, surface->geometric);
  LightSample sample =
      light_sample(scene, &light, origin, sampler_bits(sampler, dimension_of_vertex(path->depth, DIMENSION_LIGHT_POINT)));
  float3 wi = frame_to_local(surface->frame, sample.direction);
  if (!(wi.z > 0.0f) || !(dot(surface->geometric, sample.direction) > 0.0f)) return shadow;
  float weight = sample.pdf > 0.0f ? mis_light_weight(sample.pdf, bsdf_pdf(material, wi)) : 1.0f;
  shadow.contribution = pack3(unpack3(path->throughput) * bsdf_eval(material, wo, wi) * sample.weight * weight);
  shadow.ray.origin = pack3(origin);
  shadow.ray.direction = pack3(sample.direction);
  shadow.ray.t_max = sample.distance;
  shadow.ray.skip = primitive;
  shadow.ray.target = sample.primitive;
  shadow.ray.t_min = 0.0f;
  shadow.ray.passed = 0u;
  shadow.depth = path->depth;
  return shadow;
}

// Scatters the path: its next ray, or its end.
INLINE void path_scatter(const Scene *scene, PathState *path, const Surface *surface, uint primitive, const Material *material,
                         float3 wo, const Sampler *sampler) {
  float2 u = sampler_2d(sampler, dimension_of_vertex(path->depth, DIMENSION_SCATTER));
  Scatter scatter = bsdf_sample(material, wo, surface->front, u);
  float3 wi = renormalize(frame_to_world(surface->frame, scatter.wi));
  // With interpolated normals a direction can end on the wrong side of the true surface: it is rejected.
  float side = dot(surface->geometric, wi) * scatter.wi.z;
  float3 throughput = unpack3(path->throughput) * scatter.weight;
  if (!(side > 0.0f) || !(max_component(throughput) > 0.0f)) {
    path->alive = 0;
    return;
  }
  path->eta *= scatter.eta;
  path->pdf = scatter.pdf;
  path->ray.origin = pack3(surface_offset(surface->position, surface->error, surface->geometric, wi));
  path->ray.direction = pack3(wi);
  path->ray.t_max = INFINITE_DISTANCE;
  path->ray.skip = primitive;
  path->ray.t_min = 0.0f;
  path->ray.passed = 0u;
  path->depth += 1;

  // Russian roulette by the throughput, without the radiance scaling of the media that the path is in. Never by radiance: then
  // emission times 2^k would change the paths.
  if (path->depth >= scene->settings->rr_depth) {
    float q = clamp(max_component(throughput) * path->eta * path->eta, ROULETTE_MIN, ROULETTE_MAX);
    float survive = rng_unit((uint)sampler_bits(sampler, dimension_of_vertex(path->depth - 1u, DIMENSION_LIGHT)));
    if (survive >= q) path->alive = 0;
    throughput /= q;
  }
  path->throughput = pack3(throughput);
}

// One vertex of the path: what the ray found, the shadow ray to trace (its contribution is 0 if there is none), the next ray.
INLINE ShadowRay path_shade(const Scene *scene, PathState *path, Hit hit, const Sampler *sampler) {
  ShadowRay none;
  none.contribution = pack3((float3)(0.0f));
  if (hit.primitive == NONE) {
    path_escape(scene, path);
    return none;
  }
  Surface surface = surface_from_hit(scene, &path->ray, hit);
  Shape shape = scene->shapes[surface.shape];
  if (shape.first_light != NONE && path_hides_lights(scene, path)) {
    path_pass_through(path, hit);
    return none;
  }
  path_emission(scene, path, hit, &surface, shape);

  uint material_index = surface.front ? shape.material_front : shape.material_back;
  if (material_index != NONE) {
    ulong bits = path_surface_bits(sampler, path->depth, path->passes, false);
    material_index = material_select(scene, material_index, &surface.at, (uint)(bits >> 32));
    if (HAS(OPACITY) && rng_unit((uint)bits) < path_transparency(scene, path->ray, hit, material_index, surface.at)) {
      path_pass_through(path, hit);
      return none;
    }
  }
  path->hit_anything |= path->depth == 0u;
  if (material_index == NONE || path->depth + 1u >= min(scene->settings->max_depth, HARD_DEPTH)) {
    path->alive = 0;
    return none;
  }
  Material material = material_at(scene, material_index, &surface.at);
  if (HAS_TANGENTS) surface.frame = normal_map_frame(scene, &material, &surface, -unpack3(path->ray.direction));
  float3 wo = frame_to_local(surface.frame, -unpack3(path->ray.direction));
  ShadowRay shadow = bsdf_is_delta(&material) ? none : path_shadow_ray(scene, path, &surface, hit.primitive, &material, wo, sampler);
  path_scatter(scene, path, &surface, hit.primitive, &material, wo, sampler);
  return shadow;
}

INLINE bool path_has_shadow_ray(const ShadowRay *shadow) {
  return shadow->contribution.x > 0.0f || shadow->contribution.y > 0.0f || shadow->contribution.z > 0.0f;
}

INLINE void path_add_light(PathState *path, const ShadowRay *shadow, float visibility) {
  path->radiance = pack3(unpack3(path->radiance) + unpack3(shadow->contribution) * visibility);
}

// Share of the light of a shadow ray that arrives. *rays counts the traversals.
INLINE float path_visibility(const Scene *scene, const ShadowRay *shadow, const Sampler *sampler, uint *rays) {
  if (!HAS(OPACITY)) {
    ++*rays;
    return traverse_any(scene, &shadow->ray) ? 0.0f : 1.0f;
  }
  Ray ray = shadow->ray;
  ray.t_max = nextafter(ray.t_max, 0.0f);  // as in traverse_any: what lies strictly between the two ends
  float share = 1.0f;
  for (uint passes = 0; passes < HARD_DEPTH; ++passes) {
    ++*rays;
    Hit hit = traverse_closest(scene, &ray);
    if (hit.primitive == NONE) return share;
    Surface surface = surface_from_hit(scene, &ray, hit);
    Shape shape = scene->shapes[surface.shape];
    uint index = surface.front ? shape.material_front : shape.material_back;
    if (index == NONE) return 0.0f;
    index = material_select(scene, index, &surface.at, (uint)(path_surface_bits(sampler, shadow->depth, passes, true) >> 32));
    share *= path_transparency(scene, ray, hit, index, surface.at);
    if (!(share > 0.0f)) return 0.0f;
    path_pass(&ray, hit);
  }
  return 0.0f;
}

// What the film gets of a path that has ended.
INLINE float3 path_sample(const PathState *path, __global const Settings *settings) {
  float3 radiance = unpack3(path->radiance);
  return APPROXIMATES(CLAMP) ? film_clamped(radiance, settings->largest_sample) : radiance;
}

// A whole path: radiance along the camera ray of one sample. *rays counts the traversals.
INLINE PathState path_trace(const Scene *scene, uint x, uint y, const Sampler *sampler, uint *rays) {
  PathState path = path_begin(scene, x, y, sampler);
  while (path.alive) {
    ++*rays;
    Hit hit = traverse_closest(scene, &path.ray);
    ShadowRay shadow = path_shade(scene, &path, hit, sampler);
    if (path_has_shadow_ray(&shadow)) path_add_light(&path, &shadow, path_visibility(scene, &shadow, sampler, rays));
  }
  return path;
}

#endif
