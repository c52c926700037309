#include "../host/mesh.h"

#include <algorithm>
#include <cstring>

#include "../host/mesh_file.h"
#include "scene_text.h"

namespace oclair {

namespace {

glm::dvec3 front_of(const Mesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  return glm::normalize(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

// Counter-clockwise seen from +z; a normal that says so, or the contrary.
const std::string TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string FLAT = TRIANGLE + "f 1 2 3\n";
const std::string UP = TRIANGLE + "vn 0 0 3\nf 1//1 2//1 3//1\n";
const std::string DOWN = TRIANGLE + "vn 0 0 -3\nf 1//1 2//1 3//1\n";
const glm::dvec3 Z(0, 0, 1);

MeshOptions mirrored() {
  MeshOptions options;
  options.to_world[0][0] = -1.0;
  return options;
}

TEST(mesh_test, winding_decides_the_front_without_vertex_normals) {
  expect_near(front_of(to_world(parse_obj(FLAT), {}), 0), Z, 0);
  expect_near(front_of(to_world(parse_obj(FLAT), mirrored()), 0), -Z, 0);
}

TEST(mesh_test, vertex_normals_decide_the_front_where_they_exist) {
  expect_near(front_of(to_world(parse_obj(UP), {}), 0), Z, 0);
  expect_near(front_of(to_world(parse_obj(DOWN), {}), 0), -Z, 0);
  expect_near(front_of(to_world(parse_obj(UP), mirrored()), 0), Z, 0);
}

TEST(mesh_test, vertex_normals_become_unit_vectors) { expect_near(to_world(parse_obj(UP), {}).normals[0], Z, 0); }

TEST(mesh_test, face_normals_forget_the_vertex_normals_and_the_side_they_chose) {
  MeshOptions options;
  options.face_normals = true;
  const auto mesh = to_world(parse_obj(DOWN), options);
  EXPECT_TRUE(mesh.normals.empty());
  expect_near(front_of(mesh, 0), Z, 0);
}

TEST(mesh_test, flip_normals_turns_triangles_and_vertex_normals) {
  MeshOptions options;
  options.flip_normals = true;
  const auto mesh = to_world(parse_obj(DOWN), options);
  expect_near(front_of(mesh, 0), Z, 0);
  expect_near(mesh.normals[0], Z, 0);
  expect_near(front_of(to_world(parse_obj(FLAT), options), 0), -Z, 0);
}

// Measured in Mitsuba 3.9.1, 4 digits.
TEST(mesh_test, missing_normals_are_the_mean_of_faces_weighted_by_their_angles) {
  const auto mesh = to_world(parse_obj(TRIANGLE + "v 0 0 2\nf 1 2 3\nf 1 2 4\n"), {});
  expect_near(mesh.normals[0], {0, -0.7071, 0.7071}, 5e-5);
  expect_near(mesh.normals[1], {0, -0.8156, 0.5786}, 5e-5);
  expect_near(mesh.normals[2], {0, 0, 1}, 5e-5);
  expect_near(mesh.normals[3], {0, -1, 0}, 5e-5);
}

TEST(mesh_test, missing_normals_are_computed_after_the_transform) {
  MeshOptions options;  // scale 2, 3, 1, then 90 degrees around x; measured in Mitsuba 3.9.1
  options.to_world = glm::dmat4(2, 0, 0, 0, 0, 0, 3, 0, 0, -1, 0, 0, 0, 0, 0, 1);
  const auto mesh = to_world(parse_obj(TRIANGLE + "v 0 0 2\nf 1 2 3\nf 1 2 4\n"), options);
  expect_near(mesh.normals[1], {0, -0.7812, -0.6243}, 5e-5);
}

TEST(mesh_test, smooth_normals_do_not_depend_on_scale) {
  for (const double scale : {1e-150, 1e150}) {
    MeshOptions options;
    for (int i = 0; i < 3; ++i) options.to_world[i][i] = scale;
    expect_near(to_world(parse_obj(TRIANGLE + "v 0 0 2\nf 1 2 3\nf 1 2 4\n"), options).normals[1], {0, -0.8156, 0.5786},
                5e-5);
  }
}

TEST(mesh_test, degenerate_primitives_do_not_disturb_normals) {
  const auto mesh = to_world(parse_obj(TRIANGLE + "f 1 2 3\nf 1 1 2\n"), {});
  EXPECT_EQ(mesh.triangles.size(), 2u);
  for (const auto& n : mesh.normals) expect_near(n, Z, 0);
}

TEST(mesh_test, corners_with_different_texture_coordinates_are_different_vertices) {
  const auto mesh = parse_obj(TRIANGLE + "v 0 0 2\nvt 0 0\nvt 1 0\nf 1/1 2/1 3/1\nf 1/2 2/2 4/2\n");
  EXPECT_EQ(mesh.positions.size(), 6u);
}

TEST(mesh_test, equal_positions_with_different_indices_are_different_vertices) {
  const auto mesh = to_world(parse_obj(TRIANGLE + "v 0 0 0\nv 1 0 0\nv 0 0 2\nf 1 2 3\nf 4 5 6\n"), {});
  EXPECT_EQ(mesh.positions.size(), 6u);
  expect_near(mesh.normals[0], Z, 0);  // the edge between the two faces stays hard
}

TEST(mesh_test, polygons_become_fans_around_their_first_corner) {
  const auto mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
  EXPECT_EQ(mesh.triangles[1], glm::uvec3(0, 2, 3));
  EXPECT_EQ(mesh.concave_polygons, 0u);
}

TEST(mesh_test, concave_polygons_are_counted) {
  EXPECT_EQ(parse_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv .5 .4 0\nv 0 1 0\nf 1 2 3 4 5\n").concave_polygons, 1u);
}

TEST(mesh_test, negative_obj_indices_count_from_the_last) {
  const auto mesh = parse_obj(TRIANGLE + "f -3 -2 -1\n");
  EXPECT_EQ(mesh.positions[0], glm::dvec3(0, 0, 0));
  EXPECT_EQ(mesh.positions[2], glm::dvec3(0, 1, 0));
}

TEST(mesh_test, obj_materials_groups_lines_and_points_are_skipped) {
  const auto mesh = parse_obj("# comment\r\nmtllib gone.mtl\r\no a\r\n" + TRIANGLE +
                              "usemtl a\nl 1 2\np 1\ns 1\nf 1 2 3 # triangle\ng b\nf 3 2 1");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions.size(), 3u);
}

TEST(mesh_test, missing_material_library_does_not_matter) {
  SceneDirectory directory;
  directory.write("a.obj", "mtllib gone.mtl\n" + FLAT);
  EXPECT_EQ(directory.read(SENSOR + "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape>")
                .shapes[0]
                .mesh.triangles.size(),
            1u);
}

std::string ply_header(const std::string& format, const std::string& normals = "") {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + normals +
         "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

template <typename T>
std::string bytes_of(T value, bool big_endian) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string binary_body(bool big_endian) {
  std::string body;
  for (int v = 0; v < 3; ++v) {
    for (const float x : {v == 1 ? 1.0f : 0.0f, v == 2 ? 1.0f : 0.0f, 0.25f}) body += bytes_of(x, big_endian);
    body += '\xff';
  }
  body += '\3';
  for (const std::int32_t i : {0, 1, 2}) body += bytes_of(i, big_endian);
  return body;
}

void expect_ply_triangle(const std::string& bytes) {
  const auto mesh = parse_ply(bytes);
  ASSERT_EQ(mesh.positions.size(), 3u);
  ASSERT_EQ(mesh.triangles.size(), 1u);
  expect_near(mesh.positions[1], {1, 0, 0.25}, 0);
  expect_near(mesh.positions[2], {0, 1, 0.25}, 0);
  EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
}

// In little-endian memory, which every OpenCL host that we know has, bytes_of(x, true) is big-endian.
TEST(mesh_test, ply_is_read_in_all_three_encodings) {
  expect_ply_triangle(ply_header("ascii") + "0 0 .25 255\n1 0 .25 255\n0 1 .25 255\n3 0 1 2\n");
  expect_ply_triangle(ply_header("binary_little_endian") + binary_body(false));
  expect_ply_triangle(ply_header("binary_big_endian") + binary_body(true));
}

TEST(mesh_test, ply_normals_are_read) {
  const auto mesh = parse_ply(ply_header("ascii", "property float nx\nproperty float ny\nproperty float nz\n") +
                              "0 0 0 0 0 2 255\n1 0 0 0 0 2 255\n0 1 0 0 0 2 255\n3 0 1 2\n");
  ASSERT_EQ(mesh.normals.size(), 3u);
  expect_near(mesh.normals[0], {0, 0, 2}, 0);
}

TEST(mesh_test, every_truncation_of_a_binary_ply_is_refused) {
  const std::string whole = ply_header("binary_little_endian") + binary_body(false);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(parse_ply(whole.substr(0, size)), MeshFileError) << size;
}

TEST(mesh_test, cube_faces_outwards_even_when_it_is_mirrored) {
  for (const auto& options : {MeshOptions{}, mirrored()}) {
    const auto mesh = cube_mesh(options);
    ASSERT_EQ(mesh.triangles.size(), 12u);
    for (std::size_t i = 0; i < 12; ++i) EXPECT_GT(glm::dot(front_of(mesh, i), mesh.positions[mesh.triangles[i].x]), 0.5);
  }
}

TEST(mesh_test, cube_covers_two_units_on_each_side) {
  const auto mesh = cube_mesh({});
  double area = 0.0;
  for (const auto& t : mesh.triangles)
    area +=
        glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x])) / 2.0;
  EXPECT_DOUBLE_EQ(area, 24.0);
}

// Measured in Mitsuba 3.9.1: the normal of a rectangle is +z through the inverse transpose.
TEST(mesh_test, rectangle_faces_where_the_transform_sends_z) {
  expect_near(front_of(rectangle_mesh({}), 0), Z, 0);
  expect_near(front_of(rectangle_mesh(mirrored()), 1), Z, 0);
  MeshOptions upside_down;
  upside_down.to_world[2][2] = -1.0;
  expect_near(front_of(rectangle_mesh(upside_down), 0), -Z, 0);
  expect_near(front_of(rectangle_mesh(upside_down), 1), -Z, 0);
}

TEST(mesh_test, flip_normals_turns_rectangle_and_cube) {
  MeshOptions options;
  options.flip_normals = true;
  expect_near(front_of(rectangle_mesh(options), 0), -Z, 0);
  const auto cube = cube_mesh(options);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_LT(glm::dot(front_of(cube, i), cube.positions[cube.triangles[i].x]), 0.0);
}

}  // namespace

}  // namespace oclair
