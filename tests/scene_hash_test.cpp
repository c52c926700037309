// What tells scenes apart: every file that is read, its name in the scene, and the definitions; not the place.
#include "../host/scene_hash.h"

#include <set>

#include "../host/xxh3.h"
#include "encoders.h"
#include "scene_text.h"

namespace {

using namespace oclair;
using namespace oclair::test;

constexpr const char* TRIANGLE_PLY =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string pixel_png(std::uint8_t gray) { return png_bytes(1, 1, PNG_COLOR_TYPE_GRAY, 8, {gray}); }

const std::vector<std::pair<std::string, std::string>> files = {
    {"part/inc.xml", "<scene version=\"3.0.0\"><shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape></scene>"},
    {"a.ply", TRIANGLE_PLY},
    {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
    {"albedo.png", pixel_png(9)},
    {"sky.png", png_bytes(2, 2, PNG_COLOR_TYPE_RGB, 8, std::vector<std::uint8_t>(12, 5))}};

const std::string shape_of_ply = "<shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>";
const std::string content =
    SENSOR + "<default name=\"r\" value=\"1\"/><include filename=\"part/inc.xml\"/><include filename=\"part/inc.xml\"/>" +
    shape_of_ply +
    "<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" "
    "value=\"albedo.png\"/></texture>"
    "</bsdf></shape><shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape>" +
    shape_of_ply + "</shape><emitter type=\"envmap\"><string name=\"filename\" value=\"sky.png\"/></emitter>";

struct WholeScene {
  SceneDirectory directory;
  WholeScene() {
    for (const auto& [name, bytes] : files) directory.write(name, bytes);
  }
  std::string hash(const Definitions& definitions = {}, const std::string& text = content) const {
    return scene_hash(directory.read(text, definitions), definitions);
  }
};

// Of no bytes: published with the algorithm.
TEST(scene_hash_test, checksums_are_xxh3_of_128_bits) {
  EXPECT_EQ(xxh3_digits("", 0), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(Xxh3().add("ab", 2).add("c", 1).digits(), xxh3_digits("abc", 3));
}

TEST(scene_hash_test, every_file_is_listed_once_in_the_order_of_first_reading) {
  const WholeScene scene;
  const World world = scene.directory.read(content);
  std::vector<std::string> names;
  for (const SceneFile& file : world.files) names.push_back(file.name);
  EXPECT_EQ(names, (std::vector<std::string>{"", "part/inc.xml", "a.ply", "albedo.png", "a.obj", "sky.png"}));
}

TEST(scene_hash_test, a_scene_that_is_moved_keeps_its_hash) {
  const WholeScene here, there;
  EXPECT_EQ(here.hash(), there.hash());
  const Definitions definitions = {{"r", "2"}};
  std::filesystem::rename(there.directory.path() / "scene.xml", there.directory.path() / "other.xml");
  EXPECT_EQ(scene_hash(read_scene(there.directory.path() / "other.xml", definitions), definitions), here.hash(definitions));
}

TEST(scene_hash_test, every_byte_of_every_file_counts) {
  const WholeScene scene;
  const std::string before = scene.hash();
  for (const auto& [name, bytes] : files) {
    const std::string changed = name == "albedo.png" ? pixel_png(10)
                                : name == "sky.png"  ? png_bytes(2, 2, PNG_COLOR_TYPE_RGB, 8, std::vector<std::uint8_t>(12, 6))
                                                     : bytes + "\n";
    scene.directory.write(name, changed);
    EXPECT_NE(scene.hash(), before) << name;
    scene.directory.write(name, bytes);
  }
  EXPECT_NE(scene.hash({}, content + " "), before);
  EXPECT_EQ(scene.hash(), before);
}

TEST(scene_hash_test, files_that_change_places_change_the_hash) {
  const WholeScene scene;
  const std::string two = "<texture type=\"bitmap\"><string name=\"filename\" value=\"one.png\"/></texture>"
                          "<texture type=\"bitmap\"><string name=\"filename\" value=\"two.png\"/></texture>" + SENSOR;
  scene.directory.write("one.png", pixel_png(1));
  scene.directory.write("two.png", pixel_png(2));
  const std::string before = scene.hash({}, two);
  scene.directory.write("one.png", pixel_png(2));
  scene.directory.write("two.png", pixel_png(1));
  EXPECT_NE(scene.hash({}, two), before);
}

TEST(scene_hash_test, definitions_count) {
  const World world = WholeScene().directory.read(content);
  const Definitions all[] = {
      {}, {{"r", "1"}}, {{"r", "2"}}, {{"r", "12"}}, {{"r1", "2"}}, {{"r", "1"}, {"s", "1"}}, {{"r", "1s1"}}};
  std::set<std::string> hashes;
  for (const Definitions& definitions : all) hashes.insert(scene_hash(world, definitions));
  EXPECT_EQ(hashes.size(), std::size(all));
}

TEST(scene_hash_test, a_file_that_changes_while_the_scene_is_read_is_refused) {
  const WholeScene scene;
  std::vector<SceneFile> list;
  read_scene_file(scene.directory.path() / "a.obj", "a.obj", list);
  read_scene_file(scene.directory.path() / "a.obj", "a.obj", list);
  EXPECT_EQ(list.size(), 1u);
  scene.directory.write("a.obj", "v 0 0 0\n");
  EXPECT_THROW(read_scene_file(scene.directory.path() / "a.obj", "a.obj", list), SceneFileError);
}

}  // namespace
