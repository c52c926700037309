#include "instance.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "mesh.h"
#include "quadric.h"

namespace oclair {

namespace {

bool mirrors(const glm::dmat4& matrix) {
  glm::dmat3 m(matrix);
  // The largest component becomes 1: no product under- or overflows.
  for (int c = 0; c < 3; ++c) m[c] /= std::max({std::abs(m[c].x), std::abs(m[c].y), std::abs(m[c].z)});
  return glm::determinant(m) < 0.0;
}

Mesh moved(const Mesh& mesh, const glm::dmat4& matrix) {
  const bool flat = mesh.normals.empty();
  ObjectMesh source{mesh.positions, mesh.normals, mesh.uvs, mesh.triangles, mesh.attributes, 0};
  Mesh result = to_world(std::move(source), {.to_world = matrix, .face_normals = flat, .flip_normals = false});
  if (flat && mirrors(matrix))
    for (glm::uvec3& t : result.triangles) std::swap(t.y, t.z);
  return result;
}

std::optional<PlacedQuadric> moved_quadric(Geometry geometry, const glm::dmat4& matrix) {
  switch (geometry) {
    case Geometry::sphere:
      return place_sphere(matrix);
    case Geometry::cylinder:
      return place_cylinder(matrix);
    default:
      return place_disk(matrix);
  }
}

}  // namespace

std::optional<WorldShape> instance_of(const WorldShape& shape, const glm::dmat4& to_world) {
  if (shape.geometry == Geometry::mesh) {
    WorldShape result;
    result.mesh = moved(shape.mesh, to_world);
    result.material_front = shape.material_front;
    result.material_back = shape.material_back;
    result.where = shape.where;
    return result;
  }
  const auto quadric = moved_quadric(shape.geometry, to_world * shape.to_world);
  if (!quadric) return std::nullopt;
  WorldShape result = shape;
  result.to_world = quadric->to_world;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      if (!std::isfinite(result.to_world[column][row])) throw std::range_error("it lies too far away");
  return result;
}

}  // namespace oclair
