// BSDFs that hold others, and textures on their parameters: what becomes of them in the world's materials.
#include "../host/bsdf_wrapper.h"

#include "scene_text.h"

namespace oclair {

namespace {

const std::string PNG_NAME = "colors.png";

// A PNG of 1x1 pixels, 8 bits, three channels (or one): the smallest that there is, uncompressed.
std::string png(bool grey);

class Scenes {
 public:
  Scenes() {
    directory_.write("colors.png", png(false));
    directory_.write("heights.png", png(true));
  }
  World read(const std::string& bsdf) const {
    return directory_.read("<shape type=\"rectangle\">" + bsdf + "</shape>" + SENSOR);
  }

 private:
  SceneDirectory directory_;
};

// CRC-32 of PNG (ISO 3309).
std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const unsigned char byte : bytes) {
    crc ^= byte;
    for (int i = 0; i < 8; ++i) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
  }
  return ~crc;
}

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc32(type + data));
}

std::string png(bool grey) {
  const std::string row = grey ? std::string("\0\x80", 2) : std::string("\0\x80\x40\x20", 4);
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const unsigned char byte : row) {
    a += byte;
    b += a;
  }
  const auto length = static_cast<char>(row.size());
  const std::string stored = std::string("\x78\x01\x01", 3) + length + '\0' + static_cast<char>(~length) + '\xff' + row + big_endian(b << 16 | a);
  const std::string header = big_endian(1) + big_endian(1) + std::string("\x08", 1) + (grey ? '\0' : '\2') + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", stored) + chunk("IEND", "");
}

std::string bitmap(const std::string& name, bool raw = true, const std::string& file = PNG_NAME) {
  return "<texture type=\"bitmap\" name=\"" + name + "\"><string name=\"filename\" value=\"" + file + "\"/><boolean name=\"raw\" value=\"" + (raw ? "true" : "false") + "\"/></texture>";
}

const std::string DIFFUSE = "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0.25\"/></bsdf>";
const std::string WHITE = "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"1\"/></bsdf>";

std::string wrapped(const std::string& type, const std::string& content) { return "<bsdf type=\"" + type + "\">" + content + "</bsdf>"; }
std::string number(const std::string& name, double value) { return "<float name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>"; }

const Material& front(const World& world) { return world.materials.at(world.shapes.at(0).material_front); }
const Material& back(const World& world) { return world.materials.at(world.shapes.at(0).material_back); }

std::string refusal(const std::string& bsdf) {
  try {
    Scenes().read(bsdf);
  } catch (const Error& error) {
    const std::string what = error.what();
    return what.substr(what.find(": ") + 2);
  }
  return "";
}

}  // namespace

TEST(bsdf_wrapper_test, a_texture_takes_the_place_of_a_reflectance) {
  const Scenes scenes;
  EXPECT_EQ(front(scenes.read(wrapped("diffuse", bitmap("reflectance")))).reflectance_texture, 1u);
  EXPECT_EQ(front(scenes.read(wrapped("conductor", bitmap("specular_reflectance")))).reflectance_texture, 1u);
  const Material m = front(scenes.read(wrapped("dielectric", bitmap("specular_reflectance") + bitmap("specular_transmittance"))));
  EXPECT_EQ(m.reflectance_texture, 1u);
  EXPECT_EQ(m.transmittance_texture, 2u);
  EXPECT_EQ(refusal(wrapped("diffuse", bitmap("colour"))), "<texture type=\"bitmap\"> \"colour\" is not supported in <bsdf type=\"diffuse\">");
}

// The back of a plain material absorbs, but where the mask lets light through.
TEST(bsdf_wrapper_test, a_mask_makes_both_sides_transparent) {
  const Scenes scenes;
  World world = scenes.read(wrapped("mask", number("opacity", 0.25) + DIFFUSE));
  EXPECT_EQ(front(world).transparency, 0.75f);
  EXPECT_EQ(front(world).reflectance.x, 0.25f);
  EXPECT_EQ(back(world).transparency, 0.75f);
  EXPECT_EQ(back(world).reflectance.x, 0.0f);
  EXPECT_EQ(back(world).kind, static_cast<uint>(MATERIAL_DIFFUSE));
  EXPECT_EQ(front(scenes.read(wrapped("mask", DIFFUSE))).transparency, 0.5f);  // measured
  world = scenes.read(wrapped("mask", bitmap("opacity") + wrapped("twosided", DIFFUSE)));
  EXPECT_EQ(front(world).opacity_texture, 1u);
  EXPECT_EQ(back(world).opacity_texture, 1u);
  EXPECT_EQ(back(world).reflectance.x, 0.25f);
}

TEST(bsdf_wrapper_test, a_mask_leaves_what_it_holds_as_it_is_elsewhere) {
  const World world = SceneDirectory().read("<bsdf type=\"diffuse\" id=\"a\"/><shape type=\"rectangle\"><bsdf type=\"mask\"><ref id=\"a\"/></bsdf></shape>"
                                            "<shape type=\"sphere\"><ref id=\"a\"/></shape>" + SENSOR);
  EXPECT_EQ(front(world).transparency, 0.5f);
  EXPECT_EQ(world.materials.at(world.shapes.at(1).material_front).transparency, 0.0f);
}

TEST(bsdf_wrapper_test, the_weight_of_a_blend_is_the_share_of_the_second) {
  const Scenes scenes;
  World world = scenes.read(wrapped("blendbsdf", number("weight", 0.125) + DIFFUSE + WHITE));
  const Material m = front(world);
  EXPECT_EQ(m.kind, static_cast<uint>(MATERIAL_BLEND));
  EXPECT_EQ(m.weight, 0.125f);
  EXPECT_EQ(world.materials.at(m.first).reflectance.x, 0.25f);  // measured: the order of the file, whatever their names
  EXPECT_EQ(world.materials.at(m.second).reflectance.x, 1.0f);
  EXPECT_EQ(world.shapes.at(0).material_back, NONE);
  EXPECT_EQ(front(scenes.read(wrapped("blendbsdf", bitmap("weight") + DIFFUSE + WHITE))).weight_texture, 1u);
  // Glass has a back, the other absorbs there.
  world = scenes.read(wrapped("blendbsdf", number("weight", 0.5) + DIFFUSE + "<bsdf type=\"dielectric\"/>"));
  EXPECT_EQ(world.materials.at(back(world).first).reflectance.x, 0.0f);
  EXPECT_EQ(world.materials.at(back(world).second).kind, static_cast<uint>(MATERIAL_DIELECTRIC));
}

TEST(bsdf_wrapper_test, around_a_blend_each_of_its_materials_is_changed) {
  const Scenes scenes;
  const std::string blend = wrapped("blendbsdf", number("weight", 0.5) + DIFFUSE + wrapped("blendbsdf", number("weight", 0.25) + DIFFUSE + WHITE));
  for (const auto& [type, content] : {std::pair<std::string, std::string>{"mask", number("opacity", 0.25)}, {"normalmap", bitmap("normalmap")}, {"bumpmap", bitmap("x")}}) {
    const World world = scenes.read(wrapped(type, content + blend));
    const Material outer = front(world), inner = world.materials.at(outer.second);
    EXPECT_EQ(outer.weight, 0.5f);
    EXPECT_EQ(inner.weight, 0.25f);
    EXPECT_EQ(outer.transparency, 0.0f);
    for (const uint leaf : {outer.first, inner.first, inner.second}) {
      const Material m = world.materials.at(leaf);
      EXPECT_TRUE(m.transparency == 0.75f || m.normal_texture == 1 || m.bump_texture == 1) << type;
    }
  }
}

// Measured: inside twosided the back is the front mirrored in the surface; around it, it is the back of the front.
TEST(bsdf_wrapper_test, maps_around_twosided_are_turned_on_the_back_and_inside_they_are_not) {
  const Scenes scenes;
  World world = scenes.read(wrapped("normalmap", bitmap("normalmap") + wrapped("twosided", DIFFUSE)));
  EXPECT_EQ(front(world).normal_turned, 0u);
  EXPECT_EQ(back(world).normal_turned, 1u);
  EXPECT_EQ(back(world).normal_texture, 1u);
  world = scenes.read(wrapped("twosided", wrapped("normalmap", bitmap("normalmap") + DIFFUSE)));
  EXPECT_EQ(back(world).normal_turned, 0u);
  EXPECT_EQ(back(world).normal_texture, 1u);
  world = scenes.read(wrapped("bumpmap", number("scale", 3) + bitmap("any") + wrapped("twosided", DIFFUSE)));
  EXPECT_EQ(front(world).bump_scale, 3.0f);
  EXPECT_EQ(back(world).bump_scale, -3.0f);
  world = scenes.read(wrapped("twosided", wrapped("bumpmap", bitmap("any") + DIFFUSE)));
  EXPECT_EQ(back(world).bump_scale, 1.0f);
  world = scenes.read(wrapped("normalmap", bitmap("normalmap") + wrapped("bumpmap", bitmap("any") + DIFFUSE)));
  EXPECT_EQ(front(world).normal_texture, 1u);
  EXPECT_EQ(front(world).bump_texture, 2u);
  EXPECT_EQ(world.shapes.at(0).material_back, NONE);
}

TEST(bsdf_wrapper_test, what_a_map_cannot_be_made_of_is_refused) {
  EXPECT_EQ(refusal(wrapped("normalmap", bitmap("normalmap", false) + DIFFUSE)), "\"normalmap\" of <bsdf type=\"normalmap\"> would be decoded as sRGB, which is not supported (supported: \"raw\" true)");
  EXPECT_EQ(refusal(wrapped("normalmap", bitmap("normalmap", true, "heights.png") + DIFFUSE)), "\"normalmap\" of <bsdf type=\"normalmap\"> has one channel, three are expected");
  EXPECT_EQ(refusal(wrapped("normalmap", bitmap("normalmap") + wrapped("normalmap", bitmap("normalmap") + DIFFUSE))), "<bsdf type=\"normalmap\"> around another one is not supported");
  EXPECT_EQ(refusal(wrapped("bumpmap", bitmap("a") + wrapped("twosided", wrapped("bumpmap", bitmap("a") + DIFFUSE)))), "<bsdf type=\"bumpmap\"> around another one is not supported");
  EXPECT_EQ(refusal(wrapped("bumpmap", bitmap("a") + bitmap("b") + DIFFUSE)), "<bsdf type=\"bumpmap\"> has more than one <texture>");
}

TEST(bsdf_wrapper_test, no_shadowing_is_what_there_is_and_anything_else_gets_a_warning) {
  const Scenes scenes;
  const auto warnings = [&](const std::string& value) {
    return scenes.read(wrapped("bumpmap", "<boolean name=\"use_shadowing_function\" value=\"" + value + "\"/>" + bitmap("a") + DIFFUSE)).warnings.size();
  };
  EXPECT_EQ(warnings("true"), warnings("false") + 1);
}

// 2^50 ways down, which nothing may walk one by one.
TEST(bsdf_wrapper_test, a_tower_of_shared_blends_is_read_at_once) {
  std::string text = "<bsdf type=\"diffuse\" id=\"b0\"/>";
  for (int i = 1; i <= 50; ++i) {
    const std::string below = "<ref id=\"b" + std::to_string(i - 1) + "\"/>";
    text += "<bsdf type=\"blendbsdf\" id=\"b" + std::to_string(i) + "\"><float name=\"weight\" value=\"0.5\"/>" + below + below + "</bsdf>";
  }
  const World world = SceneDirectory().read(text + "<shape type=\"rectangle\"><bsdf type=\"mask\"><bsdf type=\"twosided\"><ref id=\"b50\"/></bsdf></bsdf></shape>" + SENSOR);
  EXPECT_LT(world.materials.size(), 200u);
}

}  // namespace oclair
