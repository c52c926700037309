// Texture coordinates and the derivatives of the position by them: against double arithmetic, and against Mitsuba.
#include "scene_text.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double pi = glm::pi<double>();

struct Result {
  packed_float3 position, dp_du, dp_dv;
  float u, v, b1, b2;
  cl_uint primitive, face;
};

std::vector<Result> coordinates(const Scene& scene, const Bvh& bvh, const std::vector<Ray>& rays,
                                const std::vector<Hit>& hits) {
  std::vector<Result> results(hits.size());
  run_with({every_feature, bvh.width}, "texture_coordinates_test.cl", "coordinates", hits.size(), bvh.blocks, scene.quadrics,
           scene.shapes, scene.triangle_shape, scene.triangle_vertices, scene.uvs, scene.normals, rays, hits, out(results));
  return results;
}

// So that the shapes keep their coordinates on the way to the device.
void make_textured(World& world) {
  WorldTexture texture;
  texture.kind = TEXTURE_CHECKERBOARD;
  world.textures.push_back(texture);
  for (Material& m : world.materials) m.reflectance_texture = static_cast<uint>(world.textures.size());
}

std::vector<uint> slots(const Scene& scene, const Bvh& bvh) {
  std::vector<uint> slot(scene.triangles.size(), NONE);
  const auto* blocks = reinterpret_cast<const TriangleBlock<8>*>(bvh.blocks.data());
  for (std::size_t b = bvh.block_count; b-- > 0;)
    for (uint lane = 8; lane-- > 0;) slot[blocks[b].primitive[lane]] = static_cast<uint>(8 * b + lane);
  return slot;
}

// A hit of every triangle, at random places.
struct Hits {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
};

Hits one_on_each(const Scene& scene, const Bvh& bvh, Random& random) {
  const auto slot = slots(scene, bvh);
  Hits result;
  for (uint i = 0; i < scene.triangles.size(); ++i) {
    const double b1 = random.unit(), b2 = random.between(0, 1 - b1);
    result.hits.push_back({1.0f, static_cast<float>(b1), static_cast<float>(b2), i, slot[i]});
    result.rays.push_back({{0, 0, 0}, 1e30f, {0, 0, 1}, NONE, NONE, 0.0f, 0});
  }
  return result;
}

// A triangle soup in which every triangle has its own vertices; a second shape in front, so that nothing begins at 0.
World soup(std::size_t count, bool with_uv, Random& random) {
  World world;
  for (int shape = 0; shape < 2; ++shape) {
    Mesh& mesh = add_shape(world, diffuse(0.5), Sides::both).mesh;
    for (std::size_t i = 0; i < count; ++i) {
      const glm::dvec3 at = random.in_cube(0.5);
      add_triangle(mesh, at, at + random.in_cube(0.4), at + random.in_cube(0.4));
    }
    for (std::size_t i = 0; with_uv && i < 3 * count; ++i) {
      const glm::dvec3 uv = random.in_cube(2);
      mesh.uvs.push_back({uv.x, uv.y});
    }
  }
  make_textured(world);
  return world;
}

// Worst deviations of a shape's position from p(u, v) of the coordinates that the kernel gave, and of its derivatives from
// central differences in double.
template <class Position>
void expect_surface(const std::vector<Result>& results, Position position, double size, const char* what) {
  const double h = 1e-5;  // the third derivative is at most (2 pi)^3 times the size: h^2/6 of it is 4e-9
  // atan2 may err by 6 ulp, of angles up to pi: 6 * 2^-22 rad; the local point itself by 16 u, as its error bound says.
  const double tolerance = size * (6 * 0x1p-22 + 32 * unit_roundoff);
  for (const Result& r : results) {
    const double u = r.u, v = r.v;
    ASSERT_TRUE(u >= 0 && u <= 1 && v >= 0 && v <= 1) << what;
    EXPECT_LE(glm::length(position(u, v) - unpacked(r.position)), tolerance) << what << " " << u << " " << v;
    const glm::dvec3 du = (position(u + h, v) - position(u - h, v)) / (2 * h),
                     dv = (position(u, v + h) - position(u, v - h)) / (2 * h);
    EXPECT_LE(glm::length(du - unpacked(r.dp_du)), 2 * pi * tolerance + 1e-8) << what << " " << u << " " << v;
    EXPECT_LE(glm::length(dv - unpacked(r.dp_dv)), 2 * pi * tolerance + 1e-8) << what << " " << u << " " << v;
  }
}

// Hits of the shape by rays towards random points of it.
Hits rays_at(const Scene& scene, const Bvh& bvh, const glm::dvec3& center, double size, Random& random) {
  Hits result;
  for (std::size_t i = 0; i < count_or_small(2000, 8); ++i) {
    const glm::dvec3 from = center + random.direction() * (3 * size);
    result.rays.push_back(ray_towards(from, center + random.in_cube(0.5 * size)));
  }
  const auto hits = trace_closest(scene, bvh, result.rays);
  Hits kept;
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].primitive != NONE) kept.hits.push_back(hits[i]), kept.rays.push_back(result.rays[i]);
  return kept;
}

struct Expected {
  glm::dvec3 from, direction;
  double u, v;
};

void expect_coordinates(const std::string& shape, const std::vector<Expected>& rows) {
  World world = oclair::world_of("<shape " + shape + "</shape>");
  make_textured(world);
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, 8);
  std::vector<Ray> rays;
  for (const Expected& row : rows)
    rays.push_back({packed(scene.frame.place(row.from)), 1e30f, packed(row.direction), NONE, NONE, 0.0f, 0});
  const auto hits = trace_closest(scene, bvh, rays);
  ASSERT_EQ(missed(hits), 0u) << shape;
  const auto results = coordinates(scene, bvh, rays, hits);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(results[i].u, rows[i].u, 1e-5) << shape << " ray " << i;
    EXPECT_NEAR(results[i].v, rows[i].v, 1e-5) << shape << " ray " << i;
  }
}

}  // namespace

// (1 - b1 - b2) rounds twice, three products and two sums: 7 roundings of the terms, coordinates are at most 2; themselves
// rounded once.
TEST(texture_coordinates_test, coordinates_are_interpolated_between_the_vertices_of_a_triangle) {
  Random random(1);
  const World world = soup(count_or_small(2000, 10), true, random);
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, 8);
  const Hits at = one_on_each(scene, bvh, random);
  const auto results = coordinates(scene, bvh, at.rays, at.hits);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Shape& shape = scene.shapes[scene.triangle_shape[i]];
    const Mesh& mesh = world.shapes[scene.triangle_shape[i]].mesh;
    const packed_uint3 t = scene.triangle_vertices[i];
    const double b1 = at.hits[i].b1, b2 = at.hits[i].b2;
    const glm::dvec2 uv = (1 - b1 - b2) * mesh.uvs[t.x] + b1 * mesh.uvs[t.y] + b2 * mesh.uvs[t.z];
    ASSERT_NEAR(results[i].u, uv.x, 8 * unit_roundoff * 2) << i;
    ASSERT_NEAR(results[i].v, uv.y, 8 * unit_roundoff * 2) << i;
    EXPECT_EQ(results[i].b1, at.hits[i].b1);
    EXPECT_EQ(results[i].b2, at.hits[i].b2);
    EXPECT_EQ(results[i].primitive, i);
    EXPECT_EQ(results[i].face, i - shape.first_triangle);
  }
}

// The oracle solves edge_k = dp_du d_k.u + dp_dv d_k.v in double. Differences of rounded coordinates err by 3u each, the
// products and the determinant by a few u more: 8 u of the terms, enlarged by the condition of the determinant.
TEST(texture_coordinates_test, tangents_of_a_triangle_map_coordinates_to_positions) {
  Random random(2);
  const World world = soup(count_or_small(2000, 10), true, random);
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, 8);
  const Hits at = one_on_each(scene, bvh, random);
  const auto results = coordinates(scene, bvh, at.rays, at.hits);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Shape& shape = scene.shapes[scene.triangle_shape[i]];
    const packed_uint3 t = scene.triangle_vertices[i];
    const auto uv_of = [&](uint vertex) {
      const auto& uv = scene.uvs[shape.first_uv + vertex];
      return glm::dvec2(uv[0], uv[1]);
    };
    const Corners corners = corners_of(scene, i);
    const glm::dvec3 e1 = unpacked(corners[1]) - unpacked(corners[0]), e2 = unpacked(corners[2]) - unpacked(corners[0]);
    const glm::dvec2 d1 = uv_of(t.y) - uv_of(t.x), d2 = uv_of(t.z) - uv_of(t.x);
    const double determinant = d1.x * d2.y - d1.y * d2.x, terms = std::abs(d1.x * d2.y) + std::abs(d1.y * d2.x);
    const glm::dvec3 du = (d2.y * e1 - d1.y * e2) / determinant, dv = (d1.x * e2 - d2.x * e1) / determinant;
    const double relative = 8 * unit_roundoff * (1 + terms / std::abs(determinant)) / std::abs(determinant);
    const double tolerance = relative * (glm::length(d1) + glm::length(d2)) * (glm::length(e1) + glm::length(e2));
    ASSERT_LE(glm::length(unpacked(results[i].dp_du) - du), tolerance) << i;
    ASSERT_LE(glm::length(unpacked(results[i].dp_dv) - dv), tolerance) << i;
  }
}

TEST(texture_coordinates_test, without_coordinates_the_barycentric_ones_take_their_place) {
  Random random(3);
  const Scene scene = place_scene(soup(20, false, random));
  EXPECT_TRUE(scene.uvs.empty());
  const Bvh bvh = build_bvh(scene, 8);
  const Hits at = one_on_each(scene, bvh, random);
  const auto results = coordinates(scene, bvh, at.rays, at.hits);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Corners c = corners_of(scene, i);
    EXPECT_EQ(results[i].u, at.hits[i].b1);
    EXPECT_EQ(results[i].v, at.hits[i].b2);
    expect_near(unpacked(results[i].dp_du), unpacked(c[1]) - unpacked(c[0]), 2 * unit_roundoff);
    expect_near(unpacked(results[i].dp_dv), unpacked(c[2]) - unpacked(c[0]), 2 * unit_roundoff);
  }
}

TEST(texture_coordinates_test, a_triangle_whose_coordinates_coincide_has_no_tangents) {
  World world;
  Mesh& mesh = add_shape(world, diffuse(0.5), Sides::both).mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(mesh, {0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  mesh.uvs = {{.5, .5}, {.5, .5}, {.5, .5}, {0, 0}, {1, 1}, {2, 2}};
  make_textured(world);
  Random random(4);
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, 8);
  const Hits at = one_on_each(scene, bvh, random);
  for (const Result& r : coordinates(scene, bvh, at.rays, at.hits)) {
    EXPECT_EQ(unpacked(r.dp_du), glm::dvec3(0));
    EXPECT_EQ(unpacked(r.dp_dv), glm::dvec3(0));
  }
}

TEST(texture_coordinates_test, only_shapes_that_a_texture_asks_carry_coordinates) {
  Random random(5);
  World world = soup(3, true, random);
  world.materials[0].reflectance_texture = 0;
  const Scene scene = place_scene(world);
  EXPECT_EQ(scene.shapes[0].first_uv, NONE);
  EXPECT_EQ(scene.shapes[1].first_uv, 0u);
  EXPECT_EQ(scene.uvs.size(), 9u);
  world.materials[1].reflectance_texture = 0;
  const Scene plain = place_scene(world);
  EXPECT_TRUE(plain.uvs.empty());
  EXPECT_TRUE(plain.triangle_vertices.empty());
  EXPECT_TRUE(plain.textures.empty());
  EXPECT_TRUE(plain.texels.empty());
}

// Longitude in turns, angle from +z in half turns; disk: radius, longitude; cylinder: longitude, height. In frames of any
// kind.
TEST(texture_coordinates_test, quadrics_have_the_coordinates_of_their_parametrisation) {
  Random random(6);
  for (const Geometry geometry : {Geometry::sphere, Geometry::disk, Geometry::cylinder})
    for (const double mirror : {1.0, -1.0}) {
      World world;
      WorldShape& shape = add_shape(world, diffuse(0.5), Sides::both);
      shape.geometry = geometry;
      const glm::dvec3 z = random.direction(), x = glm::normalize(glm::cross(z, random.direction())),
                       y = glm::cross(z, x) * mirror;
      const double height = geometry == Geometry::sphere ? 0.7 : 0.9, across = geometry == Geometry::disk ? 0.4 : 0.7;
      shape.to_world = glm::dmat4(glm::dvec4(x * 0.7, 0), glm::dvec4(y * across, 0), glm::dvec4(z * height, 0),
                                  glm::dvec4(0.1, -0.2, 0.3, 1));
      make_textured(world);
      const Scene scene = place_scene(world);
      const Bvh bvh = build_bvh(scene, 8);
      const glm::dvec3 center = scene.frame.place({0.1, -0.2, 0.3});
      const auto length = [&](double l) { return scene.frame.place_length(l); };
      const glm::dvec3 ax = x * length(0.7), ay = y * length(across), az = z * length(height);
      const Hits at = rays_at(scene, bvh, center, length(1.0), random);
      ASSERT_GT(at.hits.size(), small_inputs() ? 0u : 100u);
      const auto position = [&](double u, double v) -> glm::dvec3 {
        if (geometry == Geometry::disk)
          return center + v * 0.0 + u * (ax * std::cos(2 * pi * v) + ay * std::sin(2 * pi * v));
        const glm::dvec3 ring = ax * std::cos(2 * pi * u) + ay * std::sin(2 * pi * u);
        if (geometry == Geometry::cylinder) return center + ring + az * v;
        return center + std::sin(pi * v) * ring + std::cos(pi * v) * az;
      };
      expect_surface(coordinates(scene, bvh, at.rays, at.hits), position, length(1.0) + glm::length(center),
                     geometry == Geometry::sphere ? "sphere"
                     : geometry == Geometry::disk ? "disk"
                                                  : "cylinder");
    }
}

// All below: measured in Mitsuba 3.9.1, variant scalar_rgb, ray_intersect(...).uv, 5 digits.
TEST(texture_coordinates_test, rectangles_and_cubes_have_the_coordinates_of_mitsuba) {
  const glm::dvec3 down(0, 0, -1);
  expect_coordinates("type=\"rectangle\">", {{{-.5, -.8, 1}, down, .25, .1},
                                             {{.5, -.8, 1}, down, .75, .1},
                                             {{-.5, .8, 1}, down, .25, .9},
                                             {{.5, .3, -1}, -down, .75, .65}});
  expect_coordinates("type=\"rectangle\"><transform name=\"to_world\"><scale x=\"-1\"/></transform>",
                     {{{.3, .4, 3}, down, .35, .7}});
  expect_coordinates("type=\"cube\">", {{{-3, .4, -.7}, {1, 0, 0}, .7, .15},
                                        {{3, .4, -.7}, {-1, 0, 0}, .7, .85},
                                        {{-.7, -3, .4}, {0, 1, 0}, .7, .15},
                                        {{-.7, 3, .4}, {0, -1, 0}, .85, .3},
                                        {{.4, -.7, -3}, {0, 0, 1}, .85, .7},
                                        {{.4, -.7, 3}, down, .15, .7}});
}

TEST(texture_coordinates_test, quadrics_have_the_coordinates_of_mitsuba) {
  const glm::dvec3 down(0, 0, -1), left(-1, 0, 0);
  const auto to_world = [](const std::string& steps) { return "<transform name=\"to_world\">" + steps + "</transform>"; };
  expect_coordinates("type=\"disk\">",
                     {{{.3, .4, 1}, down, .5, .14758}, {{.3, -.4, 1}, down, .5, .85242}, {{-.3, .4, 1}, down, .5, .35242}});
  expect_coordinates("type=\"disk\">" + to_world("<scale x=\"2\" y=\"3\"/>"), {{{.3, .4, 1}, down, .20069, .11565}});
  expect_coordinates("type=\"disk\">" + to_world("<scale x=\"-2\" y=\"3\"/>"), {{{.3, -.4, 1}, down, .20069, .61565}});
  expect_coordinates(
      "type=\"sphere\">",
      {{{.3, .4, 3}, down, .14758, .16667}, {{.3, -.4, 3}, down, .85242, .16667}, {{-.3, .4, -3}, -down, .35242, .83333}});
  expect_coordinates("type=\"sphere\"><float name=\"radius\" value=\"2\"/><point name=\"center\" value=\"1, 0, 0\"/>" +
                         to_world("<rotate x=\"1\" angle=\"90\"/>"),
                     {{{1.3, -5, .4}, {0, 1, 0}, .14758, .08043}});
  expect_coordinates("type=\"sphere\">" + to_world("<rotate z=\"1\" angle=\"30\"/><rotate y=\"1\" angle=\"90\"/>"),
                     {{{3, .3, .4}, left, .31425, .16667}});
  expect_coordinates("type=\"sphere\">" + to_world("<scale x=\"-1\"/>"), {{{.3, .4, 3}, down, .35242, .16667}});
  expect_coordinates(
      "type=\"cylinder\">",
      {{{3, .3, .25}, left, .04849, .25}, {{3, -.3, .25}, left, .95151, .25}, {{-3, .3, .75}, -left, .45151, .75}});
  expect_coordinates("type=\"cylinder\">" + to_world("<scale y=\"-1\"/>"), {{{3, .3, .25}, left, .95151, .25}});
  const auto between = [](const std::string& p0, const std::string& p1, const std::string& radius) {
    return "type=\"cylinder\"><point name=\"p0\" value=\"" + p0 + "\"/><point name=\"p1\" value=\"" + p1 +
           "\"/><float name=\"radius\" value=\"" + radius + "\"/>";
  };
  expect_coordinates(between("1, 0, 0", "1, 0, 3", "2"),
                     {{{5, .3, .5}, left, .02396, .16667}, {{1, 5, .5}, {0, -1, 0}, .25, .16667}});
  expect_coordinates(between("0, 0, 0", "3, 0, 0", "1"),
                     {{{1, .3, 5}, down, .45151, .33333}, {{1, 5, .2}, {0, -1, 0}, .28205, .33333}});
  expect_coordinates(between("0, 0, 0", "1, 2, -2", "1"),
                     {{{.5, 1, 5}, down, .82379, .20186}, {{.5, 5, -1}, {0, -1, 0}, .72138, .79814}});
}
