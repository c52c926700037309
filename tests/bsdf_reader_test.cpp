// <bsdf>: the rough diffuse models and the thin dielectric.
#include "scene_text.h"

namespace oclair {

namespace {

Material material(const std::string& bsdf) { return world_of(bsdf).materials.at(0); }

Material of_type(const std::string& type, const std::string& content) {
  return material("<bsdf type=\"" + type + "\">" + content + "</bsdf>");
}

const std::string NO_SPECULAR = "<float name=\"specular\" value=\"0\"/>";

}  // namespace

// Mitsuba 0.6's defaults, and its sigma: alpha / sqrt(2).
TEST(bsdf_reader_test, rough_diffuse_is_the_full_model_of_alpha_a_fifth_unless_told_otherwise) {
  const Material m = material("<bsdf type=\"roughdiffuse\"/>");
  EXPECT_EQ(m.kind, MATERIAL_OREN_NAYAR);
  EXPECT_EQ(m.reflectance.y, 0.5f);
  EXPECT_FLOAT_EQ(m.roughness, 0.141421356f);
}

TEST(bsdf_reader_test, rough_diffuse_takes_reflectance_alpha_and_the_approximation) {
  const Material m = of_type("roughdiffuse", "<rgb name=\"reflectance\" value=\"0.25 0.5 0.75\"/><float name=\"alpha\" value=\"0.5\"/>"
                                             "<boolean name=\"use_fast_approx\" value=\"true\"/>");
  EXPECT_EQ(m.kind, MATERIAL_OREN_NAYAR_FAST);
  EXPECT_EQ(m.reflectance.z, 0.75f);
  EXPECT_FLOAT_EQ(m.roughness, 0.353553391f);
  EXPECT_EQ(of_type("roughdiffuse", "<boolean name=\"use_fast_approx\" value=\"false\"/>").kind, MATERIAL_OREN_NAYAR);
}

TEST(bsdf_reader_test, principled_without_specular_is_disney_diffuse) {
  const Material m = of_type("principled", NO_SPECULAR);
  EXPECT_EQ(m.kind, MATERIAL_DISNEY);
  EXPECT_EQ(m.reflectance.y, 0.5f);
  EXPECT_EQ(m.roughness, 0.5f);
  const Material red = of_type("principled", NO_SPECULAR + "<rgb name=\"base_color\" value=\"0.75 0.5 0.25\"/><float name=\"roughness\" value=\"1\"/>");
  EXPECT_EQ(red.reflectance.x, 0.75f);
  EXPECT_EQ(red.roughness, 1.0f);
  EXPECT_EQ(of_type("principled", "<float name=\"eta\" value=\"1\"/>").kind, MATERIAL_DISNEY);
}

// And that without a warning.
TEST(bsdf_reader_test, principled_takes_everything_that_is_switched_off) {
  std::string content = NO_SPECULAR;
  for (const char* name : {"metallic", "spec_trans", "flatness", "sheen", "clearcoat", "anisotropic", "spec_tint", "sheen_tint", "clearcoat_gloss"})
    content += "<float name=\"" + std::string(name) + "\" value=\"0\"/>";
  content += "<float name=\"diffuse_reflectance_sampling_rate\" value=\"2\"/>";
  const World world = world_of("<integrator type=\"path\"/><emitter type=\"constant\"/><bsdf type=\"principled\">" + content + "</bsdf>");
  EXPECT_EQ(world.materials.at(0).kind, MATERIAL_DISNEY);
  for (const std::string& warning : world.warnings) EXPECT_EQ(warning.find("principled"), std::string::npos) << warning;
}

TEST(bsdf_reader_test, thin_dielectric_is_bk7_in_air_on_both_sides) {
  const World world = world_of("<shape type=\"sphere\"><bsdf type=\"thindielectric\"/></shape>");
  const Material& m = world.materials.at(0);
  EXPECT_EQ(m.kind, MATERIAL_THIN_DIELECTRIC);
  EXPECT_FLOAT_EQ(m.eta, 1.504183292f);  // measured
  EXPECT_EQ(m.reflectance.x, 1.0f);
  EXPECT_EQ(m.transmittance.x, 1.0f);
  EXPECT_EQ(world.shapes[0].material_front, 0u);
  EXPECT_EQ(world.shapes[0].material_back, 0u);
}

TEST(bsdf_reader_test, thin_dielectric_takes_indices_and_colours) {
  const Material m = of_type("thindielectric", "<float name=\"int_ior\" value=\"3\"/><float name=\"ext_ior\" value=\"2\"/>"
                                               "<float name=\"specular_reflectance\" value=\"0.25\"/><rgb name=\"specular_transmittance\" value=\"0.5 0.75 1\"/>");
  EXPECT_FLOAT_EQ(m.eta, 1.5f);
  EXPECT_EQ(m.reflectance.y, 0.25f);
  EXPECT_EQ(m.transmittance.y, 0.75f);
}

TEST(bsdf_reader_test, rough_materials_absorb_on_their_back_and_may_be_twosided) {
  for (const std::string& bsdf : {std::string("<bsdf type=\"roughdiffuse\"/>"), "<bsdf type=\"principled\">" + NO_SPECULAR + "</bsdf>"}) {
    EXPECT_EQ(world_of("<shape type=\"sphere\">" + bsdf + "</shape>").shapes[0].material_back, NONE);
    EXPECT_EQ(world_of("<shape type=\"sphere\"><bsdf type=\"twosided\">" + bsdf + "</bsdf></shape>").shapes[0].material_back, 0u);
  }
}

}  // namespace oclair
