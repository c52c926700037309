#include "../host/transform.h"

#include <cmath>

#include "scene_text.h"

namespace oclair {

namespace {

// The numbers marked so were measured in Mitsuba 3.9.1 (variant scalar_rgb, printed with 4 to 7 digits).
constexpr double MEASURED = 1e-5;

glm::dmat4 camera_of(const std::string& steps) {
  return SceneDirectory()
      .read("<sensor type=\"perspective\"><transform name=\"to_world\">" + steps + "</transform></sensor>")
      .camera.to_world;
}

// A disk keeps what a transform does to the origin and to z.
glm::dvec3 origin_of(const std::string& steps) {
  const auto world = world_of("<shape type=\"rectangle\"><transform name=\"to_world\">" + steps + "</transform></shape>");
  const auto& p = world.shapes[0].mesh.positions;
  return (p[0] + p[2]) / 2.0;  // opposite corners
}

TEST(transform_test, rotation_turns_counter_clockwise_around_its_axis) {
  expect_near(transform_vector(rotation({0, 0, 1}, 90), {1, 0, 0}), {0, 1, 0}, 0);
  expect_near(transform_vector(rotation({0, 1, 0}, 30), {1, 0, 0}), {0.8660254, 0, -0.5}, 1e-7);  // measured
}

TEST(transform_test, quarter_turns_are_exact) {
  for (int quarter = -8; quarter <= 8; ++quarter) {
    const auto m = rotation({0, 1, 0}, 90.0 * quarter);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_EQ(m[i][j], std::round(m[i][j]));
  }
  expect_near(transform_vector(rotation({0, 0, 1}, -90), {1, 0, 0}), {0, -1, 0}, 0);
  expect_near(transform_vector(rotation({0, 0, 1}, 270), {1, 0, 0}), {0, -1, 0}, 0);
}

TEST(transform_test, rotation_does_not_normalise_its_axis) {
  const auto m = rotation({1, 2, 3}, 30);  // measured
  expect_near(glm::dvec3(m[0]), {1.0, 1.7679492, -0.5980762}, 1e-7);
  expect_near(glm::dvec3(m[2]), {1.4019238, 0.3038475, 2.0717968}, 1e-6);
}

TEST(transform_test, rotation_around_an_axis_that_is_no_unit_vector_is_warned_of) {
  const auto world =
      world_of("<shape type=\"cube\">\n<transform name=\"to_world\"><rotate x=\"2\" angle=\"10\"/></transform></shape>");
  ASSERT_FALSE(world.warnings.empty());
  EXPECT_NE(world.warnings[0].find("scene.xml:3: <rotate>: the axis is not of unit length"), std::string::npos);
}

TEST(transform_test, lookat_builds_left_up_and_forward) {
  const auto m = camera_of("<lookat origin=\"1,2,3\" target=\"4 5 7\" up=\"0 1 0\"/>");  // measured
  expect_near(glm::dvec3(m[0]), {0.8, 0, -0.6}, MEASURED);
  expect_near(glm::dvec3(m[1]), {-0.308697, 0.857493, -0.411597}, MEASURED);
  expect_near(glm::dvec3(m[2]), {0.514496, 0.514496, 0.685994}, MEASURED);
  expect_near(glm::dvec3(m[3]), {1, 2, 3}, 0);
}

TEST(transform_test, lookat_without_up_chooses_the_basis_that_mitsuba_does) {
  for (const auto* up : {"", " up=\"0 0 0\""}) {
    const auto m = camera_of("<lookat origin=\"1,2,3\" target=\"4 5 7\"" + std::string(up) + "/>");  // measured
    expect_near(glm::dvec3(m[0]), {0.157003, -0.842997, 0.514496}, MEASURED);
    expect_near(glm::dvec3(m[1]), {0.842997, -0.157003, -0.514496}, MEASURED);
  }
}

TEST(transform_test, steps_act_in_the_order_of_the_file) {
  expect_near(origin_of("<translate x=\"1\"/><rotate z=\"1\" angle=\"90\"/><scale y=\"2\"/>"), {0, 2, 0}, 1e-15);
}

TEST(transform_test, translate_takes_one_number_for_all_axes) {
  expect_near(origin_of("<translate value=\"2\"/>"), {2, 2, 2}, 0);
}

TEST(transform_test, translate_leaves_axes_that_are_not_named) {
  expect_near(origin_of("<translate y=\"2\"/>"), {0, 2, 0}, 0);
}

TEST(transform_test, lists_are_separated_by_commas_and_blanks) {
  expect_near(origin_of("<translate value=\" 1,2 ,\t3 \"/>"), {1, 2, 3}, 0);
}

TEST(transform_test, numbers_may_have_a_plus_and_an_exponent) {
  expect_near(origin_of("<translate x=\" +1.5e2 \" y=\".5\" z=\"5.\"/>"), {150, 0.5, 5}, 0);
}

TEST(transform_test, matrix_of_sixteen_is_written_by_rows) {
  expect_near(origin_of("<matrix value=\"1 0 0 4 0 1 0 5 0 0 1 6 0 0 0 1\"/>"), {4, 5, 6}, 0);
}

TEST(transform_test, matrix_of_nine_is_the_linear_part) {
  const auto m = camera_of("<matrix value=\"0 -1 0, 1 0 0, 0 0 1\"/>");
  expect_near(glm::dvec3(m[0]), {0, 1, 0}, 0);
  expect_near(glm::dvec3(m[3]), {0, 0, 0}, 0);
}

TEST(transform_test, normals_go_with_the_inverse_transpose) {
  const auto m = scaling({2, 1, 1});
  expect_near(transform_normal(m, glm::normalize(glm::dvec3(1, 1, 0))), glm::normalize(glm::dvec3(0.5, 1, 0)), 1e-15);
}

TEST(transform_test, normals_keep_their_side_under_a_mirror) {
  expect_near(transform_normal(scaling({-1, 1, 1}), {0, 0, 1}), {0, 0, 1}, 0);
  expect_near(transform_normal(scaling({1, 1, -1}), {0, 0, 1}), {0, 0, -1}, 0);
}

TEST(transform_test, normals_survive_tiny_and_huge_scales) {
  for (const double scale : {1e-120, 1e120})
    expect_near(transform_normal(scaling(glm::dvec3(scale)), {0, 0, 1}), {0, 0, 1}, 1e-15);
}

TEST(transform_test, invertibility_does_not_depend_on_scale) {
  EXPECT_TRUE(is_invertible(scaling(glm::dvec3(1e-100))));
  EXPECT_TRUE(is_invertible(scaling({1e-6, 1e6, 1})));
  EXPECT_FALSE(is_invertible(scaling({1, 0, 1})));
}

}  // namespace

}  // namespace oclair
