#include "frame.h"

#include <cmath>
#include <mutex>

#include "parallel.h"

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
      const Mesh& mesh = shape.mesh;
      std::mutex mutex;
      parallel_pieces(mesh.triangles.size(), [&](std::size_t first, std::size_t end) {
        Bounds piece;
        for (std::size_t i = first; i < end; ++i)
          for (int k = 0; k < 3; ++k) piece.include(mesh.positions[mesh.triangles[i][k]]);
        const std::lock_guard lock(mutex);
        bounds.include(piece.low);
        bounds.include(piece.high);
      });
    } else {
      const Bounds box = quadric_bounds(shape.geometry, shape.to_world);
      bounds.include(box.low);
      bounds.include(box.high);
    }
  }
  CanonicalFrame frame;
  if (bounds.empty()) return frame;
  frame.center = 0.5 * bounds.low + 0.5 * bounds.high + 0.0;  // never -0, whichever zero was met first
  const glm::dvec3 half = 0.5 * bounds.high - 0.5 * bounds.low;
  const double largest = std::max(half.x, std::max(half.y, half.z));
  if (largest > 0.0) std::frexp(largest, &frame.exponent);  // largest < 2^exponent <= 2 largest
  return frame;
}

}  // namespace oclair
