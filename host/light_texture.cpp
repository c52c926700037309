#include "light_texture.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <mutex>

#include "color.h"
#include "parallel.h"
#include "texture.h"

namespace oclair {
namespace {

constexpr double MAX_SAMPLES = 1 << 24;  // of a texture over one shape

// How fine a texture is along u and v of its lookup: texels, or eighths of a checkerboard's unit square.
glm::dvec2 resolution(const Texture& texture) {
  return texture.kind == TEXTURE_BITMAP ? glm::dvec2(texture.width, texture.height) : glm::dvec2(8.0);
}

// Texels that the triangle covers.
double texels_covered(const Scene& scene, const Shape& shape, const Texture& texture, uint primitive) {
  if (texture.kind == TEXTURE_FACE_ATTRIBUTE) return 1.0;
  if (texture.kind == TEXTURE_VERTEX_ATTRIBUTE) return 16.0;  // it runs linearly
  const auto lookup = [&](double b1, double b2) {
    const glm::dvec3 uv(point_on_triangle(scene, shape, primitive, b1, b2).uv, 1.0);
    return resolution(texture) * glm::dvec2(glm::dot(unpack(texture.to_u), uv), glm::dot(unpack(texture.to_v), uv));
  };
  if (texture.kind == TEXTURE_BITMAP && texture.width == 1 && texture.height == 1) return 1.0;
  const glm::dvec2 origin = lookup(0, 0), a = lookup(1, 0) - origin, b = lookup(0, 1) - origin;
  // A sliver in texels is as fine as it is long.
  return std::max({0.5 * std::abs(a.x * b.y - a.y * b.x), glm::length(a), glm::length(b), 1.0});
}

// Of what several threads find.
struct Greatest {
  double value = 0.0;
  std::mutex mutex;

  void include(double x) {
    const std::lock_guard lock(mutex);
    value = std::max(value, x);
  }
};

uint ceil_root(double x, double least, double greatest) {
  return static_cast<uint>(std::clamp(std::ceil(std::sqrt(x)), least, greatest));
}

}  // namespace

double brightest_texel(const Scene& scene, uint reference) {
  const Texture& texture = scene.textures[reference - 1];
  if (texture.kind == TEXTURE_CHECKERBOARD) return std::max(largest(unpack(texture.color0)), largest(unpack(texture.color1)));
  if (texture.kind != TEXTURE_BITMAP) return 0.0;
  const Texels texels = texels_of(scene, texture);
  Greatest brightest;
  parallel_pieces(std::size_t{texture.width} * texture.height, [&](std::size_t first, std::size_t end) {
    double piece = 0.0;
    for (std::size_t i = first; i < end; ++i) piece = std::max(piece, largest(texels.at(i)));
    brightest.include(piece);
  });
  return brightest.value;
}

TrianglePart triangle_part(uint part, uint split) {
  const uint row = static_cast<uint>(std::sqrt(part + 0.5)), j = part - row * row, k = j / 2, turned = j % 2;
  const double n = split;
  return {(row - k) / n, (k + turned) / n, (turned ? -1.0 : 1.0) / n};
}

LightTexture light_texture(const Scene& scene, const Shape& shape, uint reference, double brightest, std::size_t parts) {
  const Texture& texture = scene.textures[reference - 1];
  const uint end = static_cast<uint>(scene.triangles.size());
  const double triangles = end - shape.first_triangle;
  double texels = 1.0;
  for (uint i = shape.first_triangle; i < end; ++i) texels = std::max(texels, texels_covered(scene, shape, texture, i));

  LightTexture result;
  const std::size_t allowed = std::min(MAX_SHAPE_PARTS, MAX_PARTS - std::min(MAX_PARTS, parts));
  const double most = std::floor(std::sqrt(static_cast<double>(allowed) / triangles));
  result.split = ceil_root(texels, 1.0, std::clamp(most, 1.0, static_cast<double>(MAX_LIGHT_SPLIT)));
  const uint count = result.split * result.split;
  // Each part is asked at the centroids of its own m^2 parts, about twice as many as texels.
  const double samples = std::floor(std::sqrt(MAX_SAMPLES / (triangles * count)));
  const uint m = ceil_root(2.0 * texels / count, 1.0, std::clamp(samples, 1.0, 64.0));
  Greatest sampled;
  result.parts.resize(static_cast<std::size_t>(triangles) * count);
  const auto mean_of_part = [&](uint primitive, uint k, double& greatest) {
    const TrianglePart part = triangle_part(k, result.split);
    glm::dvec3 sum(0.0);
    for (uint s = 0; s < m * m; ++s) {
      const TrianglePart small = triangle_part(s, m);
      const double third = small.size / 3.0;
      const double b1 = part.b1 + part.size * (small.b1 + third), b2 = part.b2 + part.size * (small.b2 + third);
      const glm::dvec3 value = texture_value(scene, reference, point_on_triangle(scene, shape, primitive, b1, b2));
      greatest = std::max(greatest, largest(value));
      sum += value;
    }
    return sum / static_cast<double>(m * m);
  };
  parallel_pieces(result.parts.size(), [&](std::size_t first, std::size_t last) {
    double greatest = 0.0;
    for (std::size_t i = first; i < last; ++i)
      result.parts[i] =
          mean_of_part(shape.first_triangle + static_cast<uint>(i / count), static_cast<uint>(i % count), greatest);
    sampled.include(greatest);
  }, 256 / m);
  result.brightest = std::max(brightest, sampled.value);
  double area = 0.0;
  for (uint i = shape.first_triangle; i < end; ++i) {
    const packed_uint3 v = scene.triangles[i];
    const glm::dvec3 p0 = unpack(scene.positions[v.x]), p1 = unpack(scene.positions[v.y]), p2 = unpack(scene.positions[v.z]);
    const double part_area = 0.5 * glm::length(glm::cross(p1 - p0, p2 - p0)) / count;
    for (uint k = 0; k < count; ++k) {
      result.mean += part_area * result.parts[std::size_t{i - shape.first_triangle} * count + k];
      area += part_area;
    }
  }
  result.mean /= area;
  if (texture.kind == TEXTURE_VERTEX_ATTRIBUTE) result.brightest *= 3.0;  // a centroid gives each corner a third at least
  if (!(largest(result.mean) > 0.0)) result.mean = glm::dvec3(result.brightest);
  return result;
}

LightTexture light_texture(const Scene& scene, const Quadric& quadric, uint reference, double brightest) {
  const Texture& texture = scene.textures[reference - 1];
  LightTexture result;
  result.brightest = brightest;
  const glm::dvec2 n = glm::clamp(glm::ceil(2.0 * resolution(texture)), 16.0, 1024.0);
  std::vector<glm::dvec3> columns(static_cast<std::size_t>(n.x));
  parallel_pieces(columns.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i)
      for (double j = 0.5; j < n.y; ++j) {
        // Uniform by area: the sphere's height, the square of the disk's radius.
        glm::dvec2 uv = glm::dvec2(static_cast<double>(i) + 0.5, j) / n;
        if (quadric.kind == QUADRIC_SPHERE) uv.y = std::acos(1.0 - 2.0 * uv.y) / glm::pi<double>();
        if (quadric.kind == QUADRIC_DISK) uv.x = std::sqrt(uv.x);
        columns[i] += texture_value(scene, reference, {uv});
      }
  }, 4);
  for (const glm::dvec3& column : columns) result.mean += column;
  result.mean /= n.x * n.y;
  if (!(largest(result.mean) > 0.0)) result.mean = glm::dvec3(result.brightest);
  return result;
}

}  // namespace oclair
