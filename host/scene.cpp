#include "scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "color.h"
#include "error.h"
#include "filter.h"
#include "light_placer.h"
#include "material.h"
#include "material_placer.h"
#include "parallel.h"

namespace oclair {
namespace {

Features material_features(const Material& m) {
  Features features = 0;
  switch (m.kind) {
    case MATERIAL_DIFFUSE: features |= FEATURE_DIFFUSE; break;
    case MATERIAL_OREN_NAYAR: features |= FEATURE_OREN_NAYAR; break;
    case MATERIAL_OREN_NAYAR_FAST: features |= FEATURE_OREN_NAYAR_FAST; break;
    case MATERIAL_DISNEY: features |= FEATURE_DISNEY; break;
    case MATERIAL_MIRROR: features |= FEATURE_MIRROR; break;
    case MATERIAL_CONDUCTOR: features |= FEATURE_CONDUCTOR; break;
    case MATERIAL_DIELECTRIC: features |= FEATURE_DIELECTRIC; break;
    case MATERIAL_THIN_DIELECTRIC: features |= FEATURE_THIN_DIELECTRIC; break;
    default: features |= FEATURE_BLEND; break;
  }
  if (has_opacity(m)) features |= FEATURE_OPACITY;
  if (m.normal_texture != 0) features |= FEATURE_NORMAL_MAPS;
  if (m.bump_texture != 0) features |= FEATURE_BUMP_MAPS;
  return features;
}

// The triangles that can be seen. The device forms the normal from edges rounded to float32: where those are parallel, or their
// cross product below what float32 holds, there is none.
std::vector<uint> triangles_with_area(const Scene& scene, const Mesh& mesh, std::size_t first_position) {
  BufferVector<char> has_area(mesh.triangles.size());
  parallel_pieces(has_area.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const glm::uvec3 t = mesh.triangles[i];
      const auto position = [&](uint vertex) { return unpack(scene.positions[first_position + vertex]); };
      const glm::dvec3 p0 = position(t.x), p1 = position(t.y), p2 = position(t.z);
      const glm::dvec3 normal = glm::abs(glm::cross(unpack(pack(p1 - p0)), unpack(pack(p2 - p0))));
      has_area[i] = glm::length(glm::cross(p1 - p0, p2 - p0)) > 0.0 && largest(normal) >= std::numeric_limits<float>::min();
    }
  });
  std::vector<uint> faces;
  faces.reserve(has_area.size());
  for (std::size_t i = 0; i < has_area.size(); ++i)
    if (has_area[i]) faces.push_back(static_cast<uint>(i));
  return faces;
}

// Appends what varies with the vertices; returns where it begins, or NONE.
template <class Out, class In, class Convert>
uint append_vertices(BufferVector<Out>& out, const std::vector<In>& in, Convert convert) {
  if (in.empty()) return NONE;
  const std::size_t before = out.size();
  out.resize(before + in.size());
  parallel_pieces(in.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) out[before + i] = convert(in[i]);
  });
  return static_cast<uint>(before);
}

// Scene::triangle_vertices of the triangles that are still without. first_position: of each shape, where the positions of its
// mesh begin.
void count_vertices_in_mesh(Scene& scene, const std::vector<uint>& first_position) {
  const std::size_t before = scene.triangle_vertices.size();
  scene.triangle_vertices.resize(scene.triangles.size());
  parallel_pieces(scene.triangles.size() - before, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = before + first; i < before + end; ++i) {
      const uint offset = first_position[scene.triangle_shape[i]];
      const packed_uint3 v = scene.triangles[i];
      scene.triangle_vertices[i] = {v.x - offset, v.y - offset, v.z - offset};
    }
  });
}

// Takes the mesh apart as it goes.
void add_mesh(Scene& scene, LightPlacer& lights, MaterialPlacer& materials, WorldShape& source,
              std::vector<uint>& first_positions, bool keep_uvs) {
  Mesh& mesh = source.mesh;
  const uint shape_index = static_cast<uint>(scene.shapes.size()) - 1;
  const uint first_position = static_cast<uint>(scene.positions.size());
  first_positions.back() = first_position;
  if (first_position + mesh.positions.size() >= NONE || scene.triangles.size() + mesh.triangles.size() >= QUADRIC_BIT)
    throw Error(Exit::scene, source.where + ": too many triangles: expected fewer than 2^31 triangles and 2^32 vertices in all");
  append_vertices(scene.positions, mesh.positions, [&](const glm::dvec3& p) { return pack(scene.frame.place(p)); });
  mesh.positions = {};
  const std::vector<uint> faces = triangles_with_area(scene, mesh, first_position);
  scene.degenerate_primitives += mesh.triangles.size() - faces.size();
  materials.begin_shape(source, faces);

  Shape& shape = scene.shapes[shape_index];
  shape.material_front = materials.material(source.material_front);
  shape.material_back = materials.material(source.material_back);
  shape.first_triangle = static_cast<uint>(scene.triangles.size());
  shape.first_normal = append_vertices(scene.normals, mesh.normals, pack);
  mesh.normals = {};
  const uint texture = materials.texture(source.radiance_texture);
  if (keep_uvs || materials.needs_uv(source.material_front) || materials.needs_uv(source.material_back) ||
      materials.texture_needs_uv(source.radiance_texture))
    shape.first_uv = append_vertices(scene.uvs, mesh.uvs, [](const glm::dvec2& uv) {
      return std::array{static_cast<float>(uv.x), static_cast<float>(uv.y)};
    });
  const std::size_t before = scene.triangles.size();
  scene.triangles.resize(before + faces.size());
  scene.triangle_shape.resize(before + faces.size(), shape_index);
  parallel_pieces(faces.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const glm::uvec3 v = mesh.triangles[faces[i]] + glm::uvec3(first_position);
      scene.triangles[before + i] = {v.x, v.y, v.z};
    }
  });
  mesh = {};
  if (texture != 0) count_vertices_in_mesh(scene, first_positions);
  if (source.radiance) lights.add_mesh(shape, *source.radiance, texture);
}

double quadric_area(Geometry geometry, const glm::dmat4& to_canonical) {
  const double x = glm::length(glm::dvec3(to_canonical[0])), y = glm::length(glm::dvec3(to_canonical[1]));
  switch (geometry) {
    case Geometry::sphere: return 4.0 * glm::pi<double>() * x * x;
    case Geometry::disk: return glm::pi<double>() * x * y;
    default: return 2.0 * glm::pi<double>() * x * glm::length(glm::dvec3(to_canonical[2]));
  }
}

void add_quadric(Scene& scene, LightPlacer& lights, MaterialPlacer& materials, const WorldShape& source, uint shape_index) {
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
  materials.begin_shape(source, {});
  scene.shapes[shape_index].material_front = materials.material(source.material_front);
  scene.shapes[shape_index].material_back = materials.material(source.material_back);
  quadric.flip = source.flip_normals ? -1.0f : 1.0f;
  quadric.area = static_cast<float>(quadric_area(source.geometry, map));
  scene.quadrics.push_back(quadric);
  if (source.radiance) lights.add_quadric(scene.shapes[shape_index], *source.radiance, materials.texture(source.radiance_texture));
}

void add_shapes(Scene& scene, LightPlacer& lights, MaterialPlacer& materials, std::vector<WorldShape>& sources, bool keep_uvs) {
  std::size_t positions = 0, normals = 0, triangles = 0;
  for (const WorldShape& source : sources) {
    positions += source.mesh.positions.size();
    normals += source.mesh.normals.size();
    triangles += source.mesh.triangles.size();
  }
  scene.positions.reserve(positions);
  scene.normals.reserve(normals);
  scene.triangles.reserve(triangles);
  scene.triangle_shape.reserve(triangles);
  std::vector<uint> first_positions;  // of each shape's mesh
  for (WorldShape& source : sources) {
    const uint index = static_cast<uint>(scene.shapes.size());
    scene.shapes.push_back({NONE, NONE, NONE, 1, 0, NONE, NONE});
    first_positions.push_back(0);
    if (source.geometry == Geometry::mesh) add_mesh(scene, lights, materials, source, first_positions, keep_uvs);
    else add_quadric(scene, lights, materials, source, index);
  }
  const bool vertex_attributes = std::any_of(scene.textures.begin(), scene.textures.end(),
                                             [](const Texture& t) { return t.kind == TEXTURE_VERTEX_ATTRIBUTE; });
  if (scene.normals.empty() && scene.uvs.empty() && !vertex_attributes) scene.triangle_vertices = {};
  else count_vertices_in_mesh(scene, first_positions);
}

// How far the rays of an orthographic camera can go from their film positions (canonical) before any of them meets the scene,
// which lies in [-1, 1]^3. Negative: some start beyond its beginning.
double free_way(const WorldFilm& film, const glm::dvec3& first, const glm::dvec3& step_x, const glm::dvec3& step_y,
                const glm::dvec3& axis) {
  const glm::dvec3 reach = glm::abs(axis);
  double way = std::numeric_limits<double>::infinity();
  for (const double x : {-film.filter_radius, film.width + film.filter_radius})
    for (const double y : {-film.filter_radius, film.height + film.filter_radius})
      way = std::min(way, -glm::dot(axis, first + x * step_x + y * step_y));
  return way - (1.0 + 0x1p-10) * (reach.x + reach.y + reach.z);
}

// depth: becomes Scene::camera_depth.
Camera place_camera(const WorldCamera& source, const WorldFilm& film, const CanonicalFrame& frame, double& depth) {
  const glm::dmat3 linear(source.to_world);
  const glm::dvec2 size(film.width, film.height);
  const glm::dvec2 half(source.tan_half_fov_x, source.tan_half_fov_x * size.y / size.x);
  const glm::dvec2 corner = half * (1.0 - 2.0 * source.principal_point_offset);  // film position (0, 0): left is +x, up is +y
  const glm::dvec2 step = -2.0 * half / size;
  const auto length = [&](double world) { return std::min(frame.place_length(world), 1e30); };
  const auto vector = [&](const glm::dvec3& v) {
    return glm::dvec3(frame.place_length(v.x), frame.place_length(v.y), frame.place_length(v.z));
  };
  const glm::dvec3 axis = glm::normalize(linear[2]);
  glm::dvec3 origin = frame.place(glm::dvec3(source.to_world[3]));
  glm::dvec3 across = linear * glm::dvec3(corner, source.orthographic ? 0.0 : 1.0);
  glm::dvec3 step_x = linear * glm::dvec3(step.x, 0.0, 0.0), step_y = linear * glm::dvec3(0.0, step.y, 0.0);
  double near_clip = length(source.near_clip), far_clip = length(source.far_clip);
  if (source.orthographic) {
    across = vector(across);
    step_x = vector(step_x);
    step_y = vector(step_y);
    // The rays start where the scene can begin, in double: in float32 those of a camera 10^6 away would lie 0.06 off.
    const double start = std::clamp(free_way(film, origin + across, step_x, step_y, axis), near_clip, far_clip);
    origin += start * axis;
    depth = start;
    near_clip = 0.0;
    far_clip -= start;
  }
  Camera camera{};
  camera.orthographic = source.orthographic;
  camera.origin = pack(origin);
  camera.corner = pack(across);
  camera.step_x = pack(step_x);
  camera.step_y = pack(step_y);
  camera.axis = pack(axis);
  if (source.aperture_radius > 0.0) {
    camera.aperture_radius = static_cast<float>(length(source.aperture_radius));
    camera.focus_distance = static_cast<float>(std::max(length(source.focus_distance), 1e-30));
  }
  camera.near_clip = static_cast<float>(near_clip);
  camera.far_clip = static_cast<float>(far_clip);
  return camera;
}

void set_settings(Scene& scene, const World& world) {
  const WorldFilm& film = world.film;
  Settings& s = scene.settings;
  s.seed = world.seed;
  s.sampler = world.sampler;
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

Features features_of(const Scene& scene, const World& world) {
  Features features = 0;
  for (const Material& material : scene.materials) features |= material_features(material);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    if (i + 1 == scene.settings.environment_texture) continue;
    switch (scene.textures[i].kind) {
      case TEXTURE_BITMAP: features |= FEATURE_BITMAPS; break;
      case TEXTURE_CHECKERBOARD: features |= FEATURE_CHECKERBOARDS; break;
      default: features |= FEATURE_ATTRIBUTES; break;
    }
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
      case LIGHT_SPOT: features |= FEATURE_SPOT_LIGHTS; break;
      case LIGHT_DIRECTIONAL: features |= FEATURE_DIRECTIONAL_LIGHTS; break;
      case LIGHT_CONSTANT: features |= FEATURE_CONSTANT_LIGHT; break;
      default: features |= FEATURE_ENVIRONMENT_MAP; break;
    }
    if (light.texture != 0) features |= FEATURE_TEXTURED_LIGHTS;
  }
  if (world.camera.orthographic) features |= FEATURE_ORTHOGRAPHIC;
  if (world.camera.aperture_radius > 0.0) features |= FEATURE_THIN_LENS;
  constexpr Features SEEN_LIGHTS = FEATURE_TRIANGLE_LIGHTS | FEATURE_QUADRIC_LIGHTS | FEATURE_CONSTANT_LIGHT | FEATURE_ENVIRONMENT_MAP;
  if (world.integrator.hide_emitters && (features & SEEN_LIGHTS)) features |= FEATURE_HIDDEN_EMITTERS;
  if (world.integrator.moments) features |= FEATURE_MOMENTS;
  if (world.sampler == SAMPLER_SOBOL) features |= FEATURE_SOBOL;
  return features;
}

}  // namespace

Scene place_scene(World world) {
  Scene scene;
  scene.frame = canonical_frame(world);
  MaterialPlacer materials(world, scene);
  LightPlacer lights(scene);
  add_shapes(scene, lights, materials, world.shapes, world.keep_uvs);
  for (const WorldLight& light : world.lights) lights.add(light, materials);
  lights.finish();
  scene.filter = filter_table(world.film.filter, world.film.filter_radius, world.film.filter_stddev);
  scene.camera = place_camera(world.camera, world.film, scene.frame, scene.camera_depth);
  set_settings(scene, world);
  scene.features = features_of(scene, world);
  return scene;
}

}  // namespace oclair
