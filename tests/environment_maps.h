// Environment maps made in code, what the device says of them, and the specification of cl/environment.h in long double.
#pragma once

#include <cstring>
#include <functional>

#include "quadrature.h"
#include "worlds.h"

namespace oclair::test {

// An image of 32-bit floats, texel by texel.
inline std::shared_ptr<const Image> float_image(uint width, uint height, const std::function<glm::dvec3(uint, uint)>& texel) {
  Image image{width, height, 3, TEXEL_FLOAT, false, {}};
  std::vector<float> values;
  for (uint y = 0; y < height; ++y)
    for (uint x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(texel(x, y)[c]));
  image.texels.resize(values.size() * sizeof(float));
  std::memcpy(image.texels.data(), values.data(), image.texels.size());
  return std::make_shared<const Image>(image);
}

inline glm::dvec3 texel_of(const Image& image, uint x, uint y) {
  float rgb[3];
  std::memcpy(rgb, image.texels.data() + (std::size_t{y} * image.width + x) * sizeof rgb, sizeof rgb);
  return {rgb[0], rgb[1], rgb[2]};
}

inline std::shared_ptr<const Image> random_image(uint width, uint height, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto unit = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  return float_image(width, height, [&](uint, uint) { return glm::dvec3(std::pow(10.0, 3 * unit() - 2), unit(), unit()); });
}

// A black map but for one texel.
inline std::shared_ptr<const Image> sun_image(uint width, uint height, uint x, uint y, double radiance) {
  return float_image(width, height, [=](uint i, uint j) { return glm::dvec3(i == x && j == y ? radiance : 0.0); });
}

inline Scene map_scene(std::shared_ptr<const Image> image, double scale = 1.0, const glm::dmat3& rotation = glm::dmat3(1.0)) {
  World world;
  WorldLight& light = world.lights.emplace_back();
  light.kind = LIGHT_ENVIRONMENT;
  light.value = glm::dvec3(scale);
  light.image = std::move(image);
  light.rotation = rotation;
  return place_scene(world);
}

inline std::vector<packed_float3> map_radiance(const Scene& scene, const std::vector<packed_float3>& directions) {
  std::vector<packed_float3> results(directions.size());
  run("environment_map_test.cl", "radiance", directions.size(), scene.textures, scene.texels, scene.srgb, scene.environment_cdf,
      std::vector<Settings>{scene.settings}, directions, out(results));
  return results;
}

inline std::vector<float> map_density(const Scene& scene, const std::vector<packed_float3>& directions) {
  std::vector<float> results(directions.size());
  run("environment_map_test.cl", "density", directions.size(), scene.textures, scene.texels, scene.srgb, scene.environment_cdf,
      std::vector<Settings>{scene.settings}, directions, out(results));
  return results;
}

struct MapSamples {
  std::vector<packed_float3> directions;
  std::vector<float> pdf;
};

inline MapSamples map_samples(const Scene& scene, const std::vector<cl_ulong>& bits) {
  MapSamples s{std::vector<packed_float3>(bits.size()), std::vector<float>(bits.size())};
  run("environment_map_test.cl", "sample", bits.size(), scene.textures, scene.texels, scene.srgb, scene.environment_cdf,
      std::vector<Settings>{scene.settings}, bits, out(s.directions), out(s.pdf));
  return s;
}

inline std::vector<cl_ulong> random_bits(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::vector<cl_ulong> bits(n);
  for (cl_ulong& b : bits) b = engine();
  return bits;
}

// Coordinates in cells of a direction in the image's frame: x in [0, columns), y in [0, rows].
struct MapPlace {
  long double x, y;
};

inline MapPlace map_place(uint width, uint height, const glm::dvec3& d) {
  const long double pi = std::acos(-1.0L), rows = std::max(height, 2u) - 1;
  long double u = std::atan2(static_cast<long double>(d.x), -static_cast<long double>(d.z)) / (2 * pi);
  long double x = (u - std::floor(u)) * width - 0.5L;
  if (x < 0) x += width;
  const long double side = std::sqrt(static_cast<long double>(d.x) * d.x + static_cast<long double>(d.z) * d.z);
  return {x, std::atan2(side, static_cast<long double>(d.y)) / pi * rows};
}

// The radiance at a place of the image, times 1.
inline glm::dvec3 map_value(const Image& image, const MapPlace& p) {
  const uint rows = std::max(image.height, 2u) - 1;
  const uint i = std::min(static_cast<uint>(p.x), image.width - 1), j = std::min(static_cast<uint>(p.y), rows - 1);
  const double s = static_cast<double>(p.x - i), t = static_cast<double>(p.y - j);
  const uint right = (i + 1) % image.width, below = std::min(j + 1, image.height - 1);
  return (1 - t) * ((1 - s) * texel_of(image, i, j) + s * texel_of(image, right, j)) + t * ((1 - s) * texel_of(image, i, below) + s * texel_of(image, right, below));
}

// Direction in the image's frame at a place of it.
inline glm::dvec3 map_direction(uint width, uint height, double x, double y) {
  const double pi = std::acos(-1.0), phi = 2 * pi * (x + 0.5) / width, theta = pi * y / (std::max(height, 2u) - 1);
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

// Integral over one cell of f(direction, radiance) by solid angle: Gauss-Legendre, n x n points.
inline double integrate_cell(const Image& image, uint x, uint y, int n, const std::function<double(const glm::dvec3&, const glm::dvec3&)>& f) {
  const double pi = std::acos(-1.0), rows = std::max(image.height, 2u) - 1;
  double sum = 0.0;
  const auto nodes = gauss_legendre(n, 0.0, 1.0);
  for (const Node& a : nodes)
    for (const Node& b : nodes) {
      const MapPlace p{x + static_cast<long double>(a.x), y + static_cast<long double>(b.x)};
      sum += a.weight * b.weight * std::sin(pi * static_cast<double>(p.y) / rows) * f(map_direction(image.width, image.height, static_cast<double>(p.x), static_cast<double>(p.y)), map_value(image, p));
    }
  return sum * (2 * pi / image.width) * (pi / rows);
}

inline double luminance_of(const glm::dvec3& rgb) { return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z; }

inline double cell_solid_angle(uint width, uint height, uint y) {
  const long double pi = std::acos(-1.0L), rows = std::max(height, 2u) - 1;
  return static_cast<double>(4 * pi / width * std::sin((2 * y + 1.0L) * pi / (2 * rows)) * std::sin(pi / (2 * rows)));
}

}  // namespace oclair::test
