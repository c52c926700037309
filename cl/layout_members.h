// Every struct of cl/types.h and its members, in order: what the device is asked, and the host (host/selftest/layout.h).
// A forgotten struct or member fails in tests/layout_test.
#define LAYOUT_LIST(STRUCT, MEMBER)                                                                                     \
  STRUCT(packed_float3) MEMBER(packed_float3, x) MEMBER(packed_float3, y) MEMBER(packed_float3, z)                      \
  STRUCT(packed_uint3) MEMBER(packed_uint3, x) MEMBER(packed_uint3, y) MEMBER(packed_uint3, z)                          \
  STRUCT(Shape) MEMBER(Shape, material_front) MEMBER(Shape, material_back) MEMBER(Shape, first_light)                   \
  MEMBER(Shape, light_split) MEMBER(Shape, first_triangle) MEMBER(Shape, first_normal) MEMBER(Shape, first_uv)          \
  STRUCT(Quadric) MEMBER(Quadric, center) MEMBER(Quadric, kind) MEMBER(Quadric, axis_x) MEMBER(Quadric, shape)          \
  MEMBER(Quadric, axis_y) MEMBER(Quadric, flip) MEMBER(Quadric, axis_z) MEMBER(Quadric, area)                           \
  STRUCT(Material) MEMBER(Material, reflectance) MEMBER(Material, kind) MEMBER(Material, transmittance)                 \
  MEMBER(Material, eta) MEMBER(Material, conductor_eta) MEMBER(Material, roughness) MEMBER(Material, conductor_k)       \
  MEMBER(Material, transparency) MEMBER(Material, reflectance_texture) MEMBER(Material, transmittance_texture)          \
  MEMBER(Material, roughness_texture) MEMBER(Material, opacity_texture) MEMBER(Material, normal_texture)                \
  MEMBER(Material, bump_texture) MEMBER(Material, bump_scale) MEMBER(Material, weight)                                  \
  MEMBER(Material, weight_texture) MEMBER(Material, first) MEMBER(Material, second) MEMBER(Material, normal_turned)     \
  STRUCT(Texture) MEMBER(Texture, color0) MEMBER(Texture, kind) MEMBER(Texture, color1) MEMBER(Texture, channels)       \
  MEMBER(Texture, to_u) MEMBER(Texture, format) MEMBER(Texture, to_v) MEMBER(Texture, srgb) MEMBER(Texture, offset)     \
  MEMBER(Texture, width) MEMBER(Texture, height) MEMBER(Texture, wrap) MEMBER(Texture, nearest)                         \
  STRUCT(Light) MEMBER(Light, radiance) MEMBER(Light, kind) MEMBER(Light, position) MEMBER(Light, probability)          \
  MEMBER(Light, edge1) MEMBER(Light, primitive) MEMBER(Light, edge2) MEMBER(Light, area) MEMBER(Light, texture)         \
  MEMBER(Light, part) MEMBER(Light, split) MEMBER(Light, pad)                                                           \
  STRUCT(Camera) MEMBER(Camera, origin) MEMBER(Camera, near_clip) MEMBER(Camera, corner) MEMBER(Camera, far_clip)       \
  MEMBER(Camera, step_x) MEMBER(Camera, aperture_radius) MEMBER(Camera, step_y) MEMBER(Camera, focus_distance)          \
  MEMBER(Camera, axis) MEMBER(Camera, orthographic)                                                                     \
  STRUCT(FilterEntry) MEMBER(FilterEntry, density) MEMBER(FilterEntry, integral) MEMBER(FilterEntry, first)             \
  STRUCT(Settings) MEMBER(Settings, seed) MEMBER(Settings, film_width) MEMBER(Settings, film_height)                    \
  MEMBER(Settings, crop_x) MEMBER(Settings, crop_y) MEMBER(Settings, crop_width) MEMBER(Settings, crop_height)          \
  MEMBER(Settings, max_depth) MEMBER(Settings, rr_depth) MEMBER(Settings, hide_emitters) MEMBER(Settings, light_count)  \
  MEMBER(Settings, sample_border) MEMBER(Settings, filter_count) MEMBER(Settings, filter_radius)                        \
  MEMBER(Settings, film_exponent) MEMBER(Settings, environment) MEMBER(Settings, environment_probability)               \
  MEMBER(Settings, environment_x) MEMBER(Settings, environment_texture) MEMBER(Settings, environment_y)                 \
  MEMBER(Settings, sampler) MEMBER(Settings, environment_z) MEMBER(Settings, largest_sample)                            \
  STRUCT(FilmPixel) MEMBER(FilmPixel, sum) MEMBER(FilmPixel, rejected) MEMBER(FilmPixel, hits)                          \
  STRUCT(FilmMoments) MEMBER(FilmMoments, product)                                                                      \
  STRUCT(FilmErrors) MEMBER(FilmErrors, sum) MEMBER(FilmErrors, square)                                                 \
  STRUCT(AovPixel) MEMBER(AovPixel, albedo) MEMBER(AovPixel, hits) MEMBER(AovPixel, normal) MEMBER(AovPixel, primitive)   \
  MEMBER(AovPixel, u) MEMBER(AovPixel, v) MEMBER(AovPixel, depth) MEMBER(AovPixel, pixel)                               \
  STRUCT(BvhNode) MEMBER(BvhNode, bounds) MEMBER(BvhNode, child) MEMBER(BvhNode, pad)                                   \
  STRUCT(TriangleBlock) MEMBER(TriangleBlock, vertex) MEMBER(TriangleBlock, primitive)                                  \
  STRUCT(Ray) MEMBER(Ray, origin) MEMBER(Ray, t_max) MEMBER(Ray, direction) MEMBER(Ray, skip) MEMBER(Ray, target)       \
  MEMBER(Ray, t_min) MEMBER(Ray, passed)                                                                                \
  STRUCT(Hit) MEMBER(Hit, t) MEMBER(Hit, b1) MEMBER(Hit, b2) MEMBER(Hit, primitive) MEMBER(Hit, slot)                   \
  STRUCT(PathState) MEMBER(PathState, ray) MEMBER(PathState, throughput) MEMBER(PathState, radiance)                    \
  MEMBER(PathState, eta) MEMBER(PathState, pdf) MEMBER(PathState, depth) MEMBER(PathState, passes)                      \
  MEMBER(PathState, hit_anything) MEMBER(PathState, alive)                                                              \
  STRUCT(ShadowRay) MEMBER(ShadowRay, ray) MEMBER(ShadowRay, contribution) MEMBER(ShadowRay, depth)
