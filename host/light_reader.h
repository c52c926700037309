// <emitter>: area, point, directional, constant.
#pragma once

#include <glm/glm.hpp>

#include "document.h"
#include "world.h"

namespace oclair {

// <emitter type="area"> of a shape: its radiance, W/(m^2 sr). Throws Error(Exit::scene).
glm::dvec3 read_area_light(Element& element);

// point, directional and constant: appends the light to the world. Throws Error(Exit::scene).
void read_light(Element& element, World& world);

}  // namespace oclair
