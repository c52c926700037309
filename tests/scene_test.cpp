// What a world becomes on its way to the device: features, lights, shapes, what is left out.
#include <cstring>
#include <functional>

#include "lights.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Row {
  const char* name;
  std::function<void(World&)> add;
  Features features;
};

WorldShape& add_quadric(World& world, Geometry geometry, double radiance) {
  WorldShape& shape = add_shape(world, diffuse(0.5), Sides::front, radiance);
  shape.geometry = geometry;
  return shape;
}

void add_material(World& world, const Material& material) { add_box(add_shape(world, material, Sides::front).mesh, {-1, -1, -1}, {1, 1, 1}); }

// One texel.
void add_map(World& world, float value) {
  Image image{1, 1, 1, TEXEL_FLOAT, false, std::vector<std::byte>(sizeof value)};
  std::memcpy(image.texels.data(), &value, sizeof value);
  world.lights.push_back({LIGHT_ENVIRONMENT, glm::dvec3(1.0), {}});
  world.lights.back().image = std::make_shared<const Image>(image);
}

void add_radiance_texture(World& world) {
  world.textures.emplace_back().kind = TEXTURE_CHECKERBOARD;
  world.shapes[0].radiance = glm::dvec3(1.0);
  world.shapes[0].radiance_texture = 1;
}

void add_texture(World& world, TextureKind kind) {
  add_material(world, diffuse(0.5));
  world.materials[0].reflectance_texture = 1;
  WorldTexture& texture = world.textures.emplace_back();
  texture.kind = kind;
  if (kind == TEXTURE_BITMAP) {
    Image image;
    image.width = image.height = 1;
    image.texels.resize(3);
    texture.image = std::make_shared<const Image>(image);
  } else if (kind != TEXTURE_CHECKERBOARD) {
    texture.attribute = "vertex_heat";
    Mesh& mesh = world.shapes[0].mesh;
    mesh.attributes.push_back({texture.attribute, false, 1, std::vector<float>(mesh.positions.size(), 0.5f)});
  }
}

Material of_kind(MaterialKind kind) {
  Material m = diffuse(1.0);
  m.kind = kind;
  return m;
}

}  // namespace

TEST(scene_test, a_scene_has_exactly_the_features_that_its_parts_require) {
  const Features flat = FEATURE_DIFFUSE;
  const std::vector<Row> rows = {
      {"nothing", [](World&) {}, 0},
      {"unused material", [](World& w) { w.materials.push_back(dielectric(1.5)); }, 0},
      {"diffuse", [](World& w) { add_material(w, diffuse(0.5)); }, FEATURE_DIFFUSE | FEATURE_TRIANGLES},
      {"mirror", [](World& w) { add_material(w, mirror(0.5)); }, FEATURE_MIRROR | FEATURE_TRIANGLES},
      {"conductor", [](World& w) { add_material(w, of_kind(MATERIAL_CONDUCTOR)); }, FEATURE_CONDUCTOR | FEATURE_TRIANGLES},
      {"dielectric", [](World& w) { add_material(w, dielectric(1.5)); }, FEATURE_DIELECTRIC | FEATURE_TRIANGLES},
      {"oren nayar", [](World& w) { add_material(w, of_kind(MATERIAL_OREN_NAYAR)); }, FEATURE_OREN_NAYAR | FEATURE_TRIANGLES},
      {"oren nayar, qualitative", [](World& w) { add_material(w, of_kind(MATERIAL_OREN_NAYAR_FAST)); }, FEATURE_OREN_NAYAR_FAST | FEATURE_TRIANGLES},
      {"disney", [](World& w) { add_material(w, of_kind(MATERIAL_DISNEY)); }, FEATURE_DISNEY | FEATURE_TRIANGLES},
      {"thin dielectric", [](World& w) { add_material(w, of_kind(MATERIAL_THIN_DIELECTRIC)); }, FEATURE_THIN_DIELECTRIC | FEATURE_TRIANGLES},
      {"bitmap", [](World& w) { add_texture(w, TEXTURE_BITMAP); }, FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_BITMAPS},
      {"checkerboard", [](World& w) { add_texture(w, TEXTURE_CHECKERBOARD); }, FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_CHECKERBOARDS},
      {"attribute", [](World& w) { add_texture(w, TEXTURE_VERTEX_ATTRIBUTE); }, FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_ATTRIBUTES},
      {"blend", [](World& w) { add_material(w, of_kind(MATERIAL_BLEND)), w.materials[0].first = w.materials[0].second = 1, w.materials.push_back(mirror(1.0)); },
       FEATURE_BLEND | FEATURE_MIRROR | FEATURE_TRIANGLES},
      {"mask", [](World& w) { add_material(w, diffuse(0.5)), w.materials[0].transparency = 0.5f; }, FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_OPACITY},
      {"textured mask", [](World& w) { add_texture(w, TEXTURE_CHECKERBOARD), std::swap(w.materials[0].reflectance_texture, w.materials[0].opacity_texture); },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_OPACITY | FEATURE_CHECKERBOARDS},
      {"normal map", [](World& w) { add_texture(w, TEXTURE_BITMAP), std::swap(w.materials[0].reflectance_texture, w.materials[0].normal_texture); },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_NORMAL_MAPS | FEATURE_BITMAPS},
      {"bump map", [](World& w) { add_texture(w, TEXTURE_BITMAP), std::swap(w.materials[0].reflectance_texture, w.materials[0].bump_texture); },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_BUMP_MAPS | FEATURE_BITMAPS},
      {"unused texture", [](World& w) { add_texture(w, TEXTURE_CHECKERBOARD), w.materials[0].reflectance_texture = 0; },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES},
      {"back side", [](World& w) { add_material(w, diffuse(0.5)), w.materials.push_back(mirror(1.0)), w.shapes[0].material_back = 1; },
       FEATURE_DIFFUSE | FEATURE_MIRROR | FEATURE_TRIANGLES},
      {"smooth", [](World& w) { add_material(w, diffuse(0.5)), w.shapes[0].mesh.normals.assign(w.shapes[0].mesh.positions.size(), {0, 0, 1}); },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_SMOOTH_NORMALS},
      {"sphere", [](World& w) { add_quadric(w, Geometry::sphere, 0); }, flat | FEATURE_SPHERES},
      {"disk", [](World& w) { add_quadric(w, Geometry::disk, 0); }, flat | FEATURE_DISKS},
      {"cylinder", [](World& w) { add_quadric(w, Geometry::cylinder, 0); }, flat | FEATURE_CYLINDERS},
      {"sphere light", [](World& w) { add_quadric(w, Geometry::sphere, 1); }, flat | FEATURE_SPHERES | FEATURE_QUADRIC_LIGHTS},
      {"triangle light", [](World& w) { add_material(w, diffuse(0.5)), w.shapes[0].radiance = glm::dvec3(1.0); },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_TRIANGLE_LIGHTS},
      {"black light", [](World& w) { add_material(w, diffuse(0.5)), w.shapes[0].radiance = glm::dvec3(0.0); }, FEATURE_DIFFUSE | FEATURE_TRIANGLES},
      {"point", [](World& w) { w.lights.push_back({LIGHT_POINT, glm::dvec3(1.0), {}}); }, FEATURE_POINT_LIGHTS},
      {"directional", [](World& w) { w.lights.push_back({LIGHT_DIRECTIONAL, glm::dvec3(1.0), {0, 0, 1}}); }, FEATURE_DIRECTIONAL_LIGHTS},
      {"constant", [](World& w) { w.lights.push_back({LIGHT_CONSTANT, glm::dvec3(1.0), {}}); }, FEATURE_CONSTANT_LIGHT},
      {"spot", [](World& w) { w.lights.push_back({LIGHT_SPOT, glm::dvec3(1.0), {}}); }, FEATURE_SPOT_LIGHTS},
      {"environment map", [](World& w) { add_map(w, 1.0f); }, FEATURE_ENVIRONMENT_MAP},
      {"black environment map", [](World& w) { add_map(w, 0.0f); }, 0},
      {"textured triangle light", [](World& w) { add_material(w, diffuse(0.5)), add_radiance_texture(w); },
       FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_TRIANGLE_LIGHTS | FEATURE_TEXTURED_LIGHTS | FEATURE_CHECKERBOARDS},
      {"textured disk light", [](World& w) { add_quadric(w, Geometry::disk, 0), add_radiance_texture(w); },
       FEATURE_DIFFUSE | FEATURE_DISKS | FEATURE_QUADRIC_LIGHTS | FEATURE_TEXTURED_LIGHTS | FEATURE_CHECKERBOARDS},
      {"black constant", [](World& w) { w.lights.push_back({LIGHT_CONSTANT, glm::dvec3(0.0), {}}); }, 0},
      {"lens", [](World& w) { w.camera.aperture_radius = 0.1; }, FEATURE_THIN_LENS},
      {"closed lens", [](World& w) { w.camera.focus_distance = 2.0; }, 0},
      {"orthographic", [](World& w) { w.camera.orthographic = true; }, FEATURE_ORTHOGRAPHIC},
      {"hidden lights", [](World& w) { add_quadric(w, Geometry::sphere, 1), w.integrator.hide_emitters = true; },
       flat | FEATURE_SPHERES | FEATURE_QUADRIC_LIGHTS | FEATURE_HIDDEN_EMITTERS},
      {"hidden nothing", [](World& w) { w.integrator.hide_emitters = true; }, 0},
      {"moments", [](World& w) { w.integrator.moments = true; }, FEATURE_MOMENTS},
      {"Sobol", [](World& w) { w.sampler = SAMPLER_SOBOL; }, FEATURE_SOBOL}};
  Features all = 0;
  for (const Row& row : rows) {
    World world;
    row.add(world);
    EXPECT_EQ(place_scene(world).features, row.features) << row.name;
    all |= row.features;
  }
  EXPECT_EQ(all, every_feature);  // no feature without a row
}

// Lights of a mesh lie in the order of its triangles, so that the light of a hit is found by counting; what has no area is in neither list.
TEST(scene_test, lights_and_triangles_of_a_mesh_are_in_one_order_without_the_degenerate) {
  World world;
  add_frame_box(world);
  Mesh& mesh = add_shape(world, diffuse(0.0), Sides::front, 2.0).mesh;
  for (int i = 0; i < 20; ++i) {
    const double z = 0.04 * i;
    add_triangle(mesh, {0, 0, z}, {0.5, 0, z}, {i % 3 ? 0.1 : 0.25, i % 3 ? 0.3 : 0.0, z});  // every third lies on one line
  }
  WorldShape& ball = add_shape(world, diffuse(0.0), Sides::front, 1.0);
  ball.geometry = Geometry::sphere;
  const Scene scene = place_scene(world);
  EXPECT_EQ(scene.degenerate_primitives, 7u);
  ASSERT_EQ(scene.triangles.size(), 12u + 13u);
  ASSERT_EQ(scene.triangle_shape.size(), scene.triangles.size());
  const Shape& shape = scene.shapes[1];
  EXPECT_EQ(scene.shapes[0].first_light, NONE);
  EXPECT_EQ(shape.first_triangle, 12u);
  ASSERT_EQ(scene.lights.size(), 13u + 1u);
  for (uint i = 0; i < 13; ++i) {
    const Light& light = scene.lights[shape.first_light + i];
    const uint triangle = shape.first_triangle + i;
    EXPECT_EQ(light.primitive, triangle);
    EXPECT_EQ(scene.triangle_shape[triangle], 1u);
    const packed_float3 p0 = scene.positions[scene.triangles[triangle].x], p1 = scene.positions[scene.triangles[triangle].y], p2 = scene.positions[scene.triangles[triangle].z];
    EXPECT_EQ(unpacked(light.position), unpacked(p0));
    EXPECT_EQ(unpacked(light.edge1), unpacked(p1) - unpacked(p0));
    EXPECT_EQ(unpacked(light.edge2), unpacked(p2) - unpacked(p0));
    const double area = 0.5 * glm::length(glm::cross(unpacked(light.edge1), unpacked(light.edge2)));
    EXPECT_NEAR(light.area, area, 2 * unit_roundoff * area);
  }
  const Light& last = scene.lights[scene.shapes[2].first_light];
  EXPECT_EQ(last.primitive, QUADRIC_BIT | 0u);
  EXPECT_EQ(last.kind, static_cast<uint>(LIGHT_QUADRIC));
  EXPECT_EQ(scene.quadrics[0].shape, 2u);
}

TEST(scene_test, a_mesh_of_degenerate_primitives_alone_is_no_light) {
  World world;
  add_frame_box(world);
  add_triangle(add_shape(world, diffuse(0.0), Sides::front, 2.0).mesh, {0, 0, 0}, {0.5, 0, 0}, {0.25, 0, 0});
  const Scene scene = place_scene(world);
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_EQ(scene.shapes[1].first_light, NONE);
  EXPECT_EQ(scene.settings.light_count, 0u);
  EXPECT_EQ(scene.features & FEATURE_TRIANGLE_LIGHTS, 0u);
}

TEST(scene_test, quadrics_have_the_area_and_the_axes_of_their_map) {
  World world;
  add_frame_box(world);  // halves lengths
  const double pi = std::acos(-1.0);
  add_quadric(world, Geometry::sphere, 0).to_world = glm::dmat4(0.5);
  add_quadric(world, Geometry::disk, 0).to_world = glm::dmat4(glm::dvec4(0, 0.5, 0, 0), glm::dvec4(-0.25, 0, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0.5, 0.25, 0, 1));
  WorldShape& cylinder = add_quadric(world, Geometry::cylinder, 0);
  cylinder.to_world = glm::dmat4(glm::dvec4(0.5, 0, 0, 0), glm::dvec4(0, 0.5, 0, 0), glm::dvec4(0, 0, 0.25, 0), glm::dvec4(0, 0, 0, 1));
  cylinder.flip_normals = true;
  for (WorldShape& shape : world.shapes) shape.to_world[3][3] = 1;
  const Scene scene = place_scene(world);
  ASSERT_EQ(scene.quadrics.size(), 3u);
  const double areas[] = {4 * pi * 0.0625, pi * 0.25 * 0.125, 2 * pi * 0.25 * 0.125};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(scene.quadrics[i].area, areas[i], 2 * unit_roundoff * areas[i]);
  EXPECT_EQ(scene.quadrics[0].axis_x.x, 4.0f);
  EXPECT_EQ(scene.quadrics[1].axis_x.y, 4.0f);
  EXPECT_EQ(scene.quadrics[1].axis_y.x, -8.0f);
  EXPECT_EQ(scene.quadrics[1].center.x, 0.25f);
  EXPECT_EQ(scene.quadrics[2].axis_z.z, 8.0f);
  EXPECT_EQ(scene.quadrics[1].flip, 1.0f);
  EXPECT_EQ(scene.quadrics[2].flip, -1.0f);
}

// 2^(e - 1) <= irradiance at distance 1 < 2^e: radiance times canonical area, and the irradiance of the directional light.
TEST(scene_test, the_film_exponent_is_that_of_the_illumination) {
  for (const double brightness : {1e-30, 0.5, 0.75, 1.0, 3.0, 1e30}) {
    World world;
    add_frame_box(world);
    world.lights.push_back({LIGHT_DIRECTIONAL, glm::dvec3(0.1 * brightness), {0, 0, 1}});
    add_box(add_shape(world, diffuse(0.0), Sides::front).mesh, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
    world.shapes.back().radiance = glm::dvec3(0.0, brightness, 0.5 * brightness);
    const Scene scene = place_scene(world);
    const double area = std::ldexp(6.0, -2 * scene.frame.exponent);
    const int e = scene.settings.film_exponent;
    EXPECT_LE(std::ldexp(1.0, e - 1), (area + 0.1) * brightness);
    EXPECT_GT(std::ldexp(1.0, e), (area + 0.1) * brightness);
  }
}

// Floats of 2^-126 and more are told by their exponents: those are the first that the film of this exponent does not take.
TEST(scene_test, the_film_exponent_is_at_least_that_whose_headroom_ends_at_the_smallest_normal_float) {
  for (const double size : {1.0, 1e-3, 1e-9}) {
    World world;
    add_frame_box(world);
    add_quad(add_shape(world, diffuse(0.0), Sides::front).mesh, {0, 0, 0}, {size, 0, 0}, {0, size, 0});
    world.shapes.back().radiance = glm::dvec3(1e-45);
    const double light = std::max(std::ldexp(size * size, -2 * place_scene(world).frame.exponent), 0x1p-30) * 1e-45;
    const int e = place_scene(world).settings.film_exponent;
    EXPECT_EQ(e, std::max(-126 - FILM_HEADROOM_BITS, std::ilogb(light) + 1)) << size;
    EXPECT_EQ(e == -126 - FILM_HEADROOM_BITS, size < 1.0);
  }
}

// Its own radiance must stay below the film's headroom of 2^40, with room for a path's throughput.
TEST(scene_test, a_tiny_light_of_any_radiance_fits_the_film_when_it_is_seen_directly) {
  for (const double size : {1e-3, 1e-9, 1e-15}) {
    World world;
    add_frame_box(world);
    add_quad(add_shape(world, diffuse(0.0), Sides::front).mesh, {0, 0, 0}, {size, 0, 0}, {0, size, 0});
    world.shapes.back().radiance = glm::dvec3(1e20);
    const int e = place_scene(world).settings.film_exponent;
    EXPECT_GT(std::ldexp(1.0, e + FILM_HEADROOM_BITS), 1000.0 * 1e20) << size;
    EXPECT_LE(std::ldexp(1.0, e - 1), std::max(1e20 * size * size, std::ldexp(1e20, -30))) << size;
  }
}

TEST(scene_test, settings_are_those_of_the_world) {
  World world;
  add_frame_box(world);
  world.seed = 0x123456789abcdefull;
  world.film = {64, 32, 1, 2, 30, 20, FilterKind::tent, 1.5, 0.5, true, PixelFormat::rgb};
  world.integrator = {17, 3, true, false, ""};
  const Settings s = place_scene(world).settings;
  EXPECT_EQ(s.seed, 0x123456789abcdefull);
  EXPECT_EQ((std::array<uint, 6>{s.film_width, s.film_height, s.crop_x, s.crop_y, s.crop_width, s.crop_height}), (std::array<uint, 6>{64, 32, 1, 2, 30, 20}));
  EXPECT_EQ((std::array<uint, 5>{s.max_depth, s.rr_depth, s.hide_emitters, s.sample_border, s.filter_count}), (std::array<uint, 5>{17, 3, 1, 1, 3}));
  EXPECT_EQ(s.filter_radius, 1.5f);
}
