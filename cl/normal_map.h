// Normal maps and bump maps: the shading frame that a texture tilts.
#ifndef OCLAIR_NORMAL_MAP_H
#define OCLAIR_NORMAL_MAP_H

#include "surface.h"

// Tangent frame on the side of the surface that is seen: x along dp_du, z the shading normal. y keeps the direction that it has on
// the front side, so that a bump is a bump from both sides.
INLINE Frame tangent_frame(const Surface *surface) {
  float3 z = surface->frame.z;
  float3 x = surface->dp_du - z * dot(z, surface->dp_du);
  float largest = max_component(fabs(x));
  if (!(largest > 0.0f && largest < INFINITE_DISTANCE)) return surface->frame;  // no direction of u
  Frame frame;
  x *= 1.0f / largest;
  frame.x = x * rsqrt(dot(x, x));
  frame.y = cross(surface->front ? z : -z, frame.x);
  frame.z = z;
  return frame;
}

// Normal of the tangent frame from the colour of a normal map: 2 c - 1. Where that has hardly a length or points below the
// surface, the map says nothing.
INLINE float3 normal_map_decode(float3 color) {
  float3 n = 2.0f * color - 1.0f;
  float length2 = dot(n, n);
  if (!(length2 > 1e-4f && length2 < INFINITE_DISTANCE) || !(n.z > 0.0f)) return (float3)(0.0f, 0.0f, 1.0f);
  return n * rsqrt(length2);
}

// Normal, in world space and on the front side, of the surface displaced along its normal by a height whose derivatives by u
// and v are `slope`, in canonical lengths (Blinn 1978).
INLINE float3 bump_normal(float3 n, float3 dp_du, float3 dp_dv, float2 slope) {
  float3 du = dp_du + n * (slope.x - dot(n, dp_du));
  float3 dv = dp_dv + n * (slope.y - dot(n, dp_dv));
  float3 m = cross_exact(du, dv);
  float largest = max_component(fabs(m));
  if (!(largest > 0.0f && largest < INFINITE_DISTANCE)) return n;
  m = normalize(m * (1.0f / largest));
  return dot(m, n) < 0.0f ? -m : m;
}

// The frame in which the material scatters, for a path that came from wo. A tilted normal that wo cannot see is not used.
INLINE Frame normal_map_frame(const Scene *scene, const Material *material, const Surface *surface, float3 wo) {
  float3 n = surface->frame.z;
  if (HAS(NORMAL_MAPS) && material->normal_texture != 0u) {
    float3 tilted = normal_map_decode(texture_eval(scene, material->normal_texture, &surface->at));
    n = frame_to_world(tangent_frame(surface), tilted);
  }
  if (HAS(BUMP_MAPS) && material->bump_texture != 0u) {
    float3 front = surface->front ? n : -n;
    float2 slope = material->bump_scale * texture_gradient(scene, material->bump_texture, &surface->at);
    float3 m = bump_normal(front, surface->dp_du, surface->dp_dv, slope);
    n = surface->front ? m : m - 2.0f * dot(m, front) * front;
  }
  n = renormalize(n);
  return dot(n, wo) > 0.0f ? frame_from_normal(n) : surface->frame;
}

#endif
