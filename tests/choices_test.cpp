// What the options that trade speed for accuracy change in a scene, and which of them tune tries on it.
#include "../host/choices.h"

#include <algorithm>
#include <limits>
#include <set>

#include "../host/error.h"
#include "../host/tune/tune.h"
#include "../host/variant.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

Material oren_nayar(MaterialKind kind) {
  Material m = diffuse(0.5);
  m.kind = kind;
  m.roughness = 0.5f;
  return m;
}

// A lamp above a floor of that material.
Scene lit(const Material& floor) {
  World world;
  add_shape(world, floor, Sides::both).geometry = Geometry::disk;
  WorldShape& lamp = add_shape(world, diffuse(0.0), Sides::both, 1.0);
  lamp.geometry = Geometry::sphere;
  lamp.to_world = glm::dmat4(0.1);
  lamp.to_world[3] = glm::dvec4(0, 0, 2, 1);
  look(world, {0, -3, 1}, {0, 0, 0}, {0, 0, 1}, 0.5, 8, 8);
  world.integrator.max_depth = 6;
  return place_scene(std::move(world));
}

Choices chosen(const std::string& name, const std::string& value) {
  Choices choices;
  find_choice(name)->set(choices, value, name);
  return choices;
}

Scene applied(Scene scene, const std::string& name, const std::string& value) {
  apply(chosen(name, value), scene);
  return scene;
}

std::set<std::string> tried(const Scene& scene, double mean = 0.5) {
  std::set<std::string> names;
  for (const Choices& choices : tune::candidates(scene, 8, mean)) names.insert(text_of(choices));
  return names;
}

std::set<std::string> options_of(const std::set<std::string>& names) {
  std::set<std::string> options;
  for (const std::string& name : names) options.insert(name.substr(0, name.find('=')));
  return options;
}

}  // namespace

TEST(choices_test, no_choice_changes_nothing) {
  const Scene before = lit(diffuse(0.5));
  Scene after = before;
  apply(Choices{}, after);
  EXPECT_EQ(after.features, before.features);
  EXPECT_EQ(after.approximations, 0u);
  EXPECT_FALSE(after.exact_kernel);
  EXPECT_EQ(std::memcmp(&after.settings, &before.settings, sizeof(Settings)), 0);
  EXPECT_EQ(text_of(Choices{}), "none");
}

TEST(choices_test, what_a_scene_has_no_use_for_is_neither_compiled_nor_recorded) {
  EXPECT_EQ(applied(lit(diffuse(0.5)), "fresnel", "schlick").approximations, 0u);
  EXPECT_EQ(applied(lit(dielectric(1.5)), "fresnel", "schlick").approximations, APPROXIMATION_SCHLICK);
  EXPECT_EQ(applied(lit(diffuse(0.5)), "light-sampling", "bsdf").approximations, APPROXIMATION_BSDF_SAMPLING);
  EXPECT_EQ(applied(lit(diffuse(0.5)), "light-sampling", "both").approximations, 0u);
  World dark;
  add_shape(dark, diffuse(0.5), Sides::both).geometry = Geometry::disk;
  dark.lights.emplace_back();  // a point light, which no path can meet
  EXPECT_EQ(applied(place_scene(std::move(dark)), "light-sampling", "bsdf").approximations, 0u);
}

TEST(choices_test, the_model_of_oren_nayar_surfaces_is_changed_in_materials_and_features) {
  const Features both = FEATURE_OREN_NAYAR | FEATURE_OREN_NAYAR_FAST;
  const Scene fast = applied(lit(oren_nayar(MATERIAL_OREN_NAYAR)), "oren-nayar", "qualitative");
  EXPECT_EQ(fast.features & both, FEATURE_OREN_NAYAR_FAST);
  EXPECT_EQ(fast.materials[0].kind, static_cast<uint>(MATERIAL_OREN_NAYAR_FAST));
  const Scene full = applied(lit(oren_nayar(MATERIAL_OREN_NAYAR_FAST)), "oren-nayar", "full");
  EXPECT_EQ(full.features & both, FEATURE_OREN_NAYAR);
  EXPECT_EQ(full.materials[0].kind, static_cast<uint>(MATERIAL_OREN_NAYAR));
  const Scene plain = applied(lit(diffuse(0.5)), "oren-nayar", "qualitative");
  EXPECT_EQ(plain.features & both, 0u);
  EXPECT_EQ(plain.materials[0].kind, static_cast<uint>(MATERIAL_DIFFUSE));
}

TEST(choices_test, depths_sampler_and_clamp_are_settings) {
  const Scene scene = lit(diffuse(0.5));
  EXPECT_EQ(applied(scene, "max-depth", "3").settings.max_depth, 3u);
  EXPECT_EQ(applied(scene, "rr-depth", "9").settings.rr_depth, 9u);
  EXPECT_EQ(applied(scene, "sampler", "sobol").settings.sampler, static_cast<uint>(SAMPLER_SOBOL));
  EXPECT_EQ(applied(scene, "sampler", "sobol").features ^ scene.features, FEATURE_SOBOL);
  EXPECT_EQ(applied(scene, "sampler", "independent").features, scene.features);
  const Scene clamped = applied(scene, "clamp", "0.1");
  EXPECT_EQ(clamped.settings.largest_sample, 0.1f);
  EXPECT_EQ(clamped.approximations, APPROXIMATION_CLAMP);
  EXPECT_TRUE(applied(scene, "kernels", "exact").exact_kernel);
  Device wide;
  wide.bvh_width = 8;
  EXPECT_EQ(bvh_width(chosen("bvh-width", "4"), wide), 4);
  EXPECT_EQ(bvh_width(Choices{}, wide), 8);
}

TEST(choices_test, of_two_sets_of_choices_the_second_goes_before) {
  const Choices both = joined(joined(chosen("max-depth", "3"), chosen("clamp", "2")), chosen("max-depth", "7"));
  EXPECT_EQ(text_of(both), "max-depth=7 clamp=2");
}

TEST(choices_test, only_what_the_scene_could_use_is_tried) {
  const std::set<std::string> everywhere{"max-depth", "rr-depth", "sampler", "clamp", "kernels", "bvh-width"};
  std::set<std::string> expected = everywhere;
  expected.insert("light-sampling");
  EXPECT_EQ(options_of(tried(lit(diffuse(0.5)))), expected);
  expected.insert("oren-nayar");
  EXPECT_EQ(options_of(tried(lit(oren_nayar(MATERIAL_OREN_NAYAR)))), expected);
  expected.erase("oren-nayar");
  EXPECT_EQ(options_of(tried(lit(oren_nayar(MATERIAL_OREN_NAYAR_FAST)))), expected);
  expected.insert("fresnel");
  expected.erase("light-sampling");  // the lamp itself is black: nothing scatters but the glass
  std::set<std::string> glass = options_of(tried([] {
    Scene scene = lit(dielectric(1.5));
    scene.features &= ~FEATURE_DIFFUSE;
    return scene;
  }()));
  EXPECT_EQ(glass, expected);
}

TEST(choices_test, values_that_change_nothing_are_not_tried) {
  Scene scene = lit(diffuse(0.5));  // max_depth 6, rr_depth 5
  std::set<std::string> names = tried(scene);
  EXPECT_TRUE(names.count("max-depth=2") && names.count("max-depth=4"));
  EXPECT_FALSE(names.count("max-depth=8") || names.count("max-depth=16"));
  EXPECT_TRUE(names.count("rr-depth=2") && names.count("rr-depth=16"));
  scene.settings.max_depth = 2;
  names = tried(scene);
  EXPECT_FALSE(names.count("max-depth=2"));
  EXPECT_FALSE(names.count("rr-depth=2") || names.count("rr-depth=16"));
  EXPECT_TRUE(names.count("sampler=sobol"));
  EXPECT_FALSE(names.count("sampler=independent"));
  EXPECT_TRUE(names.count("clamp=2") && names.count("clamp=8") && names.count("clamp=32"));
  EXPECT_EQ(options_of(tried(scene, 0.0)).count("clamp"), 0u);
  scene.features = variant_features(variant_of(scene.features), scene.features);
  EXPECT_EQ(options_of(tried(scene)).count("kernels"), 0u);
}

TEST(choices_test, clamps_are_typed_as_they_are_stored) {
  for (const double mean : {1e-30, 0.123456, 7.7e20})
    for (const Choices& choices : tune::candidates(lit(diffuse(0.5)), 8, mean))
      if (choices.clamp) {
        EXPECT_EQ(chosen("clamp", find_choice("clamp")->get(choices)).clamp, choices.clamp);
      }
}

// However dark or bright the picture is.
TEST(choices_test, what_is_tried_can_be_asked_for) {
  for (const double mean : {1e-45, 2e-39, 1e-30, 0.5, 1e36, 1e37, 1e300, std::numeric_limits<double>::infinity()})
    for (const Choices& choices : tune::candidates(lit(diffuse(0.5)), 8, mean))
      EXPECT_EQ(text_of(joined({}, choices)), text_of(choices)) << mean;  // joined sets each value as a user would
}

TEST(choices_test, a_wrong_value_is_refused_with_what_was_expected) {
  const std::pair<const char*, const char*> wrong[] = {
      {"fresnel", "schlik"}, {"oren-nayar", "fast"}, {"max-depth", "-1"}, {"max-depth", "4294967296"}, {"rr-depth", "0"},
      {"light-sampling", "lights"}, {"sampler", "halton"}, {"clamp", "0"}, {"clamp", "-1"}, {"clamp", "nan"}, {"clamp", "1e39"},
      {"clamp", "1e-40"}, {"kernels", "full"}, {"bvh-width", "16"}, {"bvh-width", ""}};
  for (const auto& [name, value] : wrong) {
    Choices choices;
    try {
      find_choice(name)->set(choices, value, std::string("--") + name);
      ADD_FAILURE() << name << " " << value;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::usage);
      EXPECT_EQ(std::string(error.what()).find(std::string("--") + name + " '" + value + "': expected "), 0u) << error.what();
    }
    EXPECT_EQ(text_of(choices), "none");
  }
  EXPECT_EQ(find_choice("accuracy"), nullptr);
}
