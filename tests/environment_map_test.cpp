// The lookup and the density of environment maps against long double on the same texels, and against values measured in Mitsuba.
#include "environment_maps.h"
#include "random.h"

using namespace oclair;
using namespace oclair::test;

namespace {

const double pi = std::acos(-1.0);

struct Size {
  uint width, height;
};
const std::vector<Size> sizes = {{1, 1}, {2, 1}, {1, 2}, {1, 3}, {2, 2}, {4, 3}, {7, 5}, {64, 33}, {1024, 512}};

// Axes, poles and the seam, then random ones. (At a pole the longitude hangs on the signs of zeros.)
std::vector<packed_float3> directions(std::size_t n, std::uint64_t seed) {
  std::vector<packed_float3> d = {{0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {-0.0f, 0, -1}, {-0.0f, 0, 1}, {1e-30f, 0, -1},
                                  {-1e-30f, 0, -1}, {1e-8f, 0, -1}, {-1e-8f, 0, -1}, {1e-4f, 1, 2e-4f}, {1e-4f, -1, -1e-4f}, {0.6f, -0.8f, -1e-9f}};
  Random random(seed);
  while (d.size() < n) d.push_back(packed(random.direction()));
  return d;
}

std::shared_ptr<const Image> striped(uint width, uint height) {
  return float_image(width, height, [](uint x, uint y) { return glm::dvec3(x + 4.0 * y + 1.0, x * x, y); });
}

}  // namespace

// The arc tangent errs by at most 6 ulp (OpenCL 1.2, 7.4), that is 12 u of pi; two more roundings: the place errs by 9 u of a turn across
// and 18 u of a half turn down, here with a margin of 2 roundings more of up to the size of the image. Across a place the value changes by
// at most the range of the texels per cell. Interpolation rounds 8 times.
TEST(environment_map_test, the_radiance_is_the_bilinear_interpolation_of_the_texels) {
  for (const Size size : sizes) {
    const auto image = random_image(size.width, size.height, 5);
    const Scene scene = map_scene(image, 3.0);
    const auto d = directions(count_or_small(20000, 64), 3);
    const auto values = map_radiance(scene, d);
    for (std::size_t i = 0; i < d.size(); ++i) {
      const glm::dvec3 exact = 3.0 * map_value(*image, map_place(size.width, size.height, unpacked(d[i])));
      const double move = 12 * unit_roundoff * size.width + 22 * unit_roundoff * size.height;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(unpacked(values[i])[c], exact[c], 30.0 * move + 10 * unit_roundoff * exact[c]) << size.width << "x" << size.height << " " << i;
    }
  }
}

// Mitsuba 3.9.1, scalar_rgb, to 7 digits; the rotated map also with a factor of 2.
TEST(environment_map_test, the_radiance_is_that_of_mitsuba) {
  const std::vector<packed_float3> d = {{.6f, .8f, 0}, {0, .6f, -.8f}, {-.48f, -.6f, .64f}, {.36f, -.48f, -.8f}, {0, 0, 1}, {.28f, -.96f, 0}};
  const glm::dvec3 plain[] = {{3.138662, 0.5, 0.4096655}, {4.861338, 4.5, 0.5903344}, {8.548327, 3.728995, 1.409666},
                              {6.967317, 2.077227, 1.318727}, {6.5, 2.5, 1.0}, {8.777325, 0.5, 1.819331}};
  const glm::dvec3 rotated[] = {{9.244143, 0.9767866, 1.566839}, {11.61046, 2.098708, 2.227722}, {13.35408, 10.1484, 1.731101},
                                {17.28058, 0.2895198, 3.747766}, {9.452862, 6.301634, 1.004746}, {17.66869, 7.130318, 2.989646}};
  // Rows of the matrix that Mitsuba made.
  const glm::dmat3 rotation = glm::transpose(glm::dmat3(0.7537691593170166, -0.3009178638458252, 0.584192156791687, 0.6128355860710144, 0.6427875757217407,
                                                        -0.4596266746520996, -0.23720161616802216, 0.7044661641120911, 0.6689265966415405));
  const auto a = map_radiance(map_scene(striped(4, 3)), d), b = map_radiance(map_scene(striped(4, 3), 2.0, rotation), d);
  for (std::size_t i = 0; i < d.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(unpacked(a[i])[c], plain[i][c], 2e-6 * std::max(1.0, plain[i][c])) << i;
      EXPECT_NEAR(unpacked(b[i])[c], rotated[i][c], 4e-6 * std::max(1.0, rotated[i][c])) << i;
    }
}

TEST(environment_map_test, texels_of_every_format_are_decoded) {
  Image eight{2, 3, 3, TEXEL_U8, true, {}}, gray{2, 3, 1, TEXEL_HALF, false, {}};
  for (int i = 0; i < 18; ++i) eight.texels.push_back(static_cast<std::byte>(14 * i));
  for (const unsigned bits : {0x3c00u, 0x4000u, 0x3800u, 0x0001u, 0x7bffu, 0x0000u}) {  // 1, 2, 1/2, 2^-24, 65504, 0
    gray.texels.push_back(static_cast<std::byte>(bits & 255));
    gray.texels.push_back(static_cast<std::byte>(bits >> 8));
  }
  const auto d = std::vector<packed_float3>{{1, 0, 0}, {-1, 0, 0}};  // the middles of the texels of row 1
  const auto color = map_radiance(map_scene(std::make_shared<const Image>(eight)), d), number = map_radiance(map_scene(std::make_shared<const Image>(gray)), d);
  const double decoded = std::pow((14 * 6 / 255.0 + 0.055) / 1.055, 2.4);
  EXPECT_NEAR(color[0].x, decoded, 1e-6);
  EXPECT_NEAR(color[1].z, std::pow((14 * 11 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_NEAR(number[0].x, 0.5, 2e-6);
  EXPECT_NEAR(number[0].z, 0.5, 2e-6);
  EXPECT_NEAR(number[1].y, 0x1p-24, 1e-6);
}

// The probability of a cell is its share of the integral of the luminance but for the unit of 2^-32 that each one has for sure, n in all
// of n; densities divide by the exact solid angle with some 16 roundings.
TEST(environment_map_test, the_density_is_the_share_of_the_cell_in_the_luminance_over_its_solid_angle) {
  for (const Size size : {Size{1, 1}, {2, 1}, {1, 3}, {4, 3}, {7, 5}, {16, 9}}) {
    const auto image = random_image(size.width, size.height, 6);
    const Scene scene = map_scene(image);
    const uint rows = std::max(size.height, 2u) - 1;
    std::vector<packed_float3> middles;
    std::vector<double> share;
    double total = 0;
    for (uint y = 0; y < rows; ++y)
      for (uint x = 0; x < size.width; ++x) {
        middles.push_back(packed(map_direction(size.width, size.height, x + 0.5, y + 0.5)));
        share.push_back(integrate_cell(*image, x, y, 12, [](const glm::dvec3&, const glm::dvec3& rgb) { return luminance_of(rgb); }));
        total += share.back();
      }
    const auto pdf = map_density(scene, middles);
    double sum = 0;
    for (std::size_t i = 0; i < pdf.size(); ++i) {
      const double angle = cell_solid_angle(size.width, size.height, static_cast<uint>(i) / size.width);
      sum += pdf[i] * angle;
      EXPECT_NEAR(pdf[i] * angle, share[i] / total, 16 * unit_roundoff * share[i] / total + 4e-9) << size.width << "x" << size.height << " " << i;
    }
    EXPECT_NEAR(sum, 1.0, 16 * unit_roundoff);
  }
}

// Every direction can be sampled, however dark: where BSDF sampling finds it, the weights need a density.
TEST(environment_map_test, the_density_is_positive_everywhere_and_integrates_to_one_over_dark_maps_too) {
  for (const auto& image : {sun_image(16, 9, 3, 4, 1e6), sun_image(16, 9, 15, 0, 1.0), sun_image(2, 2, 1, 1, 1e-6), sun_image(1, 1, 0, 0, 2.0)}) {
    const Scene scene = map_scene(image);
    const uint rows = std::max(image->height, 2u) - 1;
    std::vector<packed_float3> middles;
    for (uint y = 0; y < rows; ++y)
      for (uint x = 0; x < image->width; ++x) middles.push_back(packed(map_direction(image->width, image->height, x + 0.5, y + 0.5)));
    const auto pdf = map_density(scene, middles);
    double sum = 0;
    for (std::size_t i = 0; i < pdf.size(); ++i) {
      EXPECT_GT(pdf[i], 0.0f);
      sum += pdf[i] * cell_solid_angle(image->width, image->height, static_cast<uint>(i) / image->width);
    }
    EXPECT_NEAR(sum, 1.0, 16 * unit_roundoff);
  }
}

// The specification: the low half of the bits chooses the row and the height in it, linear in 1 - cos; the high half column and longitude.
// h = 1 - cos from the nearer pole has some 12 roundings (the sine may err by 4 ulp), so the direction errs by 16 u of its distance
// from the pole; the longitude by 4 u of a turn. The place in the cell has 4 roundings of up to 1, which move h by 4 u of the cell's
// height and the distance from the pole by that over itself: all of it in a map of one cell, nothing in one of many.
TEST(environment_map_test, a_sample_is_the_direction_that_the_bits_say_up_to_the_poles) {
  for (const Size size : {Size{1, 1}, {3, 2}, {7, 5}, {4096, 2049}}) {
    if (small_inputs() && size.width > 100) continue;
    const auto image = random_image(size.width, size.height, 7);
    const Scene scene = map_scene(image);
    const uint rows = std::max(size.height, 2u) - 1;
    std::vector<cl_ulong> bits = {0u, ~cl_ulong{0}, 0xffffffffull, 0xffffffff00000000ull};
    for (const cl_ulong b : random_bits(count_or_small(5000, 32), 4)) {
      bits.push_back(b);
      bits.push_back((b & 0xffffffff00000000ull) | (b & 0x0003ffffull));                   // the first rows
      bits.push_back((b & 0xffffffff00000000ull) | 0xfffc0000ull | (b & 0x0003ffffull));  // the last ones
    }
    const MapSamples s = map_samples(scene, bits);
    const auto begin_end = [](const uint* cdf, uint n, uint number, uint& i) {
      i = static_cast<uint>(std::upper_bound(cdf, cdf + n - 1, number) - cdf);
      const long double begin = i == 0 ? 0.0L : cdf[i - 1], end = i + 1 == n ? 0x1p32L : cdf[i];
      return std::pair((number - begin + 0.5L) / (end - begin), (end - begin) * 0x1p-32L);
    };
    for (std::size_t k = 0; k < bits.size(); ++k) {
      uint x, y;
      const auto [down, row_share] = begin_end(scene.environment_cdf.data(), rows, static_cast<uint>(bits[k]), y);
      const auto [across, share] = begin_end(scene.environment_cdf.data() + rows + std::size_t{y} * size.width, size.width, static_cast<uint>(bits[k] >> 32), x);
      const long double exact_pi = std::acos(-1.0L), top = std::cos(exact_pi * y / rows), bottom = std::cos(exact_pi * (y + 1) / rows);
      const long double cosine = top + down * (bottom - top), sine = std::sqrt((1 - cosine) * (1 + cosine)), phi = 2 * exact_pi * (x + 0.5L + across) / size.width;
      const glm::dvec3 exact(static_cast<double>(sine * std::sin(phi)), static_cast<double>(cosine), static_cast<double>(-sine * std::cos(phi)));
      // Long double itself knows the sine of the smallest rows to 1e-19 / sine.
      const double place = 4 * unit_roundoff * static_cast<double>(top - bottom);
      const double tolerance = (16 + 4 * 2 * pi) * unit_roundoff * static_cast<double>(sine) + std::min(place / static_cast<double>(sine), std::sqrt(2 * place)) + 1e-17;
      const glm::dvec3 d = unpacked(s.directions[k]);
      EXPECT_NEAR(d.x, exact.x, tolerance) << k;
      EXPECT_NEAR(d.y, exact.y, 8 * unit_roundoff + place) << k;
      EXPECT_NEAR(d.z, exact.z, tolerance) << k;
      EXPECT_NEAR(glm::length(d), 1.0, 4 * unit_roundoff);
      const double pdf = static_cast<double>(row_share * share) / cell_solid_angle(size.width, size.height, y);
      EXPECT_NEAR(s.pdf[k], pdf, 16 * unit_roundoff * pdf);
    }
  }
}

// Directions within the error of the lookup (see above) of an edge between cells may be taken for the neighbour's.
TEST(environment_map_test, the_density_of_a_sample_is_the_density_of_its_direction) {
  for (const Size size : sizes) {
    const auto image = random_image(size.width, size.height, 8);
    const Scene scene = map_scene(image);
    const MapSamples s = map_samples(scene, random_bits(count_or_small(50000, 64), 5));
    const auto pdf = map_density(scene, s.directions);
    std::size_t at_edges = 0;
    for (std::size_t i = 0; i < pdf.size(); ++i) {
      if (pdf[i] == s.pdf[i]) continue;
      const MapPlace p = map_place(size.width, size.height, unpacked(s.directions[i]));
      const double across = static_cast<double>(std::abs(p.x - std::round(p.x))), down = static_cast<double>(std::abs(p.y - std::round(p.y)));
      EXPECT_TRUE(across < 20 * unit_roundoff * size.width || down < 40 * unit_roundoff * size.height) << size.width << "x" << size.height << " " << i;
      ++at_edges;
    }
    EXPECT_LE(at_edges, pdf.size() / 100);
  }
}

// A quarter turn permutes the coordinates without rounding; a mirror too.
TEST(environment_map_test, a_rotated_map_is_the_map_seen_in_rotated_directions) {
  const auto image = random_image(16, 9, 9);
  const glm::dmat3 turn(glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)), flip(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
  for (const glm::dmat3& rotation : {turn, flip, turn * flip}) {
    const Scene plain = map_scene(image), rotated = map_scene(image, 1.0, rotation);
    const auto d = directions(count_or_small(1000, 32), 6);
    std::vector<packed_float3> to_image;
    for (const packed_float3& w : d) to_image.push_back(packed(glm::transpose(rotation) * unpacked(w)));
    const auto a = map_radiance(rotated, d), b = map_radiance(plain, to_image);
    const auto pdf_a = map_density(rotated, d), pdf_b = map_density(plain, to_image);
    const auto bits = random_bits(count_or_small(1000, 32), 7);
    const MapSamples x = map_samples(rotated, bits), y = map_samples(plain, bits);
    for (std::size_t i = 15; i < d.size(); ++i) {  // the first have zeros, whose signs a rotation changes
      EXPECT_EQ(a[i].x, b[i].x);
      EXPECT_EQ(pdf_a[i], pdf_b[i]);
    }
    for (std::size_t i = 0; i < bits.size(); ++i) {
      EXPECT_EQ(unpacked(x.directions[i]), rotation * unpacked(y.directions[i]));
      EXPECT_EQ(x.pdf[i], y.pdf[i]);
    }
  }
}
