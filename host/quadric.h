// Spheres, disks and cylinders: where the unit quadric of cl/types.h goes.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace oclair {

struct PlacedQuadric {
  glm::dmat4 to_world{1.0};  // columns 0-2 are orthogonal
  bool inside_out = false;   // the transform turns the normal round, as Mitsuba sees it
};

// Each takes the composed transform of its shape and gives nothing if that does not lead to a quadric of the same kind:
// sphere: columns of different lengths or not orthogonal; cylinder: the same for x and y, or a sheared axis. Lengths and
// angles are compared to 1e-4: files write few digits. `matrix` must be invertible.
std::optional<PlacedQuadric> place_sphere(const glm::dmat4& matrix);
std::optional<PlacedQuadric> place_cylinder(const glm::dmat4& matrix);

// Any linear map of a disk is a disk that is scaled along two orthogonal axes.
PlacedQuadric place_disk(const glm::dmat4& matrix);

}  // namespace oclair
