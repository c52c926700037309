// Films joined: sums against big integers, and which films are let together.
#include <algorithm>
#include <functional>
#include <numeric>

#include "../host/checkpoint.h"
#include "../host/error.h"
#include "../host/film.h"
#include "../host/limbs.h"
#include "checkpoint_cases.h"
#include "extremes.h"

namespace {

using namespace oclair;
using namespace oclair::test;

// Schoolbook addition of digits of 16 bits; what exceeds the limbs is left out.
std::vector<ulong> big_sum(std::vector<std::vector<ulong>> addends) {
  const std::size_t limbs = addends.front().size();
  std::vector<ulong> sum(limbs, 0);
  ulong carry = 0;
  for (std::size_t digit = 0; digit < 4 * limbs; ++digit) {
    for (const std::vector<ulong>& addend : addends) carry += addend[digit / 4] >> (16 * (digit % 4)) & 0xffff;
    sum[digit / 4] |= (carry & 0xffff) << (16 * (digit % 4));
    carry >>= 16;
  }
  return sum;
}

template <std::size_t LIMBS>
std::vector<ulong> limbs_of(const ulong (&limbs)[LIMBS]) {
  return {limbs, limbs + LIMBS};
}

std::string refusal(const std::function<void()>& attempt) {
  try {
    attempt();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  ADD_FAILURE() << "was not refused";
  return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

template <std::size_t LIMBS>
void check_limbs(Random& random) {
  const auto check = [](const ulong (&a)[LIMBS], const ulong (&b)[LIMBS]) {
    ulong sum[LIMBS];
    std::copy(a, a + LIMBS, sum);
    add(sum, b);
    EXPECT_EQ(limbs_of(sum), big_sum({limbs_of(a), limbs_of(b)}));
  };
  const ulong ends[] = {0, 1, ~ulong{0} - 1, ~ulong{0}};
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256; ++j) {
      ulong a[LIMBS] = {}, b[LIMBS] = {};
      for (std::size_t k = 0; k < LIMBS; ++k) {
        a[k] = ends[i >> (2 * k) & 3];
        b[k] = ends[j >> (2 * k) & 3];
      }
      check(a, b);
    }
  for (int round = 0; round < 10000; ++round) {
    ulong a[LIMBS] = {}, b[LIMBS] = {};
    for (std::size_t k = 0; k < LIMBS; ++k) {
      a[k] = any_limb(random);
      b[k] = any_limb(random);
    }
    check(a, b);
  }
}

TEST(merge_test, limbs_are_added_as_big_integers) {
  Random random(1);
  check_limbs<2>(random);
  check_limbs<3>(random);
}

// Parts of 16, 32, 48 and 20 samples with a gap between the last two.
std::vector<Checkpoint> four_parts() {
  return {random_checkpoint({{0, 16}}, 1), random_checkpoint({{16, 32}}, 2), random_checkpoint({{48, 48}}, 3),
          random_checkpoint({{128, 20}}, 4)};
}

TEST(merge_test, sums_and_counts_are_those_of_all_parts) {
  const std::vector<Checkpoint> parts = four_parts();
  const Checkpoint sum = merge(parts);
  const auto addends = [&](const auto& limbs_in) {
    std::vector<std::vector<ulong>> all;
    for (const Checkpoint& part : parts) all.push_back(limbs_in(part.film));
    return all;
  };
  for (std::size_t i = 0; i < 6; ++i) {
    ulong rejected = 0, hits = 0;
    for (const Checkpoint& part : parts) {
      rejected += part.film.pixels[i].rejected;
      hits += part.film.pixels[i].hits;
    }
    EXPECT_EQ(sum.film.pixels[i].rejected, rejected);
    EXPECT_EQ(sum.film.pixels[i].hits, hits);
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(limbs_of(sum.film.pixels[i].sum[c]),
                big_sum(addends([&](const Film& film) { return limbs_of(film.pixels[i].sum[c]); })));
    for (int k = 0; k < 6; ++k)
      EXPECT_EQ(limbs_of(sum.film.moments[i].product[k]),
                big_sum(addends([&](const Film& film) { return limbs_of(film.moments[i].product[k]); })));
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(limbs_of(sum.film.errors[i].sum[c]),
                big_sum(addends([&](const Film& film) { return limbs_of(film.errors[i].sum[c]); })));
      EXPECT_EQ(limbs_of(sum.film.errors[i].square[c]),
                big_sum(addends([&](const Film& film) { return limbs_of(film.errors[i].square[c]); })));
    }
  }
  EXPECT_EQ(sum.film.samples, 116u);
  EXPECT_EQ(sum.film.rays, 4 * parts[0].film.rays);
  EXPECT_EQ(sum.film.rays, 4u * parts[0].film.rays);
  EXPECT_EQ(sum.ranges, (std::vector<SampleRange>{{0, 96}, {128, 20}}));
}

TEST(merge_test, neither_order_nor_grouping_changes_a_bit) {
  const std::vector<Checkpoint> parts = four_parts();
  const Checkpoint expected = merge(parts);
  std::vector<int> order(4);
  std::iota(order.begin(), order.end(), 0);
  do {
    const auto part = [&](int i) { return parts[order[i]]; };
    expect_same(merge({part(0), part(1), part(2), part(3)}), expected);
    expect_same(merge({merge({part(0), part(1)}), merge({part(2), part(3)})}), expected);
    expect_same(merge({part(0), merge({part(1), merge({part(2), part(3)})})}), expected);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(merge_test, one_part_is_its_own_merge) {
  const Checkpoint part = random_checkpoint({{16, 20}}, 1);
  expect_same(merge({part}), part);
}

TEST(merge_test, what_does_not_depend_on_samples_is_that_of_the_first_sample) {
  Checkpoint a = random_checkpoint({{32, 16}}, 1), b = random_checkpoint({{0, 16}}, 2);
  b.head.attributes = {{"device", "another"}};
  b.layers[0].values[0] = 9.0f;
  for (const Checkpoint& sum : {merge({a, b}), merge({b, a})}) {
    expect_same_head(sum.head, b.head);
    expect_same_layers(sum.layers, b.layers);
  }
}

// In the order in which one render with all of them has them; of one that two parts have, the first sample's.
TEST(merge_test, layers_are_those_of_all_parts) {
  const auto layer = [](const char* name, float value) { return Layer{name, std::vector<float>(6, value)}; };
  Checkpoint a = random_checkpoint({{0, 16}}, 1), b = random_checkpoint({{16, 16}}, 2), c = random_checkpoint({{32, 16}}, 3);
  a.layers = {layer("depth.Z", 1), layer("uv.U", 1), layer("uv.V", 2)};
  b.layers = {layer("albedo.R", 3), layer("albedo.G", 4), layer("albedo.B", 5), layer("depth.Z", 6),
              layer("primitive.id", 7)};
  c.layers = {};
  const std::vector<Layer> expected = {layer("albedo.R", 3),    layer("albedo.G", 4), layer("albedo.B", 5),
                                       layer("depth.Z", 1),     layer("uv.U", 1),     layer("uv.V", 2),
                                       layer("primitive.id", 7)};
  for (const std::vector<Checkpoint>& parts : {std::vector{a, b, c}, {c, b, a}, {b, a, c}, {c, a, b}})
    expect_same_layers(merge(parts).layers, expected);
}

TEST(merge_test, overlapping_samples_are_refused_with_both_ranges) {
  const std::vector<std::pair<SampleRange, SampleRange>> overlaps = {
      {{0, 48}, {32, 32}}, {{0, 48}, {0, 48}}, {{0, 64}, {16, 16}}, {{0, 33}, {32, 16}}};
  for (const auto& [a, b] : overlaps)
    for (const bool turned : {false, true}) {
      const std::vector<Checkpoint> parts = {random_checkpoint({turned ? b : a}, 1), random_checkpoint({{160, 16}}, 2),
                                             random_checkpoint({turned ? a : b}, 3)};
      const std::string message = refusal([&] { merge(parts); });
      EXPECT_TRUE(contains(message, to_string(a)) && contains(message, to_string(b))) << message;
      EXPECT_TRUE(contains(message, "checkpoint 1") && contains(message, "checkpoint 3")) << message;
      EXPECT_TRUE(contains(message, "overlap")) << message;
    }
}

// Its last samples count in the mean, but make no replica; the errors hold complete ones alone, and are sums like the film's
// own.
TEST(merge_test, a_part_may_end_within_a_replica) {
  const Checkpoint sum =
      merge({random_checkpoint({{0, 40}}, 1), random_checkpoint({{64, 15}}, 2), random_checkpoint({{48, 16}}, 3)});
  EXPECT_EQ(sum.ranges, (std::vector<SampleRange>{{0, 40}, {48, 31}}));
  EXPECT_EQ(sum.film.samples, 71u);
  EXPECT_EQ(sum.film.replicas, 3u);
}

TEST(merge_test, every_difference_between_two_renders_is_named_with_both_values) {
  const Identity expected = {{"scene", "aa"}, {"seed", "1"}, {"max depth", "5"}, {"only here", "x"}};
  const Identity found = {{"seed", "2"}, {"scene", "bb"}, {"max depth", "5"}, {"only there", "y"}};
  const std::string message = refusal([&] { require_same(expected, found, "b.checkpoint"); });
  EXPECT_EQ(message,
            "b.checkpoint: is of another render: scene is bb, expected aa; seed is 2, expected 1; only here is absent, "
            "expected x; "
            "only there is y, expected none");
  EXPECT_NO_THROW(require_same(expected, {expected.rbegin(), expected.rend()}, "b"));
}

TEST(merge_test, parts_of_another_render_or_film_are_refused) {
  const Checkpoint a = random_checkpoint({{0, 16}}, 1);
  const std::pair<const char*, std::function<void(Checkpoint&)>> changes[] = {
      {"seed is 8, expected 7", [](Checkpoint& b) { b.identity[1].second = "8"; }},
      {"film exponent is -4, expected -3", [](Checkpoint& b) { b.film.exponent = -4; }},
      {"film size is 6x7, expected 5x7", [](Checkpoint& b) { b.head.film.width = 6; }},
      {"crop offset is 1x4, expected 2x4", [](Checkpoint& b) { b.head.film.crop_x = 1; }},
      {"crop size is 2x3, expected 3x2", [](Checkpoint& b) { std::swap(b.film.width, b.film.height); }},
      {"second moments", [](Checkpoint& b) { b.film.moments.clear(); }}};
  for (const auto& [part, change] : changes) {
    Checkpoint b = random_checkpoint({{16, 16}}, 2);
    change(b);
    const std::string message = refusal([&] { merge({a, b}); });
    EXPECT_TRUE(contains(message, part) && contains(message, "checkpoint 2")) << message;
  }
}

// 2^33 samples of the largest value that the film takes, 2^(E + 40) (1 - 2^-24), half of them in each part. The sum is below
// 2^127 units, and the mean is the value again.
TEST(merge_test, two_to_the_33_samples_fit_the_counters) {
  const auto half = [](std::uint64_t first) {
    Checkpoint part = random_checkpoint({{first, MAX_SAMPLES / 2}}, 1, false);
    for (FilmPixel& pixel : part.film.pixels) {
      pixel.rejected = 0;
      pixel.hits = MAX_SAMPLES / 2;
      for (auto& sum : pixel.sum) {  // 2^(54 + 40 - 24) (2^24 - 1) 2^32 = (2^24 - 1) 2^102
        sum[0] = 0;
        sum[1] = ((ulong{1} << 24) - 1) << 38;
      }
    }
    return part;
  };
  const Checkpoint sum = merge({half(0), half(MAX_SAMPLES / 2)});
  EXPECT_EQ(sum.film.samples, MAX_SAMPLES);
  EXPECT_EQ(sum.ranges, (std::vector<SampleRange>{{0, MAX_SAMPLES}}));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(sum.film.pixels[i].hits, MAX_SAMPLES);
    for (const double mean : pixel_mean(sum.film, i)) EXPECT_EQ(mean, std::ldexp(1 - 0x1p-24, -3 + 40));
  }
  Checkpoint rejected = half(0), other = half(MAX_SAMPLES / 2);
  for (Checkpoint* part : {&rejected, &other})
    for (FilmPixel& pixel : part->film.pixels) pixel = {{}, MAX_SAMPLES / 2, 0};
  EXPECT_EQ(rejected_samples(merge({rejected, other}).film), 6 * MAX_SAMPLES);
  record_law("X46");
}

}  // namespace
