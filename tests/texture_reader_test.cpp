// <texture> elements, and the coordinates and attributes that meshes bring for them.
#include "../host/texture_reader.h"

#include <algorithm>
#include <cstring>

#include "../host/document.h"
#include "../host/mesh_file.h"
#include "../host/property.h"
#include "../host/scene.h"
#include "encoders.h"
#include "scene_text.h"

namespace oclair {

namespace {

const std::string PNG = test::png_bytes(2, 1, PNG_COLOR_TYPE_GRAY, 8, {0, 255});
const std::string EXR = test::exr_bytes(1, 1, {{"Y", Imf::HALF, {0.5f}}});

std::string bitmap(const std::string& content, const std::string& file = "a.png") {
  return "<texture type=\"bitmap\"><string name=\"filename\" value=\"" + file + "\"/>" + content + "</texture>";
}

World read(const std::string& content) {
  SceneDirectory directory;
  directory.write("a.png", PNG);
  directory.write("a.exr", EXR);
  return directory.read(SENSOR + content);
}

TEST(texture_reader_test, a_bitmap_has_the_defaults_of_mitsuba) {
  const World world = read(bitmap(""));
  ASSERT_EQ(world.textures.size(), 1u);
  const WorldTexture& t = world.textures[0];
  EXPECT_EQ(t.kind, TEXTURE_BITMAP);
  EXPECT_TRUE(t.srgb);
  EXPECT_FALSE(t.nearest);
  EXPECT_EQ(t.wrap, WRAP_REPEAT);
  EXPECT_EQ(t.to_uv, glm::dmat3(1.0));
  EXPECT_EQ(t.image->width, 2u);
}

TEST(texture_reader_test, a_bitmap_is_read_as_it_says) {
  const World world =
      read(bitmap("<string name=\"filter_type\" value=\"nearest\"/><string name=\"wrap_mode\" value=\"mirror\"/>") +
           bitmap("<string name=\"wrap_mode\" value=\"clamp\"/><boolean name=\"raw\" value=\"true\"/>"
                  "<string name=\"format\" value=\"fp16\"/><boolean name=\"accel\" value=\"false\"/>") +
           bitmap("", "a.exr"));
  EXPECT_TRUE(world.textures[0].nearest);
  EXPECT_EQ(world.textures[0].wrap, WRAP_MIRROR);
  EXPECT_EQ(world.textures[1].wrap, WRAP_CLAMP);
  EXPECT_FALSE(world.textures[1].srgb);
  EXPECT_FALSE(world.textures[2].srgb);
  EXPECT_EQ(world.textures[0].image, world.textures[1].image);  // a file is held once
  EXPECT_EQ(world.files.size(), 3u);
  for (const auto& warning : world.warnings) EXPECT_EQ(warning.find("not used"), std::string::npos) << warning;
}

// Measured in Mitsuba 3.9.1: rows and columns of x and y, and the translation in x and y.
TEST(texture_reader_test, to_uv_is_the_part_of_the_matrix_in_the_plane) {
  const World world = read(bitmap(
      "<transform name=\"to_uv\"><matrix value=\".1 .2 .3 .4  .15 .25 .35 .12  .05 .06 .9 .08  0 0 0 1\"/></transform>"));
  const glm::dvec3 at = world.textures[0].to_uv * glm::dvec3(1, 0, 1);
  expect_near(at, {.5, .27, 1}, 1e-15);
  expect_near(world.textures[0].to_uv * glm::dvec3(0, 1, 1), {.6, .37, 1}, 1e-15);
}

TEST(texture_reader_test, a_checkerboard_has_two_colours) {
  const World world = read(
      "<texture type=\"checkerboard\"/><texture type=\"checkerboard\"><rgb name=\"color0\" value=\"1, 0, .5\"/>"
      "<float name=\"color1\" value=\".7\"/><transform name=\"to_uv\"><scale value=\"8\"/></transform></texture>");
  EXPECT_EQ(world.textures[0].kind, TEXTURE_CHECKERBOARD);
  expect_near(world.textures[0].color0, glm::dvec3(.4), 0);
  expect_near(world.textures[0].color1, glm::dvec3(.2), 0);
  expect_near(world.textures[1].color0, {1, 0, .5}, 0);
  expect_near(world.textures[1].color1, glm::dvec3(.7), 0);
  EXPECT_EQ(world.textures[1].to_uv[1][1], 8.0);
}

TEST(texture_reader_test, a_mesh_attribute_has_a_name) {
  EXPECT_EQ(read("<texture type=\"mesh_attribute\"><string name=\"name\" value=\"vertex_color\"/></texture>")
                .textures[0]
                .attribute,
            "vertex_color");
}

TEST(texture_reader_test, a_texture_that_is_referred_to_twice_is_one) {
  SceneDirectory directory;
  directory.write("a.png", PNG);
  directory.write(
      "scene.xml",
      "<scene version=\"3.0.0\"><texture type=\"bitmap\" id=\"t\"><string name=\"filename\" value=\"a.png\"/></texture>"
      "<bsdf type=\"x\"><ref id=\"t\" name=\"a\"/><ref id=\"t\" name=\"b\"/><float name=\"c\" value=\"1\"/></bsdf></scene>");
  Document document = read_document(directory.path() / "scene.xml", {});
  World world;
  KnownTextures known;
  const std::uint32_t bsdf = document.elements[0].children[1].element;
  EXPECT_EQ(texture_property(document, bsdf, "a", known, world), 1u);
  EXPECT_THROW(refuse_unasked_children(document, document.elements[bsdf]), Error);
  EXPECT_EQ(texture_property(document, bsdf, "b", known, world), 1u);
  EXPECT_EQ(texture_property(document, bsdf, "c", known, world), 0u);
  EXPECT_EQ(texture_property(document, bsdf, "missing", known, world), 0u);
  EXPECT_NO_THROW(refuse_unasked_children(document, document.elements[bsdf]));
}

const std::string CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt .1 .2\nvt .9 .2\nvt .9 .7 0\nvt .1 .7\n";

Mesh shape(const std::string& type, const std::string& text, const std::string& content = "") {
  SceneDirectory directory;
  directory.write("mesh", text);
  return directory
      .read(SENSOR + "<shape type=\"" + type + "\"><string name=\"filename\" value=\"mesh\"/>" + content + "</shape>")
      .shapes[0]
      .mesh;
}

// Measured in Mitsuba 3.9.1.
TEST(texture_reader_test, obj_flips_v_unless_told_otherwise) {
  const std::string text = CORNERS + "f 1/1 2/2 3/3 4/4\n";
  const auto flipped = shape("obj", text), kept = shape("obj", text, "<boolean name=\"flip_tex_coords\" value=\"false\"/>");
  ASSERT_EQ(flipped.uvs.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(flipped.uvs[i], glm::dvec2(i == 0 || i == 3 ? .1 : .9, i < 2 ? .8 : 1 - .7));
    EXPECT_EQ(kept.uvs[i], glm::dvec2(i == 0 || i == 3 ? .1 : .9, i < 2 ? .2 : .7));
  }
}

TEST(texture_reader_test, obj_corners_choose_their_coordinates) {
  const auto mesh = parse_obj(CORNERS + "f 1/1 2/2 3/3\nf 1/-1 3/3 4/4\n");
  ASSERT_EQ(mesh.positions.size(), 5u);  // corner 1 with two of them is two vertices
  EXPECT_EQ(mesh.uvs[mesh.triangles[0].x], glm::dvec2(.1, .2));
  EXPECT_EQ(mesh.uvs[mesh.triangles[1].x], glm::dvec2(.1, .7));
  EXPECT_EQ(mesh.triangles[0].z, mesh.triangles[1].y);
  EXPECT_TRUE(parse_obj(CORNERS + "f 1 2 3\n").uvs.empty());
}

TEST(texture_reader_test, obj_corners_without_coordinates_among_others_get_0_and_a_warning) {
  for (const std::string faces : {"f 1/1 2/2 3/3\nf 1 3 4\n", "f 1 3 4\nf 1/1 2/2 3/3\n"}) {
    const auto mesh = parse_obj(CORNERS + faces);
    EXPECT_EQ(mesh.vertices_without_uv, 3u);
    ASSERT_EQ(mesh.uvs.size(), 6u);
    EXPECT_EQ(std::count(mesh.uvs.begin(), mesh.uvs.end(), glm::dvec2(0.0)), 3);
  }
}

std::string ply(const std::string& vertex_properties, const std::string& face_properties, const std::string& vertex,
                const std::string& face) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
         vertex_properties + "element face 1\nproperty list uchar int vertex_indices\n" + face_properties +
         "end_header\n0 0 0 " + vertex + "\n1 0 0 " + vertex + "\n1 1 0 " + vertex + "\n0 1 0 " + vertex + "\n4 0 1 2 3 " +
         face + "\n";
}

std::string properties(const std::string& type, std::initializer_list<std::string> names) {
  std::string result;
  for (const auto& name : names) result += "property " + type + " " + name + "\n";
  return result;
}

TEST(texture_reader_test, ply_has_coordinates_under_three_names) {
  for (const auto& names : {std::pair{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}}) {
    const std::string text = ply(properties("float", {names.first, names.second}), "", "0.25 0.25", "");
    const auto kept = shape("ply", text), flipped = shape("ply", text, "<boolean name=\"flip_tex_coords\" value=\"true\"/>");
    ASSERT_EQ(kept.uvs.size(), 4u);
    EXPECT_EQ(kept.uvs[2], glm::dvec2(.25, .25));
    EXPECT_EQ(flipped.uvs[1], glm::dvec2(.25, .75));
  }
  EXPECT_TRUE(shape("ply", ply(properties("float", {"u"}), "", "0.25", "")).uvs.empty());
}

std::string names_of(const std::vector<MeshAttribute>& attributes) {
  std::string names;
  for (const auto& a : attributes) names += a.name + ":" + std::to_string(a.channels) + (a.values.empty() ? "i " : " ");
  return names;
}

// Measured in Mitsuba 3.9.1: the names and the numbers of channels; but it keeps alpha, and integers as they are.
TEST(texture_reader_test, ply_properties_are_grouped_into_attributes) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> rows = {
      {{"r", "g", "b"}, "vertex_color:3 "},
      {{"red", "green", "blue", "alpha"}, "vertex_color:3 "},
      {{"foo_r", "foo_g", "foo_b"}, "vertex_foo_color:3 "},
      {{"foo_r"}, "vertex_foo_color:1 "},
      {{"foo_x", "foo_y", "foo_z"}, "vertex_foo:3 "},
      {{"foo_0", "foo_1", "foo_2", "bar_0"}, "vertex_foo:3 vertex_bar:1 "},
      {{"foo_1", "foo_2", "foo_3"}, "vertex_foo:3 "},
      {{"foo_bar_x"}, "vertex_foo_bar:1 "},
      {{"vertex_foo_0"}, "vertex_vertex_foo:1 "},
      {{"foo_x", "foo_y"}, ""},
      {{"foo_0", "foo_1", "foo_2", "foo_3"}, ""},
      {{"foo_u"}, ""},
      {{"foo_bar"}, ""},
      {{"heat"}, ""},
      {{"r", "g"}, ""},
      {{"texture_u", "texture_v"}, ""}};
  for (const auto& [names, expected] : rows) {
    std::string header, values;
    for (std::size_t i = 0; i < names.size(); ++i)
      header += "property float " + names[i] + "\n", values += std::to_string(0.5 * double(i)) + " ";
    const auto mesh = parse_ply(ply(header, "", values, ""));
    EXPECT_EQ(names_of(mesh.attributes), expected) << header;
    for (const auto& a : mesh.attributes) {
      EXPECT_FALSE(a.per_face);
      ASSERT_EQ(a.values.size(), 4 * a.channels);
      const float first = a.name == "vertex_bar" ? 1.5f : 0.0f;
      for (std::size_t i = 0; i < a.values.size(); ++i)
        EXPECT_EQ(a.values[i], first + 0.5f * static_cast<float>(i % a.channels));
    }
  }
  EXPECT_EQ(parse_ply(ply(properties("float", {"g", "r", "b"}), "", "1 2 3", "")).attributes[0].values[0],
            2.0f);  // by name, not by place
  EXPECT_EQ(names_of(parse_ply(ply(properties("uchar", {"red", "green", "blue"}), "", "1 2 3", "")).attributes),
            "vertex_color:3i ");
}

TEST(texture_reader_test, the_triangles_of_a_polygon_share_its_attributes) {
  const auto mesh = parse_ply(ply("", properties("float", {"heat_0", "r", "g", "b"}), "", "7 1 2 3"));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(names_of(mesh.attributes), "face_color:3 face_heat:1 ");
  EXPECT_TRUE(mesh.attributes[0].per_face);
  EXPECT_EQ(mesh.attributes[0].values, (std::vector<float>{1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(mesh.attributes[1].values, (std::vector<float>{7, 7}));
}

// The error that placing the world ends in; empty if none.
std::string placing(const std::string& text, const std::string& attribute) {
  World world;
  WorldShape& s = world.shapes.emplace_back();
  s.mesh = to_world(parse_ply(text), {});
  s.where = "scene.xml:7";
  s.material_front = 0;
  Material material{};
  material.reflectance_texture = 1;
  world.materials.push_back(material);
  WorldTexture texture;
  texture.attribute = attribute;
  texture.where = "scene.xml:3";
  world.textures.push_back(texture);
  try {
    const Scene scene = place_scene(world);
    EXPECT_EQ(scene.textures.size(), 1u);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(texture_reader_test, a_shape_has_the_attributes_that_its_textures_ask_for) {
  const std::string floats = ply(properties("float", {"r", "g", "b"}), properties("float", {"heat_0"}), "1 2 3", "1");
  EXPECT_EQ(placing(floats, "vertex_color"), "");
  EXPECT_EQ(placing(floats, "face_heat"), "");
  EXPECT_EQ(placing(floats, "face_color"),
            "scene.xml:3: the shape at scene.xml:7 has no attribute \"face_color\" (it has: vertex_color, face_heat)");
  EXPECT_EQ(placing(ply(properties("uchar", {"red", "green", "blue"}), "", "1 2 3", ""), "vertex_color"),
            "scene.xml:3: the attribute \"vertex_color\" of the shape at scene.xml:7 is of integers, expected "
            "floating-point numbers");
}

// Attributes of the faces that are kept: one without an area is left out, and its value with it.
TEST(texture_reader_test, face_attributes_follow_the_triangles_that_are_kept) {
  World world;
  WorldShape& s = world.shapes.emplace_back();
  s.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  s.mesh.triangles = {{0, 1, 2}, {0, 1, 1}, {1, 3, 2}};
  s.mesh.attributes.push_back({"face_heat", true, 1, {1, 2, 3}});
  s.material_front = 0;
  Material material{};
  material.roughness_texture = 1;
  world.materials.push_back(material);
  world.textures.emplace_back().attribute = "face_heat";
  const Scene scene = place_scene(world);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].kind, TEXTURE_FACE_ATTRIBUTE);
  ASSERT_EQ(scene.texels.size(), 8u);
  float values[2];
  std::memcpy(values, scene.texels.data(), 8);
  EXPECT_EQ(values[0], 1.0f);
  EXPECT_EQ(values[1], 3.0f);
}

}  // namespace

}  // namespace oclair
