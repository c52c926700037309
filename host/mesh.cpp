#include "mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <stdexcept>
#include <utility>

#include "parallel.h"
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

// The triangle's unit normal and its angles. Without an area: 0 for each.
struct CornerAngles {
  glm::dvec3 normal;
  double angles[3];
};

CornerAngles corner_angles(const std::vector<glm::dvec3>& p, glm::uvec3 t) {
  const auto a = unit_or_zero(p[t.y] - p[t.x]), b = unit_or_zero(p[t.z] - p[t.y]), c = unit_or_zero(p[t.x] - p[t.z]);
  const auto n = unit_or_zero(glm::cross(a, -c));
  if (n == glm::dvec3(0.0)) return {};
  const double at_x = angle_between(a, -c), at_y = angle_between(b, -a);
  return {n, {at_x, at_y, std::max(glm::pi<double>() - at_x - at_y, 0.0)}};
}

std::vector<glm::dvec3> smooth_normals(const Mesh& mesh) {
  const auto& triangles = mesh.triangles;
  std::vector<glm::dvec3> normals(mesh.positions.size());
  // All cores find the angles of a part of the mesh, one adds them up: always in the order of the triangles.
  std::vector<CornerAngles> part(std::min<std::size_t>(triangles.size(), 1 << 16));
  for (std::size_t first = 0; first < triangles.size(); first += part.size()) {
    const std::size_t count = std::min(part.size(), triangles.size() - first);
    parallel_pieces(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) part[i] = corner_angles(mesh.positions, triangles[first + i]);
    });
    for (std::size_t i = 0; i < count; ++i)
      for (int corner = 0; corner < 3; ++corner)
        normals[triangles[first + i][corner]] += part[i].normal * part[i].angles[corner];
  }
  parallel_pieces(normals.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      normals[i] = unit_or_zero(normals[i]);
      if (normals[i] == glm::dvec3(0.0))
        normals[i] = glm::dvec3(1.0, 0.0, 0.0);  // no triangle or none with an area: never seen; Mitsuba's choice
    }
  });
  return normals;
}

void place(std::vector<glm::dvec3>& positions, const glm::dmat4& matrix) {
  parallel_pieces(positions.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      auto& p = positions[i];
      p = transform_point(matrix, p);
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        throw std::range_error("a vertex lies too far away");
    }
  });
}

// Squares [-1, 1]^2 of their own four vertices; x, y and the normal are directions along the axes, uv runs with x and y.
struct Square {
  glm::dvec3 center, x, y, normal;
};

Mesh squares(const std::vector<Square>& sides, const MeshOptions& options) {
  Mesh mesh;
  for (const auto& s : sides) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {s.center - s.x - s.y, s.center + s.x - s.y, s.center + s.x + s.y, s.center - s.x + s.y});
    mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    mesh.triangles.insert(mesh.triangles.end(), {{first, first + 1, first + 2}, {first + 2, first + 3, first}});
  }
  place(mesh.positions, options.to_world);
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

Mesh to_world(ObjectMesh source, const MeshOptions& options) {
  Mesh mesh{.positions = std::move(source.positions),
            .uvs = std::move(source.uvs),
            .triangles = std::move(source.triangles),
            .attributes = std::move(source.attributes)};
  place(mesh.positions, options.to_world);
  if (!options.face_normals && source.normals.empty()) {
    mesh.normals = smooth_normals(mesh);
  } else if (!options.face_normals) {
    mesh.normals = std::move(source.normals);
    const NormalTransform to_world(options.to_world);
    parallel_pieces(mesh.normals.size(), [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) mesh.normals[i] = to_world(unit_or_zero(mesh.normals[i]));
    });
  }
  // Mitsuba tells the sides of a smooth mesh by the shading normal alone; here the winding is turned to agree with it.
  const bool agree = !mesh.normals.empty();
  parallel_pieces(agree || options.flip_normals ? mesh.triangles.size() : 0, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      auto& t = mesh.triangles[i];
      bool turn = options.flip_normals;
      if (agree)
        turn ^= glm::dot(face_normal(mesh.positions, t), mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]) < 0.0;
      if (turn) std::swap(t.y, t.z);
    }
  });
  if (options.flip_normals)
    for (auto& n : mesh.normals) n = -n;
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
