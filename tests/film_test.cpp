// The film's exact sums against integer arithmetic on the host.
#include "../host/film.h"

#include <cstring>

#include "extremes.h"
#include "film_oracle.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

void expect_sums(const FilmPixel& pixel, const FilmMoments& moments, const Sums& s) {
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(s.sum[c][2], 0u);
    EXPECT_EQ(pixel.sum[c][0], s.sum[c][0]);
    EXPECT_EQ(pixel.sum[c][1], s.sum[c][1]);
    for (int other = 0; other < 3; ++other)
      for (int limb = 0; limb < 3; ++limb) EXPECT_EQ(moments.product[MOMENT_INDEX(c, other)][limb], s.product[c][other][limb]);
  }
  EXPECT_EQ(pixel.rejected, s.rejected);
  EXPECT_EQ(pixel.hits, s.hits);
}

struct Pixels {
  FilmVector<FilmPixel> pixels;
  FilmVector<FilmMoments> moments;
  explicit Pixels(std::size_t n) : pixels(n), moments(n) {}
};

void add(Pixels& film, const std::vector<cl_uint>& place, const std::vector<packed_float3>& samples, int exponent, cl_uint repeat = 1) {
  run("film_test.cl", "add", place.size(), place, samples, static_cast<cl_uint>(samples.size() / place.size()), repeat,
      static_cast<cl_int>(exponent), out(film.pixels), out(film.moments));
}

// As many samples for each pixel, in their order from number `first` on.
void add_in_replicas(FilmVector<FilmPixel>& film, FilmVector<FilmErrors>& errors, const std::vector<packed_float3>& samples,
                     cl_ulong first, int exponent) {
  run_with({every_feature & ~FEATURE_MOMENTS}, "film_test.cl", "add_in_replicas", film.size(), samples,
           static_cast<cl_uint>(samples.size() / film.size()), first, static_cast<cl_int>(exponent), out(film), out(errors));
}

std::vector<cl_uint> all_places(std::size_t n) {
  std::vector<cl_uint> place(n);
  for (std::size_t i = 0; i < n; ++i) place[i] = static_cast<cl_uint>(i);
  return place;
}

// A positive float of any exponent, denormals included, that the film accepts.
float any_float(Random& random, int exponent) {
  while (true) {
    const auto bits = static_cast<cl_uint>(random.engine() & 0x7fffffffu);
    float x;
    std::memcpy(&x, &bits, sizeof x);
    if (acceptable(x, exponent)) return random.below(50) == 0 ? 0.0f : x;
  }
}

// Where the sums resolve it: in the 2^-60 .. 2^40 around 2^exponent.
float typical_float(Random& random, int exponent) {
  return std::ldexp(1.0f + random.unit24(), exponent - 60 + static_cast<int>(random.below(100)));
}

struct Clamped {
  std::vector<packed_float3> samples, result;
  std::vector<float> limits;
  std::vector<cl_uint> accepted;
};

Clamped clamped(std::vector<packed_float3> samples, std::vector<float> limits) {
  Clamped c{std::move(samples), {}, std::move(limits), {}};
  c.result.resize(c.samples.size());
  c.accepted.resize(c.samples.size());
  run("film_test.cl", "clamped", c.samples.size(), c.samples, c.limits, out(c.result), out(c.accepted));
  return c;
}

bool same_bits(const packed_float3& a, const packed_float3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// The smallest float that the device tells from zero.
float least_float() { return keeps_denormals() ? 1e-45f : FLT_MIN; }

}  // namespace

TEST(film_test, sums_and_products_of_floats_of_every_exponent_are_the_exact_integers) {
  Random random(1);
  for (const int exponent : {0, 3, -40, 60, -120, 88}) {
    const std::size_t pixels = count_or_small(400, 4), each = count_or_small(100, 5);
    std::vector<packed_float3> samples;
    for (std::size_t i = 0; i < pixels * each; ++i) {
      const auto draw = [&] { return i % 2 ? any_float(random, exponent) : std::min(typical_float(random, exponent), 3e38f); };
      const float x = draw(), y = draw(), z = draw();
      samples.push_back({x, y, z});
    }
    Pixels film(pixels);
    add(film, all_places(pixels), samples, exponent);
    for (std::size_t i = 0; i < pixels; ++i) expect_sums(film.pixels[i], film.moments[i], expected_sums(&samples[i * each], each, exponent));
  }
}

// Halves of the last unit round up, anything below them down.
TEST(film_test, a_sample_is_rounded_to_the_nearest_unit_and_ties_go_up) {
  const auto unit = [](float x) { return std::ldexp(x, -FILM_FRACTION_BITS); };
  const std::vector<packed_float3> samples = {{unit(0.5f), unit(std::nextafter(0.5f, 0.0f)), unit(1.5f)}, {unit(2.5f), unit(1.0f), unit(3.4999998f)}};
  Pixels film(2);
  add(film, all_places(2), samples, 0);
  EXPECT_EQ(film.pixels[0].sum[0][0], 1u);
  EXPECT_EQ(film.pixels[0].sum[1][0], 0u);
  EXPECT_EQ(film.pixels[0].sum[2][0], 2u);
  EXPECT_EQ(film.pixels[1].sum[0][0], 3u);
  EXPECT_EQ(film.pixels[1].sum[1][0], 1u);
  EXPECT_EQ(film.pixels[1].sum[2][0], 3u);
}

TEST(film_test, carries_run_through_all_limbs) {
  Random random(2);
  for (const cl_uint limbs : {2u, 3u}) {
    const std::size_t n = count_or_small(20000, 50);
    std::vector<cl_ulong> sums(n * limbs), value(n);
    std::vector<cl_int> shift(n);
    std::vector<Wide> exact(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (cl_uint l = 0; l < limbs; ++l) sums[i * limbs + l] = random.below(3) == 0 ? random.engine() : ~cl_ulong{0} << random.below(8);
      sums[i * limbs + limbs - 1] >>= 1;  // room for the last carry
      value[i] = random.engine() >> (16 + random.below(48));
      if (random.below(4) == 0) value[i] = (cl_ulong{1} << 48) - 1;
      shift[i] = static_cast<int>(random.below(limbs * 64 - 49)) - (random.below(3) == 0 ? 70 : 0);
      Wide before{};
      for (cl_uint l = 0; l < limbs; ++l) before[l] = sums[i * limbs + l];
      exact[i] = plus(before, rounded(std::ldexp(static_cast<long double>(value[i]), shift[i])));
    }
    run("film_test.cl", "accumulate", n, out(sums), limbs, value, shift);
    for (std::size_t i = 0; i < n; ++i)
      for (cl_uint l = 0; l < limbs; ++l) EXPECT_EQ(sums[i * limbs + l], exact[i][l]) << i << " shift " << shift[i];
  }
}

TEST(film_test, the_sum_does_not_depend_on_the_order_of_the_samples) {
  Random random(3);
  const std::size_t each = count_or_small(2000, 10);
  std::vector<packed_float3> samples(each);
  for (packed_float3& s : samples) s = {typical_float(random, 0), any_float(random, 0), typical_float(random, 0)};
  std::vector<packed_float3> orders;
  for (int i = 0; i < 8; ++i) {
    orders.insert(orders.end(), samples.begin(), samples.end());
    std::shuffle(samples.begin(), samples.end(), random.engine);
  }
  Pixels film(8);
  add(film, all_places(8), orders, 0);
  for (int i = 1; i < 8; ++i) {
    EXPECT_EQ(std::memcmp(film.pixels[0].sum, film.pixels[i].sum, sizeof film.pixels[0].sum), 0);
    EXPECT_EQ(std::memcmp(&film.moments[0], &film.moments[i], sizeof(FilmMoments)), 0);
  }
}

// Extreme X5: one bad channel leaves out the whole sample, is counted, and touches nothing else.
TEST(film_test, samples_that_are_not_finite_negative_or_too_large_are_counted_and_left_out) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {nan, -nan, inf, -inf, -1.0f, -1e-45f, 0x1p40f, 3e38f}) {
    for (int channel = 0; channel < 3; ++channel) {
      packed_float3 sample{0.25f, 0.5f, 0.75f};
      (channel == 0 ? sample.x : channel == 1 ? sample.y : sample.z) = bad;
      Pixels film(3);
      for (std::size_t i = 0; i < 3; ++i) {
        std::memset(&film.pixels[i], 0x11 * static_cast<int>(i + 1), sizeof(FilmPixel));
        std::memset(&film.moments[i], 0x22, sizeof(FilmMoments));
      }
      Pixels before = film;
      add(film, {1}, {sample}, 0);
      ++before.pixels[1].rejected;
      EXPECT_EQ(std::memcmp(film.pixels.data(), before.pixels.data(), 3 * sizeof(FilmPixel)), 0) << bad;
      EXPECT_EQ(std::memcmp(film.moments.data(), before.moments.data(), 3 * sizeof(FilmMoments)), 0) << bad;
    }
  }
  record_law("X5");
}

TEST(film_test, the_limit_of_acceptance_is_finite_not_negative_and_below_the_headroom) {
  Random random(4);
  std::vector<float> x;
  std::vector<cl_int> exponent;
  std::vector<float> special = {0.0f, -0.0f, 1e-45f, -1e-45f, 3.4028234e38f, -3.4028234e38f, std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
  for (const int e : {-300, -190, -167, -166, -126, -40, 0, 1, 40, 86, 87, 88, 100, 127, 1000}) {
    std::vector<float> values = special;
    const float limit = static_cast<float>(std::ldexp(1.0, std::clamp(e + FILM_HEADROOM_BITS, -149, 128)));
    values.insert(values.end(), {limit, std::nextafter(limit, 0.0f), -limit, 0.5f * limit});
    for (int i = 0; i < 100; ++i) values.push_back(any_float(random, 1000));
    for (const float v : values) {
      x.push_back(v);
      exponent.push_back(e);
    }
  }
  std::vector<cl_uint> result(x.size());
  run("film_test.cl", "accepts", x.size(), x, exponent, out(result));
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Below 2^-126 the limit is not resolved: denormals and 0 are accepted there, and add nothing.
    const int limit = std::max(exponent[i] + FILM_HEADROOM_BITS, -126);
    const bool fits = std::isfinite(x[i]) && x[i] >= 0.0f && static_cast<long double>(x[i]) < std::ldexp(1.0L, limit);
    EXPECT_EQ(result[i] != 0, fits) << x[i] << " " << exponent[i];
  }
}

TEST(film_test, a_float_is_its_mantissa_times_its_power_of_two) {
  Random random(9);
  std::vector<float> x = {0.0f, -0.0f, 1e-45f,       -1e-45f, 0x1p-126f, std::nextafter(0x1p-126f, 0.0f),
                          1.0f, -3.0f, 3.4028234e38f};
  while (x.size() < count_or_small(20000, 64)) x.push_back(any_float(random, 1000) * static_cast<float>(random.sign()));
  std::vector<cl_ulong> mantissa(x.size());
  std::vector<cl_int> power(x.size());
  run("film_test.cl", "split", x.size(), x, out(mantissa), out(power));
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_LT(mantissa[i], cl_ulong{1} << 24);
    EXPECT_EQ(std::ldexp(static_cast<double>(mantissa[i]), power[i]), std::abs(static_cast<double>(x[i])));
  }
}

TEST(film_test, limbs_add_up_with_their_carries) {
  Random random(10);
  const std::size_t n = count_or_small(4096, 64);
  const cl_ulong ends[] = {0, 1, ~cl_ulong{0} - 1, ~cl_ulong{0}};
  const auto limb = [&] { return random.below(2) ? ends[random.below(4)] : random.engine(); };
  std::vector<cl_ulong> a, b, carry, sum(n), sums, limbs;
  for (std::size_t i = 0; i < n; ++i) {
    a.push_back(limb()), b.push_back(limb()), carry.push_back(i % 2);
    for (int k = 0; k < 3; ++k) sums.push_back(limb()), limbs.push_back(limb());
  }
  const std::vector<cl_ulong> sums_before = sums;
  run("film_test.cl", "carries", n, a, b, out(carry), out(sum));
  run("film_test.cl", "add_limbs", n, out(sums), limbs);
  for (std::size_t i = 0; i < n; ++i) {
    const Uint128 exact = static_cast<Uint128>(a[i]) + b[i] + i % 2;
    EXPECT_EQ(sum[i], static_cast<cl_ulong>(exact));
    EXPECT_EQ(carry[i], static_cast<cl_ulong>(exact >> 64));
    const auto wide = [&](const std::vector<cl_ulong>& v) { return Wide{v[3 * i], v[3 * i + 1], v[3 * i + 2]}; };
    EXPECT_EQ(wide(sums), plus(wide(sums_before), wide(limbs)));
  }
}

TEST(film_test, a_square_is_added_rounded_to_the_nearest) {
  Random random(11);
  const std::size_t n = count_or_small(4096, 64);
  std::vector<cl_ulong> low, high, sums;
  for (std::size_t i = 0; i < n; ++i) {
    // All lengths up to what a replica's sum may have; powers of two are squares in the middle between two units.
    const int bits = static_cast<int>(i % 98);
    const Uint128 x =
        (static_cast<Uint128>(1) << bits) |
        (i % 3 ? (static_cast<Uint128>(random.engine()) << 64 | random.engine()) & ((static_cast<Uint128>(1) << bits) - 1)
               : 0);
    low.push_back(static_cast<cl_ulong>(x)), high.push_back(static_cast<cl_ulong>(x >> 64));
    sums.insert(sums.end(), {random.engine(), i % 2 ? ~cl_ulong{0} : random.engine(), random.engine() >> 8});
  }
  const std::vector<cl_ulong> before = sums;
  run("film_test.cl", "add_square", n, out(sums), low, high);
  for (std::size_t i = 0; i < n; ++i) {
    const Uint128 x = static_cast<Uint128>(high[i]) << 64 | low[i];
    EXPECT_EQ((Wide{sums[3 * i], sums[3 * i + 1], sums[3 * i + 2]}),
              plus({before[3 * i], before[3 * i + 1], before[3 * i + 2]}, rounded_square(x)));
  }
}

// Extreme X27: 2^28 samples of 0.1f. All but 2^20 of them stand in the sum already, as the integer that they make.
TEST(film_test, the_mean_of_2_to_the_28_equal_samples_is_the_sample) {
  const cl_uint added = static_cast<cl_uint>(count_or_small(std::size_t{1} << 20, 64));
  const std::uint64_t total = std::uint64_t{1} << 28;
  const auto unit = static_cast<cl_ulong>(std::ldexp(static_cast<double>(0.1f), FILM_FRACTION_BITS));  // 24 bits above 2^-27: an integer
  const auto square = static_cast<Uint128>(std::ldexp(static_cast<double>(0.1f) * static_cast<double>(0.1f), 2 * FILM_MOMENT_FRACTION_BITS));
  Pixels film(1);
  for (int c = 0; c < 3; ++c) {
    const Uint128 preset = static_cast<Uint128>(unit) * (total - added);
    film.pixels[0].sum[c][0] = static_cast<cl_ulong>(preset);
    film.pixels[0].sum[c][1] = static_cast<cl_ulong>(preset >> 64);
  }
  for (auto& product : film.moments[0].product) {
    const Uint128 squares = square * (total - added);
    product[0] = static_cast<cl_ulong>(squares);
    product[1] = static_cast<cl_ulong>(squares >> 64);
  }
  add(film, {0}, {{0.1f, 0.1f, 0.1f}}, 0, added);
  Film read{1, 1, 0, total, film.pixels, film.moments};
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(pixel_mean(read, 0)[c], static_cast<double>(0.1f));
    for (int other = 0; other < 3; ++other)
      EXPECT_EQ(pixel_mean_products(read, 0)[c][other], static_cast<double>(0.1f) * static_cast<double>(0.1f));
  }
  record_law("X27");
}

// Extreme X27 again: one sample in 1024 is a spike of 2^30 times the others. The sum is that of the integers, and its mean is
// rounded once.
TEST(film_test, the_mean_of_2_to_the_28_samples_with_spikes_is_the_exact_mean_rounded_once) {
  const std::size_t each = 1024;
  const cl_uint repeat = static_cast<cl_uint>(count_or_small(1024, 1));
  const std::uint64_t total = std::uint64_t{1} << 28;
  const float low = 0.1f, spike = std::ldexp(0.7f, 30);
  std::vector<packed_float3> samples(each, {low, low, low});
  samples[each / 3] = {spike, spike, spike};
  const auto units = [](float x) { return static_cast<Uint128>(std::ldexp(static_cast<long double>(x), FILM_FRACTION_BITS)); };
  const Uint128 thousand = (each - 1) * units(low) + units(spike), preset = thousand * (total / each - repeat);
  Pixels film(1);
  for (auto& sum : film.pixels[0].sum) sum[0] = static_cast<cl_ulong>(preset), sum[1] = static_cast<cl_ulong>(preset >> 64);
  add(film, {0}, samples, 0, repeat);
  const Film read{1, 1, 0, total, film.pixels, film.moments};
  const double exact = static_cast<double>(std::ldexp(static_cast<long double>(thousand), -FILM_FRACTION_BITS - 10));
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(narrow({film.pixels[0].sum[c][0], film.pixels[0].sum[c][1], 0}), thousand * (total / each));
    EXPECT_EQ(pixel_mean(read, 0)[c], exact);
  }
  record_law("X27");
}

// Extreme X28: samples and exponent times 2^k give the same integers.
TEST(film_test, scaling_samples_and_exponent_by_a_power_of_two_changes_no_bit) {
  Random random(5);
  const std::size_t n = count_or_small(3000, 20);
  std::vector<packed_float3> samples;
  for (std::size_t i = 0; i < n; ++i) samples.push_back({random.unit24(), std::ldexp(random.unit24(), -20), std::ldexp(random.unit24(), 20)});
  Pixels plain(1);
  add(plain, {0}, samples, 0);
  for (const int k : {-60, -1, 1, 60}) {
    std::vector<packed_float3> scaled;
    for (const packed_float3& s : samples) scaled.push_back({std::ldexp(s.x, k), std::ldexp(s.y, k), std::ldexp(s.z, k)});
    Pixels film(1);
    add(film, {0}, scaled, k);
    EXPECT_EQ(std::memcmp(&film.pixels[0], &plain.pixels[0], sizeof(FilmPixel)), 0) << k;
    EXPECT_EQ(std::memcmp(&film.moments[0], &plain.moments[0], sizeof(FilmMoments)), 0) << k;
    const Film here{1, 1, k, n, film.pixels, film.moments}, there{1, 1, 0, n, plain.pixels, plain.moments};
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(pixel_mean(here, 0)[c], std::ldexp(pixel_mean(there, 0)[c], k));
      for (int other = 0; other < 3; ++other)
        EXPECT_EQ(pixel_mean_products(here, 0)[c][other], std::ldexp(pixel_mean_products(there, 0)[c][other], 2 * k));
    }
  }
  record_law("X28");
}

// Mean and mean products of the accepted samples. Three roundings to the 64 bits of long double and one to double: less than
// (1/2 + 2^-9) ulp of double, which is 2^-52 (1/2 + 2^-9) relative.
TEST(film_test, means_alpha_and_counts_are_those_of_the_accepted_samples) {
  Random random(6);
  const std::size_t n = count_or_small(2000, 20), bad = 7;
  std::vector<packed_float3> samples;
  std::array<__float128, 3> sum{};
  __float128 product[3][3] = {};
  std::uint64_t hits = 0;
  for (std::size_t i = 0; i < n; ++i) {
    packed_float3 s{random.unit24(), 100.0f * random.unit24(), 1e-3f + std::ldexp(random.unit24(), -8)};
    if (i < bad) s.y = -1.0f;
    samples.push_back(s);
    if (i < bad) continue;
    hits += i % 2 == 0;
    const float x[3] = {s.x, s.y, s.z};
    for (int c = 0; c < 3; ++c) {
      sum[c] += x[c];
      for (int other = 0; other < 3; ++other) product[c][other] += static_cast<__float128>(x[c]) * x[other];
    }
  }
  Pixels film(2);
  add(film, {1}, samples, 0);
  const Film read{2, 1, 0, n, film.pixels, film.moments};
  EXPECT_EQ(pixel_mean(read, 0), (std::array<double, 3>{}));  // n samples of nothing
  for (int c = 0; c < 3; ++c) {
    const double mean = static_cast<double>(sum[c] / (n - bad));
    const double rounding = 0x1p-52 * (1.0 + 0x1p-8);  // the oracle's own half ulp included
    EXPECT_NEAR(pixel_mean(read, 1)[c], mean, rounding * mean);
    for (int other = 0; other < 3; ++other) {
      const double mean_product = static_cast<double>(product[c][other] / (n - bad));
      // Each product is rounded to 2^-76.
      EXPECT_NEAR(pixel_mean_products(read, 1)[c][other], mean_product, rounding * mean_product + 0x1p-76);
    }
  }
  EXPECT_EQ(pixel_alpha(read, 1), static_cast<double>(hits) / static_cast<double>(n - bad));
  EXPECT_EQ(rejected_samples(read), bad);
  Film none{1, 1, 0, 3, {FilmPixel{}}, {FilmMoments{}}};
  none.pixels[0].rejected = 3;
  EXPECT_EQ(pixel_mean(none, 0), (std::array<double, 3>{}));
  EXPECT_EQ(pixel_mean_products(none, 0), glm::dmat3(0.0));
  EXPECT_EQ(pixel_alpha(none, 0), 0.0);
}

TEST(film_test, sums_and_squares_of_complete_replicas_are_the_exact_integers) {
  Random random(7);
  const std::size_t pixels = count_or_small(300, 3), each = 5 * REPLICA_SAMPLES - 1, complete = 4 * REPLICA_SAMPLES;
  for (const int exponent : {0, -40, 60, -120, 88}) {
    std::vector<packed_float3> samples;
    for (std::size_t i = 0; i < pixels * each; ++i) {
      const auto draw = [&] { return i / each % 2 ? any_float(random, exponent) : std::min(typical_float(random, exponent), 3e38f); };
      const float x = draw(), y = draw(), z = random.below(40) == 0 ? -1.0f : draw();
      samples.push_back({x, y, z});
    }
    FilmVector<FilmPixel> film(pixels);
    FilmVector<FilmErrors> errors(pixels);
    add_in_replicas(film, errors, samples, 7 * REPLICA_SAMPLES, exponent);
    for (std::size_t i = 0; i < pixels; ++i) {
      std::array<Wide, 3> square{};
      for (std::size_t first = 0; first < complete; first += REPLICA_SAMPLES) {
        const Sums replica = expected_sums(&samples[i * each + first], REPLICA_SAMPLES, exponent);
        for (int c = 0; c < 3; ++c) square[c] = plus(square[c], rounded_square(narrow(replica.sum[c])));
      }
      const Sums whole = expected_sums(&samples[i * each], complete, exponent);
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(errors[i].sum[c][0], whole.sum[c][0]);
        EXPECT_EQ(errors[i].sum[c][1], whole.sum[c][1]);
        for (int limb = 0; limb < 3; ++limb) EXPECT_EQ(errors[i].square[c][limb], square[c][limb]) << limb;
      }
    }
  }
}

// A replica of zeros gets the sum that stands in the pixel already. High limbs whose squares end just below a multiple of
// 2^64, low ones of all ones: what the product of both adds overflows from limb to limb.
TEST(film_test, squares_carry_through_all_limbs) {
  Random random(9);
  const std::size_t n = count_or_small(20000, 50);
  std::vector<Uint128> sum(n);
  FilmVector<FilmPixel> film(n);
  FilmVector<FilmErrors> errors(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto root = static_cast<cl_ulong>(std::sqrt(std::ldexp(static_cast<long double>(1 + random.below(15)), 64)));
    const cl_ulong high = random.below(2) ? root : random.engine() >> (30 + random.below(34));
    const cl_ulong low = random.below(2) ? ~cl_ulong{0} - random.below(3) : random.engine();
    sum[i] = static_cast<Uint128>(high) << 64 | low;
    film[i].sum[1][0] = low, film[i].sum[1][1] = high;
    for (ulong& limb : errors[i].square[1]) limb = random.below(2) ? ~cl_ulong{0} : random.engine();
    errors[i].square[1][2] >>= 8;
  }
  const FilmVector<FilmErrors> before = errors;
  add_in_replicas(film, errors, std::vector<packed_float3>(n * REPLICA_SAMPLES, {0, 0, 0}), 0, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const ulong* limbs = before[i].square[1];
    const Wide expected = plus({limbs[0], limbs[1], limbs[2]}, rounded_square(sum[i]));
    for (int limb = 0; limb < 3; ++limb) ASSERT_EQ(errors[i].square[1][limb], expected[limb]) << i << " limb " << limb;
  }
}

// All but the last of 2^33 samples that are as large as the film takes them stand in the sums already.
TEST(film_test, the_squares_of_2_to_the_29_replicas_of_the_largest_samples_fit) {
  const float largest = std::nextafter(std::ldexp(1.0f, FILM_HEADROOM_BITS), 0.0f);
  const std::uint64_t replicas = (std::uint64_t{1} << 33) / REPLICA_SAMPLES;
  const Uint128 sample = narrow(rounded(std::ldexp(static_cast<long double>(largest), FILM_FRACTION_BITS)));
  Wide times_a_power = rounded_square(sample * REPLICA_SAMPLES), square{};
  std::uint64_t n = 1;
  for (; n < replicas; n *= 2) {
    square = plus(square, times_a_power);  // 2^k - 1 of them
    times_a_power = plus(times_a_power, times_a_power);
  }
  ASSERT_EQ(n, replicas);
  ASSERT_GT(times_a_power[2], 0u);
  const Uint128 before = sample * REPLICA_SAMPLES * (replicas - 1);
  FilmVector<FilmPixel> film(1);
  FilmVector<FilmErrors> errors(1);
  for (int c = 0; c < 3; ++c) {
    for (auto* sum : {film[0].sum[c], errors[0].sum[c]}) sum[0] = static_cast<cl_ulong>(before), sum[1] = static_cast<cl_ulong>(before >> 64);
    std::copy(square.begin(), square.end(), errors[0].square[c]);
  }
  add_in_replicas(film, errors, std::vector<packed_float3>(REPLICA_SAMPLES, {largest, largest, largest}), REPLICA_SAMPLES * (replicas - 1), 0);
  for (int c = 0; c < 3; ++c)
    for (int limb = 0; limb < 3; ++limb) EXPECT_EQ(errors[0].square[c][limb], times_a_power[limb]);
  const Film read{1, 1, 0, REPLICA_SAMPLES * replicas, film, {}, errors, replicas};
  // 2^-63 of the square is what long double loses in each of four roundings.
  EXPECT_LE((*pixel_standard_error(read, 0))[0], largest * std::sqrt(4 * 0x1p-63 / static_cast<double>(replicas)));
}

// Four pixels of means m = (1, 2, 2) k and, by two replicas that differ by 2 d from each other, standard errors d / R, for k = 0 to 3: by hand,
// |m|^2 = 9 k^2, the mean of the image is (1.5, 3, 3) with the square 20.25.
TEST(film_test, error_of_the_image_is_the_root_mean_of_relative_squares) {
  const int exponent = 0;
  Film film{4, 1, exponent, 2 * REPLICA_SAMPLES, FilmVector<FilmPixel>(4), {}, FilmVector<FilmErrors>(4), 2};
  const double d[4] = {0.5, 0.25, 1.0, 0.0};
  double expected = 0.0;
  for (int k = 0; k < 4; ++k) {
    for (int c = 0; c < 3; ++c) {
      const double sum = REPLICA_SAMPLES * k * (c == 0 ? 1.0 : 2.0);  // of a replica; the two are sum + d and sum - d, d at most sum but for k = 0
      const double low = std::max(0.0, sum - d[k]), high = 2.0 * sum - low;
      film.pixels[k].sum[c][0] = film.errors[k].sum[c][0] = static_cast<ulong>(std::ldexp(low + high, FILM_FRACTION_BITS - 10)) << 10;
      film.pixels[k].sum[c][1] = film.errors[k].sum[c][1] = static_cast<ulong>(std::ldexp(low + high, FILM_FRACTION_BITS - 64));
      const double squares = std::ldexp(low * low + high * high, 2 * FILM_SQUARE_FRACTION_BITS);
      film.errors[k].square[c][1] = static_cast<ulong>(std::ldexp(squares, -64));
      film.errors[k].square[c][0] = static_cast<ulong>(squares - std::ldexp(std::floor(std::ldexp(squares, -64)), 64));
    }
    const double error = k == 0 ? 0.0 : d[k] / REPLICA_SAMPLES;  // a black pixel cannot spread
    expected += 3.0 * error * error / (9.0 * k * k + 0.01 * 20.25) / 4.0;
  }
  ASSERT_TRUE(image_error(film));
  // Sums and squares are multiples of 2^-4 here, exact in double and in the film; long double rounds a few times.
  EXPECT_NEAR(*image_error(film), std::sqrt(expected), 1e-12);
  Film dead = film;
  dead.pixels[2].rejected = dead.samples;
  EXPECT_FALSE(image_error(dead));
  film.replicas = 1;
  EXPECT_FALSE(image_error(film));
  EXPECT_FALSE(image_error(Film{1, 1, exponent, 2 * REPLICA_SAMPLES, {FilmPixel{}}, {}, {FilmErrors{}}, 2}));
}

// Against the sample variance of the replicas' means, in two passes; rejected samples are not among those of the mean.
TEST(film_test, standard_error_is_that_of_the_mean_of_replicas) {
  Random random(8);
  for (const std::size_t replicas : {2, 3, 50}) {
    std::vector<packed_float3> samples;
    for (std::size_t i = 0; i < replicas * REPLICA_SAMPLES + 5; ++i)
      samples.push_back({random.unit24(), 1000.0f + random.unit24(), i == 3 ? -1.0f : 1e-5f * random.unit24()});
    FilmVector<FilmPixel> film(1);
    FilmVector<FilmErrors> errors(1);
    add_in_replicas(film, errors, samples, 0, 0);
    const Film read{1, 1, 0, samples.size(), film, {}, errors, replicas};
    const auto error = pixel_standard_error(read, 0);
    ASSERT_TRUE(error);
    for (int c = 0; c < 3; ++c) {
      std::vector<__float128> sum(replicas);
      __float128 mean = 0, variance = 0;
      for (std::size_t i = 0; i < replicas * REPLICA_SAMPLES; ++i)
        if (i != 3) sum[i / REPLICA_SAMPLES] += c == 0 ? samples[i].x : c == 1 ? samples[i].y : samples[i].z;
      for (const __float128 s : sum) mean += s / replicas;
      for (const __float128 s : sum) variance += (s - mean) * (s - mean) / (replicas - 1);
      const double all = static_cast<double>(samples.size());
      const double expected = std::sqrt(static_cast<double>(variance / replicas)) / REPLICA_SAMPLES * all / (all - 1);
      // In 64 bits Q is rounded twice on its way out of its limbs, T once, T^2/n twice more: at most 2 and 4 2^-64 of Q,
      // which is hardly more than T^2/n. Each square was rounded by half of 2^-72. The root has half of the relative error.
      __float128 squares = 0;
      for (const __float128 s : sum) squares += s * s;
      const double lost = static_cast<double>(6 * squares) * 0x1p-64 + static_cast<double>(replicas) * 0x1p-73;
      const double spread = static_cast<double>(variance) * static_cast<double>(replicas - 1);
      ASSERT_LT(lost, 0.01 * spread);
      // Samples were rounded by up to 2^-55: each sum by 2^-51, the root of their spread by sqrt(replicas) times that.
      const double of_samples = 0x1p-51 / std::sqrt(static_cast<double>(replicas - 1)) / REPLICA_SAMPLES * all / (all - 1);
      EXPECT_NEAR((*error)[c], expected, (0.51 * lost / spread + 0x1p-51) * expected + of_samples);
    }
  }
}

// Noise around the unit, from a thousandth of it on, and none: the square that exact sums would have is within the unit's. Long
// double loses up to 6 2^-64 of Q beside it (as above).
TEST(film_test, what_rounding_takes_from_a_standard_error_is_below_its_unit) {
  Random random(21);
  double largest = 0.0;  // of what is lost, in squares of the unit
  for (const int exponent : {0, 33})
    for (const std::size_t replicas : {2, 3, 40})
      for (int power = -12; power <= 6; ++power) {
        const double noise = power == -12 ? 0.0 : std::ldexp(1.0, exponent - FILM_SQUARE_FRACTION_BITS - 4 + power);
        std::vector<packed_float3> samples;
        for (std::size_t i = 0; i < replicas * REPLICA_SAMPLES; ++i) {
          const auto value = [&](double mean) { return static_cast<float>(std::ldexp(mean, exponent - 30) + noise * random.unit()); };
          samples.push_back({value(0.0), value(0.003), value(1e-5)});
        }
        FilmVector<FilmPixel> film(1);
        FilmVector<FilmErrors> errors(1);
        add_in_replicas(film, errors, samples, 0, exponent);
        const Film read{1, 1, exponent, samples.size(), film, {}, errors, replicas};
        const auto error = pixel_standard_error(read, 0);
        ASSERT_TRUE(error);
        const double unit = standard_error_unit(read), n = static_cast<double>(replicas);
        for (int c = 0; c < 3; ++c) {
          std::vector<__float128> sum(replicas);
          for (std::size_t i = 0; i < samples.size(); ++i)
            sum[i / REPLICA_SAMPLES] += c == 0 ? samples[i].x : c == 1 ? samples[i].y : samples[i].z;
          __float128 mean = 0, variance = 0, squares = 0;
          for (const __float128 s : sum) mean += s / replicas, squares += s * s;
          for (const __float128 s : sum) variance += (s - mean) * (s - mean) / (replicas - 1);
          const double exact = static_cast<double>(variance / replicas) / REPLICA_SAMPLES / REPLICA_SAMPLES;
          const double of_long_double = static_cast<double>(6 * squares) * 0x1p-64 / n / (n - 1) / REPLICA_SAMPLES / REPLICA_SAMPLES;
          const double lost = std::abs((*error)[c] * (*error)[c] - exact);
          EXPECT_LE(lost, unit * unit + of_long_double + 1e-12 * exact) << exponent << " " << replicas << " " << power;
          largest = std::max(largest, (lost - of_long_double) / (unit * unit));
        }
      }
  EXPECT_GT(largest, 0.1);
}

TEST(film_test, there_is_no_standard_error_before_two_replicas_are_complete_or_without_a_sample) {
  Film film{1, 1, 0, 2 * REPLICA_SAMPLES - 1, {FilmPixel{}}, {}, {FilmErrors{}}, 1};
  EXPECT_FALSE(pixel_standard_error(film, 0));
  film.samples = 2 * REPLICA_SAMPLES;
  film.replicas = 2;
  EXPECT_TRUE(pixel_standard_error(film, 0));
  film.pixels[0].rejected = film.samples;
  EXPECT_FALSE(pixel_standard_error(film, 0));
}

// 2^-36 is the unit of a replica's sum in its square; n squares that err by half a unit^2.
TEST(film_test, samples_that_are_all_equal_have_no_standard_error) {
  const std::size_t replicas = 6;
  FilmVector<FilmPixel> film(1);
  FilmVector<FilmErrors> errors(1);
  add_in_replicas(film, errors, std::vector<packed_float3>(replicas * REPLICA_SAMPLES, {0.1f, 1e-6f, 3e7f}), 0, 0);
  const auto error = pixel_standard_error({1, 1, 0, replicas * REPLICA_SAMPLES, film, {}, errors, replicas}, 0);
  const double resolved = 0x1p-36 / REPLICA_SAMPLES / std::sqrt(2.0 * (replicas - 1));
  ASSERT_TRUE(error);
  EXPECT_LE((*error)[0], resolved);
  EXPECT_LE((*error)[1], resolved);
  EXPECT_LE((*error)[2], 3e7 * std::sqrt(4 * 0x1p-63 / replicas));
}

// Division and product round once each, a result below FLT_MIN to the next denormal or to zero: of a share of the largest channel that is
// as small, that times the limit is lost.
TEST(film_test, clamping_scales_all_channels_by_what_the_largest_is_above_the_limit) {
  Random random(11);
  std::vector<packed_float3> samples;
  std::vector<float> limits;
  for (std::size_t i = 0; i < count_or_small(20000, 200); ++i) {
    const auto draw = [&] { return random.below(20) == 0 ? 0.0f : static_cast<float>(random.log_between(1e-37, 3.4e38)); };
    const float x = draw(), y = draw(), z = draw();
    samples.push_back({x, y, z});
    limits.push_back(static_cast<float>(random.log_between(1.2e-38, 3.4e38)));
  }
  for (const float limit : {FLT_MIN, 1.0f, 0.1f, FLT_MAX})
    for (const float x : {least_float(), FLT_MIN, 0.099f, 1.0f, 1.0000001f, 3e38f, FLT_MAX}) {
      samples.insert(samples.end(), {{x, 0.0f, 0.0f}, {0.0f, x, x}, {0.5f * x, FLT_MAX, x}});
      limits.insert(limits.end(), 3, limit);
    }
  const Clamped c = clamped(samples, limits);
  int scaled = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double before[3] = {samples[i].x, samples[i].y, samples[i].z}, after[3] = {c.result[i].x, c.result[i].y, c.result[i].z};
    const double largest = *std::max_element(before, before + 3), limit = limits[i];
    EXPECT_EQ(c.accepted[i], 1u);
    if (largest <= limit) {
      EXPECT_TRUE(same_bits(c.result[i], samples[i])) << largest << " " << limit;
      continue;
    }
    ++scaled;
    for (int k = 0; k < 3; ++k) {
      const double expected = before[k] * (limit / largest);
      EXPECT_NEAR(after[k], expected, 2.01 * unit_roundoff * expected + least_float() * (1.0 + limit)) << before[k] << " of " << largest << " to " << limit;
      EXPECT_LE(after[k], limit * (1.0 + 2.0 * unit_roundoff));
    }
  }
  EXPECT_GT(scaled, static_cast<int>(samples.size() / 4));
}

// Whatever stands beside it, and however far it is scaled down: a negative number does not become a zero.
TEST(film_test, clamping_makes_no_bad_sample_a_good_one) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<packed_float3> samples;
  std::vector<float> limits;
  for (const float limit : {FLT_MIN, 1e-20f, 1.0f, 1e20f, FLT_MAX})
    for (const float bad : {nan, -nan, inf, -inf, -least_float(), -FLT_MIN, -1e-30f, -1.0f, -1e30f, -FLT_MAX})
      for (const float beside : {0.0f, -0.0f, least_float(), 0.5f, 1e10f, FLT_MAX, inf, nan, -1.0f}) {
        samples.insert(samples.end(), {{bad, beside, 0.5f}, {0.5f, bad, beside}, {beside, 0.5f, bad}, {bad, bad, beside}});
        limits.insert(limits.end(), 4, limit);
      }
  const Clamped c = clamped(samples, limits);
  for (std::size_t i = 0; i < samples.size(); ++i)
    EXPECT_EQ(c.accepted[i], 0u) << samples[i].x << " " << samples[i].y << " " << samples[i].z << " to " << limits[i] << ": " << c.result[i].x
                                 << " " << c.result[i].y << " " << c.result[i].z;
}
