// Textures made in code.
#pragma once

#include <cstring>

#include "worlds.h"

namespace oclair::test {

// A bitmap of floats, rows from top to bottom; returns how materials refer to it.
inline uint add_bitmap(World& world, uint width, uint height, uint channels, const std::vector<float>& values) {
  auto image = std::make_shared<Image>();
  image->width = width;
  image->height = height;
  image->channels = channels;
  image->format = TEXEL_FLOAT;
  image->texels.resize(values.size() * sizeof(float));
  std::memcpy(image->texels.data(), values.data(), image->texels.size());
  world.textures.emplace_back().image = image;
  return static_cast<uint>(world.textures.size());
}

// The same colour, or number, everywhere.
inline uint add_constant(World& world, const std::vector<float>& value) {
  return add_bitmap(world, 1, 1, static_cast<uint>(value.size()), value);
}

// The colour of a normal map that says n.
inline std::vector<float> normal_color(const glm::dvec3& n) {
  return {static_cast<float>(0.5 * n.x + 0.5), static_cast<float>(0.5 * n.y + 0.5), static_cast<float>(0.5 * n.z + 0.5)};
}

inline std::vector<float> random_numbers(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random() >> 40) * 0x1p-24f;
  return values;
}

// Bilinear interpolation of texels that repeat; texel (i, j) has its centre at ((i + 1/2)/width, (j + 1/2)/height).
struct HeightField {
  uint width, height;
  std::vector<float> values;

  long double at(long double u, long double v) const {
    const long double x = u * width - 0.5L, y = v * height - 0.5L, i = std::floor(x), j = std::floor(y);
    const auto texel = [&](long double a, long double b) {
      const auto wrap = [](long double k, uint n) { return static_cast<std::size_t>(k - n * std::floor(k / n)); };
      return static_cast<long double>(values[wrap(b, height) * width + wrap(a, width)]);
    };
    const long double a = x - i, b = y - j;
    return (1 - b) * ((1 - a) * texel(i, j) + a * texel(i + 1, j)) + b * ((1 - a) * texel(i, j + 1) + a * texel(i + 1, j + 1));
  }

  // Whether the slope is the same all around, within `reach` texels.
  bool smooth_at(long double u, long double v, long double reach) const {
    const auto inside = [&](long double x) { return std::abs(x - std::round(x)) > reach; };
    return inside(u * width - 0.5L) && inside(v * height - 0.5L);
  }
};

}  // namespace oclair::test
