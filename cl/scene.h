// The kernel's buffers, gathered once at the entry; everything below takes `const Scene *`. A buffer that no feature of the
// scene reads is not made: its argument is NULL.
#ifndef OCLAIR_SCENE_H
#define OCLAIR_SCENE_H

#include "features.h"
#include "vector.h"

typedef struct Scene {
  __global const BvhNode *nodes;
  __global const TriangleBlock *blocks;
  __global const Quadric *quadrics;
  __global const Shape *shapes;
  __global const uint *triangle_shape;             // shape of each triangle
  __global const packed_uint3 *triangle_vertices;  // counted in the mesh; only if a mesh has normals or uvs, or a vertex attribute is asked for
  __global const stored_float3 *normals;           // Shape::first_normal + vertex
  __global const stored_float2 *uvs;                      // Shape::first_uv + vertex
  __global const Material *materials;
  __global const Texture *textures;
  __global const uchar *texels;  // of all textures
  __global const stored_float *srgb;    // decoded values of 8-bit sRGB; only if a texture has them
  __global const Light *lights;
  __global const uint *light_cdf;     // light i is chosen by 32-bit numbers in [cdf[i - 1], cdf[i]); the last entry is 2^32 - 1
  __global const uint *environment_cdf;  // see environment.h
  __global const FilterEntry *filter;    // see filter.h
  __global const Camera *camera;
  __global const Settings *settings;
} Scene;

// The list of arguments of every kernel that needs the scene, and how it becomes the struct. Host twin: plan_buffers in
// host/upload.cpp, by position.
#define SCENE_ARGUMENTS                                                                                                     \
  __global const BvhNode *nodes, __global const TriangleBlock *blocks, __global const Quadric *quadrics,                    \
      __global const Shape *shapes, __global const uint *triangle_shape, __global const packed_uint3 *triangle_vertices,    \
      __global const stored_float3 *normals, __global const stored_float2 *uvs, __global const Material *materials,                \
      __global const Texture *textures, __global const uchar *texels, __global const stored_float *srgb,                           \
      __global const Light *lights, __global const uint *light_cdf, __global const uint *environment_cdf,                   \
      __global const FilterEntry *filter, __global const Camera *camera, __global const Settings *settings
#define SCENE_FROM_ARGUMENTS                                                                                                \
  {nodes, blocks, quadrics, shapes, triangle_shape, triangle_vertices, normals, uvs, materials, textures, texels, srgb,     \
   lights, light_cdf, environment_cdf, filter, camera, settings}

#endif
