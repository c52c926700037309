// traverse_closest and traverse_any against brute force and Embree; ties, skip, target, the ends of the interval.
#include "embree_oracle.h"
#include "extremes.h"

using namespace oclair;
using namespace oclair::test;

namespace {

std::vector<Corners> soup(Random& random, std::size_t count, double size) {
  std::vector<Corners> triangles(count);
  for (Corners& corners : triangles) {
    const glm::dvec3 center = random.in_cube(1.0 - size);
    for (packed_float3& v : corners) v = packed(center + random.in_cube(size));
  }
  return triangles;
}

std::vector<Ray> random_rays(Random& random, std::size_t count) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back(ray_towards(random.in_cube(), random.in_cube()));
  return rays;
}

}  // namespace

TEST(traverse_test, random_rays_through_a_soup_agree_with_brute_force_in_double) {
  Random random(1);
  const Scene scene = scene_of(soup(random, 300, 0.2));
  const std::vector<Ray> rays = random_rays(random, count_or_small(20000, 20));
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
    const std::vector<cl_uint> blocked = trace_any(scene, bvh, rays);
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(disagreement(scene, rays[i], hits[i]), "") << i;
      EXPECT_EQ(blocked[i] != 0, hits[i].primitive != NONE) << i;
      found += hits[i].primitive != NONE;
    }
    EXPECT_GT(found, rays.size() / 2);
    EXPECT_LT(found, rays.size());
  }
}

// Needles: rays that graze their edges are many, and what lies behind is far off.
TEST(traverse_test, random_rays_through_thin_sticks_agree_with_brute_force_in_double) {
  Random random(7);
  std::vector<Corners> sticks;
  while (sticks.size() < 1000) {
    const glm::dvec3 a = random.in_cube(0.9), along = 0.25 * random.direction();
    const glm::dvec3 across = 0.004 * glm::normalize(glm::cross(along, random.direction()));
    sticks.push_back({packed(a), packed(a + along), packed(a + across)});
    sticks.push_back({packed(a + across), packed(a + along), packed(a + along + across)});
  }
  const Scene scene = scene_of(sticks);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count_or_small(10000, 20); ++i) {
    const Corners& stick = sticks[random.below(sticks.size())];
    const double s = random.unit();
    const glm::dvec3 edge = glm::mix(unpacked(stick[0]), unpacked(stick[1]), s);
    rays.push_back(ray_towards(random.in_cube(), i % 2 ? edge + 1e-7 * random.in_cube() : random.in_cube()));
  }
  for (const int width : {4, 8}) {
    const std::vector<Hit> hits = trace_closest(scene, build_bvh(scene, width), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(disagreement(scene, rays[i], hits[i]), "") << i;
    EXPECT_LT(missed(hits), rays.size() * 9 / 10);
  }
}

// The slot names the block and the lane where the triangle lies; barycentric coordinates are its own.
TEST(traverse_test, slot_and_barycentric_coordinates_give_the_point_of_the_hit) {
  Random random(2);
  const Scene scene = scene_of(soup(random, 300, 0.2));
  const std::vector<Ray> rays = random_rays(random, count_or_small(5000, 20));
  const Bvh bvh = build_bvh(scene, 8);
  const auto* blocks = reinterpret_cast<const TriangleBlock<8>*>(bvh.blocks.data());
  const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    if (hit.primitive == NONE) continue;
    EXPECT_EQ(blocks[hit.slot / 8].primitive[hit.slot % 8], hit.primitive);
    const auto own = exact_intersection<double>(rays[i], corners_of(scene, hit.primitive));
    EXPECT_LE(std::abs(hit.b1 - own.b1), own.b_error) << i;
    EXPECT_LE(std::abs(hit.b2 - own.b2), own.b_error) << i;
  }
}

TEST(traverse_test, random_rays_in_a_closed_mesh_hit_what_embree_hits) {
  Random random(3);
  const Scene scene = place_scene(world_of(icosphere(5, 0.05, 7)));
  const Bvh bvh = build_bvh(scene, 8);
  const EmbreeScene embree(scene);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count_or_small(200000, 20); ++i) {
    const glm::dvec3 o = 0.4 * random.direction() * std::cbrt(random.unit());
    rays.push_back(ray_towards(o, o + random.direction()));
  }
  const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
  std::size_t other_triangle = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit theirs = embree.closest(rays[i]);
    ASSERT_NE(theirs.primitive, NONE);
    ASSERT_NE(hits[i].primitive, NONE);
    if (theirs.primitive == hits[i].primitive) {
      const auto own = exact_intersection<double>(rays[i], corners_of(scene, hits[i].primitive));
      EXPECT_NEAR(hits[i].t, own.t, own.t_error);
      EXPECT_NEAR(hits[i].t, theirs.t, 4 * own.t_error);  // Embree's own error is of the same order
    } else {
      ++other_triangle;
      EXPECT_EQ(disagreement(scene, rays[i], hits[i]), "") << i;  // across a shared edge: brute force decides
    }
  }
  EXPECT_LE(other_triangle, rays.size() / 1000);
}

// Extreme X15. A quad twice in one plane, cut along different diagonals in one copy, among other triangles in random order: on
// equal distance the smaller primitive id wins, in either tree.
TEST(traverse_test, of_coplanar_duplicates_the_smaller_primitive_id_is_hit_in_trees_of_either_width) {
  Random random(4);
  for (int round = 0; round < 3; ++round) {
    const Corners a{packed_float3{-0.5f, -0.5f, 0.25f}, {0.5f, -0.5f, 0.25f}, {0.5f, 0.5f, 0.25f}};
    const Corners b{packed_float3{-0.5f, -0.5f, 0.25f}, {0.5f, 0.5f, 0.25f}, {-0.5f, 0.5f, 0.25f}};
    std::vector<Corners> triangles;
    for (int copy = 0; copy < 40; ++copy) triangles.insert(triangles.end(), {a, b});
    for (const Corners& c : soup(random, 60, 0.02)) triangles.push_back(c);
    std::shuffle(triangles.begin(), triangles.end(), random.engine);
    const Scene scene = scene_of(triangles);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count_or_small(5000, 10); ++i) {
      const glm::dvec3 at(random.between(-0.5, 0.5), random.between(-0.5, 0.5), 0.25);
      rays.push_back(i % 2 ? ray_towards(at + glm::dvec3(0, 0, 0.3), at) : ray_towards({random.unit(), random.unit(), -0.9}, at));
    }
    const std::vector<Hit> four = trace_closest(scene, build_bvh(scene, 4), rays), eight = trace_closest(scene, build_bvh(scene, 8), rays);
    std::size_t duplicates = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(four[i].primitive, eight[i].primitive) << i;
      ASSERT_EQ(four[i].t, eight[i].t) << i;
      const uint winner = eight[i].primitive;
      if (winner == NONE) continue;
      const auto same = [&](const Corners& x) { return std::memcmp(&x, &triangles[winner], sizeof x) == 0; };
      const auto first = static_cast<uint>(std::find_if(triangles.begin(), triangles.end(), same) - triangles.begin());
      EXPECT_EQ(winner, first);
      duplicates += same(a) || same(b);
    }
    EXPECT_GT(duplicates, rays.size() / 2);
  }
  record_law("X15");
}


namespace {

// A stack of parallel squares at z = k / 16, primitives 2 k - 2 and 2 k - 1.
Scene layers() {
  std::vector<Corners> triangles;
  for (int k = 1; k < 12; ++k) {
    const float z = k / 16.0f;
    triangles.push_back({packed_float3{-0.5f, -0.5f, z}, {0.5f, -0.5f, z}, {0.5f, 0.5f, z}});
    triangles.push_back({packed_float3{-0.5f, -0.5f, z}, {0.5f, 0.5f, z}, {-0.5f, 0.5f, z}});
  }
  return scene_of(triangles);
}

Ray up(float t_max, uint skip = NONE, uint target = NONE) { return {{0.25f, 0.0f, 0.0f}, t_max, {0, 0, 1}, skip, target, 0.0f, 0}; }

}  // namespace

TEST(traverse_test, a_ray_never_hits_the_primitive_that_it_starts_on) {
  const Scene scene = layers();
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    const std::vector<Hit> hits = trace_closest(scene, bvh, {up(1.0f), up(1.0f, 0), up(1.0f, 1), up(1.0f, 2)});
    EXPECT_EQ(hits[0].primitive, 0u);
    EXPECT_EQ(hits[1].primitive, 2u);
    EXPECT_EQ(hits[1].t, 2 / 16.0f);
    EXPECT_EQ(hits[2].primitive, 0u);
    EXPECT_EQ(hits[3].primitive, 0u);
    EXPECT_EQ(trace_any(scene, bvh, {up(0.1f), up(0.1f, 0), up(0.15f, 0)}), (std::vector<cl_uint>{1, 0, 1}));
  }
}

TEST(traverse_test, the_target_does_not_shadow_itself_and_everything_else_does) {
  const Scene scene = layers();
  const Bvh bvh = build_bvh(scene, 8);
  // From the first layer to the second, and to the third.
  EXPECT_EQ(trace_any(scene, bvh, {up(0.13f, 0, 2), up(0.13f, 0, 4), up(0.13f, 0, NONE), up(0.19f, 0, 4)}), (std::vector<cl_uint>{0, 1, 1, 1}));
  // Nor does it stop a shadow ray that looks for what it passes through.
  EXPECT_EQ(trace_closest(scene, bvh, {up(1.0f, NONE, 0)})[0].primitive, 2u);
}

// types.h: 0 < t <= t_max (closest), 0 < t < t_max (any).
TEST(traverse_test, the_end_of_the_interval_belongs_to_closest_hits_and_not_to_shadow_rays) {
  const Scene scene = layers();
  const float end = 1 / 16.0f, before = std::nextafter(end, 0.0f), beyond = std::nextafter(end, 1.0f);
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    const std::vector<Hit> hits = trace_closest(scene, bvh, {up(before), up(end), up(beyond)});
    EXPECT_EQ(hits[0].primitive, NONE);
    EXPECT_EQ(hits[0].t, before);
    EXPECT_EQ(hits[1].primitive, 0u);
    EXPECT_EQ(hits[1].t, end);
    EXPECT_EQ(hits[2].primitive, 0u);
    EXPECT_EQ(trace_any(scene, bvh, {up(before), up(end), up(beyond), up(0.0f), up(-1.0f)}), (std::vector<cl_uint>{0, 0, 1, 0, 0}));
  }
}

// Each step asks for what lies behind the last one: together they are what brute force in double finds. Every triangle stands twice.
TEST(traverse_test, a_ray_that_goes_on_meets_each_triangle_on_its_way_once_in_order) {
  Random random(6);
  std::vector<Corners> triangles = soup(random, 100, 0.5);
  triangles.insert(triangles.end(), triangles.begin(), triangles.end());
  Scene scene = scene_of(triangles);
  scene.features |= FEATURE_OPACITY;
  const std::vector<Ray> start = random_rays(random, count_or_small(5000, 20));
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    std::vector<Ray> rays = start;
    std::vector<std::vector<uint>> met(rays.size());
    bool going = true;
    for (int step = 0; going && step < 200; ++step) {
      const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
      going = false;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].primitive == NONE) continue;
        going = true;
        ASSERT_GE(hits[i].t, rays[i].t_min) << i;
        ASSERT_TRUE(hits[i].t > rays[i].t_min || hits[i].primitive > rays[i].passed) << i;
        met[i].push_back(hits[i].primitive);
        rays[i].t_min = hits[i].t;
        rays[i].passed = hits[i].primitive;
      }
    }
    EXPECT_FALSE(going);
    std::size_t sum = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      sum += met[i].size();
      std::vector<std::size_t> times(triangles.size());
      for (const uint primitive : met[i]) ++times[primitive];
      for (std::size_t k = 0; k < triangles.size(); ++k) {
        const auto exact = exact_intersection<double>(start[i], triangles[k]);
        if (exact.certain_hit) EXPECT_EQ(times[k], 1u) << i << " " << k;
        else EXPECT_LE(times[k], exact.certain_miss ? 0u : 1u) << i << " " << k;
      }
    }
    EXPECT_GT(sum, 4 * rays.size());
  }
}

// A sphere, a cylinder and a disk have the centre of the ray's way in common: two roots each, or one.
TEST(traverse_test, a_ray_that_goes_on_meets_both_walls_of_a_quadric) {
  Scene scene;
  scene.features = FEATURE_SPHERES | FEATURE_DISKS | FEATURE_CYLINDERS | FEATURE_OPACITY;
  const auto quadric = [](uint kind, float inverse) {
    return Quadric{{0, 0, 0}, kind, {inverse, 0, 0}, 0, {0, inverse, 0}, 1.0f, {0, 0, inverse}, 1.0f};
  };
  scene.quadrics = {quadric(QUADRIC_SPHERE, 2.0f), quadric(QUADRIC_CYLINDER, 4.0f), quadric(QUADRIC_DISK, 1.0f), quadric(QUADRIC_SPHERE, 2.0f)};
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    std::vector<Ray> ray = {{{-0.9375f, 0, 0.125f}, 1e30f, {1, 0, 0}, NONE, NONE, 0.0f, 0}};
    std::vector<uint> met;
    for (int step = 0; step < 20; ++step) {
      const Hit hit = trace_closest(scene, bvh, ray)[0];
      if (hit.primitive == NONE) break;
      met.push_back(hit.primitive & ~QUADRIC_BIT);
      ray[0].t_min = hit.t;
      ray[0].passed = hit.primitive;
    }
    EXPECT_EQ(met, (std::vector<uint>{0, 3, 1, 1, 0, 3}));
  }
}

TEST(traverse_test, an_empty_scene_is_never_hit) {
  Scene scene;
  scene.features = FEATURE_TRIANGLES;
  Random random(5);
  const std::vector<Ray> rays = random_rays(random, count_or_small(1000, 10));
  for (const int width : {4, 8}) {
    const Bvh bvh = build_bvh(scene, width);
    EXPECT_EQ(missed(trace_closest(scene, bvh, rays)), rays.size());
  }
}

// From points of a sphere, to rounding: outwards nothing is hit, inwards the far wall. The rays carry the sphere as the primitive they start on.
TEST(traverse_test, a_ray_that_starts_on_a_sphere_leaves_it_outwards_and_crosses_it_inwards) {
  Random random(6);
  World world;
  WorldShape& ball = add_shape(world, diffuse(0.5), Sides::both);
  ball.geometry = Geometry::sphere;
  const Scene scene = place_scene(world);
  const glm::dvec3 center = unpacked(scene.quadrics[0].center);
  const double r = 1.0 / glm::length(unpacked(scene.quadrics[0].axis_x));
  std::vector<Ray> rays;
  std::vector<double> cosine;
  for (std::size_t i = 0; i < count_or_small(20000, 20); ++i) {
    const glm::dvec3 n = random.direction(), w = random.direction();
    rays.push_back({packed(center + r * n), 1e30f, packed(w), QUADRIC_BIT | 0u, NONE, 0.0f, 0});
    cosine.push_back(glm::dot(n, w));
  }
  const Bvh bvh = build_bvh(scene, 8);
  const std::vector<Hit> hits = trace_closest(scene, bvh, rays);
  const std::vector<cl_uint> blocked = trace_any(scene, bvh, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (std::abs(cosine[i]) < 1e-3) continue;  // both roots at 0, to rounding
    EXPECT_EQ(hits[i].primitive, cosine[i] > 0 ? NONE : QUADRIC_BIT) << cosine[i];
    EXPECT_EQ(blocked[i] != 0, cosine[i] < 0);
    if (cosine[i] < 0) {
      EXPECT_NEAR(hits[i].t, -2 * r * cosine[i], 32 * unit_roundoff / -cosine[i]);
    }
  }
}
