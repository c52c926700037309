#include "extremes.h"
#include "inputs.h"
#include "kernel.h"

using namespace oclair::test;

namespace {

constexpr const char* file = "warp_test.cl";
constexpr double pi = 3.14159265358979323846;

// Extreme X21: every pair of 0, the smallest, the middle and the largest random number, and their neighbours; then random ones.
std::vector<cl_float2> squares() {
  std::vector<cl_float2> list;
  const std::vector<float> edges{0.0f, 0x1p-24f, 0x1p-23f, 0.25f, 0.5f - 0x1p-24f,
                                 0.5f, 0.5f + 0x1p-24f, 0.75f, 1 - 0x1p-23f, 1 - 0x1p-24f};
  for (float x : edges)
    for (float y : edges) list.push_back({{x, y}});
  Random random(40);
  const auto draw = [&] { return static_cast<float>(random.engine() >> 40) * 0x1p-24f; };
  for (std::size_t i = 0; i < count_or_small(500000, 200); ++i) {
    const float x = draw(), y = draw();
    list.push_back({{x, y}});
  }
  return list;
}

template <class Result, class... Arguments>
std::vector<Result> warped(const char* kernel, const Arguments&... arguments) {
  const auto u = squares();
  std::vector<Result> result(u.size());
  run(file, kernel, u.size(), u, arguments..., out(result));
  return result;
}

double length(const cl_float4& v) { return std::hypot(v.s[0], v.s[1], v.s[2]); }

// 1 - cos, from the sine: the cosine itself is 1 in float for cones below 3e-4 rad.
double one_minus_cosine(const cl_float4& v) {
  const double s2 = static_cast<double>(v.s[0]) * v.s[0] + static_cast<double>(v.s[1]) * v.s[1];
  const double below = 1 + std::copysign(std::sqrt(std::max(0.0, 1 - s2)), v.s[2]);
  return v.s[2] > 0 ? s2 / below : 1 - static_cast<double>(v.s[2]);
}

const std::vector<float> cone_sizes{1e-30f, 1e-10f, 1e-6f, 0.01f, 0.5f, 1.0f, 1.5f, 2.0f};

}  // namespace

// Every number that the generator gives, and 1.
TEST(warp_test, circle_is_cosine_and_sine_to_2e_7) {
  const std::size_t count = count_or_small(std::size_t{1} << 24, 1024), step = (std::size_t{1} << 24) / count;
  std::vector<float> u(count + 1);
  for (std::size_t i = 0; i <= count; ++i) u[i] = static_cast<float>(i * step) * 0x1p-24f;
  std::vector<cl_float2> result(u.size());
  run(file, "circle", u.size(), u, out(result));
  double worst = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double angle = 2 * pi * u[i];
    worst = std::max({worst, std::abs(result[i].s[0] - std::cos(angle)), std::abs(result[i].s[1] - std::sin(angle))});
  }
  EXPECT_LE(worst, 2e-7);
}

// The radius sqrt(u) and the circle's own error of 2e-7.
TEST(warp_test, disk_points_lie_in_the_unit_disk) {
  for (const cl_float2& p : warped<cl_float2>("disk")) ASSERT_LE(std::hypot(p.s[0], p.s[1]), 1 + 3e-7);
}

TEST(warp_test, hemisphere_directions_are_unit_vectors) {
  for (const cl_float4& d : warped<cl_float4>("cosine_hemisphere")) ASSERT_NEAR(length(d), 1, 3e-7);
}

// Extreme X21: z == 0 would give density 0 and a weight of 0/0.
TEST(warp_test, hemisphere_directions_never_lie_in_the_surface) {
  for (const cl_float4& d : warped<cl_float4>("cosine_hemisphere")) ASSERT_GE(d.s[2], 0x1p-13f);  // smallest: sqrt(2^-24) = 2^-12
  record_law("X21");
}

// That z has its digits although sqrt(1 - x^2 - y^2) has none near the rim: z^2 is uniform, so sorted by z the k-th of n numbers
// on the grid u = k / n has z^2 = (k + 1/2) / n to half a step. Along u.x or u.y, whichever is the radius.
TEST(warp_test, hemisphere_cosine_is_the_root_of_a_uniform_number) {
  const std::size_t n = count_or_small(4096, 256);
  std::vector<cl_float2> along_x(n), along_y(n);
  for (std::size_t k = 0; k < n; ++k) {
    const float u = (static_cast<float>(k) + 0.5f) / static_cast<float>(n);
    along_x[k] = {{u, 0.3f}}, along_y[k] = {{0.3f, u}};
  }
  std::vector<cl_float4> x(n), y(n);
  run(file, "cosine_hemisphere", n, along_x, out(x));
  run(file, "cosine_hemisphere", n, along_y, out(y));
  std::vector<double> squared;
  for (const cl_float4& d : x[0].s[2] == x[n / 2].s[2] ? y : x) squared.push_back(static_cast<double>(d.s[2]) * d.s[2]);
  std::sort(squared.begin(), squared.end());
  double worst = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double expected = (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    const double off = std::abs(squared[k] / expected - 1) / unit_roundoff;
    ASSERT_LE(off, 4) << k;
    worst = std::max(worst, off);
  }
  record_extreme("X21", worst, 4);
}

TEST(warp_test, sphere_directions_are_unit_vectors) {
  for (const cl_float4& d : warped<cl_float4>("sphere")) ASSERT_NEAR(length(d), 1, 3e-7);
}

TEST(warp_test, cone_directions_are_unit_vectors) {
  for (float size : cone_sizes)
    for (const cl_float4& d : warped<cl_float4>("cone", size)) ASSERT_NEAR(length(d), 1, 3e-7) << size;
}

// Above 1e-30: as far as the sine can be told from 0; 8u for the roundings of sine and size, 4u where the cosine is subtracted.
TEST(warp_test, cone_directions_lie_in_the_cone_and_reach_its_rim) {
  for (float size : cone_sizes) {
    double largest = 0;
    for (const cl_float4& d : warped<cl_float4>("cone", size)) largest = std::max(largest, one_minus_cosine(d));
    EXPECT_LE(largest, size * (1 + 8 * unit_roundoff) + (size > 0.4 ? 4 * unit_roundoff : 0)) << size;
    EXPECT_GE(largest, size * (1 - 0x1p-18)) << size;
  }
}

TEST(warp_test, triangle_points_lie_in_the_triangle) {
  const std::vector<cl_float2> u = squares(), b = warped<cl_float2>("triangle");
  for (std::size_t i = 0; i < b.size(); ++i) {
    ASSERT_TRUE(b[i].s[0] >= 0 && b[i].s[1] >= 0) << u[i].s[0] << " " << u[i].s[1];
    ASSERT_LE(static_cast<double>(b[i].s[0]) + b[i].s[1], 1 + unit_roundoff) << u[i].s[0] << " " << u[i].s[1];
  }
}

// One constant and two operations: 3u. The cone's density is 1 over its solid angle, 2 pi (1 - cos).
TEST(warp_test, densities_are_one_over_the_measure) {
  const std::vector<float> argument{0x1p-12f, 1e-6f, 0.1f, 0.25f, 0.5f, 0.999f, 1.0f, 1e-30f};
  std::vector<cl_float4> result(argument.size());
  run(file, "densities", argument.size(), argument, out(result));
  for (std::size_t i = 0; i < argument.size(); ++i) {
    const std::array<double, 4> expected{argument[i] / pi, 1 / (2 * pi * argument[i]), 1 / pi, 1 / (4 * pi)};
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(result[i].s[k], expected[k], 3 * unit_roundoff * expected[k]) << k << " " << argument[i];
  }
}

// Fractions of the area: a point of the square at u and its neighbours u + h make a cell whose image has the area that the
// density says. (Signed determinants of either orientation; cells away from the square's edges, folds and poles.)
TEST(warp_test, warps_keep_area_point_by_point) {
  Random random(41);
  const std::size_t cells = count_or_small(2000, 60);
  constexpr float h = 0x1p-10f;
  std::vector<cl_float2> u;
  for (std::size_t i = 0; i < cells; ++i) {
    const float x = static_cast<float>(random.between(0.02, 0.97)), y = static_cast<float>(random.between(0.02, 0.97));
    u.insert(u.end(), {{{x - h, y}}, {{x + h, y}}, {{x, y - h}}, {{x, y + h}}});
  }
  const auto determinants = [&](const auto& p) {
    std::vector<double> result;
    for (std::size_t i = 0; i < 4 * cells; i += 4) {
      const double ax = p[i + 1].s[0] - p[i].s[0], ay = p[i + 1].s[1] - p[i].s[1];
      const double bx = p[i + 3].s[0] - p[i + 2].s[0], by = p[i + 3].s[1] - p[i + 2].s[1];
      result.push_back(std::abs(ax * by - ay * bx) / (4.0 * h * h));
    }
    std::sort(result.begin(), result.end());
    return result;
  };
  std::vector<cl_float2> disk(u.size()), triangle(u.size());
  std::vector<cl_float4> hemisphere(u.size());
  run(file, "disk", u.size(), u, out(disk));
  run(file, "triangle", u.size(), u, out(triangle));
  run(file, "cosine_hemisphere", u.size(), u, out(hemisphere));
  // Disk: area pi. The hemisphere's projection is the same disk. The triangle of barycentrics has area 1/2.
  // Central differences err by h^2 / 6 of third derivatives (1e-4 at 0.02 from a square root's zero); folds get 5 % of the cells.
  for (const auto& [values, area] : {std::pair(determinants(disk), pi), std::pair(determinants(hemisphere), pi),
                                     std::pair(determinants(triangle), 0.5)}) {
    EXPECT_NEAR(values[cells / 20], area, 2e-3 * area);
    EXPECT_NEAR(values[cells - 1 - cells / 20], area, 2e-3 * area);
  }
}
