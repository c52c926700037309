// Points, error bounds and normals of surfaces, and rays that leave them (extremes X9, X10, X16).
#include "extremes.h"
#include "inputs.h"
#include "leaving_rays.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Result {
  packed_float3 position, error, geometric, shading;
  cl_uint shape, front;
};

std::vector<Result> surfaces(const Scene& scene, const Bvh& bvh, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  std::vector<Result> results(hits.size());
  run_with({every_feature, bvh.width}, "surface_test.cl", "surfaces", hits.size(), bvh.blocks, scene.quadrics, scene.shapes, scene.triangle_shape,
           scene.triangle_vertices, scene.normals, rays, hits, out(results));
  return results;
}

// A diffuse walk of `bounces` bounces in the closed world, from its middle.
void no_walk_leaves(const World& world, const std::string& what) {
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const std::size_t paths = count_or_small(600, 2);
  const auto bounces = static_cast<cl_uint>(count_or_small(1000, 10));
  Random random(11);
  std::vector<Ray> start;
  for (std::size_t i = 0; i < paths; ++i) start.push_back({packed(random.in_cube(0.05)), 1e30f, packed(random.direction()), NONE, NONE, 0.0f, 0});
  std::vector<cl_uint> survived(paths);
  run_with({scene.features, bvh.width, bvh.stack_size()}, "../cl/selftest.cl", "walk", paths, bvh.nodes, bvh.blocks, scene.quadrics, scene.shapes,
           scene.triangle_shape, start, bounces, out(survived));
  EXPECT_EQ(std::count(survived.begin(), survived.end(), bounces), static_cast<std::ptrdiff_t>(paths)) << what;
}

}  // namespace

// The law that leaving a surface rests on: across the surface, the computed point is within dot(|normal|, error) of it. Along the surface the
// rounding of b0 = 1 - b1 - b2 (1.5 u) moves it too, which is nobody's business.
TEST(surface_test, the_error_bounds_how_far_the_point_is_off_the_triangle) {
  Random random(1);
  const Scene scene = place_scene(world_of(triangles_in({0, 0, 0}, 1.0, count_or_small(20000, 20), random)));
  const Bvh bvh = build_bvh(scene, 8);
  const std::vector<Hit> hits = hits_everywhere(scene, bvh, 5 * scene.triangles.size(), random);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < hits.size(); ++i) rays.push_back({{0, 0, 0}, 1e30f, packed(random.direction()), NONE, NONE, 0.0f, 0});
  const std::vector<Result> results = surfaces(scene, bvh, rays, hits);
  double worst = 0.0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Corners c = corners_of(scene, hits[i].primitive);
    const glm::dvec3 a = unpacked(c[0]), e1 = unpacked(c[1]) - a, e2 = unpacked(c[2]) - a, n = glm::normalize(glm::cross(e1, e2));
    const glm::dvec3 p = unpacked(results[i].position), bound = unpacked(results[i].error);
    const double off = std::abs(glm::dot(n, p - a)), allowed = glm::dot(glm::abs(n), bound);
    EXPECT_LE(off, allowed) << i;
    keep_worst(worst, off / allowed);
    const glm::dvec3 exact = a + static_cast<double>(hits[i].b1) * e1 + static_cast<double>(hits[i].b2) * e2;
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(p[k] - exact[k]), bound[k] + 1.5 * unit_roundoff * std::abs(a[k])) << i;
  }
  record_extreme("X9", worst, 1);
  EXPECT_GT(worst, 0.1);  // the bound is not ten times too wide
}

// Extreme X9: 4e5 triangles at five scales and three distances from the origin; none is hit again by a ray that leaves it, and the
// offset stays below 2e-6.
TEST(surface_test, a_ray_that_leaves_a_triangle_does_not_hit_it_again_even_if_it_is_not_left_out) {
  Random random(2);
  std::size_t again_total = 0, rays = 0;
  double largest = 0.0;
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6})
    for (const double distance : {0.0, 1e3, 1e5}) {
      const Scene scene = place_scene(world_of(triangles_in(distance * glm::dvec3(1.0, -0.7, 0.3), scale, count_or_small(27000, 20), random)));
      const Bvh bvh = build_bvh(scene, 8);
      const std::vector<Hit> hits = hits_everywhere(scene, bvh, scene.triangles.size(), random);
      std::vector<packed_float3> w, offset(hits.size());
      for (std::size_t i = 0; i < hits.size(); ++i) w.push_back(packed(leaving_direction(scene, hits[i], i, random)));
      std::vector<cl_uint> again(hits.size());
      run("../cl/selftest.cl", "leave", hits.size(), bvh.blocks, scene.shapes, scene.triangle_shape, hits, w, out(offset), out(again));
      again_total += static_cast<std::size_t>(std::count(again.begin(), again.end(), 1u));
      rays += hits.size();
      for (const packed_float3& o : offset) keep_worst(largest, glm::length(unpacked(o)));
    }
  EXPECT_EQ(again_total, 0u) << "of " << rays;
  record_extreme("X9", largest, 2e-6);
  EXPECT_GT(largest, 1e-8);
}

// Extreme X10. The boxes' walls meet at right angles, the ball's at flat ones; tilted, they have no exact coordinates.
TEST(surface_test, no_diffuse_walk_of_a_thousand_bounces_leaves_a_closed_room) {
  World straight, tilted, far_away, tiny, ball;
  add_box(add_shape(straight, diffuse(0.5), Sides::front).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  no_walk_leaves(straight, "box");
  const glm::dmat3 turn(glm::normalize(glm::dvec3(1, 2, 3)), glm::normalize(glm::dvec3(-2, 1, 0)), glm::normalize(glm::dvec3(-3, -6, 5)));
  Mesh& mesh = add_shape(tilted, diffuse(0.5), Sides::front).mesh;
  add_box(mesh, {-1, -0.8, -0.9}, {1, 0.8, 0.9}, true);
  for (glm::dvec3& p : mesh.positions) p = turn * p;
  no_walk_leaves(tilted, "tilted box");
  far_away = tilted;
  for (glm::dvec3& p : far_away.shapes[0].mesh.positions) p += glm::dvec3(1e5, -1e3, 7e4);
  no_walk_leaves(far_away, "tilted box 1e5 away");
  tiny = tilted;
  for (glm::dvec3& p : tiny.shapes[0].mesh.positions) p *= 1e-6;
  no_walk_leaves(tiny, "tilted box of 1e-6");
  add_shape(ball, diffuse(0.5), Sides::both).mesh = icosphere(3, 0.05, 5);
  no_walk_leaves(ball, "icosphere");
  World sphere;
  add_shape(sphere, diffuse(0.5), Sides::both).geometry = Geometry::sphere;
  no_walk_leaves(sphere, "true sphere");
  record_law("X10");
}

// Extreme X30. Walls along the axes only turn the signs of the direction: its components come back. Each bounce renormalises
// with two roundings of at most u a component.
TEST(surface_test, a_thousand_reflections_in_a_closed_box_keep_the_direction) {
  World world;
  add_box(add_shape(world, mirror(1.0), Sides::front).mesh, {-1, -0.8, -0.9}, {1, 0.8, 0.9}, true);
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  const auto bounces = static_cast<cl_uint>(count_or_small(1000, 10));
  Random random(12);
  std::vector<Ray> start;
  for (std::size_t i = 0; i < count_or_small(5000, 5); ++i)
    start.push_back({packed(random.in_cube(0.3)), 1e30f, packed(random.direction()), NONE, NONE, 0.0f, 0});
  std::vector<Ray> end = start;
  run_with({scene.features, bvh.width, bvh.stack_size()}, "surface_test.cl", "reflect", end.size(), bvh.nodes, bvh.blocks,
           scene.quadrics, scene.shapes, scene.triangle_shape, bounces, out(end));
  double worst = 0.0;
  for (std::size_t i = 0; i < end.size(); ++i) {
    ASSERT_NE(end[i].skip, NONE) << i;
    keep_worst(worst, glm::length(glm::abs(unpacked(end[i].direction)) - glm::abs(unpacked(start[i].direction))));
    EXPECT_NEAR(glm::length(unpacked(end[i].direction)), 1.0, 4 * unit_roundoff);
  }
  record_extreme("X30", worst, 1000 * 2 * unit_roundoff);
}

// Extreme X16. A triangle in z = 0 whose front is +z; the ray comes from above and from below.
TEST(surface_test, the_shading_normal_is_the_interpolated_one_where_it_faces_the_ray_and_else_the_geometric_one) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity(), r = std::sqrt(0.5f);
  struct Row {
    packed_float3 n[3];
    packed_float3 from;  // the ray comes from there
    bool interpolated;
  };
  const packed_float3 up{0, 0, 1}, down{0, 0, -1}, side{1, 0, 0}, slant{r, 0, r}, zero{0, 0, 0}, bad{nan, 0, 1}, infinite{0, inf, 1}, steep{0.8f, 0, -0.6f}, almost{-0.9999998f, 0, 0};
  const std::vector<Row> table = {
      {{up, up, up}, {0.3f, 0.2f, 1}, true},         {{slant, slant, slant}, {0.3f, 0.2f, 1}, true},
      {{slant, up, side}, {0.3f, 0.2f, 1}, true},    {{slant, slant, slant}, {-1, 0, 0.5f}, false},  // faces away
      {{zero, zero, zero}, {0.3f, 0.2f, 1}, false},  {{side, {-1, 0, 0}, {-1, 0, 0}}, {0.3f, 0.2f, 1}, false},
      {{side, almost, almost}, {0.3f, 0.2f, 1}, false},  // what is left is rounding
      {{side, {-1, 0.3f, 0.3f}, {-1, 0.3f, 0.3f}}, {0.3f, 0.2f, 1}, true},
      {{bad, bad, bad}, {0.3f, 0.2f, 1}, false},     {{infinite, up, up}, {0.3f, 0.2f, 1}, false},
      {{down, down, down}, {0.3f, 0.2f, 1}, false},  {{side, side, side}, {0, 0, 1}, false},
      {{up, up, up}, {0.3f, 0.2f, -1}, true},        {{slant, slant, slant}, {0.3f, 0.2f, -1}, true},  // from below: both are turned
      {{slant, slant, slant}, {1, 0, -0.5f}, false}, {{steep, steep, steep}, {1, 0, 0.5f}, true}};
  Scene scene = scene_of({{packed_float3{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0, 0.5f, 0}}});
  scene.triangle_shape = {0};
  scene.shapes = {{0, 0, NONE, 1, 0, 0, NONE}};
  scene.triangle_vertices = {{0, 1, 2}};
  const Bvh bvh = build_bvh(scene, 8);
  double worst = 0.0;
  for (const Row& row : table) {
    scene.normals.assign(row.n, row.n + 3);
    const Hit hit{1.0f, 0.125f, 0.375f, 0, 0};
    const glm::dvec3 wo = glm::normalize(unpacked(row.from));
    const Result s = surfaces(scene, bvh, {{packed(wo), 1e30f, packed(-wo), NONE, NONE, 0.0f, 0}}, {hit})[0];
    const bool front = wo.z >= 0;
    const glm::dvec3 geometric(0, 0, front ? 1 : -1);
    glm::dvec3 shading = glm::normalize(0.5 * unpacked(row.n[0]) + 0.125 * unpacked(row.n[1]) + 0.375 * unpacked(row.n[2]));
    if (!front) shading = -shading;
    EXPECT_EQ(s.front != 0, front);
    EXPECT_LE(glm::length(unpacked(s.geometric) - geometric), 0.0);
    // rsqrt: 2 ulp, and 6 roundings
    const double off = glm::length(unpacked(s.shading) - (row.interpolated ? shading : geometric)) / unit_roundoff;
    EXPECT_LE(off, 12) << row.n[0].x << " " << row.from.x;
    keep_worst(worst, off);
    EXPECT_GT(glm::dot(unpacked(s.shading), wo), 0.0);
  }
  record_extreme("X16", worst, 12);
}

// The normal of slivers, down to edges of 1e-30: cross products and their squares would underflow.
TEST(surface_test, the_geometric_normal_of_a_sliver_is_that_of_double_and_faces_the_ray) {
  Random random(3);
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < count_or_small(50000, 40); ++i) {
    const double thin = random.log_between(i % 2 ? 1e-7 : 1e-13, 1.0), length = random.log_between(i % 2 ? 1e-4 : 1e-15, 1.0);
    const glm::dvec3 x = random.direction(), y = random.direction(), at = i % 2 ? random.in_cube(0.5) : glm::dvec3(0.0);
    triangles.push_back({packed(at), packed(at + length * x), packed(at + length * (0.4 * x + thin * y))});
  }
  Scene scene = scene_of(triangles);
  scene.triangle_shape.assign(triangles.size(), 0);
  scene.shapes = {{0, 0, NONE, 1, 0, NONE, NONE}};
  const Bvh bvh = build_bvh(scene, 8);
  const std::vector<uint> slot = slots(scene, bvh);
  std::vector<Hit> hits;
  std::vector<Ray> rays;
  std::vector<glm::dvec3> exact;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Corners& c = triangles[i];
    // Edges as float32 has them: what is lost there is lost.
    const glm::dvec3 e1(c[1].x - c[0].x, c[1].y - c[0].y, c[1].z - c[0].z), e2(c[2].x - c[0].x, c[2].y - c[0].y, c[2].z - c[0].z);
    const glm::dvec3 n = glm::cross(e1, e2);
    if (std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) < 0x1p-100) continue;  // products of float32 underflow below 2^-126
    exact.push_back(glm::normalize(n));
    hits.push_back({1.0f, 0.3f, 0.3f, static_cast<uint>(i), slot[i]});
    rays.push_back({{0, 0, 0}, 1e30f, packed(random.direction()), NONE, NONE, 0.0f, 0});
  }
  const std::vector<Result> results = surfaces(scene, bvh, rays, hits);
  EXPECT_GT(hits.size(), triangles.size() / 2);
  double worst = 0.0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const glm::dvec3 n = unpacked(results[i].geometric), wo = -unpacked(rays[i].direction);
    const double cosine = glm::dot(exact[i], wo);
    // Every component to 1.5 ulp of itself, the scaling one and normalising three more.
    const double off = std::min(glm::length(n - exact[i]), glm::length(n + exact[i])) / unit_roundoff;
    EXPECT_LE(off, 10) << i;
    keep_worst(worst, off);
    if (std::abs(cosine) < 1e-5) continue;
    EXPECT_EQ(results[i].front != 0, cosine > 0);
    EXPECT_GT(glm::dot(n, wo), 0.0);
  }
  record_extreme("X14", worst, 10);
}

// Slivers whose float32 edges are parallel, or whose cross product underflows, have no normal on the device: they must not get there.
TEST(surface_test, every_triangle_that_a_scene_keeps_has_a_unit_normal) {
  Random random(5);
  Mesh mesh;
  for (std::size_t i = 0; i < count_or_small(20000, 40); ++i) {
    const double thin = random.log_between(1e-9, 1e-3), length = i % 3 ? random.log_between(1e-3, 1.0) : random.log_between(1e-25, 1e-12);
    const glm::dvec3 x = random.direction(), y = random.direction(), at = i % 3 ? random.in_cube(0.9) : glm::dvec3(0.0);
    add_triangle(mesh, at, at + length * x, at + length * (0.4 * x + thin * y));
    add_triangle(mesh, at, at + length * x, at + length * (-2.0 * x + thin * y));
  }
  const std::size_t all = mesh.triangles.size();
  add_triangle(mesh, {-1, -1, -1}, {1, 1, 1}, {1, -1, 1});  // symmetric: the frame's centre is 0
  const Scene scene = place_scene(world_of(mesh));
  EXPECT_EQ(scene.triangles.size() + scene.degenerate_primitives, all + 1);
  EXPECT_GT(scene.triangles.size(), all / 3);
  const Bvh bvh = build_bvh(scene, 8);
  const std::vector<uint> slot = slots(scene, bvh);
  std::vector<Hit> hits;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    hits.push_back({1.0f, 0.3f, 0.3f, static_cast<uint>(i), slot[i]});
    rays.push_back({{0, 0, 0}, 1e30f, packed(random.direction()), NONE, NONE, 0.0f, 0});
  }
  std::size_t wrong = 0;
  for (const Result& s : surfaces(scene, bvh, rays, hits)) wrong += !(std::abs(glm::length(unpacked(s.geometric)) - 1.0) < 4 * unit_roundoff);
  EXPECT_EQ(wrong, 0u) << "of " << hits.size();
  record_law("X14");
}

TEST(surface_test, points_of_quadrics_lie_within_their_error_and_normals_point_outwards_unless_flipped) {
  Random random(4);
  World world;
  for (int i = 0; i < 300; ++i) {
    WorldShape& shape = add_shape(world, diffuse(0.5), Sides::both);
    shape.geometry = i % 3 == 0 ? Geometry::sphere : i % 3 == 1 ? Geometry::disk : Geometry::cylinder;
    shape.flip_normals = i % 2;
    const glm::dvec3 z = random.direction(), x = glm::normalize(glm::cross(random.direction(), z)), y = glm::cross(z, x);
    const double r = random.log_between(1e-3, 1.0), h = i % 3 == 2 ? random.between(0.5, 2.0) : 1.0;
    shape.to_world = glm::dmat4(glm::dvec4(r * x, 0), glm::dvec4(r * y, 0), glm::dvec4(r * h * z, 0), glm::dvec4(random.in_cube(1.0), 1));
  }
  const Scene scene = place_scene(world);
  const Bvh bvh = build_bvh(scene, 8);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count_or_small(200000, 20); ++i) {
    const glm::dvec3 o = random.in_cube(1.0);
    rays.push_back(ray_towards(o, o + random.direction()));
  }
  const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
  std::vector<Ray> hit_rays;
  std::vector<Hit> found;
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].primitive != NONE) found.push_back(hits[i]), hit_rays.push_back(rays[i]);
  EXPECT_GT(found.size(), rays.size() / 4);
  const std::vector<Result> results = surfaces(scene, bvh, hit_rays, found);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Quadric& q = scene.quadrics[found[i].primitive & ~QUADRIC_BIT];
    const glm::dvec3 d = unpacked(results[i].position) - unpacked(q.center), x = unpacked(q.axis_x), y = unpacked(q.axis_y), z = unpacked(q.axis_z);
    const glm::dvec3 local(glm::dot(x, d), glm::dot(y, d), glm::dot(z, d));
    const double radius = 1.0 / glm::length(q.kind == QUADRIC_DISK ? z : x);  // local length 1, across the surface
    const double off = radius * (q.kind == QUADRIC_SPHERE ? glm::length(local) - 1 : q.kind == QUADRIC_DISK ? local.z : glm::length(glm::dvec2(local)) - 1);
    const glm::dvec3 n = unpacked(results[i].geometric);
    EXPECT_LE(std::abs(off), glm::dot(glm::abs(n), unpacked(results[i].error))) << q.kind << " " << i;
    // Projected, it is off by rounding alone: sixteen of the quadric's own size, two of the coordinates.
    EXPECT_LE(std::abs(off), unit_roundoff * (16 * glm::length(d) + 2 * glm::length(unpacked(results[i].position)))) << q.kind << " " << i;
    // Along the surface it is where the ray is: at grazing angles the parameter is coarse.
    const glm::dvec3 wo = -unpacked(hit_rays[i].direction);
    EXPECT_GE(glm::dot(n, wo), 0.0);
    const glm::dvec3 outwards = q.kind == QUADRIC_DISK ? z : q.kind == QUADRIC_SPHERE ? d : d - z * (glm::dot(z, d) / glm::dot(z, z));
    const glm::dvec3 front = glm::normalize(outwards) * static_cast<double>(q.flip);
    EXPECT_LE(glm::length(n - (results[i].front ? front : -front)), 1e-4) << q.kind;  // radii of 1e-3: positions to 1e-7
    EXPECT_EQ(results[i].shape, q.shape);
    const glm::dvec3 on_ray = unpacked(hit_rays[i].origin) + static_cast<double>(found[i].t) * unpacked(hit_rays[i].direction);
    EXPECT_LE(glm::length(on_ray - unpacked(results[i].position)), 1e-5 / std::max(glm::dot(n, wo), 1e-2));
  }
}
