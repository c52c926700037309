#include "quadric.h"

#include <algorithm>
#include <cmath>

#include "transform.h"

namespace oclair {

namespace {

constexpr double TOLERANCE = 1e-4;

bool orthogonal(glm::dvec3 a, glm::dvec3 b) { return std::abs(glm::dot(glm::normalize(a), glm::normalize(b))) < TOLERANCE; }

bool equal(double a, double b) { return std::abs(a - b) < TOLERANCE * std::max(a, b); }

glm::dmat4 from_columns(glm::dvec3 x, glm::dvec3 y, glm::dvec3 z, glm::dvec4 origin) {
  return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), origin};
}

}  // namespace

std::optional<PlacedQuadric> place_sphere(const glm::dmat4& matrix) {
  const glm::dmat3 m(matrix);
  const double radius = glm::length(m[0]);
  if (!orthogonal(m[0], m[1]) || !orthogonal(m[1], m[2]) || !orthogonal(m[2], m[0])) return std::nullopt;
  if (!equal(radius, glm::length(m[1])) || !equal(radius, glm::length(m[2]))) return std::nullopt;
  // The axes matter to texture coordinates only; they are made orthogonal exactly.
  const double handedness = glm::determinant(m / radius) < 0.0 ? -1.0 : 1.0;
  const glm::dvec3 x = m[0] / radius, y = glm::normalize(m[1] - x * glm::dot(m[1], x)), z = glm::cross(x, y) * handedness;
  // A mirror turns Mitsuba's sphere inside out, but none of its other shapes.
  return PlacedQuadric{from_columns(x * radius, y * radius, z * radius, matrix[3]), handedness < 0.0};
}

std::optional<PlacedQuadric> place_cylinder(const glm::dmat4& matrix) {
  const glm::dmat3 m(matrix);
  const double radius = glm::length(m[0]);
  if (!orthogonal(m[0], m[1]) || !orthogonal(m[1], m[2]) || !orthogonal(m[2], m[0])) return std::nullopt;
  if (!equal(radius, glm::length(m[1]))) return std::nullopt;
  const glm::dvec3 axis = glm::normalize(m[2]);
  const glm::dvec3 x = glm::normalize(m[0] - axis * glm::dot(m[0], axis));
  const double handedness = glm::determinant(m / radius) < 0.0 ? -1.0 : 1.0;
  return PlacedQuadric{from_columns(x * radius, glm::cross(axis, x) * (radius * handedness), m[2], matrix[3]), false};
}

PlacedQuadric place_disk(const glm::dmat4& matrix) {
  const glm::dmat3 m(matrix);
  // One Jacobi rotation of the disk in its own plane makes the images of its axes orthogonal: tan 2t = 2 a.b / (a.a - b.b).
  const double aa = glm::dot(m[0], m[0]), bb = glm::dot(m[1], m[1]), ab = glm::dot(m[0], m[1]);
  // None where they are orthogonal already: texture coordinates count from the first axis.
  const double t = orthogonal(m[0], m[1]) ? 0.0 : 0.5 * std::atan2(2.0 * ab, aa - bb);
  const glm::dvec3 normal = transform_normal(matrix, {0.0, 0.0, 1.0});
  const glm::dvec3 x = std::cos(t) * m[0] + std::sin(t) * m[1];
  const glm::dvec3 y = std::cos(t) * m[1] - std::sin(t) * m[0];
  glm::dvec3 across = glm::cross(normal, glm::normalize(x));
  if (glm::dot(across, y) < 0.0) across = -across;
  return {from_columns(x, across * glm::length(y), normal * std::max(glm::length(x), glm::length(y)), matrix[3]), false};
}

}  // namespace oclair
