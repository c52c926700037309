#include "../cl/normal_map.h"

__kernel void decode(uint count, __global const packed_float3 *colors, __global packed_float3 *normals) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  normals[i] = pack3(normal_map_decode(unpack3(colors[i])));
}

__kernel void tangent_frames(uint count, __global const packed_float3 *z, __global const packed_float3 *dp_du,
                             __global packed_float3 *columns) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Frame frame = tangent_frame(unpack3(z[i]), unpack3(dp_du[i]));
  columns[3 * i] = pack3(frame.x);
  columns[3 * i + 1] = pack3(frame.y);
  columns[3 * i + 2] = pack3(frame.z);
}

__kernel void bumps(uint count, __global const packed_float3 *n, __global const packed_float3 *dp_du,
                    __global const packed_float3 *dp_dv, __global const float2 *slopes, __global packed_float3 *normals) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  normals[i] = pack3(bump_normal(unpack3(n[i]), unpack3(dp_du[i]), unpack3(dp_dv[i]), slopes[i]));
}

// The normal in which what the rays have hit scatters, and the one without maps.
__kernel void shading_normals(uint count, __global const TriangleBlock *blocks, __global const Quadric *quadrics,
                              __global const Shape *shapes, __global const uint *triangle_shape,
                              __global const packed_uint3 *triangle_vertices, __global const packed_float3 *vertex_normals,
                              __global const float2 *uvs, __global const Material *materials, __global const Texture *textures,
                              __global const uchar *texels, __global const Ray *rays, __global const Hit *hits,
                              __global packed_float3 *normals, __global packed_float3 *untilted) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.blocks = blocks, .quadrics = quadrics, .shapes = shapes, .triangle_shape = triangle_shape,
                 .triangle_vertices = triangle_vertices, .normals = vertex_normals, .uvs = uvs, .materials = materials,
                 .textures = textures, .texels = texels};
  Ray ray = rays[i];
  Surface s = surface_from_hit(&scene, &ray, hits[i]);
  Material material = materials[s.front ? shapes[s.shape].material_front : shapes[s.shape].material_back];
  normals[i] = pack3(normal_map_frame(&scene, &material, &s, -unpack3(ray.direction)).z);
  untilted[i] = pack3(s.frame.z);
}
