// triangle_block_intersect against long double on the same floats.
#include <bit>

#include "extremes.h"
#include "triangle_oracle.h"

#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Case {
  Ray ray;
  Corners corners;
};

Ray ray_to(const packed_float3& origin, const glm::dvec3& target, float t_max = 1e30f) {
  return {origin, t_max, packed(glm::normalize(target - unpacked(origin))), NONE, NONE, 0.0f, 0};
}

struct Result {
  bool hit;
  float t, b1, b2;
};

// Each case once in each lane of a block, beside other cases.
template <int W>
std::vector<Result> intersect_lanes(const std::vector<Case>& cases, int shift) {
  const std::size_t n = cases.size();
  std::vector<TriangleBlock<W>> blocks(n);
  std::vector<Ray> rays(n);
  for (std::size_t i = 0; i < n; ++i) {
    rays[i] = cases[i].ray;
    for (int lane = 0; lane < W; ++lane) {
      const Corners& c = cases[(i + static_cast<std::size_t>((lane + W - shift) % W)) % n].corners;
      for (int v = 0; v < 3; ++v) {
        blocks[i].vertex[v][0][lane] = c[v].x;
        blocks[i].vertex[v][1][lane] = c[v].y;
        blocks[i].vertex[v][2][lane] = c[v].z;
      }
    }
  }
  std::vector<cl_uint> mask(n);
  std::vector<float> t(n * W), b1(n * W), b2(n * W);
  run_with({every_feature, W}, "triangle_test.cl", "intersect", n, blocks, rays, out(mask), out(t), out(b1), out(b2));
  std::vector<Result> results(n);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(mask[i] >> W, 0u);
    const std::size_t at = i * W + static_cast<std::size_t>(shift);
    results[i] = {(mask[i] >> shift & 1u) != 0, t[at], b1[at], b2[at]};
  }
  return results;
}

std::vector<Result> intersect(const std::vector<Case>& cases, int width, int shift) {
  return width == 4 ? intersect_lanes<4>(cases, shift) : intersect_lanes<8>(cases, shift);
}

template <int W>
std::vector<cl_uint> owners(const std::vector<TriangleBlock<W>>& blocks, const std::vector<Ray>& rays) {
  std::vector<cl_uint> mask(rays.size());
  run_with({every_feature, W}, "triangle_test.cl", "owners", rays.size(), blocks, rays, out(mask));
  return mask;
}

struct Tally {
  std::size_t hits = 0, misses = 0, unsure = 0;
};

// Judges every case in which float32 has no excuse; counts the others.
Tally judge(const std::vector<Case>& cases, const std::vector<Result>& results) {
  Tally tally;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto exact = exact_intersection<long double>(cases[i].ray, cases[i].corners);
    const Result& r = results[i];
    const long double t_max = cases[i].ray.t_max;
    const bool must_miss = exact.certain_miss || (exact.t > t_max + exact.t_error);
    const bool must_hit = exact.certain_hit && exact.t < t_max - exact.t_error;
    tally.hits += must_hit;
    tally.misses += must_miss;
    tally.unsure += !must_hit && !must_miss;
    EXPECT_FALSE(must_hit && !r.hit) << i;
    EXPECT_FALSE(must_miss && r.hit) << i;
    if (!r.hit) continue;
    EXPECT_TRUE(r.t > 0.0f && r.t <= cases[i].ray.t_max && std::isfinite(r.b1) && std::isfinite(r.b2)) << i;
    EXPECT_TRUE(r.b1 >= 0.0f && r.b2 >= 0.0f && r.b1 + r.b2 <= 1.0f + 4 * unit_roundoff) << i;
    if (!exact.certain_hit) continue;
    EXPECT_LE(std::abs(r.t - exact.t), exact.t_error) << i;
    EXPECT_LE(std::abs(r.b1 - exact.b1), exact.b_error) << i;
    EXPECT_LE(std::abs(r.b2 - exact.b2), exact.b_error) << i;
  }
  return tally;
}

Case random_case(Random& random) {
  const double size = random.log_between(1e-4, 1.0);
  const glm::dvec3 center = random.in_cube(1.0);
  Case c;
  std::array<glm::dvec3, 3> v;
  for (int i = 0; i < 3; ++i) {
    v[i] = glm::clamp(center + random.in_cube(size), -1.0, 1.0);
    c.corners[i] = packed(v[i]);
  }
  // Half of the rays are aimed inside the triangle, half just beside it; both orientations come of themselves.
  double b1 = random.between(-0.3, 1.0), b2 = random.between(-0.3, 1.0);
  c.ray = ray_to(packed(random.in_cube(1.0)), v[0] + b1 * (v[1] - v[0]) + b2 * (v[2] - v[0]));
  if (random.below(8) == 0) c.ray.t_max = static_cast<float>(random.between(0.0, 2.0));
  if (random.below(8) == 0) c.ray.direction = packed(-unpacked(c.ray.direction));
  return c;
}

const packed_float3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

}  // namespace

TEST(triangle_test, random_hits_misses_and_parameters_are_those_of_long_double_in_every_lane) {
  Random random(1);
  std::vector<Case> cases(count_or_small(200000, 50));
  for (Case& c : cases) c = random_case(random);
  for (const int width : {4, 8}) {
    for (int shift = 0; shift < (small_inputs() ? 1 : width); shift += 3) {
      const Tally tally = judge(cases, intersect(cases, width, shift));
      EXPECT_GT(tally.hits, cases.size() / 8);
      EXPECT_GT(tally.misses, cases.size() / 4);
      EXPECT_LT(tally.unsure, cases.size() / 20);  // or the test judges too little
    }
  }
}

TEST(triangle_test, rays_along_the_axes_with_zeros_of_either_sign_hit_as_in_long_double) {
  Random random(2);
  std::vector<Case> cases;
  for (std::size_t i = 0; i < count_or_small(20000, 20); ++i) {
    Case c = random_case(random);
    c.ray.direction = axes[random.below(6)];
    for (float* component : {&c.ray.direction.x, &c.ray.direction.y, &c.ray.direction.z})
      if (*component == 0.0f && random.below(2)) *component = -0.0f;
    // The origin is moved so that the axis passes through the triangle's neighbourhood.
    const glm::dvec3 inside = 0.3 * unpacked(c.corners[0]) + 0.4 * unpacked(c.corners[1]) + 0.3 * unpacked(c.corners[2]);
    c.ray.origin = packed(inside + 0.01 * random.in_cube() - random.between(0.01, 1.0) * unpacked(c.ray.direction));
    c.ray.t_max = 1e30f;
    cases.push_back(c);
  }
  for (const int width : {4, 8}) {
    const Tally tally = judge(cases, intersect(cases, width, 0));
    EXPECT_GT(tally.hits, cases.size() / 20);
    EXPECT_GT(tally.misses, cases.size() / 20);
  }
  record_law("X8");
}

TEST(triangle_test, turning_a_triangle_round_changes_neither_hit_nor_parameter) {
  Random random(3);
  std::vector<Case> cases(count_or_small(50000, 50)), turned;
  for (Case& c : cases) c = random_case(random);
  turned = cases;
  for (Case& c : turned) std::swap(c.corners[1], c.corners[2]);
  const std::vector<Result> a = intersect(cases, 8, 0), b = intersect(turned, 8, 0);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    ASSERT_EQ(a[i].hit, b[i].hit) << i;
    if (!a[i].hit) continue;
    // The three terms are added in another order: 2 roundings of numerator and denominator each.
    EXPECT_NEAR(a[i].t, b[i].t, 8 * unit_roundoff * 4.0);
    EXPECT_NEAR(a[i].b1, b[i].b2, 4 * unit_roundoff);
    EXPECT_NEAR(a[i].b2, b[i].b1, 4 * unit_roundoff);
  }
}

// A hit at exactly t_max counts, one ulp less does not; one at t = 0 never does.
TEST(triangle_test, the_interval_is_open_at_0_and_closed_at_t_max) {
  const Corners corners{packed_float3{-1, -1, 0.5f}, {1, -1, 0.5f}, {0, 1, 0.5f}};
  std::vector<Case> cases;
  for (const float t_max : {1e30f, 0.5f, std::nextafter(0.5f, 0.0f)}) cases.push_back({{{0, 0, 0}, t_max, {0, 0, 1}, NONE, NONE, 0.0f, 0}, corners});
  cases.push_back({{{0, 0, 0.5f}, 1e30f, {0, 0, 1}, NONE, NONE, 0.0f, 0}, corners});
  cases.push_back({{{0, 0, 0.5f}, 1e30f, {0, 0, -1}, NONE, NONE, 0.0f, 0}, corners});
  const std::vector<Result> r = intersect(cases, 8, 0);
  EXPECT_TRUE(r[0].hit);
  EXPECT_TRUE(r[1].hit);
  EXPECT_EQ(r[1].t, 0.5f);
  EXPECT_FALSE(r[2].hit);
  EXPECT_FALSE(r[3].hit);
  EXPECT_FALSE(r[4].hit);
}

// Every ray through an edge or a vertex of a flat grid hits, and what it hits has barycentric coordinates in [0, 1].
TEST(triangle_test, points_of_edges_and_vertices_count_as_inside) {
  const Corners corners{packed_float3{-0.5f, -0.5f, 0.5f}, {0.5f, -0.5f, 0.5f}, {-0.5f, 0.5f, 0.5f}};
  std::vector<Case> cases;
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; i + j <= 16; ++j)
      cases.push_back({{{-0.5f + i / 16.0f, -0.5f + j / 16.0f, -0.5f}, 1e30f, {0, 0, 1}, NONE, NONE, 0.0f, 0}, corners});
  for (const Result& r : intersect(cases, 8, 0)) {
    EXPECT_TRUE(r.hit);
    EXPECT_EQ(r.t, 1.0f);
  }
}

// Extreme X14. Zero extent, slivers down to one denormal, needles, and a triangle that has been hit falsely elsewhere
// (Pharr, Jakob, Humphreys, pbrt-v4, triangle tests, brought to [-1, 1]^3 by 2^-11).
TEST(triangle_test, degenerate_primitives_give_no_nan_and_no_certain_miss_is_hit) {
  std::vector<Corners> bad;
  const auto add = [&](packed_float3 a, packed_float3 b, packed_float3 c) {
    bad.push_back({a, b, c});
    bad.push_back({b, c, a});
    bad.push_back({c, b, a});
  };
  add({0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f});
  add({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  add({0.1f, 0.2f, 0.3f}, {0.5f, 0.6f, 0.7f}, {0.1f, 0.2f, 0.3f});
  add({-0.5f, -0.5f, -0.5f}, {0, 0, 0}, {0.5f, 0.5f, 0.5f});
  for (const float width : {1e-7f, 1e-12f, 1e-19f, 1e-23f, 1e-30f, 1e-38f, 1e-45f}) {
    add({0, 0, 0}, {0.5f, 0, 0}, {0.25f, width, 0});
    add({0, 0, 0}, {width, 0, 0}, {0, width, 0});
    add({0.5f, 0, 0}, {0.5f, width, 0}, {0.5f, 0, width});
  }
  add({-1113.45459f / 2048, -79.0496140f / 2048, -56.2431908f / 2048}, {-1113.45459f / 2048, -87.0922699f / 2048, -56.2431908f / 2048},
      {-1113.45459f / 2048, -79.0496140f / 2048, -56.2431908f / 2048});
  Random random(4);
  std::vector<Case> cases;
  for (const Corners& c : bad) {
    for (std::size_t i = 0; i < count_or_small(2000, 4); ++i) {
      const double b1 = random.unit(), b2 = random.between(0.0, 1.0 - b1);
      const glm::dvec3 at = unpacked(c[0]) + b1 * (unpacked(c[1]) - unpacked(c[0])) + b2 * (unpacked(c[2]) - unpacked(c[0]));
      Case aimed{ray_to(packed(random.in_cube(1.0)), at), c};
      if (i % 3 == 0) aimed.ray = ray_to(packed(random.in_cube(1.0)), at + 1e-3 * random.direction());
      if (i % 5 == 0) {
        aimed.ray.direction = axes[i / 5 % 6];
        aimed.ray.origin = packed(at - 0.5 * unpacked(aimed.ray.direction));
      }
      cases.push_back(aimed);
    }
    cases.push_back({{{-1081.47925f / 2048, 99.9999542f / 2048, 87.7701111f / 2048}, 0.9999f,
                      {-32.1072998f / 2048, -183.355865f / 2048, -144.607635f / 2048}, NONE, NONE, 0.0f, 0}, c});
  }
  for (const int width : {4, 8}) judge(cases, intersect(cases, width, width - 1));
  record_law("X14");
}

// The triangles around a vertex of a dyadic grid, of any winding, and rays along an axis through the vertex, through the middles of
// edges and through faces: all arithmetic is exact. Moving the ray by 2^-10 and 2^-20 tells whose hit it is.
TEST(triangle_test, of_the_triangles_around_an_edge_or_a_vertex_one_owns_the_hit) {
  Random random(8);
  std::vector<TriangleBlock<8>> blocks;
  std::vector<Ray> rays;
  std::vector<cl_uint> expected;
  const int around[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  for (std::size_t i = 0; i < count_or_small(3000, 30); ++i) {
    const int kz = static_cast<int>(random.below(3)), kx = (kz + 1) % 3, ky = (kx + 1) % 3;
    const bool inner = random.below(2) != 0;
    // The vertex in the middle, a quarter of the way to a neighbour, or inside a triangle.
    const int* a = around[random.below(8)];
    const double at[2] = {inner ? 0.25 * a[0] : 0.0, inner ? 0.25 * a[1] + (random.below(2) ? 0.125 : 0.0) : 0.0};
    glm::dvec3 origin(0.0), direction(0.0);
    origin[kx] = at[0];
    origin[ky] = at[1];
    origin[kz] = -2.0;
    direction[kz] = 1.0;
    rays.push_back({packed(origin), 1e30f, packed(direction), NONE, NONE, 0.0f, 0});
    TriangleBlock<8>& block = blocks.emplace_back();
    const double moved[2] = {at[0] + 0x1p-10, at[1] - 0x1p-20};
    cl_uint owner = 0;
    for (int lane = 0; lane < 8; ++lane) {
      const int* next = around[(lane + 1) % 8];
      double plane[3][2] = {{0, 0}, {1.0 * around[lane][0], 1.0 * around[lane][1]}, {1.0 * next[0], 1.0 * next[1]}};
      if (random.below(2)) std::swap(plane[1], plane[2]);
      if (random.below(2)) std::swap(plane[0], plane[1]);
      int sides = 0;
      for (int e = 0; e < 3; ++e) {
        const double *p = plane[e], *q = plane[(e + 1) % 3];
        const double side = (q[0] - p[0]) * (moved[1] - p[1]) - (q[1] - p[1]) * (moved[0] - p[0]);
        sides += side > 0 ? 1 : -1;
      }
      if (std::abs(sides) == 3) owner |= 1u << lane;
      for (int v = 0; v < 3; ++v) {
        block.vertex[v][kx][lane] = static_cast<float>(plane[v][0]);
        block.vertex[v][ky][lane] = static_cast<float>(plane[v][1]);
        block.vertex[v][kz][lane] = static_cast<float>(random.below(8)) / 8.0f;
      }
    }
    ASSERT_EQ(std::popcount(owner), 1);
    expected.push_back(owner);
  }
  EXPECT_EQ(owners<8>(blocks, rays), expected);
}
