// Rules of the scene format that do not depend on what an element is: <default>, <include>, <path>, <alias>, <ref>.
#include "scene_text.h"

namespace oclair {

namespace {

double radius_of(const std::string& content, const Definitions& definitions = {}) {
  return world_of(content, definitions).shapes.at(0).to_world[0].x;
}

std::string sphere(const std::string& radius) {
  return "<shape type=\"sphere\"><float name=\"radius\" value=\"" + radius + "\"/></shape>";
}
std::string set(const std::string& name, const std::string& value) {
  return "<default name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string scene(const std::string& content) { return "<scene version=\"2.1.0\">" + content + "</scene>"; }
const std::string OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string MESH = "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape>";

TEST(document_test, defaults_are_put_in_for_dollar_names) { EXPECT_EQ(radius_of(set("r", "2") + sphere("$r")), 2.0); }

TEST(document_test, definitions_override_defaults) { EXPECT_EQ(radius_of(set("r", "2") + sphere("$r"), {{"r", "5"}}), 5.0); }

TEST(document_test, definitions_need_no_default) { EXPECT_EQ(radius_of(sphere("$r"), {{"r", "5"}}), 5.0); }

TEST(document_test, first_default_wins) { EXPECT_EQ(radius_of(set("r", "2") + set("r", "3") + sphere("$r")), 2.0); }

TEST(document_test, defaults_may_use_earlier_ones) {
  EXPECT_EQ(radius_of(set("a", "2") + set("r", "1$a") + sphere("$r")), 12.0);
}

TEST(document_test, longest_known_name_wins) {
  EXPECT_EQ(radius_of(set("r", "2") + set("rr", "7") + sphere("$rr")), 7.0);
  EXPECT_EQ(radius_of(set("r", "2") + sphere("$r5")), 25.0);
}

TEST(document_test, types_and_references_are_substituted_too) {
  const auto world = world_of(set("t", "cube") + set("m", "a") +
                              "<bsdf type=\"diffuse\" id=\"a\"/><shape type=\"$t\"><ref id=\"$m\"/></shape>");
  EXPECT_EQ(world.shapes[0].geometry, Geometry::mesh);
  EXPECT_EQ(world.shapes[0].material_front, 0u);
}

TEST(document_test, backslash_keeps_a_dollar_sign) {
  const auto world = world_of("<bsdf type=\"diffuse\" id=\"a\\$b\"/><shape type=\"cube\"><ref id=\"a\\$b\"/></shape>");
  EXPECT_EQ(world.materials.size(), 1u);
}

TEST(document_test, definition_that_the_scene_does_not_use_is_a_usage_error) {
  for (const auto& content : {std::string(), set("q", "1")}) {
    try {
      world_of(content, {{"q", "5"}});
      FAIL() << "was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::usage);
      EXPECT_STREQ(error.what(), "definition of \"q\": the scene does not use $q");
    }
  }
}

TEST(document_test, definition_with_a_dollar_sign_is_a_usage_error) {
  try {
    world_of(sphere("$r"), {{"r", "$q"}});
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::usage);
  }
}

TEST(document_test, references_may_point_forwards) {
  const auto world = world_of("<shape type=\"cube\"><ref id=\"m\"/></shape><bsdf type=\"conductor\" id=\"m\"/>");
  EXPECT_EQ(world.materials.at(world.shapes[0].material_front).kind, MATERIAL_MIRROR);
}

TEST(document_test, alias_is_a_second_name) {
  const auto world =
      world_of("<bsdf type=\"conductor\" id=\"m\"/><alias id=\"m\" as=\"n\"/><shape type=\"cube\"><ref id=\"n\"/></shape>");
  EXPECT_EQ(world.materials.size(), 1u);
  EXPECT_EQ(world.shapes[0].material_front, 0u);
}

TEST(document_test, area_light_may_be_referred_to) {
  const auto world = world_of("<emitter type=\"area\" id=\"e\"/><shape type=\"cube\"><ref id=\"e\"/></shape>");
  EXPECT_TRUE(world.shapes[0].radiance.has_value());
}

TEST(document_test, included_scene_stands_for_its_contents) {
  SceneDirectory directory;
  directory.write("inc.xml", scene("<shape type=\"sphere\"/><shape type=\"cube\"/>"));
  const auto world = directory.read("<include filename=\"inc.xml\"/>" + SENSOR);
  EXPECT_EQ(world.shapes.size(), 2u);
  EXPECT_EQ(world.files.size(), 2u);
  EXPECT_EQ(world.shapes[0].where, (directory.path() / "inc.xml").string() + ":1");
}

TEST(document_test, included_contents_come_where_the_include_stands) {
  SceneDirectory directory;
  directory.write("inc.xml", scene("<shape type=\"cube\"/>"));
  const auto world =
      directory.read("<shape type=\"disk\"/><include filename=\"inc.xml\"/><shape type=\"sphere\"/>" + SENSOR);
  ASSERT_EQ(world.shapes.size(), 3u);
  EXPECT_EQ(world.shapes[0].geometry, Geometry::disk);
  EXPECT_EQ(world.shapes[1].geometry, Geometry::mesh);
  EXPECT_EQ(world.shapes[2].geometry, Geometry::sphere);
}

TEST(document_test, included_object_is_nested_where_it_is_included) {
  SceneDirectory directory;
  directory.write("inc.xml", "<bsdf version=\"3.0.0\" type=\"conductor\"/>");
  const auto world = directory.read("<shape type=\"cube\"><include filename=\"inc.xml\"/></shape>" + SENSOR);
  EXPECT_EQ(world.materials.at(world.shapes[0].material_front).kind, MATERIAL_MIRROR);
}

TEST(document_test, defaults_cross_includes_both_ways) {
  SceneDirectory directory;
  directory.write("inc.xml", scene(set("b", "3") + sphere("$a")));
  const auto world = directory.read(set("a", "2") + "<include filename=\"inc.xml\"/>" + sphere("$b") + SENSOR);
  EXPECT_EQ(world.shapes[0].to_world[0].x, 2.0);
  EXPECT_EQ(world.shapes[1].to_world[0].x, 3.0);
}

TEST(document_test, includes_are_found_beside_the_including_file) {
  SceneDirectory directory;
  directory.write("sub/one.xml", scene("<include filename=\"two.xml\"/>"));
  directory.write("sub/two.xml", scene("<shape type=\"cube\"/>"));
  EXPECT_EQ(directory.read("<include filename=\"sub/one.xml\"/>" + SENSOR).shapes.size(), 1u);
}

TEST(document_test, same_file_may_be_included_twice) {
  SceneDirectory directory;
  directory.write("inc.xml", scene("<shape type=\"cube\"/>"));
  EXPECT_EQ(directory.read("<include filename=\"inc.xml\"/><include filename=\"inc.xml\"/>" + SENSOR).shapes.size(), 2u);
}

TEST(document_test, meshes_of_an_included_file_are_found_beside_the_main_one) {
  SceneDirectory directory;
  directory.write("sub/inc.xml", scene(MESH));
  directory.write("a.obj", OBJ);
  EXPECT_EQ(directory.read("<include filename=\"sub/inc.xml\"/>" + SENSOR).shapes.size(), 1u);
  std::filesystem::rename(directory.path() / "a.obj", directory.path() / "sub" / "a.obj");
  EXPECT_THROW(directory.read("<include filename=\"sub/inc.xml\"/>" + SENSOR), Error);
}

TEST(document_test, path_adds_a_directory_for_meshes_wherever_it_stands) {
  SceneDirectory directory;
  directory.write("sub/a.obj", OBJ);
  EXPECT_EQ(directory.read("<path value=\"sub\"/>" + MESH + SENSOR).shapes.size(), 1u);
  EXPECT_EQ(directory.read(MESH + "<path value=\"sub\"/>" + SENSOR).shapes.size(), 1u);
}

TEST(document_test, path_comes_before_the_directory_of_the_scene) {
  SceneDirectory directory;
  directory.write("sub/a.obj", OBJ);
  directory.write("a.obj", "broken");
  EXPECT_EQ(directory.read("<path value=\"sub\"/>" + MESH + SENSOR).shapes.size(), 1u);
}

TEST(document_test, path_of_an_included_file_ends_with_it) {
  SceneDirectory directory;
  directory.write("sub/a.obj", OBJ);
  directory.write("inc.xml", scene("<path value=\"sub\"/>"));
  EXPECT_THROW(directory.read("<include filename=\"inc.xml\"/>" + MESH + SENSOR), Error);
}

TEST(document_test, scene_file_that_is_missing_is_named) {
  try {
    read_scene("gone.xml");
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "gone.xml: there is no such file");
    EXPECT_EQ(error.exit, Exit::scene);
  }
}

TEST(document_test, scene_that_is_a_directory_is_not_called_missing) {
  try {
    read_scene(".");
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), ".: is not a file");
    EXPECT_EQ(error.exit, Exit::scene);
  }
}

TEST(document_test, doctype_comments_and_declarations_are_no_content) {
  SceneDirectory directory;
  directory.write("scene.xml", "<?xml version=\"1.0\"?><!DOCTYPE scene><!-- c --><scene version=\"3.1\">" + SENSOR +
                                   "<!-- c --></scene>");
  EXPECT_NO_THROW(read_scene(directory.path() / "scene.xml"));
}

TEST(document_test, doubling_chain_of_shared_objects_is_read_once_each) {
  std::string chain = "<bsdf type=\"diffuse\" id=\"t0\"/>";
  for (int i = 1; i < 60; ++i) {
    const std::string ref = "<ref id=\"t" + std::to_string(i - 1) + "\"/>";
    chain += "<bsdf type=\"twosided\" id=\"t" + std::to_string(i) + "\">" + ref + ref + "</bsdf>";
  }
  EXPECT_EQ(world_of(chain).materials.size(), 1u);
}

TEST(document_test, long_chain_of_references_is_refused) {
  std::string chain = "<bsdf type=\"diffuse\" id=\"t0\"/>";
  for (int i = 1; i < 1000; ++i)
    chain += "<bsdf type=\"twosided\" id=\"t" + std::to_string(i) + "\"><ref id=\"t" + std::to_string(i - 1) + "\"/></bsdf>";
  EXPECT_THROW(world_of(chain), Error);
}

TEST(document_test, includes_that_multiply_are_refused) {
  SceneDirectory directory;
  for (int i = 0; i < 12; ++i) {
    const std::string next = "<include filename=\"i" + std::to_string(i + 1) + ".xml\"/>";
    directory.write("i" + std::to_string(i) + ".xml", scene(next + next + next));
  }
  directory.write("i12.xml", scene(""));
  EXPECT_THROW(directory.read("<include filename=\"i0.xml\"/>" + SENSOR), Error);
}

}  // namespace

}  // namespace oclair
