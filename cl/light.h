// Lights: choosing one, sampling a point on it, and the density of both for multiple importance sampling.
#ifndef OCLAIR_LIGHT_H
#define OCLAIR_LIGHT_H

#include "environment.h"
#include "mis.h"
#include "rng.h"
#include "surface.h"

// A light as seen from a point.
typedef struct LightSample {
  float3 direction;    // unit, towards the light
  float distance;      // to the end of the shadow ray, or INFINITE_DISTANCE
  float3 weight;       // radiance (or its like for a delta) over the density; 0: nothing arrives
  float pdf;           // per solid angle, selection included; 0 for a delta
  uint primitive;      // on which the shadow ray ends, or NONE
} LightSample;

// A triangle with a textured radiance is split into n^2 equal triangles, each a light of its own with its own power. Part
// p = r^2 + j lies in row r (between b1 + b2 = r/n and (r + 1)/n), j-th along it; even ones are copies of the triangle, odd ones are
// turned round.
typedef struct LightPart {
  float b1, b2;  // barycentric coordinates of its vertex 0
  float size;    // its edges over those of the triangle: 1/n, or -1/n if it is turned round
} LightPart;

INLINE LightPart light_part(uint part, uint split) {
  uint row = (uint)sqrt((float)part + 0.5f);  // r^2 + 1/2 lies too far from the squares for an error of some ulp
  uint j = part - row * row, k = j / 2u;
  uint turned = j & 1u;
  LightPart p;
  p.size = (turned ? -1.0f : 1.0f) / (float)split;
  p.b1 = (float)(row - k) / split;            // upright: corner (row - k, k); turned: (row - k, k + 1), the far one
  p.b2 = (float)(k + turned) / split;
  return p;
}

// The part in which (b1, b2) lies.
INLINE uint light_part_at(float b1, float b2, uint split) {
  float x = fmax(b1, 0.0f) * split, y = fmax(b2, 0.0f) * split;
  uint i = min((uint)x, split - 1u), k = min((uint)y, split - 1u - i);
  uint turned = (x - i) + (y - k) >= 1.0f && i + k + 1u < split;
  uint row = i + k + turned;
  return row * row + 2u * k + turned;
}

// What an area light sends from the point where it is asked.
INLINE float3 light_radiance(const Scene *scene, const Light *light, const TexturePoint *at) {
  if (!HAS(TEXTURED_LIGHTS) || light->texture == 0u) return unpack3(light->radiance);
  return fmax(texture_eval(scene, light->texture, at), 0.0f);
}

// Solid-angle density of an area density: pdf_area d^2 / cos. 0 where the surface is seen from behind or edge-on.
INLINE float light_pdf_from_area(float pdf_area, float distance2, float cosine) {
  return cosine > 0.0f ? pdf_area * distance2 / cosine : 0.0f;
}

// 1 - cos of the half angle under which a sphere of radius r is seen from distance d > r: without cancellation when it is small.
INLINE float light_cone(float radius2, float distance2) {
  float sin2 = radius2 / distance2;
  return sin2 / (1.0f + sqrt(fmax(0.0f, 1.0f - sin2)));
}

// From here on a sphere is sampled by its cone of directions; nearer, or from inside, by its area.
INLINE bool light_sees_cone(const Quadric *quadric, float3 from, float *radius2, float *distance2) {
  if (quadric->kind != QUADRIC_SPHERE) return false;
  float3 axis = unpack3(quadric->axis_x);
  float3 d = unpack3(quadric->center) - from;
  *radius2 = 1.0f / dot(axis, axis);
  *distance2 = dot(d, d);
  return *distance2 > 1.0001f * *radius2;
}

// Density, selection included, of reaching an area light by light_sample: for a ray from `from` that hit it at distance t, with
// the cosine between its direction and the light's front normal there.
INLINE float light_pdf(const Scene *scene, const Light *light, float3 from, float t, float cosine) {
  if (HAS(QUADRIC_LIGHTS) && light->kind == LIGHT_QUADRIC) {
    Quadric quadric = scene->quadrics[light->primitive & ~QUADRIC_BIT];
    float radius2, distance2;
    if (light_sees_cone(&quadric, from, &radius2, &distance2))
      return light->probability * warp_cone_pdf(light_cone(radius2, distance2));
    return light_pdf_from_area((float)light->probability / quadric.area, t * t, cosine);
  }
  return light_pdf_from_area((float)light->probability / light->area, t * t, cosine);
}

// Uniform point on a quadric by area: local coordinates.
INLINE float3 quadric_sample(const Quadric *quadric, float2 u) {
  if (HAS(DISKS) && quadric->kind == QUADRIC_DISK) {
    float2 d = warp_disk(u);
    return (float3)(d.x, d.y, 0.0f);
  }
  if (HAS(CYLINDERS) && quadric->kind == QUADRIC_CYLINDER) {
    float2 d = warp_circle(u.y);
    return (float3)(d.x, d.y, u.x);
  }
  return warp_sphere(u);
}

// Ends a light sample at a point of an area light that was chosen by area.
INLINE LightSample light_from_area(const Light *light, float3 radiance, float area, float3 from, float3 point, float3 error, float3 normal) {
  LightSample s;
  float3 d = point - from;
  float distance2 = dot(d, d);
  s.primitive = light->primitive;
  s.direction = distance2 > 0.0f ? d * rsqrt(distance2) : (float3)(0.0f, 0.0f, 1.0f);
  float cosine = -dot(normal, s.direction);
  // In the area form nothing is divided by the cosine, which may be 0.
  bool seen = cosine > 0.0f && distance2 > 0.0f;
  s.weight = seen ? radiance * (cosine * area / (distance2 * light->probability)) : (float3)(0.0f);
  s.pdf = seen ? light_pdf_from_area(light->probability / area, distance2, cosine) : 0.0f;
  s.distance = length(surface_offset(point, error, normal, -s.direction) - from);
  return s;
}

INLINE LightSample light_sample_quadric(const Scene *scene, const Light *light, float3 from, float2 u) {
  Quadric quadric = scene->quadrics[light->primitive & ~QUADRIC_BIT];
  float3 center = unpack3(quadric.center);
  float radius2, distance2;
  if (light_sees_cone(&quadric, from, &radius2, &distance2)) {
    LightSample s;
    float one_minus_cos = light_cone(radius2, distance2);
    float3 cone = warp_cone(u, one_minus_cos);
    s.direction = frame_to_world(frame_from_normal((center - from) * rsqrt(distance2)), cone);
    // Nearest point along the direction: distance_to_centre cos - sqrt(r^2 - distance_to_centre^2 sin^2). The sine from x and y: of a
    // small cone 1 - z keeps no digit.
    float sin2 = dot(cone.xy, cone.xy);
    s.distance = cone.z * sqrt(distance2) - sqrt(fmax(0.0f, radius2 - distance2 * sin2));
    s.primitive = light->primitive;
    s.pdf = light->probability * warp_cone_pdf(one_minus_cos);
    float3 radiance = unpack3(light->radiance);
    if (HAS(TEXTURED_LIGHTS) && light->texture != 0u) {
      TexturePoint at = texture_point_on_quadric(
          &quadric, quadric_project(&quadric, quadric_to_local(&quadric, s.direction * s.distance + (from - center))));
      radiance = light_radiance(scene, light, &at);
    }
    s.weight = quadric.flip > 0.0f ? radiance / s.pdf : (float3)(0.0f);
    return s;
  }
  float3 q = quadric_sample(&quadric, u);
  float3 offset = quadric_to_world(&quadric, q);
  TexturePoint at = texture_point_on_quadric(&quadric, q);
  return light_from_area(light, light_radiance(scene, light, &at), quadric.area, from, center + offset, quadric_error(center, offset), quadric_normal(&quadric, q));
}

INLINE LightSample light_sample_triangle(const Scene *scene, const Light *light, float3 from, float2 u) {
  float2 b = warp_triangle(u);
  float3 v0 = unpack3(light->position), e1 = unpack3(light->edge1), e2 = unpack3(light->edge2);
  float3 point = v0 + b.x * e1 + b.y * e2;
  float3 error = triangle_error(fabs(v0) + fabs(b.x * e1) + fabs(b.y * e2));
  float3 radiance = unpack3(light->radiance);
  if (HAS(TEXTURED_LIGHTS) && light->texture != 0u) {
    LightPart part = light_part(light->part, light->split);
    Shape shape = scene->shapes[scene->triangle_shape[light->primitive]];
    TexturePoint p = texture_point_on_triangle(scene, &shape, light->primitive, part.b1 + part.size * b.x, part.b2 + part.size * b.y);
    TexturePoint at = {p.uv, p.b1, p.b2, p.primitive, p.face};  // a copy: oclgrind does not know what clang makes of a result passed on
    radiance = light_radiance(scene, light, &at);
  }
  return light_from_area(light, radiance, light->area, from, point, error, triangle_normal(e1, e2));
}

// Share of its intensity that a spot light sends in the unit direction d: all of it within the beam, then falling linearly with the
// angle from its axis to 0 at the cutoff (as in Mitsuba 3).
INLINE float spot_falloff(const Light *light, float3 d) {
  float cutoff = light->edge2.x, beam = light->edge2.y;
  float3 axis = unpack3(light->edge1), across = cross(axis, d);
  float angle = atan2(sqrt(dot(across, across)), dot(axis, d));  // the arc cosine has no digits in a narrow beam
  if (angle <= beam) return 1.0f;
  return angle < cutoff ? (cutoff - angle) / (cutoff - beam) : 0.0f;
}

// Samples the light towards the point `from` by 64 random bits.
INLINE LightSample light_sample(const Scene *scene, const Light *light, float3 from, ulong bits) {
  float2 u = rng_point(bits);
  if (HAS(TRIANGLE_LIGHTS) && light->kind == LIGHT_TRIANGLE) return light_sample_triangle(scene, light, from, u);
  if (HAS(QUADRIC_LIGHTS) && light->kind == LIGHT_QUADRIC) return light_sample_quadric(scene, light, from, u);
  LightSample s;
  s.primitive = NONE;
  s.distance = INFINITE_DISTANCE;
  s.pdf = 0.0f;
  s.weight = unpack3(light->radiance) / light->probability;
  s.direction = HAS(DIRECTIONAL_LIGHTS) ? -unpack3(light->position) : (float3)(0.0f, 0.0f, 1.0f);
  bool point = HAS(POINT_LIGHTS) && light->kind == LIGHT_POINT, spot = HAS(SPOT_LIGHTS) && light->kind == LIGHT_SPOT;
  if (point || spot) {
    float3 d = unpack3(light->position) - from;
    float distance2 = dot(d, d);
    bool apart = distance2 > 0.0f;
    s.distance = sqrt(distance2);
    s.direction = apart ? d / s.distance : (float3)(0.0f, 0.0f, 1.0f);
    s.weight = apart ? s.weight / distance2 : (float3)(0.0f);
    if (spot) s.weight *= spot_falloff(light, -s.direction);
  }
  if (HAS(CONSTANT_LIGHT) && light->kind == LIGHT_CONSTANT) {
    s.direction = warp_sphere(u);
    s.weight /= warp_sphere_pdf();
    s.pdf = light->probability * warp_sphere_pdf();
  }
  if (HAS(ENVIRONMENT_MAP) && light->kind == LIGHT_ENVIRONMENT) {
    float pdf;
    s.direction = environment_sample(scene, bits, &pdf);
    s.pdf = light->probability * pdf;
    s.weight = environment_radiance(scene, s.direction) / s.pdf;
  }
  return s;
}

#endif
