// Instances of a group of shapes, each a copy in world space: docs/decisions/instances.md.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "world.h"

namespace oclair {

// The shape moved by an invertible matrix. Its front goes where the inverse transpose sends its normals, as in Mitsuba: a
// mirror turns no shape inside out. Nothing if a sphere or cylinder would become another surface. Throws std::range_error if
// a coordinate overflows.
std::optional<WorldShape> instance_of(const WorldShape& shape, const glm::dmat4& to_world);

}  // namespace oclair
