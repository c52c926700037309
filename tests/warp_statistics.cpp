// Each warp against the integral of its density over cells, in closed form; the kernels are those of warp_test.cl.
#include <functional>

#include "inputs.h"
#include "kernel.h"
#include "statistics.h"

using namespace oclair::test;

namespace {

constexpr double pi = 3.14159265358979323846;

// Where a sample falls, in two coordinates in [0, 1) whose joint density is uniform if the warp is right.
struct Cell {
  double x, y;
};

// NaN and what lies outside go to a cell in which nothing is expected.
template <class Result, class... Arguments>
double p_value(const char* kernel, std::uint64_t seed, const std::function<Cell(const Result&)>& place,
               const Arguments&... arguments) {
  Random random(seed);
  const std::size_t count = count_or_small(1000000, 4000), columns = 41, rows = 37;
  std::vector<cl_float2> u(count);
  for (cl_float2& point : u)
    for (float& component : point.s) component = static_cast<float>(random.engine() >> 40) * 0x1p-24f;
  std::vector<Result> result(count);
  run("warp_test.cl", kernel, count, u, arguments..., out(result));
  std::vector<double> observed(columns * rows + 1), expected(observed.size(), static_cast<double>(count) / (columns * rows));
  expected.back() = 0;
  for (const Result& sample : result) {
    const Cell cell = place(sample);
    const bool inside = cell.x >= 0 && cell.x < 1 && cell.y >= 0 && cell.y < 1;
    const auto index = [&] { return static_cast<std::size_t>(cell.x * columns) * rows + static_cast<std::size_t>(cell.y * rows); };
    ++observed[inside ? index() : columns * rows];
  }
  return chi_square_test(observed, expected);
}

// The azimuth as a fraction of the full turn.
double turn(double x, double y) {
  const double fraction = std::atan2(y, x) / (2 * pi);
  return fraction < 0 ? std::min(fraction + 1, 1 - 0x1p-53) : fraction;
}

// Values of [0, 1] that rounding may have put a few u beyond 1.
double closed(double fraction) { return fraction >= 1 && fraction < 1 + 1e-6 ? 1 - 0x1p-53 : fraction; }

}  // namespace

// Area: r^2 and the azimuth are uniform and independent.
TEST(warp_statistics, disk_is_uniform_in_area) {
  EXPECT_GT(p_value<cl_float2>("disk", 50, [](const cl_float2& p) {
    return Cell{closed(static_cast<double>(p.s[0]) * p.s[0] + static_cast<double>(p.s[1]) * p.s[1]), turn(p.s[0], p.s[1])};
  }), false_alarm);
}

// Density cos / pi: its integral down from the pole to cos is 1 - cos^2.
TEST(warp_statistics, cosine_hemisphere_has_density_cosine_over_pi) {
  EXPECT_GT(p_value<cl_float4>("cosine_hemisphere", 51, [](const cl_float4& d) {
    return Cell{d.s[2] <= 0 ? -1 : 1 - static_cast<double>(d.s[2]) * d.s[2], turn(d.s[0], d.s[1])};
  }), false_alarm);
}

// Archimedes: the height is uniform.
TEST(warp_statistics, sphere_is_uniform_in_solid_angle) {
  EXPECT_GT(p_value<cl_float4>("sphere", 52, [](const cl_float4& d) {
    return Cell{closed((static_cast<double>(d.s[2]) + 1) / 2), turn(d.s[0], d.s[1])};
  }), false_alarm);
}

// Below a hemisphere 1 - cos comes from the sine, which has its digits in the narrowest cones.
TEST(warp_statistics, cones_are_uniform_in_solid_angle) {
  for (float size : {1e-30f, 1e-10f, 1e-4f, 0.1f, 0.9f, 1.5f, 2.0f})
    EXPECT_GT(p_value<cl_float4>("cone", 53, [size](const cl_float4& d) {
      const double s2 = static_cast<double>(d.s[0]) * d.s[0] + static_cast<double>(d.s[1]) * d.s[1];
      const double height = size < 0.5f ? s2 / (1 + std::sqrt(1 - s2)) : 1 - static_cast<double>(d.s[2]);
      return Cell{closed(height / size), turn(d.s[0], d.s[1])};
    }, size), significance(7)) << size;
}

// Barycentrics (b1, b2) uniform over area: b1 + b2 has the distribution s^2, and b1 / (b1 + b2) is uniform given it.
TEST(warp_statistics, triangle_is_uniform_in_area) {
  EXPECT_GT(p_value<cl_float2>("triangle", 54, [](const cl_float2& b) {
    const double sum = static_cast<double>(b.s[0]) + b.s[1];
    return Cell{closed(sum * sum), sum > 0 ? std::min(b.s[0] / sum, 1 - 0x1p-53) : 0};
  }), false_alarm);
}
