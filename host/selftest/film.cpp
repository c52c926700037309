#include <cstring>
#include <limits>

#include "film_oracle.h"
#include "groups.h"

namespace oclair::selftest {
namespace {

constexpr std::size_t pixels = 100, per_pixel = 8 * REPLICA_SAMPLES;

// One in twenty is any float at all; the others are where the sums resolve them.
float sample_value(Random& random, int exponent) {
  if (random.below(20) != 0) return std::ldexp(1.0f + random.unit24(), exponent - 60 + static_cast<int>(random.below(100)));
  const auto bits = static_cast<cl_uint>(random.engine());
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

// Rejected: what is not finite, negative or too large.
void add_bad(std::vector<packed_float3>& samples, Random& random) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {nan, -nan, inf, -inf, -1.0f, 3e38f}) {
    packed_float3& sample = samples[random.below(static_cast<std::uint32_t>(samples.size()))];
    const uint channel = random.below(3);
    (channel == 0 ? sample.x : channel == 1 ? sample.y : sample.z) = bad;
  }
}

struct Film {
  std::vector<FilmPixel> pixels;
  std::vector<FilmMoments> moments;
  std::vector<FilmErrors> errors;
};

bool right(const FilmPixel& pixel, const FilmMoments& moments, const FilmErrors& errors, const packed_float3* samples,
           int exponent) {
  const Sums all = expected_sums(samples, per_pixel, exponent);
  if (pixel.rejected != all.rejected || pixel.hits != all.hits) return false;
  std::array<Wide, 3> square{};
  for (std::size_t first = 0; first < per_pixel; first += REPLICA_SAMPLES) {
    const Sums replica = expected_sums(samples + first, REPLICA_SAMPLES, exponent);
    for (std::size_t c = 0; c < 3; ++c) square[c] = plus(square[c], rounded_square(narrow(replica.sum[c])));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t limb = 0; limb < 2; ++limb)
      if (pixel.sum[c][limb] != all.sum[c][limb] || errors.sum[c][limb] != all.sum[c][limb]) return false;
    for (std::size_t limb = 0; limb < 3; ++limb) {
      if (errors.square[c][limb] != square[c][limb]) return false;
      for (std::size_t other = 0; other < 3; ++other)
        if (moments.product[MOMENT_INDEX(c, other)][limb] != all.product[c][other][limb]) return false;
    }
  }
  return true;
}

template <class T>
bool untouched(const T& value, int byte) {
  T pattern;
  std::memset(static_cast<void*>(&pattern), byte, sizeof pattern);
  return std::memcmp(&value, &pattern, sizeof pattern) == 0;
}

}  // namespace

// The sums of samples, of their products and of the squares of replicas are the integers that the same samples have on the
// host; every other pixel is nobody's, and stays as it was.
void check_film(const Session& session, Group& group) {
  Random random(5);
  std::size_t wrong = 0, touched = 0, rejected = 0;
  const int exponents[] = {0, -40, 60};
  for (const int exponent : exponents) {
    std::vector<packed_float3> samples(pixels * per_pixel);
    for (packed_float3& s : samples)
      s.x = sample_value(random, exponent), s.y = sample_value(random, exponent), s.z = sample_value(random, exponent);
    add_bad(samples, random);
    Film film{std::vector<FilmPixel>(2 * pixels), std::vector<FilmMoments>(2 * pixels), std::vector<FilmErrors>(2 * pixels)};
    for (std::size_t i = 1; i < 2 * pixels; i += 2) {
      std::memset(&film.pixels[i], 0x11, sizeof(FilmPixel));
      std::memset(&film.moments[i], 0x22, sizeof(FilmMoments));
      std::memset(&film.errors[i], 0x33, sizeof(FilmErrors));
    }
    run(session, "film_samples", pixels, samples, static_cast<cl_uint>(per_pixel), static_cast<cl_int>(exponent),
        out(film.pixels), out(film.moments), out(film.errors));
    for (std::size_t i = 0; i < pixels; ++i) {
      const FilmPixel& pixel = film.pixels[2 * i];
      wrong += !right(pixel, film.moments[2 * i], film.errors[2 * i], &samples[i * per_pixel], exponent);
      rejected += pixel.rejected;
      touched += !untouched(film.pixels[2 * i + 1], 0x11) || !untouched(film.moments[2 * i + 1], 0x22) ||
                 !untouched(film.errors[2 * i + 1], 0x33);
    }
  }
  group.measure("samples", static_cast<double>(std::size(exponents) * pixels * per_pixel));
  group.measure("rejected", static_cast<double>(rejected));
  group.bound("sums wrong", static_cast<double>(wrong), 0);
  group.bound("neighbours touched", static_cast<double>(touched), 0);
}

}  // namespace oclair::selftest
