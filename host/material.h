// What a material of the scene is like, whatever it is nested in.
#pragma once

#include <functional>
#include <vector>

#include "world.h"

namespace oclair {

bool has_opacity(const Material& material);         // lets a share of the light straight through
bool lets_light_through(const Material& material);  // dielectrics

// Whether it holds for the material, or for one that a blend of it comes down to, blends included; NONE is none. Shared ones are
// asked once, so that blends of blends take no time.
bool any_material(const std::vector<Material>& materials, uint index, const std::function<bool(const Material&)>& holds);

}  // namespace oclair
