#include "texture.h"

#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "color.h"

namespace oclair {
namespace {

template <class T>
T element(std::span<const std::byte> bytes, std::size_t i) {
  T value;
  std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
  return value;
}

// What the integers of sRGB mean: found once, a power for each texel takes ten times as long as reading it.
std::vector<double> decoded_integers(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = srgb_decoded(static_cast<double>(i) / static_cast<double>(count - 1));
  return values;
}

template <class T>
double integer(const Texels& texels, std::size_t i) {
  static const std::vector<double> srgb = decoded_integers(std::size_t{std::numeric_limits<T>::max()} + 1);
  const T value = element<T>(texels.bytes, i);
  return texels.srgb ? srgb[value] : value / static_cast<double>(std::numeric_limits<T>::max());
}

double component(const Texels& texels, std::size_t i) {
  switch (texels.format) {
    case TEXEL_U8: return integer<std::uint8_t>(texels, i);
    case TEXEL_U16: return integer<std::uint16_t>(texels, i);
    case TEXEL_HALF: {
      half value;
      value.setBits(element<std::uint16_t>(texels.bytes, i));
      return value;
    }
    default: return element<float>(texels.bytes, i);
  }
}

// The two texels around a coordinate and the weight of the second.
struct TexelSpan {
  uint first, second;
  double weight;
};

TexelSpan texel_span(double u, uint n, const Texture& texture) {
  if (!std::isfinite(u)) u = 0.0;
  if (texture.wrap == WRAP_REPEAT) u -= std::floor(u);
  else if (texture.wrap == WRAP_MIRROR) u = 1.0 - std::abs(u - 2.0 * std::floor(0.5 * u) - 1.0);
  else u = std::clamp(u, 0.0, 1.0);
  const double x = u * n, below = std::floor(x - 0.5);
  if (texture.nearest) {
    const uint i = static_cast<uint>(std::clamp(std::floor(x), 0.0, n - 1.0));
    return {i, i, 0.0};
  }
  const auto neighbour = [&](double i) {
    if (texture.wrap == WRAP_REPEAT) return static_cast<uint>(i < 0.0 ? n - 1 : i >= n ? 0 : i);
    return static_cast<uint>(std::clamp(i, 0.0, n - 1.0));
  };
  return {neighbour(below), neighbour(below + 1.0), x - 0.5 - below};
}

glm::dvec3 bitmap_value(const Texture& texture, const Texels& texels, glm::dvec2 uv) {
  const TexelSpan x = texel_span(uv.x, texture.width, texture), y = texel_span(uv.y, texture.height, texture);
  const std::size_t row0 = std::size_t{y.first} * texture.width, row1 = std::size_t{y.second} * texture.width;
  return glm::mix(glm::mix(texels.at(row0 + x.first), texels.at(row0 + x.second), x.weight),
                  glm::mix(texels.at(row1 + x.first), texels.at(row1 + x.second), x.weight), y.weight);
}

}  // namespace

glm::dvec3 Texels::at(std::size_t i) const {
  if (channels == 1) return glm::dvec3(component(*this, i));
  return {component(*this, 3 * i), component(*this, 3 * i + 1), component(*this, 3 * i + 2)};
}

Texels texels_of(const Image& image, bool srgb) { return {image.texels, image.format, image.channels, srgb}; }

Texels texels_of(const Scene& scene, const Texture& texture) {
  return {std::span(scene.texels).subspan(texture.offset), texture.format, texture.channels, texture.srgb != 0};
}

TexturePoint point_on_triangle(const Scene& scene, const Shape& shape, uint primitive, double b1, double b2) {
  TexturePoint at{{b1, b2}, b1, b2, primitive, primitive - shape.first_triangle};
  if (shape.first_uv == NONE) return at;
  const packed_uint3 v = scene.triangle_vertices[primitive];
  const auto uv = [&](uint vertex) {
    const auto& pair = scene.uvs[shape.first_uv + vertex];
    return glm::dvec2(pair[0], pair[1]);
  };
  at.uv = (1.0 - b1 - b2) * uv(v.x) + b1 * uv(v.y) + b2 * uv(v.z);
  return at;
}

glm::dvec3 texture_value(const Scene& scene, uint reference, const TexturePoint& at) {
  const Texture& texture = scene.textures[reference - 1];
  const Texels texels = texels_of(scene, texture);
  const glm::dvec3 p(at.uv, 1.0);
  const glm::dvec2 uv(glm::dot(unpack(texture.to_u), p), glm::dot(unpack(texture.to_v), p));
  glm::dvec3 value(0.0);
  if (texture.kind == TEXTURE_BITMAP) {
    value = bitmap_value(texture, texels, uv);
  } else if (texture.kind == TEXTURE_CHECKERBOARD) {
    const glm::dvec2 q = uv - glm::floor(uv);
    value = unpack((q.x > 0.5) == (q.y > 0.5) ? texture.color0 : texture.color1);
  } else if (texture.kind == TEXTURE_FACE_ATTRIBUTE) {
    value = texels.at(at.face);
  } else {
    const packed_uint3 v = scene.triangle_vertices[at.primitive];
    value = (1.0 - at.b1 - at.b2) * texels.at(v.x) + at.b1 * texels.at(v.y) + at.b2 * texels.at(v.z);
  }
  return glm::max(value, 0.0);
}

}  // namespace oclair
