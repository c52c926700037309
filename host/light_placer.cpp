#include "light_placer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "color.h"
#include "distribution.h"
#include "environment.h"
#include "light_texture.h"

namespace oclair {
namespace {

constexpr double PI = glm::pi<double>();
// film_accepts tells what the film takes by the exponents of normal floats. Below this, floats end before the film's last
// bit does.
constexpr int least_film_exponent = -126 - FILM_HEADROOM_BITS;

double area_of(const Light& triangle) {
  return 0.5 * glm::length(glm::cross(unpack(triangle.edge1), unpack(triangle.edge2)));
}

// Solid angle that counts for a spot light: the integral of its falloff, see cl/light.h. That is 1 - (sin cutoff - sin beam)/
// (cutoff - beam) times 2 pi; with the middle m and the half width h of the ramp, 1 - cos m sin(h)/h, written without cancellation.
double spot_solid_angle(double cutoff, double beam) {
  const double m = 0.5 * (cutoff + beam), h = 0.5 * (cutoff - beam), s = std::sin(0.5 * m);
  const double rest = h < 0.1 ? h * h / 6.0 * (1.0 - h * h / 20.0 * (1.0 - h * h / 42.0)) : 1.0 - std::sin(h) / h;  // 1 - sin(h)/h
  return 2.0 * PI * (2.0 * s * s + std::cos(m) * rest);
}

}  // namespace

void LightPlacer::append(const Light& light, double flux, double illumination, double brightest) {
  scene_.lights.push_back(light);
  flux_.push_back(flux);
  illumination_ += illumination;
  brightest_ = std::max(brightest_, brightest);
}

Light LightPlacer::triangle(uint primitive) const {
  const packed_uint3 v = scene_.triangles[primitive];
  const glm::dvec3 p0 = unpack(scene_.positions[v.x]), p1 = unpack(scene_.positions[v.y]), p2 = unpack(scene_.positions[v.z]);
  Light light{};
  light.kind = LIGHT_TRIANGLE;
  light.position = pack(p0);
  light.edge1 = pack(p1 - p0);
  light.edge2 = pack(p2 - p0);
  light.primitive = primitive;
  light.area = static_cast<float>(0.5 * glm::length(glm::cross(p1 - p0, p2 - p0)));
  light.split = 1;
  return light;
}

void LightPlacer::add_mesh(Shape& shape, const glm::dvec3& radiance, uint texture) {
  const uint end = static_cast<uint>(scene_.triangles.size());
  const double brightest = largest(radiance);
  if (shape.first_triangle == end || !(brightest > 0.0)) return;
  if (texture != 0) return add_textured_mesh(shape, texture);
  shape.first_light = static_cast<uint>(scene_.lights.size());
  for (uint i = shape.first_triangle; i < end; ++i) {
    Light light = triangle(i);
    light.radiance = pack(radiance);
    const double area = area_of(light);
    append(light, PI * area * luminance(radiance), area * brightest, brightest);
  }
}

double LightPlacer::brightest_texel_of(uint texture) {
  const auto [found, is_new] = brightest_texels_.try_emplace(texture);
  if (is_new) found->second = brightest_texel(scene_, texture);
  return found->second;
}

void LightPlacer::add_textured_mesh(Shape& shape, uint texture) {
  const LightTexture means = light_texture(scene_, shape, texture, brightest_texel_of(texture), parts_);
  if (!(means.brightest > 0.0)) return;
  shape.first_light = static_cast<uint>(scene_.lights.size());
  shape.light_split = means.split;
  const uint parts = means.split * means.split, end = static_cast<uint>(scene_.triangles.size());
  parts_ += std::size_t{end - shape.first_triangle} * parts;
  for (uint i = shape.first_triangle; i < end; ++i) {
    const Light whole = triangle(i);
    const glm::dvec3 p0 = unpack(whole.position), e1 = unpack(whole.edge1), e2 = unpack(whole.edge2);
    const double area = area_of(whole) / parts;
    for (uint k = 0; k < parts; ++k) {
      const TrianglePart part = triangle_part(k, means.split);
      Light light = whole;
      light.position = pack(p0 + part.b1 * e1 + part.b2 * e2);
      light.edge1 = pack(part.size * e1);
      light.edge2 = pack(part.size * e2);
      light.area = static_cast<float>(area);
      light.texture = texture;
      light.part = k;
      light.split = means.split;
      const glm::dvec3& mean = means.parts[std::size_t{i - shape.first_triangle} * parts + k];
      light.radiance = pack(mean);
      // A share of the power of the whole shape goes to every part: what the samples of the texture have missed stays likely enough.
      append(light, PI * area * (0.95 * luminance(mean) + 0.05 * luminance(means.mean)), area * largest(mean), means.brightest);
    }
  }
}

void LightPlacer::add_quadric(Shape& shape, const glm::dvec3& radiance, uint texture) {
  const Quadric& quadric = scene_.quadrics.back();
  glm::dvec3 mean = radiance;
  double brightest = largest(radiance);
  if (texture != 0 && brightest > 0.0) {
    const LightTexture means = light_texture(scene_, quadric, texture, brightest_texel_of(texture));
    mean = means.mean;
    brightest = means.brightest;
  }
  if (!(brightest > 0.0)) return;
  shape.first_light = static_cast<uint>(scene_.lights.size());
  Light light{};
  light.kind = LIGHT_QUADRIC;
  light.radiance = pack(mean);
  light.primitive = QUADRIC_BIT | static_cast<uint>(scene_.quadrics.size() - 1);
  light.area = quadric.area;
  light.texture = texture;
  light.split = 1;
  const double area = quadric.area;
  append(light, PI * area * luminance(mean), area * largest(mean), brightest);
}

void LightPlacer::add(const WorldLight& source, MaterialPlacer& materials) {
  // Radius^2 of a sphere around [-1, 1]^3: what directional and constant light send into the scene.
  const double radius2 = 3.0;
  if (!(largest(source.value) > 0.0)) return;
  Light light{};
  light.kind = source.kind;
  light.primitive = NONE;
  glm::dvec3 value = source.value, arriving = value;
  double flux = 0.0, brightest = 0.0;
  EnvironmentDistribution map;
  if (source.kind == LIGHT_POINT || source.kind == LIGHT_SPOT) {
    for (int c = 0; c < 3; ++c) value[c] = std::ldexp(value[c], -2 * scene_.frame.exponent);
    const glm::dvec3 position = scene_.frame.place(source.position);
    light.position = pack(position);
    double solid_angle = 4.0 * PI;
    if (source.kind == LIGHT_SPOT) {
      const double cutoff = glm::radians(source.cutoff_angle), beam = glm::radians(source.beam_width);
      light.edge1 = pack(source.axis);
      light.edge2 = pack({cutoff, beam, 0.0});
      solid_angle = spot_solid_angle(cutoff, beam);
    }
    // From far away an intensity says nothing about the image: what arrives counts, at a distance of 1 if the light is nearer.
    const glm::dvec3 outside = glm::max(glm::abs(position) - 1.0, 0.0);
    arriving = value / std::max(1.0, glm::dot(outside, outside));
    flux = solid_angle * luminance(value);
  } else if (source.kind == LIGHT_DIRECTIONAL) {
    light.position = pack(source.position);
    flux = PI * radius2 * luminance(value);
  } else if (source.kind == LIGHT_ENVIRONMENT) {
    map = environment_distribution(*source.image);
    brightest = largest(value) * map.brightest;
    if (!(brightest > 0.0)) return;
    arriving = value * map.integral / (4.0 * PI);
    flux = PI * radius2 * luminance(value * map.integral);
  } else {
    flux = 4.0 * PI * PI * radius2 * luminance(value);
  }
  light.radiance = pack(value);
  if (!(light.radiance.x + light.radiance.y + light.radiance.z > 0.0f)) return;  // too weak for float32: no light
  Settings& settings = scene_.settings;
  if (source.kind == LIGHT_CONSTANT || source.kind == LIGHT_ENVIRONMENT) settings.environment = light.radiance;
  if (source.kind == LIGHT_ENVIRONMENT) {
    scene_.environment_cdf = std::move(map.cdf);
    settings.environment_texture = materials.image(*source.image, source.image->srgb);
    settings.environment_x = pack(source.rotation[0]);
    settings.environment_y = pack(source.rotation[1]);
    settings.environment_z = pack(source.rotation[2]);
  }
  append(light, flux, largest(arriving), brightest);
}

void LightPlacer::finish() {
  std::vector<Light>& lights = scene_.lights;
  Settings& settings = scene_.settings;
  settings.light_count = static_cast<uint>(lights.size());
  if (lights.empty()) return;
  scene_.light_cdf = distribution(flux_);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const std::uint64_t end = i + 1 < lights.size() ? scene_.light_cdf[i] : std::uint64_t{1} << 32;
    lights[i].probability = static_cast<float>(std::ldexp(static_cast<double>(end - below), -32));
    below = end;
    const bool around = lights[i].kind == LIGHT_CONSTANT || lights[i].kind == LIGHT_ENVIRONMENT;
    if (around) settings.environment_probability = lights[i].probability;
  }
  // The film is laid out for what is lit; its headroom of 2^40 must also hold a small bright light seen directly.
  std::frexp(std::max(illumination_, std::ldexp(brightest_, -30)), &settings.film_exponent);
  settings.film_exponent = std::max(settings.film_exponent, least_film_exponent);
}

}  // namespace oclair
