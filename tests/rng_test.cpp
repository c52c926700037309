#include <set>

#include "extremes.h"
#include "inputs.h"
#include "kernel.h"

using namespace oclair::test;

namespace {

constexpr const char* file = "rng_test.cl";

std::vector<cl_ulong> mixed(const std::vector<cl_ulong>& z) {
  std::vector<cl_ulong> result(z.size());
  run(file, "mixed", z.size(), z, out(result));
  return result;
}

// Inverse of an odd number modulo 2^64: Newton's method doubles the correct bits, from 3.
std::uint64_t inverse(std::uint64_t odd) {
  std::uint64_t x = odd;
  for (int i = 0; i < 6; ++i) x *= 2 - odd * x;
  return x;
}

std::uint64_t undo_shift(std::uint64_t z, int shift) {
  std::uint64_t x = z;
  for (int done = shift; done < 64; done += shift) x = z ^ (x >> shift);
  return x;
}

// Inverse of Stafford's variant 13, the output function of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t unmixed(std::uint64_t z) {
  static const std::uint64_t second = inverse(0x94d049bb133111ebu), first = inverse(0xbf58476d1ce4e5b9u);
  z = undo_shift(z, 31) * second;
  z = undo_shift(z, 27) * first;
  return undo_shift(z, 30);
}

std::vector<cl_ulong> words() {
  std::vector<cl_ulong> list{0, ~cl_ulong{0}, 0x0123456789abcdefu};
  for (int bit = 0; bit < 64; ++bit) list.push_back(cl_ulong{1} << bit), list.push_back(~(cl_ulong{1} << bit));
  Random random(30);
  for (std::size_t i = 0; i < count_or_small(100000, 100); ++i) list.push_back(random.engine());
  return list;
}

struct Stream {
  cl_ulong seed;
  cl_uint pixel;
  cl_ulong sample;
};

std::vector<cl_ulong> keys(const std::vector<Stream>& streams) {
  std::vector<cl_ulong> seed, sample, result(streams.size());
  std::vector<cl_uint> pixel;
  for (const Stream& s : streams) seed.push_back(s.seed), pixel.push_back(s.pixel), sample.push_back(s.sample);
  run(file, "key", streams.size(), seed, pixel, sample, out(result));
  return result;
}

std::size_t distinct(std::vector<cl_ulong> values) {
  std::sort(values.begin(), values.end());
  return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
}

struct Draw {
  std::vector<cl_ulong> bits;
  std::vector<cl_float2> point;
};

Draw draw(const std::vector<cl_ulong>& key, const std::vector<cl_uint>& dimension) {
  Draw result{std::vector<cl_ulong>(key.size()), std::vector<cl_float2>(key.size())};
  run(file, "draw", key.size(), key, dimension, out(result.bits), out(result.point));
  return result;
}

}  // namespace

// Extreme X20: u32 * 2^-32 rounds to 1.0f for 128 values of 2^32.
TEST(rng_test, unit_is_never_one) {
  std::vector<cl_uint> bits;
  for (std::size_t i = 0; i < 256; ++i) bits.push_back(0xffffffffu - static_cast<cl_uint>(i));
  std::vector<float> result(bits.size());
  run(file, "unit", bits.size(), bits, out(result));
  for (float u : result) EXPECT_EQ(u, 1.0f - 0x1p-24f);
  record_law("X20");
}

// All of them, each with some low bits that must not matter.
TEST(rng_test, unit_is_every_multiple_of_two_to_the_minus_24) {
  const std::size_t count = count_or_small(std::size_t{1} << 24, 1000), step = (std::size_t{1} << 24) / count;
  std::vector<cl_uint> bits(count);
  for (std::size_t i = 0; i < count; ++i) bits[i] = static_cast<cl_uint>(i * step << 8 | (i * 37 & 255));
  std::vector<float> result(count);
  run(file, "unit", count, bits, out(result));
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(result[i], static_cast<double>(i * step) * 0x1p-24);
  record_law("X20");
}

// Published outputs of SplitMix64 seeded with 0 and with 1234567: its n-th state is the seed plus n times the golden gamma.
TEST(rng_test, mix_is_splitmix64) {
  constexpr cl_ulong gamma = 0x9e3779b97f4a7c15u;
  EXPECT_EQ(mixed({gamma, 2 * gamma, 3 * gamma}),
            (std::vector<cl_ulong>{0xe220a8397b1dcdafu, 0x6e789e6aa1b965f4u, 0x06c45d188009454fu}));
  EXPECT_EQ(mixed({1234567 + gamma, 1234567 + 2 * gamma}), (std::vector<cl_ulong>{6457827717110365317u, 3203168211198807973u}));
}

TEST(rng_test, mix_can_be_undone) {
  const std::vector<cl_ulong> z = words(), result = mixed(z);
  for (std::size_t i = 0; i < z.size(); ++i) ASSERT_EQ(unmixed(result[i]), z[i]);
}

// Avalanche: flipping one input bit flips each output bit with probability 1/2. Over 4096 words the count of each of the 64 * 64
// has a standard deviation of 32; 6 of them is exceeded by one in 4096 pairs with probability 8e-6.
TEST(rng_test, mix_lets_every_bit_decide_over_every_bit) {
  const std::size_t samples = count_or_small(4096, 64);
  Random random(31);
  std::vector<cl_ulong> base(samples);
  for (cl_ulong& z : base) z = random.engine();
  const std::vector<cl_ulong> before = mixed(base);
  for (int in = 0; in < 64; ++in) {
    std::vector<cl_ulong> flipped(base);
    for (cl_ulong& z : flipped) z ^= cl_ulong{1} << in;
    const std::vector<cl_ulong> after = mixed(flipped);
    for (int bit = 0; bit < 64; ++bit) {
      double changed = 0;
      for (std::size_t i = 0; i < samples; ++i) changed += static_cast<double>((before[i] ^ after[i]) >> bit & 1);
      const double mean = static_cast<double>(samples) / 2;
      EXPECT_NEAR(changed, mean, 6 * std::sqrt(mean / 2)) << "bit " << in << " over bit " << bit;
    }
  }
}

// Extreme X22. Single bits, their complements and neighbours at both ends of both ranges: where packing or mixing two numbers
// into one would let them overlap.
TEST(rng_test, keys_of_all_streams_of_a_seed_differ) {
  const auto boundary = [](int bits) {
    std::set<cl_ulong> values;
    const cl_ulong end = cl_ulong{1} << bits;
    for (cl_ulong k = 0; k < 16; ++k) values.insert(k), values.insert(end - 1 - k);
    for (int bit = 0; bit < bits; ++bit) values.insert(cl_ulong{1} << bit), values.insert(end - 1 - (cl_ulong{1} << bit));
    return std::vector<cl_ulong>(values.begin(), values.end());
  };
  std::vector<Stream> streams;
  for (cl_ulong pixel : boundary(31))
    for (cl_ulong sample : boundary(33)) streams.push_back({5, static_cast<cl_uint>(pixel), sample});
  EXPECT_EQ(distinct(keys(streams)), streams.size());
  // And a whole frame of 2048 x 1024 with two samples: random keys would collide with probability 5e-7.
  streams.clear();
  const cl_uint pixels = static_cast<cl_uint>(count_or_small(1 << 21, 1000));
  for (cl_uint pixel = 0; pixel < pixels; ++pixel)
    for (cl_ulong sample : {cl_ulong{0}, cl_ulong{1}}) streams.push_back({5, pixel, sample});
  EXPECT_EQ(distinct(keys(streams)), streams.size());
  record_law("X22");
}

// So no two are equal: from the key of each of 8192^2 pixels, with samples of all sizes, both numbers come back.
TEST(rng_test, the_key_of_every_pixel_of_8192_squared_tells_pixel_and_sample) {
  constexpr cl_ulong seed = 5, golden = 0x9e3779b97f4a7c15u;
  const cl_ulong start = mixed({seed + golden})[0];
  const std::size_t pixels = count_or_small(std::size_t{1} << 26, 1024), chunk = std::min<std::size_t>(pixels, 1 << 22);
  std::size_t wrong = 0;
  for (std::size_t first = 0; first < pixels; first += chunk) {
    std::vector<cl_uint> pixel(chunk);
    for (std::size_t i = 0; i < chunk; ++i) pixel[i] = static_cast<cl_uint>(first + i);
    const cl_ulong sample = (cl_ulong{1} << 33) - 1 - first * 127;
    std::vector<cl_ulong> key(chunk);
    run(file, "key_of_sample", chunk, seed, pixel, sample, out(key));
    for (std::size_t i = 0; i < chunk; ++i) wrong += (unmixed(key[i]) ^ start) != (sample << 31 | pixel[i]);
  }
  EXPECT_EQ(wrong, 0u);
  record_law("X22");
}

// 64 seeds next to each other by value or by one bit, 64 pixels, 4 samples.
TEST(rng_test, keys_of_different_seeds_differ) {
  std::vector<Stream> streams;
  std::set<cl_ulong> seeds;
  for (cl_ulong k = 0; k < 16; ++k) seeds.insert(k);
  for (int bit = 0; bit < 64; ++bit) seeds.insert(cl_ulong{1} << bit);
  for (cl_ulong seed : seeds)
    for (cl_uint pixel = 0; pixel < 64; ++pixel)
      for (cl_ulong sample = 0; sample < 4; ++sample) streams.push_back({seed, pixel, sample});
  EXPECT_EQ(distinct(keys(streams)), streams.size());
  // 2^20 seeds, one stream: if only 32 bits of a seed counted, 128 pairs would collide; 64 bits: 3e-8.
  streams.clear();
  for (cl_ulong seed = 0; seed < count_or_small(1 << 20, 1000); ++seed) streams.push_back({seed, 3, 4});
  EXPECT_EQ(distinct(keys(streams)), streams.size());
}

// If keys were not mixed after pixel and sample go in, the stream whose key differs by d steps of the dimension's increment
// would repeat another one from its d-th dimension on. The pixels and samples where that would happen, for seed 0, whose mixed
// word is SplitMix64's first output.
TEST(rng_test, no_stream_is_another_one_shifted_by_some_dimensions) {
  constexpr cl_ulong gamma = 0x9e3779b97f4a7c15u, word = 0xe220a8397b1dcdafu;
  std::vector<Stream> streams{{0, 0, 0}};
  for (cl_uint d = 1; d < 64; ++d) {
    const cl_ulong place = word ^ (word + d * gamma);
    streams.push_back({0, static_cast<cl_uint>(place & 0x7fffffffu), place >> 31});
  }
  const std::vector<cl_ulong> key = keys(streams);
  std::vector<cl_ulong> from;
  std::vector<cl_uint> dimension;
  for (cl_uint d = 1; d < 64; ++d) {
    from.insert(from.end(), {key[0], key[d]});
    dimension.insert(dimension.end(), {d + 5, 5});
  }
  const Draw result = draw(from, dimension);
  for (std::size_t i = 0; i < from.size(); i += 2)
    EXPECT_NE(result.bits[i], result.bits[i + 1]) << "shifted by " << dimension[i] - 5;
}

TEST(rng_test, dimensions_of_neighbouring_streams_do_not_repeat_each_other) {
  std::vector<Stream> streams;
  for (cl_uint pixel = 0; pixel < 32; ++pixel)
    for (cl_ulong sample = 0; sample < 32; ++sample) streams.push_back({0, pixel, sample});
  const std::vector<cl_ulong> stream_keys = keys(streams);
  const cl_uint dimensions = static_cast<cl_uint>(count_or_small(1000, 3));
  std::vector<cl_ulong> key;
  std::vector<cl_uint> dimension;
  for (cl_ulong k : stream_keys)
    for (cl_uint d = 0; d < dimensions; ++d) key.push_back(k), dimension.push_back(d);
  EXPECT_EQ(distinct(draw(key, dimension).bits), key.size());
}

TEST(rng_test, a_point_is_the_high_and_the_low_half_of_the_bits) {
  const std::vector<cl_ulong> key = words();
  std::vector<cl_uint> dimension(key.size());
  for (std::size_t i = 0; i < key.size(); ++i) dimension[i] = static_cast<cl_uint>(i % 1021);
  const Draw result = draw(key, dimension);
  for (std::size_t i = 0; i < key.size(); ++i) {
    ASSERT_EQ(result.point[i].s[0], static_cast<double>(result.bits[i] >> 40) * 0x1p-24);
    ASSERT_EQ(result.point[i].s[1], static_cast<double>((result.bits[i] & 0xffffffffu) >> 8) * 0x1p-24);
  }
}

TEST(rng_test, the_same_stream_gives_the_same_numbers) {
  const std::vector<Stream> streams{{7, 11, 13}, {7, 11, 13}, {8, 11, 13}, {7, 12, 13}, {7, 11, 14}};
  const std::vector<cl_ulong> k = keys(streams);
  const Draw result = draw({k[0], k[1], k[0], k[2], k[3], k[4]}, {3, 3, 4, 3, 3, 3});
  EXPECT_EQ(result.bits[0], result.bits[1]);
  for (std::size_t other = 2; other < 6; ++other) EXPECT_NE(result.bits[0], result.bits[other]);
}
