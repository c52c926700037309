// Complex refractive indices of conductors by name.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>

namespace oclair {

struct Conductor {
  const char* name;  // case matters: Ta is not TA
  glm::dvec3 eta;    // real part, relative to vacuum, per channel of linear sRGB
  glm::dvec3 k;      // extinction coefficient, likewise
};

std::span<const Conductor> conductors();

// nullptr for a name that is not in the table.
const Conductor* find_conductor(const std::string& name);

}  // namespace oclair
