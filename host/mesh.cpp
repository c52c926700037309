#include "mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <stdexcept>

#include "transform.h"

namespace oclair {

namespace {

glm::dvec3 unit_or_zero(glm::dvec3 v) {
  const double square = glm::dot(v, v);
  if (square > 1e-280 && square < 1e280) return v / std::sqrt(square);
  const double greatest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(greatest > 0.0) || !std::isfinite(greatest)) return glm::dvec3(0.0);
  return glm::normalize(v / greatest);
}

// Unit vector, or 0 if the triangle has no area. The edges are made unit vectors first: their product neither overflows
// nor vanishes for any scale of the scene.
glm::dvec3 face_normal(const std::vector<glm::dvec3>& p, glm::uvec3 t) {
  return unit_or_zero(glm::cross(unit_or_zero(p[t.y] - p[t.x]), unit_or_zero(p[t.z] - p[t.x])));
}

// By the half-angle form of Kahan, exact for small and for flat angles.
double angle_between(glm::dvec3 a, glm::dvec3 b) { return 2.0 * std::atan2(glm::length(a - b), glm::length(a + b)); }

std::vector<glm::dvec3> smooth_normals(const Mesh& mesh) {
  const auto& p = mesh.positions;
  std::vector<glm::dvec3> normals(p.size(), glm::dvec3(0.0));
  for (const auto& t : mesh.triangles) {
    const auto a = unit_or_zero(p[t.y] - p[t.x]), b = unit_or_zero(p[t.z] - p[t.y]), c = unit_or_zero(p[t.x] - p[t.z]);
    const auto n = unit_or_zero(glm::cross(a, -c));
    if (n == glm::dvec3(0.0)) continue;
    const double at_x = angle_between(a, -c), at_y = angle_between(b, -a);
    normals[t.x] += n * at_x;
    normals[t.y] += n * at_y;
    normals[t.z] += n * std::max(glm::pi<double>() - at_x - at_y, 0.0);
  }
  for (auto& n : normals) {
    n = unit_or_zero(n);
    if (n == glm::dvec3(0.0))
      n = glm::dvec3(1.0, 0.0, 0.0);  // no triangle or none with an area: never seen; Mitsuba's choice
  }
  return normals;
}

std::vector<glm::dvec3> placed(const std::vector<glm::dvec3>& positions, const glm::dmat4& matrix) {
  std::vector<glm::dvec3> result;
  result.reserve(positions.size());
  for (const auto& p : positions) {
    const auto q = transform_point(matrix, p);
    if (!std::isfinite(q.x) || !std::isfinite(q.y) || !std::isfinite(q.z))
      throw std::range_error("a vertex lies too far away");
    result.push_back(q);
  }
  return result;
}

Mesh flat_mesh(const std::vector<glm::dvec3>& positions, const std::vector<glm::uvec3>& triangles,
               const std::vector<glm::dvec3>& fronts, const MeshOptions& options) {
  Mesh mesh{.positions = placed(positions, options.to_world), .triangles = triangles};
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    auto& t = mesh.triangles[i];
    const auto front = transform_normal(options.to_world, fronts[i]) * (options.flip_normals ? -1.0 : 1.0);
    if (glm::dot(face_normal(mesh.positions, t), front) < 0.0) std::swap(t.y, t.z);
  }
  return mesh;
}

}  // namespace

void append_polygon(ObjectMesh& mesh, std::span<const std::uint32_t> corners) {
  glm::dvec3 first(0.0);
  bool concave = false;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const glm::uvec3 triangle(corners[0], corners[i - 1], corners[i]);
    mesh.triangles.push_back(triangle);
    if (corners.size() == 3) return;
    const auto n = face_normal(mesh.positions, triangle);
    if (first == glm::dvec3(0.0)) first = n;
    concave |= glm::dot(first, n) < 0.0;
  }
  mesh.concave_polygons += concave;
}

Mesh to_world(const ObjectMesh& source, const MeshOptions& options) {
  Mesh mesh{.positions = placed(source.positions, options.to_world),
            .uvs = source.uvs,
            .triangles = source.triangles,
            .attributes = source.attributes};
  if (!options.face_normals && source.normals.empty()) {
    mesh.normals = smooth_normals(mesh);
  } else if (!options.face_normals) {
    mesh.normals.reserve(source.normals.size());
    for (const auto& n : source.normals) mesh.normals.push_back(transform_normal(options.to_world, unit_or_zero(n)));
  }
  if (!mesh.normals.empty()) {
    // Mitsuba tells the sides of a smooth mesh by the shading normal alone; here the winding is turned to agree with it.
    for (auto& t : mesh.triangles) {
      const auto sum = mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z];
      if (glm::dot(face_normal(mesh.positions, t), sum) < 0.0) std::swap(t.y, t.z);
    }
  }
  if (options.flip_normals) {
    for (auto& t : mesh.triangles) std::swap(t.y, t.z);
    for (auto& n : mesh.normals) n = -n;
  }
  return mesh;
}

Mesh rectangle_mesh(const MeshOptions& options) {
  const glm::dvec3 z(0.0, 0.0, 1.0);
  return flat_mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {2, 3, 0}}, {z, z}, options);
}

Mesh cube_mesh(const MeshOptions& options) {
  // Corner i has the coordinates that the bits of i say: bit 0 is x.
  std::vector<glm::dvec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  std::vector<glm::uvec3> triangles;
  std::vector<glm::dvec3> fronts;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, base = side ? 1u << axis : 0u;
      triangles.push_back({base, base + u, base + u + v});
      triangles.push_back({base, base + u + v, base + v});
      glm::dvec3 front(0.0);
      front[axis] = side ? 1.0 : -1.0;
      fronts.insert(fronts.end(), 2, front);
    }
  return flat_mesh(corners, triangles, fronts, options);
}

}  // namespace oclair
