#include "frame.h"

#include <cmath>

namespace oclair {

glm::dvec3 CanonicalFrame::place(const glm::dvec3& world) const {
  const glm::dvec3 d = world - center;
  return {std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent)};
}

double CanonicalFrame::place_length(double world) const { return std::ldexp(world, -exponent); }

void Bounds::include(const glm::dvec3& p) {
  low = glm::min(low, p);
  high = glm::max(high, p);
}

Bounds quadric_bounds(Geometry geometry, const glm::dmat4& to_world) {
  // The extent of an ellipse or ellipsoid along an axis is the length of that row of the map.
  const auto radius = [&](int columns) {
    glm::dvec3 sum(0.0);
    for (int c = 0; c < columns; ++c) sum += glm::dvec3(to_world[c]) * glm::dvec3(to_world[c]);
    return glm::sqrt(sum);
  };
  const glm::dvec3 r = radius(geometry == Geometry::sphere ? 3 : 2);
  const glm::dvec3 base(to_world[3]);
  Bounds bounds;
  bounds.include(base - r);
  bounds.include(base + r);
  if (geometry == Geometry::cylinder) {
    const glm::dvec3 top = base + glm::dvec3(to_world[2]);
    bounds.include(top - r);
    bounds.include(top + r);
  }
  return bounds;
}

CanonicalFrame canonical_frame(const World& world) {
  Bounds bounds;
  for (const WorldShape& shape : world.shapes) {
    if (shape.geometry == Geometry::mesh) {
      for (const glm::uvec3& triangle : shape.mesh.triangles)
        for (int i = 0; i < 3; ++i) bounds.include(shape.mesh.positions[triangle[i]]);
    } else {
      const Bounds box = quadric_bounds(shape.geometry, shape.to_world);
      bounds.include(box.low);
      bounds.include(box.high);
    }
  }
  CanonicalFrame frame;
  if (bounds.empty()) return frame;
  frame.center = 0.5 * bounds.low + 0.5 * bounds.high;
  const glm::dvec3 half = 0.5 * bounds.high - 0.5 * bounds.low;
  const double largest = std::max(half.x, std::max(half.y, half.z));
  if (largest > 0.0) std::frexp(largest, &frame.exponent);  // largest < 2^exponent <= 2 largest
  return frame;
}

}  // namespace oclair
