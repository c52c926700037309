// Textures: colours and numbers that vary over a surface. Texels are kept in the format of their file and decoded here.
#ifndef OCLAIR_TEXTURE_H
#define OCLAIR_TEXTURE_H

#include "scene.h"

// Where on a surface a texture is asked.
typedef struct TexturePoint {
  float2 uv;
  float b1, b2;    // barycentric coordinates of vertices 1 and 2 of the triangle, for attributes
  uint primitive;  // the triangle
  uint face;       // and its number in its mesh
} TexturePoint;

INLINE float luminance(float3 rgb) { return dot(rgb, (float3)(REAL(0.2126), REAL(0.7152), REAL(0.0722))); }  // Rec. ITU-R BT.709

// Transfer curve of sRGB (IEC 61966-2-1), for encoded values in [0, 1].
INLINE float srgb_decoded(float encoded) {
  return encoded <= REAL(0.04045) ? encoded / REAL(12.92) : powr((encoded + REAL(0.055)) / REAL(1.055), REAL(2.4));
}

// Component i of the texture, counted from its first texel.
INLINE float texel_component(const Scene *scene, const Texture *texture, ulong i) {
  __global const uchar *bytes = scene->texels + texture->offset;
  switch (texture->format) {
    case TEXEL_U8: return texture->srgb ? scene->srgb[bytes[i]] : (float)bytes[i] / 255.0f;
    case TEXEL_U16: {
      float value = (float)((__global const ushort *)bytes)[i] / 65535.0f;
      return texture->srgb ? srgb_decoded(value) : value;
    }
    case TEXEL_HALF: return vload_half(i, (__global const half *)bytes);
    default: return ((__global const stored_float *)bytes)[i];
  }
}

// One value in all three channels, or the three. Out of line, like texture_eval: it stands four times in each interpolation.
OUT_OF_LINE float3 texel(const Scene *scene, const Texture *texture, ulong i) {
  i *= texture->channels;
  if (texture->channels == 1u) return (float3)(texel_component(scene, texture, i));
  return (float3)(texel_component(scene, texture, i), texel_component(scene, texture, i + 1ul),
                  texel_component(scene, texture, i + 2ul));
}

// Coordinate u brought into [0, 1]. Of a u beyond 2^24 nothing but the integer is left: 0. NaN may come out, of NaN and infinities.
INLINE float texture_wrapped(float u, uint wrap) {
  if (wrap == WRAP_REPEAT) return u - floor(u);
  if (wrap == WRAP_MIRROR) return 1.0f - fabs(u - 2.0f * floor(0.5f * u) - 1.0f);
  return fmin(fmax(u, 0.0f), 1.0f);
}

// Texel i of n along one axis, i in [-1, n]: beyond an edge lies the other edge, or the edge itself.
INLINE uint texel_neighbour(int i, uint n, uint wrap) {
  int last = (int)n - 1;
  if (wrap == WRAP_REPEAT) return (uint)(i < 0 ? last : i > last ? 0 : i);
  return (uint)clamp(i, 0, last);
}

// The two texels around a wrapped coordinate and the weight of the second. Texel i has its centre at (i + 1/2)/n. Whatever the
// coordinate, NaN included (which converts to 0), the texels exist.
typedef struct TexelSpan {
  uint first, second;
  float weight;
} TexelSpan;

INLINE TexelSpan texel_span(float u, uint n, uint wrap, bool nearest) {
  float x = texture_wrapped(u, wrap) * n;
  TexelSpan s;
  if (nearest) {
    s.first = s.second = (uint)clamp(convert_int_sat(x), 0, (int)n - 1);
    s.weight = 0.0f;
    return s;
  }
  float below = floor(x - 0.5f);
  int i = clamp(convert_int_sat(below), -1, (int)n - 1);
  s.first = texel_neighbour(i, n, wrap);
  s.second = texel_neighbour(i + 1, n, wrap);
  float weight = x - 0.5f - below;
  s.weight = weight >= 0.0f && weight <= 1.0f ? weight : 0.0f;
  return s;
}

INLINE float2 texture_coordinates(const Texture *texture, float2 uv) {
  float3 p = (float3)(uv, 1.0f);
  return (float2)(dot(unpack3(texture->to_u), p), dot(unpack3(texture->to_v), p));
}

INLINE float3 bitmap_eval(const Scene *scene, const Texture *texture, float2 uv) {
  TexelSpan x = texel_span(uv.x, texture->width, texture->wrap, texture->nearest);
  TexelSpan y = texel_span(uv.y, texture->height, texture->wrap, texture->nearest);
  ulong row0 = (ulong)y.first * texture->width, row1 = (ulong)y.second * texture->width;
  float3 t00 = texel(scene, texture, row0 + x.first);
  if (texture->nearest) return t00;
  float3 t10 = texel(scene, texture, row0 + x.second);
  float3 t01 = texel(scene, texture, row1 + x.first), t11 = texel(scene, texture, row1 + x.second);
  return mix(mix(t00, t10, x.weight), mix(t01, t11, x.weight), y.weight);
}

INLINE float3 checkerboard_eval(const Texture *texture, float2 uv) {
  float2 p = uv - floor(uv);
  return (p.x > 0.5f) == (p.y > 0.5f) ? unpack3(texture->color0) : unpack3(texture->color1);
}

INLINE float3 attribute_eval(const Scene *scene, const Texture *texture, const TexturePoint *at) {
  if (texture->kind == TEXTURE_FACE_ATTRIBUTE) return texel(scene, texture, at->face);
  packed_uint3 v = scene->triangle_vertices[at->primitive];
  float b0 = 1.0f - at->b1 - at->b2;
  return b0 * texel(scene, texture, v.x) + at->b1 * texel(scene, texture, v.y) + at->b2 * texel(scene, texture, v.z);
}

// Value of a texture, given as 1 + its index. Out of line: it is asked for in many places.
OUT_OF_LINE float3 texture_eval(const Scene *scene, uint reference, const TexturePoint *at) {
  Texture texture = scene->textures[reference - 1u];
  if (HAS(BITMAPS) && texture.kind == TEXTURE_BITMAP)
    return bitmap_eval(scene, &texture, texture_coordinates(&texture, at->uv));
  if (HAS(CHECKERBOARDS) && texture.kind == TEXTURE_CHECKERBOARD)
    return checkerboard_eval(&texture, texture_coordinates(&texture, at->uv));
  if (HAS(ATTRIBUTES)) return attribute_eval(scene, &texture, at);
  return (float3)(0.0f);
}

// A texture as a number: that of a colour is its luminance.
INLINE float texture_number(const Scene *scene, uint reference, const TexturePoint *at) {
  float3 value = texture_eval(scene, reference, at);
  return scene->textures[reference - 1u].channels == 1u ? value.x : luminance(value);
}

// Derivatives of texture_number by u and v, that is of the interpolation itself; 0 where the texture has steps.
INLINE float2 texture_gradient(const Scene *scene, uint reference, const TexturePoint *at) {
  Texture texture = scene->textures[reference - 1u];
  if (!HAS(BITMAPS) || texture.kind != TEXTURE_BITMAP || texture.nearest) return (float2)(0.0f);
  float2 uv = texture_coordinates(&texture, at->uv);
  TexelSpan x = texel_span(uv.x, texture.width, texture.wrap, false);
  TexelSpan y = texel_span(uv.y, texture.height, texture.wrap, false);
  ulong row0 = (ulong)y.first * texture.width, row1 = (ulong)y.second * texture.width;
  float t00 = luminance(texel(scene, &texture, row0 + x.first)), t10 = luminance(texel(scene, &texture, row0 + x.second));
  float t01 = luminance(texel(scene, &texture, row1 + x.first)), t11 = luminance(texel(scene, &texture, row1 + x.second));
  float2 slope = (float2)(texture.width * mix(t10 - t00, t11 - t01, y.weight), texture.height * mix(t01 - t00, t11 - t10, x.weight));
  // A mirrored stretch runs backwards.
  if (texture.wrap == WRAP_MIRROR) slope = select(slope, -slope, isgreater(uv - 2.0f * floor(0.5f * uv), (float2)(1.0f)));
  return slope.x * unpack3(texture.to_u).xy + slope.y * unpack3(texture.to_v).xy;
}

#endif
