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

// Squares [-1, 1]^2 of their own four vertices; x, y and the normal are directions along the axes, uv runs with x and y.
struct Square {
  glm::dvec3 center, x, y, normal;
};

Mesh squares(const std::vector<Square>& sides, const MeshOptions& options) {
  std::vector<glm::dvec3> positions;
  Mesh mesh;
  for (const auto& s : sides) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {s.center - s.x - s.y, s.center + s.x - s.y, s.center + s.x + s.y, s.center - s.x + s.y});
    mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    mesh.triangles.insert(mesh.triangles.end(), {{first, first + 1, first + 2}, {first + 2, first + 3, first}});
  }
  mesh.positions = placed(positions, options.to_world);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    auto& t = mesh.triangles[i];
    const auto front = transform_normal(options.to_world, sides[i / 2].normal) * (options.flip_normals ? -1.0 : 1.0);
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
  return squares({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, options);
}

Mesh cube_mesh(const MeshOptions& options) {
  // The directions of u and v are Mitsuba's, measured: (normal, u, v).
  constexpr int SIDES[6][3][3] = {{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
                                  {{0, -1, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}},
                                  {{0, 0, -1}, {0, -1, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}};
  std::vector<Square> sides;
  for (const auto& side : SIDES) {
    const auto axis = [&](int i) { return glm::dvec3(side[i][0], side[i][1], side[i][2]); };
    sides.push_back({axis(0), axis(1), axis(2), axis(0)});
  }
  return squares(sides, options);
}

}  // namespace oclair
