#include "scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "distribution.h"
#include "error.h"
#include "filter.h"

namespace oclair {
namespace {

packed_float3 pack(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

glm::dvec3 unpack(const packed_float3& v) { return {v.x, v.y, v.z}; }

double luminance(const glm::dvec3& rgb) { return glm::dot(rgb, glm::dvec3(0.2126, 0.7152, 0.0722)); }  // Rec. ITU-R BT.709

double largest(const glm::dvec3& v) { return std::max(v.x, std::max(v.y, v.z)); }

// What the lights of the scene are gathered in, with the flux that decides how often each is chosen.
struct Lights {
  std::vector<Light>& list;
  std::vector<double> flux;
  double illumination = 0.0;  // irradiance at distance 1, all lights together, the largest channel
  double brightest = 0.0;     // radiance of an area light

  void add(Light light, double power, double irradiance, double radiance) {
    list.push_back(light);
    flux.push_back(power);
    illumination += irradiance;
    brightest = std::max(brightest, radiance);
  }

  // The film is laid out for what is lit; its headroom of 2^40 must also hold a small bright light seen directly.
  double film_scale() const { return std::max(illumination, std::ldexp(brightest, -30)); }
};

std::uint32_t material_feature(const Material& material) {
  switch (material.kind) {
    case MATERIAL_DIFFUSE: return FEATURE_DIFFUSE;
    case MATERIAL_MIRROR: return FEATURE_MIRROR;
    case MATERIAL_CONDUCTOR: return FEATURE_CONDUCTOR;
    default: return FEATURE_DIELECTRIC;
  }
}

void add_mesh(Scene& scene, Lights& lights, const WorldShape& source, uint shape_index) {
  const Mesh& mesh = source.mesh;
  const std::size_t first_position = scene.positions.size();
  const std::size_t first_normal = scene.normals.size();
  if (first_position + mesh.positions.size() >= NONE || scene.triangles.size() + mesh.triangles.size() >= QUADRIC_BIT)
    throw Error(Exit::scene, source.where + ": too many triangles: expected fewer than 2^31 triangles and 2^32 vertices in all");
  Shape& shape = scene.shapes[shape_index];
  shape.first_triangle = static_cast<uint>(scene.triangles.size());
  shape.smooth = !mesh.normals.empty();
  for (const glm::dvec3& p : mesh.positions) scene.positions.push_back(pack(scene.frame.place(p)));
  for (const glm::dvec3& n : mesh.normals) scene.normals.push_back(pack(n));

  const double brightest = source.radiance ? largest(*source.radiance) : 0.0;
  const bool emits = brightest > 0.0;
  if (emits) shape.first_light = static_cast<uint>(scene.lights.size());
  for (const glm::uvec3& triangle : mesh.triangles) {
    const glm::uvec3 v = triangle + glm::uvec3(static_cast<uint>(first_position));
    const glm::dvec3 p0 = unpack(scene.positions[v.x]), p1 = unpack(scene.positions[v.y]), p2 = unpack(scene.positions[v.z]);
    // The device forms the normal from edges rounded to float32: where those are parallel, or their cross product below what float32
    // holds, there is none.
    const glm::dvec3 normal = glm::abs(glm::cross(unpack(pack(p1 - p0)), unpack(pack(p2 - p0))));
    const double area = 0.5 * glm::length(glm::cross(p1 - p0, p2 - p0));
    if (!(area > 0.0) || !(largest(normal) >= std::numeric_limits<float>::min())) {
      ++scene.degenerate_primitives;
      continue;
    }
    const uint primitive = static_cast<uint>(scene.triangles.size());
    scene.triangles.push_back({v.x, v.y, v.z});
    scene.triangle_shape.push_back(shape_index);
    const glm::uvec3 n = triangle + glm::uvec3(static_cast<uint>(first_normal));
    scene.triangle_vertices.push_back(shape.smooth ? packed_uint3{n.x, n.y, n.z} : packed_uint3{0, 0, 0});
    if (!emits) continue;
    Light light{};
    light.kind = LIGHT_TRIANGLE;
    light.radiance = pack(*source.radiance);
    light.position = pack(p0);
    light.edge1 = pack(p1 - p0);
    light.edge2 = pack(p2 - p0);
    light.primitive = primitive;
    light.area = static_cast<float>(area);
    lights.add(light, glm::pi<double>() * area * luminance(*source.radiance), area * brightest, brightest);
  }
  if (shape.first_triangle == scene.triangles.size()) shape.first_light = NONE;
}

double quadric_area(Geometry geometry, const glm::dmat4& to_canonical) {
  const double x = glm::length(glm::dvec3(to_canonical[0])), y = glm::length(glm::dvec3(to_canonical[1]));
  switch (geometry) {
    case Geometry::sphere: return 4.0 * glm::pi<double>() * x * x;
    case Geometry::disk: return glm::pi<double>() * x * y;
    default: return 2.0 * glm::pi<double>() * x * glm::length(glm::dvec3(to_canonical[2]));
  }
}

void add_quadric(Scene& scene, Lights& lights, const WorldShape& source, uint shape_index) {
  glm::dmat4 map = source.to_world;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) map[c][r] = scene.frame.place_length(map[c][r]);
  map[3] = glm::dvec4(scene.frame.place(glm::dvec3(map[3])), 1.0);

  Quadric quadric{};
  quadric.kind = source.geometry == Geometry::sphere ? QUADRIC_SPHERE
                 : source.geometry == Geometry::disk ? QUADRIC_DISK
                                                     : QUADRIC_CYLINDER;
  quadric.center = pack(glm::dvec3(map[3]));
  packed_float3* axes[3] = {&quadric.axis_x, &quadric.axis_y, &quadric.axis_z};
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 column(map[c]);
    const double length2 = glm::dot(column, column);
    if (!(length2 > 0.0)) {  // no extent: nothing can hit it
      ++scene.degenerate_primitives;
      return;
    }
    *axes[c] = pack(column / length2);  // row of the inverse: the columns are orthogonal
  }
  quadric.shape = shape_index;
  quadric.flip = source.flip_normals ? -1.0f : 1.0f;
  const double area = quadric_area(source.geometry, map);
  quadric.area = static_cast<float>(area);
  const double brightest = source.radiance ? largest(*source.radiance) : 0.0;
  if (brightest > 0.0) {
    scene.shapes[shape_index].first_light = static_cast<uint>(scene.lights.size());
    Light light{};
    light.kind = LIGHT_QUADRIC;
    light.radiance = pack(*source.radiance);
    light.primitive = QUADRIC_BIT | static_cast<uint>(scene.quadrics.size());
    light.area = quadric.area;
    lights.add(light, glm::pi<double>() * area * luminance(*source.radiance), area * brightest, brightest);
  }
  scene.quadrics.push_back(quadric);
}

void add_shapes(Scene& scene, Lights& lights, std::vector<WorldShape>& sources) {
  for (WorldShape& source : sources) {
    const uint index = static_cast<uint>(scene.shapes.size());
    scene.shapes.push_back({source.material_front, source.material_back, NONE, 0, 0});
    if (source.geometry == Geometry::mesh) add_mesh(scene, lights, source, index);
    else add_quadric(scene, lights, source, index);
    source.mesh = {};
  }
  if (scene.normals.empty()) scene.triangle_vertices.clear();
}

void add_lights(Scene& scene, Lights& lights, const std::vector<WorldLight>& sources) {
  // Radius^2 of a sphere around [-1, 1]^3: what directional and constant light send into the scene.
  const double radius2 = 3.0;
  for (const WorldLight& source : sources) {
    if (!(largest(source.value) > 0.0)) continue;
    Light light{};
    light.kind = source.kind;
    light.primitive = NONE;
    glm::dvec3 value = source.value;
    double flux = 0.0, distance2 = 1.0;
    if (source.kind == LIGHT_POINT) {
      for (int c = 0; c < 3; ++c) value[c] = std::ldexp(value[c], -2 * scene.frame.exponent);
      const glm::dvec3 position = scene.frame.place(source.position);
      light.position = pack(position);
      // From far away an intensity says nothing about the image: what arrives counts, at a distance of 1 if the light is nearer.
      const glm::dvec3 outside = glm::max(glm::abs(position) - 1.0, 0.0);
      distance2 = std::max(1.0, glm::dot(outside, outside));
      flux = 4.0 * glm::pi<double>() * luminance(value);
    } else if (source.kind == LIGHT_DIRECTIONAL) {
      light.position = pack(source.position);
      flux = glm::pi<double>() * radius2 * luminance(value);
    } else {
      scene.settings.environment = pack(value);
      flux = 4.0 * glm::pi<double>() * glm::pi<double>() * radius2 * luminance(value);
    }
    light.radiance = pack(value);
    if (!(light.radiance.x + light.radiance.y + light.radiance.z > 0.0f)) continue;  // too weak for float32: no light
    lights.add(light, flux, largest(value) / distance2, 0.0);
  }
}

void finish_lights(Scene& scene, const Lights& lights) {
  scene.settings.light_count = static_cast<uint>(scene.lights.size());
  if (scene.lights.empty()) return;
  scene.light_cdf = distribution(lights.flux);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const std::uint64_t end = i + 1 < scene.lights.size() ? scene.light_cdf[i] : std::uint64_t{1} << 32;
    scene.lights[i].probability = static_cast<float>(std::ldexp(static_cast<double>(end - below), -32));
    below = end;
    if (scene.lights[i].kind == LIGHT_CONSTANT) scene.settings.environment_probability = scene.lights[i].probability;
  }
  std::frexp(lights.film_scale(), &scene.settings.film_exponent);
}

Camera place_camera(const WorldCamera& source, const WorldFilm& film, const CanonicalFrame& frame) {
  const glm::dmat3 rotation(source.to_world);
  const glm::dvec2 size(film.width, film.height);
  const glm::dvec2 half(source.tan_half_fov_x, source.tan_half_fov_x * size.y / size.x);
  const glm::dvec2 corner = half * (1.0 - 2.0 * source.principal_point_offset);  // film position (0, 0): left is +x, up is +y
  const glm::dvec2 step = -2.0 * half / size;
  Camera camera{};
  camera.origin = pack(frame.place(glm::dvec3(source.to_world[3])));
  camera.corner = pack(rotation * glm::dvec3(corner, 1.0));
  camera.step_x = pack(rotation * glm::dvec3(step.x, 0.0, 0.0));
  camera.step_y = pack(rotation * glm::dvec3(0.0, step.y, 0.0));
  camera.near_clip = static_cast<float>(frame.place_length(source.near_clip));
  camera.far_clip = static_cast<float>(std::min(frame.place_length(source.far_clip), 1e30));
  return camera;
}

void set_settings(Scene& scene, const World& world) {
  const WorldFilm& film = world.film;
  Settings& s = scene.settings;
  s.seed = world.seed;
  s.film_width = film.width;
  s.film_height = film.height;
  s.crop_x = film.crop_x;
  s.crop_y = film.crop_y;
  s.crop_width = film.crop_width;
  s.crop_height = film.crop_height;
  s.max_depth = world.integrator.max_depth;
  s.rr_depth = world.integrator.rr_depth;
  s.hide_emitters = world.integrator.hide_emitters;
  s.sample_border = film.sample_border;
  s.filter_count = static_cast<uint>(scene.filter.size());
  s.filter_radius = static_cast<float>(film.filter_radius);
}

std::uint32_t features_of(const Scene& scene, const World& world) {
  std::uint32_t features = 0;
  const auto used = [&](uint material) {
    if (material != NONE) features |= material_feature(scene.materials[material]);
  };
  for (const Shape& shape : scene.shapes) {
    used(shape.material_front);
    used(shape.material_back);
  }
  if (!scene.triangles.empty()) features |= FEATURE_TRIANGLES;
  if (!scene.normals.empty()) features |= FEATURE_SMOOTH_NORMALS;
  for (const Quadric& quadric : scene.quadrics)
    features |= quadric.kind == QUADRIC_SPHERE ? FEATURE_SPHERES : quadric.kind == QUADRIC_DISK ? FEATURE_DISKS : FEATURE_CYLINDERS;
  for (const Light& light : scene.lights) {
    switch (light.kind) {
      case LIGHT_TRIANGLE: features |= FEATURE_TRIANGLE_LIGHTS; break;
      case LIGHT_QUADRIC: features |= FEATURE_QUADRIC_LIGHTS; break;
      case LIGHT_POINT: features |= FEATURE_POINT_LIGHTS; break;
      case LIGHT_DIRECTIONAL: features |= FEATURE_DIRECTIONAL_LIGHTS; break;
      default: features |= FEATURE_CONSTANT_LIGHT; break;
    }
  }
  if (world.integrator.moments) features |= FEATURE_MOMENTS;
  return features;
}

}  // namespace

Scene place_scene(World world) {
  Scene scene;
  scene.frame = canonical_frame(world);
  scene.materials = world.materials;
  Lights lights{scene.lights, {}};
  add_shapes(scene, lights, world.shapes);
  add_lights(scene, lights, world.lights);
  finish_lights(scene, lights);
  scene.filter = filter_table(world.film.filter, world.film.filter_radius, world.film.filter_stddev);
  scene.camera = place_camera(world.camera, world.film, scene.frame);
  set_settings(scene, world);
  scene.features = features_of(scene, world);
  return scene;
}

}  // namespace oclair
