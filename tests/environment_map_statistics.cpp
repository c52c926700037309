// Sampling of environment maps: where the directions fall, and what the estimate of the light is in the mean.
#include "environment_maps.h"
#include "random.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Map {
  const char* name;
  std::shared_ptr<const Image> image;
};

std::vector<Map> maps() {
  return {{"noise", random_image(12, 7, 1)},
          {"sun", sun_image(16, 9, 5, 3, 1e5)},
          {"sun at the pole", sun_image(16, 9, 0, 8, 1e5)},
          {"gradient", float_image(10, 6, [](uint x, uint y) { return glm::dvec3(x * 0.1 + y); })},
          {"dark rows", float_image(8, 9, [](uint x, uint y) { return glm::dvec3(y < 4 || y > 6 ? 0.0 : 1.0 + x); })},
          {"constant", float_image(5, 4, [](uint, uint) { return glm::dvec3(1.0); })},
          {"one texel", float_image(1, 1, [](uint, uint) { return glm::dvec3(2.0); })}};
}

}  // namespace

// Four quarters of each cell, of equal solid angle, against the exact widths of the distribution. Directions within 2e-6 of an edge may
// be counted for the neighbour: fewer than 1e-4 of them, where one count more is expected than in a cell that is hardly chosen, none are.
TEST(environment_map_statistics, directions_follow_the_density) {
  for (const Map& map : maps()) {
    SCOPED_TRACE(map.name);
    const Image& image = *map.image;
    const Scene scene = map_scene(map.image);
    const uint columns = image.width, rows = std::max(image.height, 2u) - 1;
    const std::size_t n = count_or_small(1000000, 500);
    std::vector<double> counts(std::size_t{4} * rows * columns), expected(counts.size());
    std::vector<packed_float3> middles;
    for (uint y = 0; y < rows; ++y)
      for (uint x = 0; x < columns; ++x) middles.push_back(packed(map_direction(columns, image.height, x + 0.5, y + 0.5)));
    const auto pdf = map_density(scene, middles);
    double total = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) total += expected[i] = pdf[i / 4] * cell_solid_angle(columns, image.height, static_cast<uint>(i / 4 / columns));
    for (double& e : expected) e *= static_cast<double>(n) / total;
    std::size_t strays = 0;
    for (const packed_float3& d : map_samples(scene, random_bits(n, 3)).directions) {
      const MapPlace p = map_place(columns, image.height, unpacked(d));
      const uint x = std::min(static_cast<uint>(p.x), columns - 1), y = std::min(static_cast<uint>(p.y), rows - 1);
      const double pi = std::acos(-1.0), top = std::cos(pi * y / rows), bottom = std::cos(pi * (y + 1) / rows);
      const bool lower = (top - static_cast<double>(d.y)) / (top - bottom) >= 0.5, right = p.x - x >= 0.5L;
      const std::size_t bin = std::size_t{4} * (std::size_t{y} * columns + x) + 2 * lower + right;
      if (expected[bin] < 1e-3) ++strays;
      else counts[bin] += 1;
    }
    EXPECT_LE(strays, n / 10000);
    double left = 0, kept = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (expected[i] < 1e-3) expected[i] = 0.0;
      left += expected[i], kept += counts[i];
    }
    for (double& e : expected) e *= kept / left;
    EXPECT_GE(chi_square_test(counts, expected), false_alarm);
  }
}

// The mean of f / pdf is the integral of f: of the radiance, and of the radiance times a square of the
// height. Gauss-Legendre over every cell, in which the integrand is smooth.
TEST(environment_map_statistics, the_mean_of_radiance_over_density_is_the_integral_over_the_sphere) {
  for (const Map& map : maps()) {
    SCOPED_TRACE(map.name);
    const Image& image = *map.image;
    const Scene scene = map_scene(map.image);
    const uint rows = std::max(image.height, 2u) - 1;
    const MapSamples s = map_samples(scene, random_bits(count_or_small(1000000, 500), 4));
    const auto radiance = map_radiance(scene, s.directions);
    const double n = static_cast<double>(s.pdf.size());
    for (const bool squared : {false, true}) {
      const auto weight = [&](const glm::dvec3& d) { return squared ? d.y * d.y : 1.0; };
      double integral = 0, sum = 0, squares = 0;
      for (uint y = 0; y < rows; ++y)
        for (uint x = 0; x < image.width; ++x)
          integral += integrate_cell(image, x, y, 12, [&](const glm::dvec3& d, const glm::dvec3& rgb) { return weight(d) * rgb.x; });
      for (std::size_t i = 0; i < s.pdf.size(); ++i) {
        const double f = weight(unpacked(s.directions[i])) * radiance[i].x / s.pdf[i];
        sum += f;
        squares += f * f;
      }
      const double mean = sum / n, error = std::sqrt(std::max(0.0, squares / n - mean * mean) / n);
      EXPECT_NEAR(mean, integral, sidak_z * error + 64 * unit_roundoff * integral) << (mean - integral) / error;
    }
  }
}
