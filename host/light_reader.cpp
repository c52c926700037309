#include "light_reader.h"

#include <algorithm>
#include <cmath>

#include "property.h"
#include "texture.h"
#include "transform.h"

namespace oclair {

namespace {

constexpr double DISTORTION = 1e-3;  // of a matrix that is taken for a rotation

void refuse_both(const Element& element, const std::string& one, const std::string& other) {
  if (has_property(element, one) && has_property(element, other))
    refuse(where_is(element, other),
           "\"" + one + "\" and \"" + other + "\" of " + describe(element) + " exclude each other");
}

// An image as radiance, times a factor. That nothing in it is infinite or NaN is sure of every image.
void require_radiances(const std::string& where, const Image& image, bool srgb, double factor) {
  const Texels texels = texels_of(image, srgb);
  for (std::size_t i = 0; i < std::size_t{image.width} * image.height; ++i) {
    const glm::dvec3 value = factor * texels.at(i);
    if (std::min({value.x, value.y, value.z}) >= 0.0 && std::max({value.x, value.y, value.z}) <= GREATEST_EMISSION) continue;
    refuse(where, "texel (" + std::to_string(i % image.width) + ", " + std::to_string(i / image.width) +
                      ") of the image is no radiance: it lies outside [0, 1e30]");
  }
}

// How far the columns of the linear part are from being orthogonal and of the length of the first one.
double distortion(const glm::dmat3& m) {
  const double length2 = glm::dot(m[0], m[0]);
  const glm::dmat3 product = glm::transpose(m) * m;
  double worst = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) worst = std::max(worst, std::abs(product[i][j] - (i == j) * length2));
  return length2 > 0.0 ? worst / length2 : 1.0;
}

// The orthogonal matrix nearest to the order of the columns (Gram-Schmidt); mirrors stay mirrors.
glm::dmat3 orthogonal(const glm::dmat3& m) {
  const glm::dvec3 x = glm::normalize(m[0]), y = glm::normalize(m[1] - glm::dot(m[1], x) * x), z = glm::cross(x, y);
  return {x, y, glm::dot(z, m[2]) < 0.0 ? -z : z};
}

void read_spot(Element& element, WorldLight& light) {
  light.kind = LIGHT_SPOT;
  light.value = emission_property(element, "intensity");
  const auto matrix = transform_property(element, "to_world").value_or(glm::dmat4(1.0));
  if (!(distortion(glm::dmat3(matrix)) < DISTORTION))
    refuse(where_is(element, "to_world"),
           "\"to_world\" of " + describe(element) + " shears it or scales it differently along its axes, which is not supported");
  light.position = glm::dvec3(matrix[3]);
  light.axis = glm::normalize(glm::dvec3(matrix[2]));
  light.cutoff_angle = number_property(element, "cutoff_angle", 20.0);
  if (!(light.cutoff_angle > 0.0 && light.cutoff_angle <= 180.0))
    refuse(where_is(element, "cutoff_angle"), "\"cutoff_angle\" of " + describe(element) + " lies outside (0, 180] degrees");
  light.beam_width = number_property(element, "beam_width", 0.75 * light.cutoff_angle);
  if (!(light.beam_width >= 0.0 && light.beam_width <= light.cutoff_angle))
    refuse(where_is(element, "beam_width"), "\"beam_width\" of " + describe(element) + " lies outside [0, cutoff_angle]");
}

void read_environment_map(Document& document, std::uint32_t index, KnownTextures& textures, World& world, WorldLight& light) {
  light.kind = LIGHT_ENVIRONMENT;
  light.image = image_property(document, index, textures, world);
  auto& element = document.elements[index];
  boolean_property(element, "mis_compensation", false);  // how Mitsuba samples it
  const double scale = number_property(element, "scale", 1.0);
  if (!(scale == 0.0 || (scale >= LEAST_EMISSION && scale <= GREATEST_EMISSION)))
    refuse(where_is(element, "scale"), "\"scale\" of " + describe(element) + " is neither 0 nor within [1e-30, 1e30]");
  light.value = glm::dvec3(scale);
  require_radiances(where_is(element, "filename"), *light.image, light.image->srgb, scale);
  const glm::dmat3 matrix(transform_property(element, "to_world").value_or(glm::dmat4(1.0)));
  if (!(distortion(matrix) < DISTORTION && std::abs(glm::length(matrix[0]) - 1.0) < DISTORTION))
    refuse(where_is(element, "to_world"), "\"to_world\" of " + describe(element) + " scales or shears, which directions cannot");
  light.rotation = orthogonal(matrix);
}

}  // namespace

void read_area_light(Document& document, std::uint32_t index, KnownTextures& textures, World& world, WorldShape& shape) {
  shape.radiance_texture = texture_property(document, index, "radiance", textures, world);
  auto& element = document.elements[index];
  if (has_property(element, "to_world"))
    refuse(where_is(element, "to_world"), describe(element) + " has no \"to_world\": it lies where its shape does");
  refuse_unasked_children(document, element);
  shape.radiance = shape.radiance_texture == 0 ? emission_property(element, "radiance") : glm::dvec3(1.0);
  if (shape.radiance_texture == 0) return;
  const WorldTexture& texture = world.textures[shape.radiance_texture - 1];
  if (texture.image) require_radiances(texture.where, *texture.image, texture.srgb, 1.0);
  for (const MeshAttribute& attribute : shape.mesh.attributes) {
    if (attribute.name != texture.attribute) continue;
    for (std::size_t i = 0; i < attribute.values.size(); ++i)
      if (!(attribute.values[i] >= 0.0f && attribute.values[i] <= static_cast<float>(GREATEST_EMISSION)))
        refuse(texture.where, "number " + std::to_string(i / attribute.channels) + " of the attribute \"" + attribute.name +
                                  "\" is no radiance: it lies outside [0, 1e30]");
  }
}

void read_light(Document& document, std::uint32_t index, KnownTextures& textures, World& world) {
  auto& element = document.elements[index];
  refuse_unasked_children(document, element);
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
  } else if (element.type == "spot") {
    read_spot(element, light);
  } else if (element.type == "envmap") {
    read_environment_map(document, index, textures, world, light);
  } else if (element.type == "area") {
    refuse(element.where, describe(element) + " shines only when it is nested in a <shape>");
  } else {
    refuse(element.where, describe(element) + " is not supported (supported: area, constant, directional, envmap, point, spot)");
  }
  const auto is_environment = [](const WorldLight& l) { return l.kind == LIGHT_CONSTANT || l.kind == LIGHT_ENVIRONMENT; };
  if (is_environment(light) && std::any_of(world.lights.begin(), world.lights.end(), is_environment))
    refuse(element.where, describe(element) + " is a second environment, a scene has one");
  world.lights.push_back(light);
}

}  // namespace oclair
