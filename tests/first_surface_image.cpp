// The functions of cl/aov.h: the first surface along a ray, what it adds to its pixel, a pixel's 16 samples, and the
// primitive in its middle; against double precision on the same floats. (No unit test: under
// the memory checker, which reports nothing, it takes two minutes and a half.)
#include <cstring>
#include <optional>

#include "statistics.h"
#include "textured.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Found {
  packed_float3 position, normal;
  float u, v;
  cl_uint material, primitive, front, passes;
  AovPixel sum;
};

struct Placed {
  Scene scene;
  Bvh bvh;

  explicit Placed(const World& world) : scene(place_scene(world)), bvh(build_bvh(scene, device().bvh_width)) {}

  template <class... Arguments>
  void run(const std::string& kernel, std::size_t count, const Arguments&... arguments) const {
    ASSERT_EQ(bvh.stack_size(), 64);  // one compilation for all tests
    run_with({every_feature, bvh.width, 64}, "first_surface_image.cl", kernel, count, bvh.nodes, bvh.blocks, scene.quadrics,
             scene.shapes, scene.triangle_shape, scene.triangle_vertices, scene.normals, scene.uvs, scene.materials,
             scene.textures, scene.texels, scene.srgb, scene.lights, scene.light_cdf, scene.environment_cdf, scene.filter,
             std::vector<Camera>{scene.camera}, std::vector<Settings>{scene.settings}, arguments...);
  }

  // From one point of the world towards another.
  Ray ray(const glm::dvec3& from, const glm::dvec3& to) const {
    return ray_towards(scene.frame.place(from), scene.frame.place(to));
  }

  // Ray i by the numbers of sample i % 16 of pixel i / 16, or by none.
  std::vector<Found> first_surfaces(const std::vector<Ray>& rays, bool by_chance) const {
    std::vector<cl_uint> pixel;
    std::vector<cl_ulong> sample;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      pixel.push_back(static_cast<cl_uint>(i / AOV_SAMPLES));
      sample.push_back(i % AOV_SAMPLES);
    }
    std::vector<Found> found(rays.size());
    run("first_surfaces", rays.size(), rays, pixel, sample, cl_uint{by_chance}, out(found));
    return found;
  }

  // Depth of a point, canonical, as the layer counts it.
  double depth(const glm::dvec3& p) const {
    return glm::dot(p - unpacked(scene.camera.origin), unpacked(scene.camera.axis));
  }
};

// What triangle `primitive` is at the exact place where the ray meets it, with the bounds of what float32 makes of it.
struct Met {
  uint primitive = NONE;
  double t = std::numeric_limits<double>::infinity(), slack = 0;  // slack: of both barycentric coordinates
  double b1 = 0, b2 = 0;
};

// The nearest of all triangles; nothing where rounding could choose another one.
std::optional<Met> meet(const Scene& scene, const Ray& ray) {
  Met nearest;
  double doubt = std::numeric_limits<double>::infinity(), error = 0;
  for (uint i = 0; i < scene.triangles.size(); ++i) {
    const auto exact = exact_intersection<double>(ray, corners_of(scene, i));
    if (exact.certain_miss) continue;
    const double before = exact.t - exact.t_error;
    if (exact.certain_hit && exact.t < nearest.t) {
      if (nearest.primitive != NONE) doubt = std::min(doubt, nearest.t - error);
      nearest = {i, exact.t, exact.b_error, exact.b1, exact.b2};
      error = exact.t_error;
    } else {
      doubt = std::min(doubt, before);
    }
  }
  if (nearest.primitive == NONE)
    return doubt < std::numeric_limits<double>::infinity() ? std::nullopt : std::optional(nearest);
  return nearest.t + error < doubt ? std::optional(nearest) : std::nullopt;
}

template <class Vector>
Vector interpolated(const Vector& a, const Vector& b, const Vector& c, const Met& met) {
  return (1 - met.b1 - met.b2) * a + met.b1 * b + met.b2 * c;
}

// Triangles of all sizes in [-1, 1]^3, with texture coordinates and normals that are not theirs; the back is another
// material.
World triangles(std::size_t count) {
  Random random(1);
  World world;
  WorldShape& shape = add_shape(world, diffuse(0.25), Sides::both);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 at = random.in_cube(0.7), a = at + random.in_cube(0.3), b = at + random.in_cube(0.3),
                     c = at + random.in_cube(0.3);
    add_triangle(shape.mesh, a, b, c);
    const glm::dvec3 front = glm::normalize(glm::cross(b - a, c - a));
    for (int k = 0; k < 3; ++k) {
      shape.mesh.normals.push_back(glm::normalize(front + 0.5 * random.direction()));
      shape.mesh.uvs.emplace_back(random.between(-1, 2), random.between(-1, 2));
    }
  }
  shape.material_back = static_cast<uint>(world.materials.size());
  world.materials.push_back(diffuse(0.75));
  world.keep_uvs = true;
  look(world, {-3, 0.5, 0.25}, {0, 0, 0}, {0, 0, 1}, 0.4, 24, 16);
  return world;
}

std::vector<Ray> random_rays(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 from = random.in_cube(1.0);
    rays.push_back(ray_towards(from, from + random.direction()));
  }
  return rays;
}

// A wall across +z at depth `z`, its front towards the origin, of the material of that transparency.
void add_wall(World& world, double z, double albedo, double transparency = 0.0) {
  Material material = diffuse(albedo);
  material.transparency = static_cast<float>(transparency);
  add_quad(add_shape(world, material, Sides::both).mesh, {-4, -4, z}, {0, 8, 0}, {8, 0, 0});
}

// Through walls across +z: half of the rays along the axis, where both triangles of each wall meet.
std::vector<Ray> rays_through_walls(const Placed& placed, std::size_t count) {
  Random random(2);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = i % 2 ? random.between(-0.3, 0.3) : 0.0;
    rays.push_back(placed.ray({0, 0, 0}, {x, 0.25 * x, 1}));
  }
  return rays;
}

World walls(const std::vector<double>& transparencies) {
  World world;
  for (std::size_t i = 0; i < transparencies.size(); ++i)
    add_wall(world, 1.0 + static_cast<double>(i), 0.125 * static_cast<double>(i + 1), transparencies[i]);
  return world;
}

// Which wall was met, from 0 on; or how many there are.
std::size_t wall_of(const Found& found, std::size_t walls) { return found.primitive == NONE ? walls : found.primitive / 2; }

Material blend(double weight, uint first, uint second) {
  Material m{};
  m.kind = MATERIAL_BLEND;
  m.weight = static_cast<float>(weight);
  m.first = first;
  m.second = second;
  return m;
}

// One wall of the first of the materials.
World wall_of_materials(const std::vector<Material>& materials) {
  World world;
  world.materials = materials;
  WorldShape& shape = world.shapes.emplace_back();
  shape.material_front = shape.material_back = 0;
  add_quad(shape.mesh, {-4, -4, 1}, {0, 8, 0}, {8, 0, 0});
  return world;
}

}  // namespace

// Position: 8 u of coordinates below 1, and what the barycentric coordinates are off over the edges. Normal: seven roundings
// of unit vectors, over the length of the interpolated one, and three of the normalisation; uv: seven of coordinates
// below 2.
TEST(first_surface_image, of_triangles_is_the_nearest_with_its_interpolated_normal_and_coordinates) {
  const Placed placed(triangles(60));
  const Scene& scene = placed.scene;
  const std::vector<Ray> rays = random_rays(20000, 3);
  const std::vector<Found> found = placed.first_surfaces(rays, true);
  std::size_t hits = 0, misses = 0, unknown = 0, backs = 0, substituted = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::optional<Met> met = meet(scene, rays[i]);
    if (!met) {
      ++unknown;
      continue;
    }
    ASSERT_EQ(found[i].primitive, met->primitive) << i;
    if (met->primitive == NONE) {
      ++misses;
      EXPECT_EQ(found[i].sum.hits, 0u);
      continue;
    }
    ++hits;
    const Corners corners = corners_of(scene, met->primitive);
    const glm::dvec3 a = unpacked(corners[0]), b = unpacked(corners[1]), c = unpacked(corners[2]),
                     wo = -unpacked(rays[i].direction);
    const glm::dvec3 p = interpolated(a, b, c, *met), true_normal = glm::normalize(glm::cross(b - a, c - a));
    const double along = met->slack * (glm::length(b - a) + glm::length(c - a));
    const bool front = glm::dot(true_normal, wo) >= 0;
    EXPECT_LE(glm::length(unpacked(found[i].position) - p), std::sqrt(3.0) * 8 * unit_roundoff + along) << i;
    EXPECT_EQ(found[i].front != 0, front) << i;
    EXPECT_EQ(found[i].material, front ? scene.shapes[0].material_front : scene.shapes[0].material_back);
    backs += !front;

    const packed_uint3 v = scene.triangle_vertices[met->primitive];
    const auto normal_at = [&](uint k) { return unpacked(scene.normals[scene.shapes[0].first_normal + k]); };
    const glm::dvec3 sum = interpolated(normal_at(v.x), normal_at(v.y), normal_at(v.z), *met) * (front ? 1.0 : -1.0);
    const double length = glm::length(sum), normal_slack = (2 * met->slack + 7 * unit_roundoff) / length + 8 * unit_roundoff;
    const glm::dvec3 geometric = front ? true_normal : -true_normal;
    const bool faces = glm::dot(sum / length, wo) > 0;
    if (std::abs(glm::dot(sum / length, wo)) > normal_slack) {
      EXPECT_LE(glm::length(unpacked(found[i].normal) - (faces ? sum / length : geometric)), normal_slack) << i;
    }
    substituted += !faces;

    const auto uv_at = [&](uint k) {
      const std::array<float, 2>& uv = scene.uvs[scene.shapes[0].first_uv + k];
      return glm::dvec2(uv[0], uv[1]);
    };
    const glm::dvec2 uv = interpolated(uv_at(v.x), uv_at(v.y), uv_at(v.z), *met);
    const double uv_slack = 2 * 3 * met->slack + 2 * 7 * unit_roundoff;
    EXPECT_NEAR(found[i].u, uv.x, uv_slack) << i;
    EXPECT_NEAR(found[i].v, uv.y, uv_slack) << i;

    // Alone in its pixel. Depth: a difference and a dot product of numbers below 4.
    const AovPixel& sum_of_one = found[i].sum;
    EXPECT_EQ(sum_of_one.hits, 1u);
    EXPECT_EQ(sum_of_one.albedo.x, front ? 0.25f : 0.75f);
    EXPECT_EQ(std::memcmp(&sum_of_one.normal, &found[i].normal, sizeof(packed_float3)), 0);
    EXPECT_NEAR(sum_of_one.depth, placed.depth(unpacked(found[i].position)), 4 * 6 * unit_roundoff);
    EXPECT_EQ(sum_of_one.u, found[i].u);
    EXPECT_EQ(sum_of_one.v, found[i].v);
  }
  EXPECT_LT(unknown, rays.size() / 50);
  EXPECT_GT(misses, rays.size() / 20);
  EXPECT_GT(hits, rays.size() / 10);
  EXPECT_GT(backs, hits / 5);
  EXPECT_GT(substituted, hits / 200);
}

// A sphere, a disk and a cylinder side by side. Where the surface is met at an angle of cosine c the point errs by 64 u over
// c, in lengths of the frame; normals and coordinates by that over the radius, longitudes over the distance from the axis as
// well.
TEST(first_surface_image, of_quadrics_has_their_normal_and_their_coordinates) {
  World world;
  const double radius = 0.5;
  double x = -1.5;
  for (const Geometry geometry : {Geometry::sphere, Geometry::disk, Geometry::cylinder}) {
    WorldShape& shape = add_shape(world, diffuse(0.25), Sides::both);
    shape.geometry = geometry;
    shape.to_world = glm::dmat4(radius);
    shape.to_world[3] = {x, 0, 0, 1};
    x += 1.5;
  }
  world.keep_uvs = true;
  const Placed placed(world);
  const double scale = std::ldexp(1.0, -placed.scene.frame.exponent), pi = glm::pi<double>();
  Random random(4);
  const std::size_t count = 6000;
  std::vector<glm::dvec3> on;  // where each ray ends, on the unit quadric
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = random.between(0, 2 * pi), distance = std::sqrt(random.unit());
    glm::dvec3 q = random.direction();
    if (i % 3 == 1) q = {distance * std::cos(angle), distance * std::sin(angle), 0};
    if (i % 3 == 2) q = {std::cos(angle), std::sin(angle), random.unit()};
    const glm::dvec3 outwards = i % 3 == 0 ? q : i % 3 == 1 ? glm::dvec3(0, 0, random.sign()) : glm::dvec3(q.x, q.y, 0);
    glm::dvec3 from = random.direction();
    if (glm::dot(from, outwards) < 0) from = -from;
    on.push_back(q);
    // From near by, so that nothing else is in the way.
    const glm::dvec3 at = glm::dvec3(1.5 * (static_cast<double>(i % 3) - 1), 0, 0) + radius * q;
    rays.push_back(placed.ray(at + 0.2 * from, at));
  }
  const std::vector<Found> found = placed.first_surfaces(rays, true);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t which = i % 3;
    const glm::dvec3 q = on[i];
    const glm::dvec3 outwards = which == 0 ? q : which == 1 ? glm::dvec3(0, 0, 1) : glm::dvec3(q.x, q.y, 0);
    const double cosine = glm::dot(outwards, -unpacked(rays[i].direction));
    if (std::abs(cosine) < 0.01) continue;  // there the float ray itself may miss
    ASSERT_EQ(found[i].primitive, QUADRIC_BIT | which) << i;
    // The ray itself ends within 4 u of the frame of its target.
    const double point = 68 * unit_roundoff / std::abs(cosine), local = point / (scale * radius);
    const glm::dvec3 p = placed.scene.frame.place(glm::dvec3(1.5 * (static_cast<double>(which) - 1), 0, 0) + radius * q);
    EXPECT_LE(glm::length(unpacked(found[i].position) - p), point) << i;
    EXPECT_EQ(found[i].front != 0, cosine > 0) << i;
    EXPECT_LE(glm::length(unpacked(found[i].normal) - (cosine > 0 ? outwards : -outwards)), local + 8 * unit_roundoff) << i;
    const double from_axis = std::hypot(q.x, q.y), turn = std::atan2(q.y, q.x) / (2 * pi),
                 longitude = turn < 0 ? turn + 1 : turn;
    const double turn_slack = local / std::max(from_axis, 1e-9) + 16 * unit_roundoff;
    const auto expect_turn = [&](double value) {  // 0 and 1 are the same place
      EXPECT_LE(std::abs(std::remainder(value - longitude, 1.0)), turn_slack) << i;
    };
    expect_turn(which == 1 ? found[i].v : found[i].u);
    if (which == 0) {
      EXPECT_NEAR(found[i].v, std::atan2(from_axis, q.z) / pi, local + 8 * unit_roundoff) << i;
    }
    if (which == 1) {
      EXPECT_NEAR(found[i].u, from_axis, local + 8 * unit_roundoff) << i;
    }
    if (which == 2) {
      EXPECT_NEAR(found[i].v, q.z, local + 8 * unit_roundoff) << i;
    }
  }
}

// By no chance: what lets more than half of the light through is not there.
TEST(first_surface_image, a_mask_counts_by_no_chance_if_it_is_at_least_half_opaque) {
  const float above_half = std::nextafter(0.5f, 1.0f);
  const std::vector<std::pair<std::vector<double>, std::size_t>> table = {
      {{0.0, 0.0}, 0}, {{0.5, 0.0}, 0},     {{above_half, 0.0}, 1}, {{1.0, 0.5}, 1}, {{0.75, 0.6, 0.25, 0.0}, 2},
      {{1.0, 1.0}, 2}, {{1.0, 0.9, 0.8}, 3}};
  for (const auto& [transparencies, expected] : table) {
    const Placed placed(walls(transparencies));
    for (const Found& found : placed.first_surfaces(rays_through_walls(placed, 32), false)) {
      EXPECT_EQ(wall_of(found, transparencies.size()), expected);
      EXPECT_EQ(found.sum.hits, expected < transparencies.size() ? 1u : 0u);
    }
  }
}

// By chance: at each mask anew, and once where a ray runs along the edge of its triangles.
TEST(first_surface_image, a_mask_is_met_as_often_as_it_is_opaque_and_those_behind_it_independently) {
  const Placed placed(walls({0.25, 0.75, 0.0}));
  const std::size_t n = 40000;
  const std::vector<Found> found = placed.first_surfaces(rays_through_walls(placed, n), true);
  for (const std::size_t parity : {0u, 1u}) {
    std::vector<double> observed(4, 0.0);
    for (std::size_t i = parity; i < n; i += 2) {
      const std::size_t wall = wall_of(found[i], 3);
      ++observed[wall];
      if (wall < 3) {
        EXPECT_EQ(found[i].sum.albedo.x, 0.125f * static_cast<float>(wall + 1));
      }
    }
    const double total = static_cast<double>(n) / 2;
    EXPECT_GE(chi_square_test(observed, {total * 0.75, total * 0.25 * 0.25, total * 0.25 * 0.75, 0.0}), significance(2));
  }
}

TEST(first_surface_image, what_is_wholly_transparent_is_never_met_and_what_is_opaque_always) {
  const Placed placed(walls({1.0, 1.0, 0.0, 0.0}));
  for (const Found& found : placed.first_surfaces(rays_through_walls(placed, 4000), true)) ASSERT_EQ(wall_of(found, 4), 2u);
}

// A path ends at its 4096th passage. The sheets lie 1/512 apart, so that the frame's rounding cannot confuse them.
TEST(first_surface_image, behind_4096_passages_there_is_nothing) {
  for (const int sheets : {4095, 4096}) {
    World world;
    Material clear = diffuse(1.0);
    clear.transparency = 1.0f;
    Mesh& mesh = add_shape(world, clear, Sides::both).mesh;
    for (int i = 0; i < sheets; ++i) {
      const double z = 1 + i / 512.0;
      add_triangle(mesh, {-4, -4, z}, {4, -4, z}, {0, 8, z});
    }
    add_wall(world, 10, 0.5);
    const Placed placed(world);
    const Found found = placed.first_surfaces({placed.ray({0, 0, 0}, {0.1, 0.05, 1})}, true)[0];
    EXPECT_EQ(found.primitive == NONE, sheets == 4096);
    EXPECT_EQ(found.passes, static_cast<cl_uint>(sheets));
  }
}

TEST(first_surface_image, a_light_is_a_surface_unless_lights_are_hidden) {
  for (const bool hidden : {false, true}) {
    World world = walls({0.0, 0.0});
    world.shapes[0].radiance = glm::dvec3(2.0);
    world.integrator.hide_emitters = hidden;
    const Placed placed(world);
    for (const Found& found : placed.first_surfaces(rays_through_walls(placed, 32), true))
      EXPECT_EQ(wall_of(found, 2), hidden ? 1u : 0u);
  }
}

TEST(first_surface_image, a_side_without_material_is_a_black_surface) {
  World world = walls({0.0});
  world.shapes[0].material_front = world.shapes[0].material_back = NONE;
  const Placed placed(world);
  for (const Found& found : placed.first_surfaces(rays_through_walls(placed, 32), true)) {
    EXPECT_EQ(found.material, NONE);
    EXPECT_EQ(found.sum.hits, 1u);
    EXPECT_EQ(found.sum.albedo.x, 0.0f);
    EXPECT_EQ(found.sum.normal.z, -1.0f);
  }
}

TEST(first_surface_image, of_a_blend_the_heavier_material_counts_by_no_chance) {
  const float above_half = std::nextafter(0.5f, 1.0f);
  for (const auto& [weight, albedo] : std::vector<std::pair<double, float>>{
           {0.0, 0.25f}, {0.3, 0.25f}, {0.5, 0.25f}, {above_half, 0.75f}, {0.9, 0.75f}, {1.0, 0.75f}}) {
    const Placed placed(wall_of_materials({blend(weight, 1, 2), diffuse(0.25), diffuse(0.75)}));
    for (const Found& found : placed.first_surfaces(rays_through_walls(placed, 32), false))
      EXPECT_EQ(found.sum.albedo.x, albedo) << weight;
  }
}

TEST(first_surface_image, of_blends_within_blends_one_and_the_same_counts_by_no_chance) {
  const Placed placed(wall_of_materials(
      {blend(0.5, 1, 2), blend(0.4, 3, 4), blend(0.7, 5, 6), diffuse(0.1), diffuse(0.2), diffuse(0.3), diffuse(0.4)}));
  const std::vector<Found> found = placed.first_surfaces(rays_through_walls(placed, 64), false);
  for (const Found& f : found) EXPECT_EQ(f.sum.albedo.x, found[0].sum.albedo.x);
}

// The materials of a blend, one of them half transparent: the blend chooses first, then its material decides.
TEST(first_surface_image, of_a_blend_each_material_is_seen_as_often_as_its_weight_and_its_opacity_say) {
  Material mask = diffuse(0.75);
  mask.transparency = 0.5f;
  World world = wall_of_materials({blend(0.3, 1, 2), diffuse(0.25), mask});
  add_wall(world, 2, 0.5);
  const Placed placed(world);
  const std::size_t n = 40000;
  std::vector<double> observed(3, 0.0);
  const std::vector<Found> found = placed.first_surfaces(rays_through_walls(placed, n), true);
  // Not where both triangles are met: there a blend with a mask is chosen from twice.
  for (std::size_t i = 1; i < n; i += 2) {
    const float albedo = found[i].sum.albedo.x;
    ++observed[albedo == 0.25f ? 0 : albedo == 0.75f ? 1 : 2];
  }
  const double total = static_cast<double>(n) / 2, weight = static_cast<float>(0.3);
  EXPECT_GE(chi_square_test(observed, {total * (1 - weight), total * weight / 2, total * weight / 2}), false_alarm);
}

// Four texels without interpolation over the wall, as colour and, in the other order, as opacity: 0, 1, 1, 1.
TEST(first_surface_image, textures_say_colour_and_opacity_where_the_surface_is_met) {
  World world = walls({0.0, 0.0});
  world.shapes[0].mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  const std::vector<float> colours = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f, 0.7f, 0.8f, 0.9f, 1.0f, 0.0f, 0.25f};
  world.materials[0].reflectance_texture = add_bitmap(world, 2, 2, 3, colours);
  world.materials[0].opacity_texture = add_bitmap(world, 2, 2, 1, {1.0f, 1.0f, 1.0f, 0.0f});
  for (WorldTexture& texture : world.textures) texture.nearest = true;
  const Placed placed(world);
  Random random(5);
  std::vector<Ray> rays;
  std::vector<std::size_t> texel;
  for (std::size_t i = 0; i < 2000; ++i) {
    const double u = random.unit(), v = random.unit();
    if (std::min(std::abs(u - 0.5), std::abs(v - 0.5)) < 1e-4) continue;
    rays.push_back(placed.ray({0, 0, 0}, {8 * u - 4, 8 * v - 4, 1}));
    texel.push_back((u < 0.5 ? 0u : 1u) + (v < 0.5 ? 0u : 2u));
  }
  const std::vector<Found> found = placed.first_surfaces(rays, true);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (texel[i] == 3) {
      EXPECT_NE(wall_of(found[i], 2), 0u) << i;
      continue;
    }
    ASSERT_EQ(wall_of(found[i], 2), 0u) << i;
    EXPECT_EQ(found[i].sum.albedo.x, colours[3 * texel[i]]);
    EXPECT_EQ(found[i].sum.albedo.y, colours[3 * texel[i] + 1]);
    EXPECT_EQ(found[i].sum.albedo.z, colours[3 * texel[i] + 2]);
  }
}

// Masks, blends, a thin lens and pixels in which some samples meet nothing: float sums in the order of the samples, bit for
// bit.
TEST(first_surface_image, a_pixel_is_the_sum_of_its_first_16_samples_in_their_order) {
  World world = triangles(12);
  world.materials[0] = blend(0.5, 2, 3);
  Material mask = diffuse(0.5);
  mask.transparency = 0.5f;
  world.materials.push_back(mask);
  world.materials.push_back(diffuse(0.9));
  world.camera.aperture_radius = 0.05;
  world.camera.focus_distance = 2.5;
  const Placed placed(world);
  const uint width = world.film.width;
  const std::size_t pixels = width * world.film.height;
  std::vector<Ray> rays;
  for (cl_uint p = 0; p < pixels; ++p) {
    std::vector<Ray> of_pixel(AOV_SAMPLES);
    run("camera_test.cl", "samples", AOV_SAMPLES, std::vector<Camera>{placed.scene.camera},
        std::vector<Settings>{placed.scene.settings}, placed.scene.filter, cl_uint{p % width}, cl_uint{p / width},
        out(of_pixel));
    rays.insert(rays.end(), of_pixel.begin(), of_pixel.end());
  }
  const std::vector<Found> found = placed.first_surfaces(rays, true);
  std::vector<AovPixel> sums(pixels);
  placed.run("pixels", pixels, out(sums));
  std::vector<cl_uint> primitives(pixels);
  placed.run("primitives", pixels, out(primitives));
  std::size_t empty = 0, full = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    AovPixel expected{};
    expected.primitive = primitives[p];
    expected.pixel = static_cast<cl_uint>(p);
    const auto add = [](packed_float3& sum, const packed_float3& v) { sum = {sum.x + v.x, sum.y + v.y, sum.z + v.z}; };
    for (std::size_t k = 0; k < AOV_SAMPLES; ++k) {
      const AovPixel& one = found[p * AOV_SAMPLES + k].sum;
      expected.hits += one.hits;
      add(expected.albedo, one.albedo);
      add(expected.normal, one.normal);
      expected.u += one.u;
      expected.v += one.v;
      expected.depth += one.depth;
    }
    EXPECT_EQ(std::memcmp(&sums[p], &expected, sizeof expected), 0) << p;
    empty += expected.hits == 0;
    full += expected.hits == AOV_SAMPLES;
  }
  EXPECT_GT(empty, 0u);
  EXPECT_GT(full, 0u);
}

// The lens is so wide that hardly a sample's ray is that of the middle; the one through the middle of the lens is the
// pinhole's.
TEST(first_surface_image, the_primitive_is_that_of_the_pinhole_through_the_middle_of_the_pixel) {
  World world = triangles(60);
  world.camera.aperture_radius = 1.0;
  world.camera.focus_distance = 1.0;
  const Placed placed(world);
  const Camera& camera = placed.scene.camera;
  const std::size_t pixels = world.film.width * world.film.height;
  std::vector<cl_uint> primitives(pixels);
  placed.run("primitives", pixels, out(primitives));
  std::size_t hits = 0, unknown = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    const double x = static_cast<double>(p % world.film.width) + 0.5, y = static_cast<double>(p / world.film.width) + 0.5;
    const glm::dvec3 along = unpacked(camera.corner) + x * unpacked(camera.step_x) + y * unpacked(camera.step_y);
    // The device's ray starts at the box and errs by some u more than this one: rays are compared that a relative change of
    // 1e-5 in their direction takes nowhere else.
    std::optional<Met> met;
    bool sure = true;
    for (const glm::dvec3& d : {glm::dvec3(0, 0, 0), glm::dvec3(1e-5, 0, 0), glm::dvec3(-1e-5, 0, 0), glm::dvec3(0, 1e-5, 0),
                                glm::dvec3(0, -1e-5, 0), glm::dvec3(0, 0, 1e-5), glm::dvec3(0, 0, -1e-5)}) {
      const glm::dvec3 origin = unpacked(camera.origin);
      const auto one = meet(placed.scene, ray_towards(origin, origin + along + glm::length(along) * d));
      sure = sure && one && (!met || one->primitive == met->primitive);
      met = one;
    }
    if (!sure) {
      ++unknown;
      continue;
    }
    EXPECT_EQ(primitives[p], met->primitive) << p;
    hits += met->primitive != NONE;
  }
  EXPECT_LT(unknown, pixels / 20 + 2);
  EXPECT_GT(hits, pixels / 10);
}
