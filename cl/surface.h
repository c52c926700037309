// The point that a ray has hit, as shading needs it.
#ifndef OCLAIR_SURFACE_H
#define OCLAIR_SURFACE_H

#include "quadric.h"
#include "ray.h"
#include "texture.h"

typedef struct Surface {
  float3 position;
  float3 error;      // dot(|normal|, error) bounds how far rounding has moved the point off the surface
  float3 geometric;  // unit normal of the true surface, on the side of the ray's origin
  Frame frame;       // z: shading normal, on the same side
  float3 dp_du;      // derivatives of the position by the texture coordinates, only with HAS_TANGENTS; 0 where there is no direction of u
  float3 dp_dv;
  TexturePoint at;   // only with HAS_TEXTURES
  uint shape;
  bool front;        // that side is the front side
} Surface;

// v0 + b1 e1 + b2 e2 with 7 roundings of the products |b_i v_i|, and 1 when the offset is added (Pharr, Jakob, Humphreys
// 2016, 3.9.4: gamma(7)); a gamma is n u / (1 - n u), u = 2^-24.
#define SURFACE_ERROR (8.00001f * 0x1p-24f)

// Error bound of a point on a triangle, given |p0| + |p1| + |p2| of its terms. The largest coordinate counts for all three: the
// triangle test's shear mixes the axes, so that a neighbour across an edge is met that far off even in a plane whose own
// coordinate is exactly 0, where the point itself has no error.
INLINE float3 triangle_error(float3 magnitude) { return (float3)(SURFACE_ERROR * max_component(magnitude)); }

// Vertex `i` of the triangle in `slot` (Hit::slot).
INLINE float3 triangle_vertex(const Scene *scene, uint slot, uint i) {
  __global const TriangleBlock *block = scene->blocks + slot / BVH_WIDTH;
  uint lane = slot % BVH_WIDTH;
  return (float3)(block->vertex[i][0][lane], block->vertex[i][1][lane], block->vertex[i][2][lane]);
}

// Unit front normal of a triangle, exact to a few ulp for slivers too.
INLINE float3 triangle_normal(float3 edge1, float3 edge2) {
  float3 n = cross_exact(edge1, edge2);
  return normalize(n * (1.0f / max_component(fabs(n))));  // squares of lengths below 1e-19 would underflow
}

// Where textures are asked at barycentric coordinates (b1, b2) of a triangle. Without texture coordinates, those take their place.
INLINE TexturePoint texture_point_on_triangle(const Scene *scene, const Shape *shape, uint primitive, float b1, float b2) {
  TexturePoint p = {(float2)(b1, b2), b1, b2, primitive, primitive - shape->first_triangle};
  if (shape->first_uv == NONE) return p;
  packed_uint3 v = scene->triangle_vertices[primitive];
  __global const stored_float2 *uv = scene->uvs + shape->first_uv;
  p.uv = (1.0f - b1 - b2) * load2(uv[v.x]) + b1 * load2(uv[v.y]) + b2 * load2(uv[v.z]);
  return p;
}

// Derivatives of the position on a triangle by the texture coordinates: the inverse of the map from edges to differences of
// coordinates. 0 where that has none.
INLINE void triangle_tangents(const Scene *scene, const Shape *shape, uint primitive, float3 edge1, float3 edge2, Surface *s) {
  s->dp_du = edge1;
  s->dp_dv = edge2;
  if (shape->first_uv == NONE) return;
  packed_uint3 v = scene->triangle_vertices[primitive];
  __global const stored_float2 *uv = scene->uvs + shape->first_uv;
  float2 d1 = load2(uv[v.y]) - load2(uv[v.x]), d2 = load2(uv[v.z]) - load2(uv[v.x]);
  float determinant = difference_of_products(d1.x, d2.y, d1.y, d2.x);
  bool usable = fabs(determinant) >= 0x1p-100f && fabs(determinant) < INFINITE_DISTANCE;
  float inverse = usable ? 1.0f / determinant : 0.0f;
  s->dp_du = (d2.y * edge1 - d1.y * edge2) * inverse;
  s->dp_dv = (d1.x * edge2 - d2.x * edge1) * inverse;
}

INLINE Surface surface_on_triangle(const Scene *scene, Hit hit) {
  Surface s;
  float3 v0 = triangle_vertex(scene, hit.slot, 0), v1 = triangle_vertex(scene, hit.slot, 1), v2 = triangle_vertex(scene, hit.slot, 2);
  float b0 = 1.0f - hit.b1 - hit.b2;
  float3 p0 = b0 * v0, p1 = hit.b1 * v1, p2 = hit.b2 * v2;
  s.position = p0 + p1 + p2;
  s.error = triangle_error(fabs(p0) + fabs(p1) + fabs(p2));
  s.geometric = triangle_normal(v1 - v0, v2 - v0);
  s.frame.z = s.geometric;
  s.shape = scene->triangle_shape[hit.primitive];
  Shape shape = scene->shapes[s.shape];
  if (HAS_TEXTURES) s.at = texture_point_on_triangle(scene, &shape, hit.primitive, hit.b1, hit.b2);
  if (HAS_TANGENTS) triangle_tangents(scene, &shape, hit.primitive, v1 - v0, v2 - v0, &s);
  if (HAS(SMOOTH_NORMALS) && shape.first_normal != NONE) {
    packed_uint3 i = scene->triangle_vertices[hit.primitive];
    __global const stored_float3 *normals = scene->normals + shape.first_normal;
    float3 n = b0 * unpack3(normals[i.x]) + hit.b1 * unpack3(normals[i.y]) + hit.b2 * unpack3(normals[i.z]);
    float length2 = dot(n, n);
    if (length2 > 1e-12f) s.frame.z = n * rsqrt(length2);  // opposite vertex normals cancel: the geometric one stands
  }
  return s;
}

// Texture coordinates at the local point q: sphere (longitude, angle from +z), disk (radius, longitude), cylinder (longitude,
// height); longitudes in turns from +x towards +y, angles in half turns, all in [0, 1].
INLINE TexturePoint texture_point_on_quadric(const Quadric *quadric, float3 q) {
  float turns = atan2(q.y, q.x) * (0.5f * INV_PI);
  turns = turns < 0.0f ? turns + 1.0f : turns;
  float2 uv = (float2)(turns, atan2(length(q.xy), q.z) * INV_PI);
  if (HAS(DISKS) && quadric->kind == QUADRIC_DISK) uv = (float2)(length(q.xy), turns);
  if (HAS(CYLINDERS) && quadric->kind == QUADRIC_CYLINDER) uv = (float2)(turns, q.z);
  TexturePoint p = {uv, 0.0f, 0.0f, NONE, 0u};
  return p;
}

// Derivatives of the position by those coordinates; 0 at a pole.
INLINE void quadric_tangents(const Quadric *quadric, float3 q, Surface *s) {
  float r = length(q.xy);
  float3 du = 2.0f * PI * (float3)(-q.y, q.x, 0.0f), dv = (float3)(0.0f);
  if (r > 0.0f) dv = PI * (float3)(q.x * q.z / r, q.y * q.z / r, -r);
  if (HAS(DISKS) && quadric->kind == QUADRIC_DISK) {
    dv = du;
    du = r > 0.0f ? (float3)(q.x / r, q.y / r, 0.0f) : (float3)(0.0f);
  }
  if (HAS(CYLINDERS) && quadric->kind == QUADRIC_CYLINDER) dv = (float3)(0.0f, 0.0f, 1.0f);
  s->dp_du = quadric_to_world(quadric, du);
  s->dp_dv = quadric_to_world(quadric, dv);
}

INLINE Surface surface_on_quadric(const Scene *scene, const Ray *ray, Hit hit) {
  Surface s;
  Quadric quadric = scene->quadrics[hit.primitive & ~QUADRIC_BIT];
  float3 center = unpack3(quadric.center);
  float3 q = quadric_to_local(&quadric, fma(unpack3(ray->direction), (float3)(hit.t), unpack3(ray->origin) - center));
  q = quadric_project(&quadric, q);
  float3 offset = quadric_to_world(&quadric, q);
  s.position = center + offset;
  s.error = quadric_error(center, offset);
  s.geometric = quadric_normal(&quadric, q);
  s.frame.z = s.geometric;
  s.shape = quadric.shape;
  if (HAS_TEXTURES) s.at = texture_point_on_quadric(&quadric, q);
  if (HAS_TANGENTS) quadric_tangents(&quadric, q, &s);
  return s;
}

// The hit of a ray, its normals turned to the side that the ray comes from. Where the interpolated normal faces away from the ray, the
// geometric one takes its place (the silhouettes of coarse meshes).
INLINE Surface surface_from_hit(const Scene *scene, const Ray *ray, Hit hit) {
  bool has_quadrics = HAS_QUADRICS;
  bool on_quadric = has_quadrics && (!HAS(TRIANGLES) || (hit.primitive & QUADRIC_BIT) != 0u);
  Surface s;
  if (on_quadric) s = surface_on_quadric(scene, ray, hit);
  else s = surface_on_triangle(scene, hit);
  float3 wo = -unpack3(ray->direction);
  s.front = dot(s.geometric, wo) >= 0.0f;
  float3 geometric = s.front ? s.geometric : -s.geometric;
  float3 shading = s.front ? s.frame.z : -s.frame.z;
  s.geometric = geometric;
  s.frame = frame_from_normal(dot(shading, wo) > 0.0f ? shading : geometric);
  return s;
}

// Where a ray that leaves the surface in direction w starts: moved off the surface, to w's side, by the bound of the rounding
// error along the normal (Pharr, Jakob, Humphreys 2016, 3.9.5). The primitive itself is left out by Ray::skip.
INLINE float3 surface_offset(float3 position, float3 error, float3 normal, float3 w) {
  float distance = dot(fabs(normal), error);
  return position + normal * (dot(normal, w) >= 0.0f ? distance : -distance);
}

#endif
