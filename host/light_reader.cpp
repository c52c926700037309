#include "light_reader.h"

#include <algorithm>
#include <cmath>

#include "property.h"
#include "transform.h"

namespace oclair {

namespace {

void refuse_children(const Element& element) {
  if (!element.children.empty()) refuse(element.children[0].where, "nothing may be nested in " + describe(element));
}

void refuse_both(const Element& element, const std::string& one, const std::string& other) {
  if (has_property(element, one) && has_property(element, other))
    refuse(where_is(element, other),
           "\"" + one + "\" and \"" + other + "\" of " + describe(element) + " exclude each other");
}

}  // namespace

glm::dvec3 read_area_light(Element& element) {
  refuse_children(element);
  if (has_property(element, "to_world"))
    refuse(where_is(element, "to_world"), describe(element) + " has no \"to_world\": it lies where its shape does");
  return emission_property(element, "radiance");
}

void read_light(Element& element, World& world) {
  refuse_children(element);
  WorldLight light;
  if (element.type == "point") {
    refuse_both(element, "position", "to_world");
    light.kind = LIGHT_POINT;
    light.value = emission_property(element, "intensity");
    const auto matrix = transform_property(element, "to_world").value_or(glm::dmat4(1.0));
    light.position = point_property(element, "position").value_or(glm::dvec3(matrix[3]));
  } else if (element.type == "directional") {
    refuse_both(element, "direction", "to_world");
    light.kind = LIGHT_DIRECTIONAL;
    light.value = emission_property(element, "irradiance");
    const auto matrix = transform_property(element, "to_world").value_or(glm::dmat4(1.0));
    const auto direction = point_property(element, "direction").value_or(glm::dvec3(matrix[2]));
    const double greatest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (greatest == 0.0)
      refuse(where_is(element, has_property(element, "direction") ? "direction" : "to_world"),
             "the direction of " + describe(element) + " is zero");
    light.position = glm::normalize(direction / greatest);
  } else if (element.type == "constant") {
    light.kind = LIGHT_CONSTANT;
    light.value = emission_property(element, "radiance");
    transform_property(element, "to_world");  // a constant has no orientation
    if (std::any_of(world.lights.begin(), world.lights.end(),
                    [](const WorldLight& other) { return other.kind == LIGHT_CONSTANT; }))
      refuse(element.where, "a second " + describe(element) + " is not supported (a scene has one environment)");
  } else if (element.type == "area") {
    refuse(element.where, describe(element) + " shines only when it is nested in a <shape>");
  } else {
    refuse(element.where, describe(element) + " is not supported (supported: area, constant, directional, point)");
  }
  world.lights.push_back(light);
}

}  // namespace oclair
