// Instances are copies: each shape of the group moved by the matrix, its front carried along.
#include "../host/instance.h"

#include "../host/transform.h"
#include "random.h"
#include "scene_text.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

glm::dvec3 front_of(const Mesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  return glm::normalize(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

std::string group(const std::string& shapes) { return "<shape type=\"shapegroup\" id=\"g\">" + shapes + "</shape>"; }

std::string instance(const std::string& steps = "") {
  return "<shape type=\"instance\"><ref id=\"g\"/>" +
         (steps.empty() ? "" : "<transform name=\"to_world\">" + steps + "</transform>") + "</shape>";
}

const std::string MIRROR_X = "<scale x=\"-1\" y=\"1\" z=\"1\"/>", MIRROR_Z = "<scale x=\"1\" y=\"1\" z=\"-1\"/>";
const glm::dvec3 Z(0, 0, 1);

glm::dmat4 random_matrix(Random& random) {
  glm::dmat4 m(1.0);
  do
    for (int c = 0; c < 4; ++c) m[c] = glm::dvec4(random.in_cube(2.0), c == 3);
  while (std::abs(glm::determinant(m)) < 0.3);
  return m;
}

// A rotation, a scale of all axes alike, a mirror in every second one, and a shift.
glm::dmat4 random_similarity(Random& random, bool mirror) {
  glm::dmat4 m = translation(random.in_cube(3.0)) * glm::dmat4(frame_around(glm::normalize(random.in_cube(1.0)))) *
                 scaling(glm::dvec3(0.5 + std::abs(random.in_cube(1.0).x)));
  return mirror ? m * scaling({1, -1, 1}) : m;
}

WorldShape quadric(Geometry geometry, const glm::dmat4& to_world) {
  WorldShape shape;
  shape.geometry = geometry;
  shape.to_world = to_world;
  return shape;
}

}  // namespace

TEST(instance_test, a_mesh_is_moved_and_its_front_goes_where_the_inverse_transpose_sends_its_normals) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    WorldShape source;
    source.mesh = icosphere(1, 0.1, 7);
    const bool smooth = i % 2;
    if (smooth)
      for (const auto& p : source.mesh.positions) source.mesh.normals.push_back(glm::normalize(p));
    source.mesh.uvs.assign(source.mesh.positions.size(), {0.25, 0.5});
    source.material_front = 3;
    const glm::dmat4 m = random_matrix(random);
    const glm::dmat3 inverse_transpose = glm::transpose(glm::inverse(glm::dmat3(m)));
    const WorldShape copy = *instance_of(source, m);
    EXPECT_EQ(copy.material_front, 3u);
    EXPECT_EQ(copy.material_back, NONE);
    EXPECT_EQ(copy.mesh.uvs, source.mesh.uvs);
    ASSERT_EQ(copy.mesh.triangles.size(), source.mesh.triangles.size());
    ASSERT_EQ(copy.mesh.normals.size(), source.mesh.normals.size());
    for (std::size_t v = 0; v < source.mesh.positions.size(); ++v) {
      expect_near(copy.mesh.positions[v], glm::dvec3(m * glm::dvec4(source.mesh.positions[v], 1.0)), 1e-14 * 20);
      if (smooth) expect_near(copy.mesh.normals[v], glm::normalize(inverse_transpose * source.mesh.normals[v]), 1e-13);
    }
    for (std::size_t t = 0; t < source.mesh.triangles.size(); ++t) {
      // With vertex normals the front is theirs, also where a flat map has turned them from the side of the triangle's own.
      glm::dvec3 front = inverse_transpose * front_of(source.mesh, t);
      if (smooth)
        front = copy.mesh.normals[source.mesh.triangles[t].x] + copy.mesh.normals[source.mesh.triangles[t].y] +
                copy.mesh.normals[source.mesh.triangles[t].z];
      EXPECT_GT(glm::dot(front_of(copy.mesh, t), front), 0.0) << i;
    }
  }
}

// Points of the unit quadric go to points of it in the frame of the copy.
TEST(instance_test, a_quadric_is_the_image_of_its_points_with_the_same_side_in_front) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const bool mirror = i % 2;
    const glm::dmat4 m = random_similarity(random, mirror);
    for (const Geometry geometry : {Geometry::sphere, Geometry::cylinder, Geometry::disk}) {
      WorldShape source = quadric(geometry, random_similarity(random, false));
      source.flip_normals = i % 3 == 0;
      const WorldShape copy = *instance_of(source, m);
      EXPECT_EQ(copy.flip_normals, source.flip_normals);
      for (int k = 0; k < 8; ++k) {
        const double phi = 0.7 * k, h = 0.125 * k;
        const glm::dvec3 rim(std::cos(phi), std::sin(phi), 0.0);
        const glm::dvec3 p = geometry == Geometry::sphere ? glm::normalize(random.in_cube(1.0))
                             : geometry == Geometry::disk ? rim
                                                          : rim + h * Z;
        const glm::dvec3 q(glm::inverse(copy.to_world) * m * source.to_world * glm::dvec4(p, 1.0));
        EXPECT_NEAR(glm::length(geometry == Geometry::sphere ? q : glm::dvec3(q.x, q.y, 0.0)), 1.0, 1e-10);
        if (geometry != Geometry::sphere) {
          EXPECT_NEAR(q.z, geometry == Geometry::disk ? 0.0 : h, 1e-10);
        }
      }
      if (geometry == Geometry::disk) {
        const glm::dvec3 normal =
            glm::normalize(glm::transpose(glm::inverse(glm::dmat3(m))) * glm::dvec3(source.to_world[2]));
        expect_near(glm::normalize(glm::dvec3(copy.to_world[2])), normal, 1e-12);
      }
    }
  }
}

TEST(instance_test, what_would_be_no_sphere_or_cylinder_is_none) {
  EXPECT_FALSE(instance_of(quadric(Geometry::sphere, glm::dmat4(1.0)), scaling({2, 1, 1})));
  EXPECT_FALSE(instance_of(quadric(Geometry::cylinder, glm::dmat4(1.0)), scaling({2, 1, 1})));
  EXPECT_TRUE(instance_of(quadric(Geometry::cylinder, glm::dmat4(1.0)), scaling({2, 2, 1})));
  EXPECT_TRUE(instance_of(quadric(Geometry::disk, glm::dmat4(1.0)), scaling({2, 1, 1})));
}

// Measured in Mitsuba 3.9.1, with a ray from +z: unlike a mirror in the shape's own to_world, one in the instance keeps the
// front of a mesh without normals and of a sphere.
TEST(instance_test, fronts_are_those_of_mitsuba) {
  SceneDirectory directory;
  directory.write("a.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n");
  const std::string obj =
      "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/><boolean name=\"face_normals\" "
      "value=\"true\"/></shape>";
  const auto front = [&](const std::string& shape, const std::string& steps) {
    return front_of(directory.read(SENSOR + group(shape) + instance(steps)).shapes[0].mesh, 0);
  };
  expect_near(front(obj, MIRROR_X), Z, 0);
  expect_near(front(obj, MIRROR_Z), -Z, 0);
  expect_near(front("<shape type=\"rectangle\"/>", MIRROR_X), Z, 0);
  expect_near(front("<shape type=\"rectangle\"/>", MIRROR_Z), -Z, 0);
  const World world = directory.read(SENSOR + group("<shape type=\"sphere\"/><shape type=\"cube\"/>") + instance(MIRROR_X));
  EXPECT_FALSE(world.shapes[0].flip_normals);
  const Mesh& cube = world.shapes[1].mesh;
  for (std::size_t i = 0; i < 12; ++i) EXPECT_GT(glm::dot(front_of(cube, i), cube.positions[cube.triangles[i].x]), 0.5);
}

TEST(instance_test, a_group_alone_places_nothing_and_each_instance_all_of_it) {
  const std::string two = "<shape type=\"rectangle\"/><shape type=\"sphere\"><bsdf type=\"conductor\"/></shape>";
  EXPECT_TRUE(world_of(group(two)).shapes.empty());
  const World world =
      world_of(instance("<translate x=\"4\"/>") + group(two) + "<shape type=\"cube\"/>" + instance("<translate x=\"-4\"/>") +
               "<shape type=\"shapegroup\" id=\"empty\"/><shape type=\"instance\"><ref id=\"empty\"/></shape>");
  ASSERT_EQ(world.shapes.size(), 5u);
  EXPECT_EQ(world.shapes[0].mesh.triangles.size(), 12u);
  EXPECT_EQ(world.shapes[1].mesh.positions[0].x, 3.0);
  EXPECT_EQ(world.shapes[2].to_world[3].x, 4.0);
  EXPECT_EQ(world.shapes[4].to_world[3].x, -4.0);
  EXPECT_EQ(world.materials[world.shapes[2].material_front].kind, static_cast<uint>(MATERIAL_MIRROR));
  EXPECT_EQ(world.shapes[2].material_front, world.shapes[4].material_front);
}

TEST(instance_test, a_transform_of_the_shape_comes_before_that_of_the_instance) {
  const std::string shape =
      "<shape type=\"rectangle\"><transform name=\"to_world\"><translate x=\"1\"/></transform></shape>";
  const Mesh mesh = world_of(group(shape) + instance("<scale value=\"2\"/><translate y=\"3\"/>")).shapes[0].mesh;
  expect_near(mesh.positions[0], {0, 1, 0}, 0);
  expect_near(mesh.positions[2], {4, 5, 0}, 0);
}

// 2000 x 12 triangles, 90000 times: refused before the first of the 216 GB that they would take is asked for.
TEST(instance_test, more_triangles_than_ids_are_refused_before_they_are_copied) {
  std::string shapes, instances;
  for (int i = 0; i < 2000; ++i) shapes += "<shape type=\"cube\"/>";
  for (int i = 0; i < 90000; ++i) instances += "<shape type=\"instance\"><ref id=\"g\"/></shape>\n";
  try {
    world_of(group(shapes) + "\n" + instances);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the scene has more than 2^31 - 1 triangles"), std::string::npos)
        << error.what();
  }
}
