#include "../host/reader.h"

#include <cmath>

#include "scene_text.h"

namespace oclair {

namespace {

// Numbers marked "measured" were read out of Mitsuba 3.9.1, variant scalar_rgb.

World sensor(const std::string& content) {
  return SceneDirectory().read("<sensor type=\"perspective\">" + content + "</sensor>");
}
World film(const std::string& content) { return sensor("<film type=\"hdrfilm\">" + content + "</film>"); }
World integrator(const std::string& text) { return world_of(text); }
Material material(const std::string& bsdf) { return world_of(bsdf).materials.at(0); }
WorldShape shape(const std::string& text) { return world_of(text).shapes.at(0); }
WorldLight light(const std::string& text) { return world_of(text).lights.at(0); }

double fov_x(const World& world) { return glm::degrees(2.0 * std::atan(world.camera.tan_half_fov_x)); }

bool warns(const World& world, const std::string& part) {
  for (const auto& line : world.warnings)
    if (line.find(part) != std::string::npos) return true;
  return false;
}

// Camera

TEST(reader_test, sensor_without_parameters_has_the_defaults_of_mitsuba) {
  const auto world = sensor("");
  EXPECT_NEAR(fov_x(world), 38.1848, 5e-5);  // measured: 50 mm on 4:3
  EXPECT_EQ(world.camera.to_world, glm::dmat4(1.0));
  EXPECT_EQ(world.camera.near_clip, 1e-2);
  EXPECT_EQ(world.camera.far_clip, 1e4);
  EXPECT_EQ(world.camera.principal_point_offset, glm::dvec2(0.0));
  EXPECT_EQ(world.samples_per_pixel, 4u);
  EXPECT_EQ(world.seed, 0u);
}

TEST(reader_test, fov_axis_says_which_extent_the_angle_covers) {
  const auto fov = [](const std::string& axis) {
    return fov_x(sensor("<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"" + axis + "\"/>"));
  };
  EXPECT_NEAR(fov("x"), 40.0, 1e-12);
  EXPECT_NEAR(fov("X"), 40.0, 1e-12);
  EXPECT_NEAR(fov("y"), 51.7740097, 5e-6);        // measured, film 768 x 576
  EXPECT_NEAR(fov("smaller"), 51.7740097, 5e-6);  // measured
  EXPECT_NEAR(fov("larger"), 40.0, 1e-12);        // measured
  EXPECT_NEAR(fov("diagonal"), 32.468605, 5e-6);  // measured
}

TEST(reader_test, fov_refers_to_the_film_and_not_to_its_crop_window) {
  const auto world = sensor(
      "<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"y\"/><film type=\"hdrfilm\"><integer "
      "name=\"width\" value=\"200\"/>"
      "<integer name=\"height\" value=\"100\"/><integer name=\"crop_width\" value=\"50\"/></film>");
  EXPECT_NEAR(fov_x(world), 72.1047745, 5e-6);  // measured
}

TEST(reader_test, focal_length_is_that_of_a_36_by_24_mm_film) {
  for (const auto* text : {"35mm", "35"})
    EXPECT_NEAR(fov_x(sensor("<string name=\"focal_length\" value=\"" + std::string(text) + "\"/>")), 52.6225443,
                5e-6);  // measured
}

TEST(reader_test, an_integer_will_do_where_a_float_is_expected) {
  EXPECT_NEAR(fov_x(sensor("<integer name=\"fov\" value=\"40\"/>")), 40.0, 1e-12);
}

TEST(reader_test, clipping_and_principal_point_are_read) {
  const auto camera = sensor(
                          "<float name=\"near_clip\" value=\"0.5\"/><float name=\"far_clip\" value=\"9\"/>"
                          "<float name=\"principal_point_offset_x\" value=\"0.1\"/><float name=\"principal_point_offset_y\" "
                          "value=\"-0.2\"/>")
                          .camera;
  EXPECT_EQ(camera.near_clip, 0.5);
  EXPECT_EQ(camera.far_clip, 9.0);
  EXPECT_EQ(camera.principal_point_offset, glm::dvec2(0.1, -0.2));
}

// Film

TEST(reader_test, film_without_parameters_has_the_defaults_of_mitsuba) {
  const auto f = film("").film;
  EXPECT_EQ(f.width, 768u);
  EXPECT_EQ(f.height, 576u);
  EXPECT_EQ(f.crop_width, 768u);
  EXPECT_EQ(f.crop_height, 576u);
  EXPECT_EQ(f.filter, FilterKind::gaussian);
  EXPECT_EQ(f.filter_stddev, 0.5);
  EXPECT_EQ(f.filter_radius, 2.0);
  EXPECT_EQ(f.pixel_format, PixelFormat::rgb);
  EXPECT_FALSE(f.sample_border);
}

TEST(reader_test, crop_window_is_the_film_unless_it_is_given) {
  const auto whole = film("<integer name=\"width\" value=\"20\"/><integer name=\"height\" value=\"10\"/>").film;
  EXPECT_EQ(whole.crop_width, 20u);
  EXPECT_EQ(whole.crop_height, 10u);
  const auto part = film(
                        "<integer name=\"width\" value=\"20\"/><integer name=\"crop_offset_x\" value=\"3\"/><integer "
                        "name=\"crop_width\" value=\"17\"/>"
                        "<integer name=\"crop_offset_y\" value=\"4\"/><integer name=\"crop_height\" value=\"5\"/>")
                        .film;
  EXPECT_EQ(part.crop_x, 3u);
  EXPECT_EQ(part.crop_width, 17u);
  EXPECT_EQ(part.crop_y, 4u);
  EXPECT_EQ(part.crop_height, 5u);
}

// Two samples of a pixel beyond would be one and the same: rng_key numbers 2^31 pixels.
TEST(reader_test, film_has_at_most_two_to_the_31_pixels) {
  EXPECT_EQ(film("<integer name=\"width\" value=\"65536\"/><integer name=\"height\" value=\"32768\"/>").film.height, 32768u);
  const auto file = std::filesystem::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes" / "furnace.xml";
  EXPECT_NO_THROW(read_scene(file, {}, {glm::uvec2(65536, 32768), {}}));
  try {
    read_scene(file, {}, {glm::uvec2(32769, 65536), {}});
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::usage);
    EXPECT_STREQ(error.what(), "film size 32769x65536 has more pixels than expected: at most 2^31");
  }
}

TEST(reader_test, every_pixel_format_is_read) {
  const std::pair<const char*, PixelFormat> formats[] = {{"luminance", PixelFormat::luminance},
                                                         {"luminance_alpha", PixelFormat::luminance_alpha},
                                                         {"rgb", PixelFormat::rgb},
                                                         {"RGBA", PixelFormat::rgba},
                                                         {"xyz", PixelFormat::xyz},
                                                         {"xyza", PixelFormat::xyza}};
  for (const auto& [name, format] : formats)
    EXPECT_EQ(film("<string name=\"pixel_format\" value=\"" + std::string(name) + "\"/>").film.pixel_format, format) << name;
}

TEST(reader_test, component_formats_of_mitsuba_are_accepted) {
  for (const std::string name : {"float16", "float32", "uint32"}) {
    const auto world =
        film("<string name=\"component_format\" value=\"" + name + "\"/><string name=\"file_format\" value=\"exr\"/>");
    EXPECT_FALSE(warns(world, "_format"));
  }
}

TEST(reader_test, filters_have_the_radii_of_mitsuba) {
  const auto box = film("<rfilter type=\"box\"/>").film, tent = film("<rfilter type=\"tent\"/>").film;
  EXPECT_EQ(box.filter, FilterKind::box);
  EXPECT_EQ(box.filter_radius, 0.5);
  EXPECT_EQ(tent.filter, FilterKind::tent);
  EXPECT_EQ(tent.filter_radius, 1.0);
  const auto gaussian = film("<rfilter type=\"gaussian\"><float name=\"stddev\" value=\"0.8\"/></rfilter>").film;
  EXPECT_EQ(gaussian.filter_stddev, 0.8);
  EXPECT_DOUBLE_EQ(gaussian.filter_radius, 3.2);  // measured
}

// And nothing else: which numbers are drawn is not the scene's to say.
TEST(reader_test, samplers_of_every_type_give_count_and_seed) {
  for (const std::string type : {"independent", "stratified", "multijitter", "orthogonal", "ldsampler"}) {
    const auto world =
        sensor("<sampler type=\"" + type +
               "\"><integer name=\"sample_count\" value=\"5\"/><integer name=\"seed\" value=\"7\"/></sampler>");
    EXPECT_EQ(world.samples_per_pixel, 5u);
    EXPECT_EQ(world.seed, 7u);
    EXPECT_EQ(world.sampler, SAMPLER_SOBOL);
  }
}

// Integrator

TEST(reader_test, path_is_unbounded_and_plays_roulette_from_depth_five) {
  const auto i = integrator("<integrator type=\"path\"/>").integrator;
  EXPECT_EQ(i.max_depth, 0xffffffffu);
  EXPECT_EQ(i.rr_depth, 5u);
  EXPECT_FALSE(i.hide_emitters);
  EXPECT_FALSE(i.moments);
}

TEST(reader_test, path_parameters_are_read) {
  const auto i =
      integrator(
          "<integrator type=\"path\"><integer name=\"max_depth\" value=\"0\"/><integer name=\"rr_depth\" value=\"3\"/>"
          "<boolean name=\"hide_emitters\" value=\"TRUE\"/></integrator>")
          .integrator;
  EXPECT_EQ(i.max_depth, 0u);
  EXPECT_EQ(i.rr_depth, 3u);
  EXPECT_TRUE(i.hide_emitters);
  EXPECT_EQ(
      integrator("<integrator type=\"path\"><integer name=\"max_depth\" value=\"-1\"/></integrator>").integrator.max_depth,
      0xffffffffu);
}

TEST(reader_test, direct_is_a_path_of_depth_two) {
  EXPECT_EQ(integrator("<integrator type=\"direct\"/>").integrator.max_depth, 2u);
}

TEST(reader_test, sample_counts_of_direct_are_warned_of) {
  EXPECT_TRUE(warns(integrator("<integrator type=\"direct\"><integer name=\"emitter_samples\" value=\"4\"/></integrator>"),
                    "changes only the noise"));
}

TEST(reader_test, moment_asks_for_moments_of_what_it_holds) {
  const auto i = integrator(
                     "<integrator type=\"moment\"><integrator type=\"path\"><integer name=\"max_depth\" "
                     "value=\"3\"/></integrator></integrator>")
                     .integrator;
  EXPECT_TRUE(i.moments);
  EXPECT_EQ(i.max_depth, 3u);
}

// Measured: Mitsuba reads the parameter of <integrator type="moment"> and does nothing with it.
TEST(reader_test, hide_emitters_counts_in_the_integrator_that_moment_holds) {
  const std::string hide = "<boolean name=\"hide_emitters\" value=\"true\"/>";
  EXPECT_TRUE(world_of("<integrator type=\"moment\"><integrator type=\"direct\">" + hide + "</integrator></integrator>")
                  .integrator.hide_emitters);
  const auto outside = world_of("<integrator type=\"moment\">" + hide + "<integrator type=\"direct\"/></integrator>");
  EXPECT_FALSE(outside.integrator.hide_emitters);
  EXPECT_TRUE(warns(outside, "parameter \"hide_emitters\" of <integrator type=\"moment\"> is not used"));
}

TEST(reader_test, missing_integrator_is_a_path_and_is_warned_of) {
  const auto world = world_of("");
  EXPECT_EQ(world.integrator.max_depth, 0xffffffffu);
  EXPECT_TRUE(warns(world, "scene.xml:1: <scene> has no <integrator>"));
}

// Measured: focus_distance is that of far_clip by default; the field of view is that of a perspective camera.
TEST(reader_test, a_thin_lens_is_a_perspective_camera_with_an_aperture) {
  const auto lens = [](const std::string& content) {
    return SceneDirectory().read("<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.1\"/>" + content + "</sensor>").camera;
  };
  EXPECT_EQ(lens("").aperture_radius, 0.1);
  EXPECT_EQ(lens("").focus_distance, 1e4);
  EXPECT_EQ(lens("<float name=\"far_clip\" value=\"7\"/>").focus_distance, 7.0);
  EXPECT_EQ(lens("<float name=\"focus_distance\" value=\"3\"/>").focus_distance, 3.0);
  EXPECT_NEAR(lens("<float name=\"fov\" value=\"90\"/>").tan_half_fov_x, 1.0, 1e-15);
  EXPECT_FALSE(lens("").orthographic);
  EXPECT_EQ(sensor("").camera.aperture_radius, 0.0);
}

// Measured: a scale of the camera makes the film larger and moves the near plane; the planes stay as far apart as they were.
TEST(reader_test, an_orthographic_film_is_as_wide_as_its_transform_says) {
  const auto camera = SceneDirectory()
                          .read("<sensor type=\"orthographic\"><float name=\"near_clip\" value=\"1\"/><float name=\"far_clip\" value=\"5\"/>"
                                "<transform name=\"to_world\"><scale value=\"3\"/></transform></sensor>")
                          .camera;
  EXPECT_TRUE(camera.orthographic);
  EXPECT_EQ(camera.to_world[0].x * camera.tan_half_fov_x, 3.0);
  EXPECT_EQ(camera.near_clip, 3.0);
  EXPECT_EQ(camera.far_clip, 7.0);
  EXPECT_EQ(camera.aperture_radius, 0.0);
}

TEST(reader_test, a_principal_point_is_only_read_by_the_pinhole) {
  for (const char* type : {"orthographic", "thinlens"})
    EXPECT_TRUE(warns(SceneDirectory().read("<sensor type=\"" + std::string(type) + "\"><float name=\"aperture_radius\" value=\"1\"/>"
                                            "<float name=\"principal_point_offset_x\" value=\"0.5\"/></sensor>"),
                      "principal_point_offset_x"));
}

TEST(reader_test, first_of_two_sensors_sees_the_scene) {
  const auto world =
      SceneDirectory().read("<sensor type=\"perspective\"><float name=\"far_clip\" value=\"9\"/></sensor>\n" + SENSOR);
  EXPECT_EQ(world.camera.far_clip, 9.0);
  EXPECT_TRUE(warns(world, "scene.xml:3: the scene is seen by its first <sensor>"));
}

// Materials

TEST(reader_test, diffuse_reflects_a_half_unless_told_otherwise) {
  EXPECT_EQ(material("<bsdf type=\"diffuse\"/>").kind, MATERIAL_DIFFUSE);
  EXPECT_EQ(material("<bsdf type=\"diffuse\"/>").reflectance.y, 0.5f);
}

TEST(reader_test, rgb_takes_three_numbers_or_one) {
  const auto m = material("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.25, 0.5 0.75\"/></bsdf>");
  EXPECT_EQ(m.reflectance.x, 0.25f);
  EXPECT_EQ(m.reflectance.y, 0.5f);
  EXPECT_EQ(m.reflectance.z, 0.75f);
  EXPECT_EQ(material("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.25\"/></bsdf>").reflectance.z, 0.25f);
}

TEST(reader_test, constant_spectrum_of_a_reflectance_is_grey) {
  const auto m = material("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.25\"/></bsdf>");
  EXPECT_EQ(m.reflectance.x, 0.25f);
  EXPECT_EQ(m.reflectance.z, 0.25f);
}

TEST(reader_test, conductor_without_indices_is_a_mirror) {
  EXPECT_EQ(material("<bsdf type=\"conductor\"/>").kind, MATERIAL_MIRROR);
  EXPECT_EQ(material("<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>").kind, MATERIAL_MIRROR);
  EXPECT_EQ(material("<bsdf type=\"conductor\"><float name=\"specular_reflectance\" value=\"0.5\"/></bsdf>").reflectance.x,
            0.5f);
}

TEST(reader_test, conductor_presets_have_the_indices_of_mitsuba) {
  const auto gold = material("<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>");
  EXPECT_EQ(gold.kind, MATERIAL_CONDUCTOR);
  EXPECT_NEAR(gold.conductor_eta.x, 0.143036, 1e-6);  // measured
  EXPECT_NEAR(gold.conductor_eta.z, 1.44205, 1e-5);
  EXPECT_NEAR(gold.conductor_k.x, 3.983, 1e-5);
  EXPECT_NEAR(gold.conductor_k.z, 1.60336, 1e-5);
}

TEST(reader_test, conductor_takes_eta_and_k_with_the_defaults_zero_and_one) {
  const auto both =
      material("<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"1 2 3\"/><spectrum name=\"k\" value=\"4\"/></bsdf>");
  EXPECT_EQ(both.conductor_eta.z, 3.0f);
  EXPECT_EQ(both.conductor_k.x, 4.0f);
  EXPECT_EQ(material("<bsdf type=\"conductor\"><float name=\"k\" value=\"2\"/></bsdf>").conductor_eta.x, 0.0f);
  EXPECT_EQ(material("<bsdf type=\"conductor\"><float name=\"eta\" value=\"2\"/></bsdf>").conductor_k.x, 1.0f);
}

TEST(reader_test, dielectric_is_bk7_in_air_unless_told_otherwise) {
  const auto m = material("<bsdf type=\"dielectric\"/>");
  EXPECT_EQ(m.kind, MATERIAL_DIELECTRIC);
  EXPECT_FLOAT_EQ(m.eta, 1.504183292f);  // measured
  EXPECT_EQ(m.reflectance.x, 1.0f);
  EXPECT_EQ(m.transmittance.x, 1.0f);
}

TEST(reader_test, refractive_indices_are_numbers_or_names_in_any_case) {
  EXPECT_FLOAT_EQ(material("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"Diamond\"/></bsdf>").eta,
                  2.418329954f);  // measured
  EXPECT_FLOAT_EQ(material("<bsdf type=\"dielectric\"><string name=\"ext_ior\" value=\"water\"/></bsdf>").eta,
                  1.128732324f);  // measured
  EXPECT_FLOAT_EQ(
      material("<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"3\"/><float name=\"ext_ior\" value=\"2\"/></bsdf>")
          .eta,
      1.5f);
}

TEST(reader_test, dielectric_scales_reflection_and_transmission_apart) {
  const auto m = material(
      "<bsdf type=\"dielectric\"><float name=\"specular_reflectance\" value=\"0.25\"/><rgb name=\"specular_transmittance\" "
      "value=\"0.5 0.75 1\"/></bsdf>");
  EXPECT_EQ(m.reflectance.y, 0.25f);
  EXPECT_EQ(m.transmittance.y, 0.75f);
}

TEST(reader_test, plain_materials_absorb_on_their_back) {
  for (const std::string type : {"diffuse", "conductor"}) {
    const auto s = shape("<shape type=\"sphere\"><bsdf type=\"" + type + "\"/></shape>");
    EXPECT_EQ(s.material_front, 0u);
    EXPECT_EQ(s.material_back, NONE);
  }
}

TEST(reader_test, dielectric_is_the_same_on_both_sides) {
  const auto s = shape("<shape type=\"sphere\"><bsdf type=\"dielectric\"/></shape>");
  EXPECT_EQ(s.material_front, 0u);
  EXPECT_EQ(s.material_back, 0u);
}

TEST(reader_test, twosided_puts_one_material_on_both_sides_or_one_on_each) {
  const auto one = shape("<shape type=\"sphere\"><bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf></shape>");
  EXPECT_EQ(one.material_front, 0u);
  EXPECT_EQ(one.material_back, 0u);
  const auto two = world_of(
      "<shape type=\"sphere\"><bsdf type=\"twosided\"><bsdf type=\"conductor\"/><bsdf type=\"diffuse\"/></bsdf></shape>");
  EXPECT_EQ(two.materials[two.shapes[0].material_front].kind, MATERIAL_MIRROR);
  EXPECT_EQ(two.materials[two.shapes[0].material_back].kind, MATERIAL_DIFFUSE);
}

TEST(reader_test, shape_without_material_is_grey_but_black_if_it_shines) {
  const auto world =
      world_of("<shape type=\"sphere\"/><shape type=\"sphere\"><emitter type=\"area\"/></shape><shape type=\"cube\"/>");
  EXPECT_EQ(world.materials[world.shapes[0].material_front].reflectance.x, 0.5f);
  EXPECT_EQ(world.materials[world.shapes[1].material_front].reflectance.x, 0.0f);
  EXPECT_EQ(world.shapes[2].material_front, world.shapes[0].material_front);
  EXPECT_EQ(world.shapes[0].material_back, NONE);
}

TEST(reader_test, shared_material_is_one_material) {
  const auto world = world_of(
      "<bsdf type=\"diffuse\" id=\"m\"/><shape type=\"sphere\"><ref id=\"m\"/></shape><shape type=\"cube\"><ref id=\"m\" "
      "name=\"skin\"/></shape>");
  EXPECT_EQ(world.materials.size(), 1u);
  EXPECT_EQ(world.shapes[0].material_front, world.shapes[1].material_front);
}

// Shapes

TEST(reader_test, sphere_composes_transform_centre_and_radius) {
  const auto s = shape(
      "<shape type=\"sphere\"><point name=\"center\" value=\"1 2 3\"/><float name=\"radius\" value=\"2\"/>"
      "<transform name=\"to_world\"><scale value=\"3\"/></transform></shape>");
  EXPECT_EQ(s.geometry, Geometry::sphere);
  expect_near(glm::dvec3(s.to_world[3]), {3, 6, 9}, 1e-15);
  EXPECT_DOUBLE_EQ(glm::length(glm::dvec3(s.to_world[0])), 6.0);
  EXPECT_FALSE(s.flip_normals);
}

TEST(reader_test, mirror_or_negative_radius_turns_a_sphere_inside_out) {  // measured
  EXPECT_TRUE(shape("<shape type=\"sphere\"><float name=\"radius\" value=\"-2\"/></shape>").flip_normals);
  EXPECT_TRUE(
      shape("<shape type=\"sphere\"><transform name=\"to_world\"><scale z=\"-1\"/></transform></shape>").flip_normals);
  EXPECT_FALSE(shape("<shape type=\"sphere\"><float name=\"radius\" value=\"-2\"/><boolean name=\"flip_normals\" "
                     "value=\"true\"/></shape>")
                   .flip_normals);
}

TEST(reader_test, cylinder_runs_from_p0_to_p1) {
  const auto s = shape(
      "<shape type=\"cylinder\"><point name=\"p0\" value=\"1 0 0\"/><point name=\"p1\" value=\"5 0 0\"/><float "
      "name=\"radius\" value=\"0.5\"/></shape>");
  EXPECT_EQ(s.geometry, Geometry::cylinder);
  expect_near(glm::dvec3(s.to_world[3]), {1, 0, 0}, 0);
  expect_near(glm::dvec3(s.to_world[2]), {4, 0, 0}, 1e-15);
  EXPECT_DOUBLE_EQ(glm::length(glm::dvec3(s.to_world[0])), 0.5);
  EXPECT_NEAR(glm::dot(s.to_world[0], s.to_world[2]), 0.0, 1e-15);
}

TEST(reader_test, mirror_or_negative_radius_does_not_turn_a_cylinder) {  // measured
  EXPECT_FALSE(shape("<shape type=\"cylinder\"><float name=\"radius\" value=\"-2\"/></shape>").flip_normals);
  EXPECT_FALSE(
      shape("<shape type=\"cylinder\"><transform name=\"to_world\"><scale z=\"-1\"/></transform></shape>").flip_normals);
  EXPECT_TRUE(shape("<shape type=\"cylinder\"><boolean name=\"flip_normals\" value=\"true\"/></shape>").flip_normals);
}

TEST(reader_test, sheared_disk_becomes_an_ellipse_with_orthogonal_axes) {
  const auto s = shape(
      "<shape type=\"disk\"><transform name=\"to_world\"><matrix value=\"1 .5 .7 .2 1 0 .3 .1 -1\"/></transform></shape>");
  const glm::dvec3 x(s.to_world[0]), y(s.to_world[1]), z(s.to_world[2]);
  for (const double product : {glm::dot(x, y), glm::dot(y, z), glm::dot(z, x)}) EXPECT_NEAR(product, 0.0, 1e-14);
  expect_near(glm::normalize(z), {0.2966, -0.0530, -0.9535}, 5e-5);  // measured
  EXPECT_NEAR(glm::length(glm::cross(x, y)), glm::length(glm::cross(glm::dvec3(1, .2, .3), glm::dvec3(.5, 1, .1))), 1e-14);
}

TEST(reader_test, disk_faces_where_the_transform_sends_z) {  // measured
  EXPECT_GT(shape("<shape type=\"disk\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></shape>").to_world[2].z,
            0.0);
  EXPECT_LT(shape("<shape type=\"disk\"><transform name=\"to_world\"><scale z=\"-1\"/></transform></shape>").to_world[2].z,
            0.0);
}

TEST(reader_test, shape_remembers_its_line) {
  EXPECT_NE(shape("\n\n<shape type=\"sphere\"/>").where.find("scene.xml:4"), std::string::npos);
}

TEST(reader_test, mesh_file_is_found_beside_the_scene_and_listed) {
  SceneDirectory directory;
  directory.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto world = directory.read(SENSOR + "<shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/></shape>");
  ASSERT_EQ(world.files.size(), 2u);
  EXPECT_EQ(world.files[0].path, (directory.path() / "scene.xml").string());
  EXPECT_EQ(world.files[1].path, (directory.path() / "a.ply").string());
  expect_near(world.shapes[0].mesh.normals[0], {0, 0, 1}, 0);
}

// Lights

TEST(reader_test, lights_shine_with_one_unless_told_otherwise) {
  for (const std::string type : {"point", "directional", "constant"})
    expect_near(light("<emitter type=\"" + type + "\"/>").value, {1, 1, 1}, 0);
}

TEST(reader_test, constant_spectrum_of_an_emitter_is_of_equal_energy) {  // measured
  const auto l = light("<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"2\"/></emitter>");
  expect_near(l.value, {2.40959, 1.89658, 1.81783}, 5e-6);
  expect_near(light("<emitter type=\"constant\"><float name=\"radiance\" value=\"2\"/></emitter>").value, {2, 2, 2}, 0);
}

TEST(reader_test, point_light_stands_at_its_position_or_where_the_transform_puts_it) {
  expect_near(light("<emitter type=\"point\"><vector name=\"position\" value=\"1,2,3\"/></emitter>").position, {1, 2, 3}, 0);
  expect_near(
      light("<emitter type=\"point\"><transform name=\"to_world\"><translate x=\"4\"/></transform></emitter>").position,
      {4, 0, 0}, 0);
}

TEST(reader_test, directional_light_travels_along_its_direction_or_the_z_of_its_transform) {
  expect_near(light("<emitter type=\"directional\"/>").position, {0, 0, 1}, 0);
  expect_near(light("<emitter type=\"directional\"><vector name=\"direction\" value=\"0 3 4\"/></emitter>").position,
              {0, 0.6, 0.8}, 1e-15);
  expect_near(light("<emitter type=\"directional\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/><scale "
                    "value=\"3\"/></transform></emitter>")
                  .position,
              {0, -1, 0}, 1e-15);
}

TEST(reader_test, spot_is_a_cone_along_the_z_of_its_transform) {  // measured
  const auto plain = light("<emitter type=\"spot\"/>");
  EXPECT_EQ(plain.kind, LIGHT_SPOT);
  expect_near(plain.value, {1, 1, 1}, 0);
  expect_near(plain.axis, {0, 0, 1}, 0);
  EXPECT_EQ(plain.cutoff_angle, 20.0);
  EXPECT_EQ(plain.beam_width, 15.0);
  const auto placed = light("<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"40\"/><transform name=\"to_world\"><scale value=\"3\"/>"
                            "<rotate x=\"1\" angle=\"90\"/><translate x=\"4\"/></transform></emitter>");
  expect_near(placed.axis, {0, -1, 0}, 1e-15);
  expect_near(placed.position, {4, 0, 0}, 0);
  EXPECT_EQ(placed.beam_width, 30.0);
  EXPECT_EQ(light("<emitter type=\"spot\"><integer name=\"beam_width\" value=\"0\"/></emitter>").beam_width, 0.0);
}

const std::filesystem::path MAP = std::filesystem::path(OCLAIR_TEST_DIRECTORY) / "data" / "bad" / "environment.png";  // 2 x 3

TEST(reader_test, environment_map_has_a_scale_and_a_rotation) {
  const std::string file = "<string name=\"filename\" value=\"" + MAP.string() + "\"/>";
  const auto plain = light("<emitter type=\"envmap\">" + file + "</emitter>");
  EXPECT_EQ(plain.kind, LIGHT_ENVIRONMENT);
  expect_near(plain.value, {1, 1, 1}, 0);
  EXPECT_EQ(plain.rotation, glm::dmat3(1.0));
  ASSERT_TRUE(plain.image);
  EXPECT_EQ(plain.image->width, 2u);
  EXPECT_EQ(plain.image->height, 3u);
  EXPECT_TRUE(plain.image->srgb);
  // The translation does nothing; a mirror is one.
  const auto turned = light("<emitter type=\"envmap\">" + file + "<float name=\"scale\" value=\"2.5\"/><transform name=\"to_world\"><scale x=\"-1\"/>"
                            "<rotate y=\"1\" angle=\"90\"/><translate z=\"7\"/></transform></emitter>");
  expect_near(turned.value, {2.5, 2.5, 2.5}, 0);
  expect_near(turned.rotation * glm::dvec3(1, 0, 0), {0, 0, 1}, 1e-15);
  expect_near(turned.rotation * glm::dvec3(0, 0, 1), {1, 0, 0}, 1e-15);
  EXPECT_EQ(light("<emitter type=\"envmap\">" + file + "<float name=\"scale\" value=\"0\"/></emitter>").value.x, 0.0);
}

TEST(reader_test, area_light_takes_a_texture_as_its_radiance) {
  const auto world = world_of("<shape type=\"disk\"><emitter type=\"area\"><texture type=\"checkerboard\" name=\"radiance\"/></emitter></shape>");
  ASSERT_EQ(world.textures.size(), 1u);
  EXPECT_EQ(world.shapes[0].radiance_texture, 1u);
  EXPECT_TRUE(world.shapes[0].radiance);
  EXPECT_EQ(shape("<shape type=\"disk\"><emitter type=\"area\"/></shape>").radiance_texture, 0u);
}

TEST(reader_test, area_light_gives_its_radiance_to_its_shape) {
  const auto s =
      shape("<shape type=\"disk\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter></shape>");
  ASSERT_TRUE(s.radiance);
  expect_near(*s.radiance, {1, 2, 3}, 0);
  EXPECT_TRUE(world_of("<shape type=\"disk\"><emitter type=\"area\"/></shape>").lights.empty());
}

TEST(reader_test, scene_without_light_is_warned_of) {
  EXPECT_TRUE(warns(world_of("<shape type=\"sphere\"/>"), "<scene> has no light: the image will be black"));
  EXPECT_FALSE(warns(world_of("<emitter type=\"point\"/>"), "no light"));
}

TEST(reader_test, parameter_that_nobody_asked_for_is_named) {
  EXPECT_TRUE(warns(world_of("\n<bsdf type=\"diffuse\">\n<float name=\"alpha\" value=\"1\"/></bsdf>"),
                    "scene.xml:4: parameter \"alpha\" of <bsdf type=\"diffuse\"> is not used"));
  EXPECT_TRUE(
      warns(world_of("<bsdf type=\"conductor\"><float name=\"ext_eta\" value=\"1.5\"/></bsdf>"), "parameter \"ext_eta\""));
  EXPECT_TRUE(warns(film("<rfilter type=\"box\"><float name=\"radius\" value=\"2\"/></rfilter>"),
                    "parameter \"radius\" of <rfilter type=\"box\">"));
}

}  // namespace

}  // namespace oclair
