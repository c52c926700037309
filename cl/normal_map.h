// Normal maps and bump maps: the shading frame that a texture tilts. Everything is worked out on the front side; on the back the
// tilted normal is mirrored in the surface (docs/kernels.md).
#ifndef OCLAIR_NORMAL_MAP_H
#define OCLAIR_NORMAL_MAP_H

#include "surface.h"

// Tangent frame around the unit normal z: x along dp_du. Where dp_du is hardly longer than its rounding across z, there is no
// direction of u and any frame will do.
INLINE Frame tangent_frame(float3 z, float3 dp_du) {
  float largest = max_component(fabs(dp_du));
  if (!(largest >= 0x1p-120f && largest < INFINITE_DISTANCE)) return frame_from_normal(z);
  float3 u = dp_du * (1.0f / largest);
  float3 x = u - z * dot(z, u);
  float length2 = dot(x, x);
  if (!(length2 >= 1e-6f)) return frame_from_normal(z);
  x *= rsqrt(length2);
  x -= z * dot(z, x);  // what the first subtraction left: up to u over the length of x
  Frame frame;
  frame.x = x * rsqrt(dot(x, x));
  frame.y = cross(z, frame.x);
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

// A derivative of the displaced surface, times what makes it about 1 long: the normal does not depend on that.
INLINE float3 bump_tangent(float3 n, float3 derivative, float slope) {
  float3 along = derivative - n * dot(n, derivative);
  float largest = fmax(max_component(fabs(along)), fabs(slope));
  if (!(largest >= 0x1p-120f && largest < INFINITE_DISTANCE)) return (float3)(0.0f);
  float scale = 1.0f / largest;
  return along * scale + n * (slope * scale);
}

// Unit normal, on the side of n, of the surface displaced along its unit normal n by a height whose derivatives by u and v are
// `slope` (Blinn 1978, without the curvature of the surface itself). n where u and v have no direction.
INLINE float3 bump_normal(float3 n, float3 dp_du, float3 dp_dv, float2 slope) {
  float3 m = cross_exact(bump_tangent(n, dp_du, slope.x), bump_tangent(n, dp_dv, slope.y));
  float length2 = dot(m, m);
  if (!(length2 >= 1e-20f && length2 < INFINITE_DISTANCE)) return n;
  m *= rsqrt(length2);
  return dot(m, n) < 0.0f ? -m : m;
}

// The frame in which the material scatters, for a path that came from wo. A tilted normal that wo cannot see is not used.
INLINE Frame normal_map_frame(const Scene *scene, const Material *material, const Surface *surface, float3 wo) {
  float3 z = surface->front ? surface->frame.z : -surface->frame.z;
  float3 n = z;
  bool tilted = false;
  if (HAS(NORMAL_MAPS) && material->normal_texture != 0u) {
    float3 decoded = normal_map_decode(texture_eval(scene, material->normal_texture, &surface->at));
    if (material->normal_turned != 0u) decoded.xy = -decoded.xy;
    tilted = decoded.x != 0.0f || decoded.y != 0.0f;
    if (tilted) n = renormalize(frame_to_world(tangent_frame(z, surface->dp_du), decoded));
  }
  if (HAS(BUMP_MAPS) && material->bump_texture != 0u) {
    float2 slope = material->bump_scale * texture_gradient(scene, material->bump_texture, &surface->at);
    if (slope.x != 0.0f || slope.y != 0.0f) {
      n = bump_normal(n, surface->dp_du, surface->dp_dv, slope);
      tilted = true;
    }
  }
  if (!tilted) return surface->frame;
  if (!surface->front) n = renormalize(n - 2.0f * dot(n, z) * z);
  return dot(n, wo) > 0.0f ? frame_from_normal(n) : surface->frame;
}

#endif
