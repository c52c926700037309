// Checkpoints made in code.
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "../host/checkpoint.h"
#include "random.h"

namespace oclair::test {

// Numbers from the whole range of each type, a few of them at its ends.
inline ulong any_limb(Random& random) {
  const ulong limb = random.engine();
  return limb % 8 == 0 ? ~ulong{0} : limb % 8 == 1 ? 0 : limb;
}

inline Film random_film(uint width, uint height, const std::vector<SampleRange>& ranges, bool with_moments,
                        std::uint64_t seed) {
  const std::uint64_t samples = count_samples(ranges);
  Random random(seed);
  Film film;
  film.width = width;
  film.height = height;
  film.exponent = -3;
  film.rays = 123456789012;
  film.samples = samples;
  film.replicas = count_replicas(ranges);
  film.pixels.resize(std::size_t{width} * height);
  for (FilmPixel& pixel : film.pixels) {
    for (auto& sum : pixel.sum)
      for (ulong& limb : sum) limb = any_limb(random);
    pixel.rejected = random.engine() % (samples + 1);
    pixel.hits = samples - pixel.rejected;
  }
  if (with_moments) film.moments.resize(film.pixels.size());
  for (FilmMoments& moments : film.moments)
    for (auto& product : moments.product)
      for (ulong& limb : product) limb = any_limb(random);
  film.errors.resize(film.pixels.size());
  for (FilmErrors& errors : film.errors)
    for (int c = 0; c < 3; ++c) {
      for (ulong& limb : errors.sum[c]) limb = any_limb(random);
      for (ulong& limb : errors.square[c]) limb = any_limb(random);
    }
  return film;
}

// Of a film of 5x7 whose crop is 3x2.
inline Checkpoint random_checkpoint(std::vector<SampleRange> ranges, std::uint64_t seed, bool with_moments = true) {
  Checkpoint checkpoint;
  checkpoint.identity = {{"scene", "0123456789abcdef"}, {"seed", "7"}};
  checkpoint.ranges = ranges;
  checkpoint.film = random_film(3, 2, ranges, with_moments, seed);
  checkpoint.head.film = {5, 7, 2, 4, 3, 2, FilterKind::tent, 1.25, 0.3, true, PixelFormat::xyza};
  checkpoint.head.moment_name = "m";
  checkpoint.head.attributes = {{"software", "oclair"}};
  checkpoint.kept = true;
  checkpoint.layers = {{"albedo.R", {0.0f, 1.0f, -0.0f, 1e-45f, 3.4e38f, 0.5f}}};
  return checkpoint;
}

template <typename Array>
bool same_bytes(const Array& a, const Array& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

inline void expect_same_film(const Film& a, const Film& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.exponent, b.exponent);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.replicas, b.replicas);
  EXPECT_TRUE(same_bytes(a.pixels, b.pixels));
  EXPECT_TRUE(same_bytes(a.moments, b.moments));
  EXPECT_TRUE(same_bytes(a.errors, b.errors));
}

inline void expect_same_layers(const std::vector<Layer>& a, const std::vector<Layer>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_TRUE(same_bytes(a[i].values, b[i].values));
  }
}

inline void expect_same_head(const ImageHead& a, const ImageHead& b) {
  EXPECT_EQ(a.film.width, b.film.width);
  EXPECT_EQ(a.film.height, b.film.height);
  EXPECT_EQ(a.film.crop_x, b.film.crop_x);
  EXPECT_EQ(a.film.crop_y, b.film.crop_y);
  EXPECT_EQ(a.film.crop_width, b.film.crop_width);
  EXPECT_EQ(a.film.crop_height, b.film.crop_height);
  EXPECT_EQ(a.film.filter, b.film.filter);
  EXPECT_EQ(a.film.filter_radius, b.film.filter_radius);
  EXPECT_EQ(a.film.filter_stddev, b.film.filter_stddev);
  EXPECT_EQ(a.film.sample_border, b.film.sample_border);
  EXPECT_EQ(a.film.pixel_format, b.film.pixel_format);
  EXPECT_EQ(a.moment_name, b.moment_name);
  EXPECT_EQ(a.attributes, b.attributes);
}

inline void expect_same(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(a.identity, b.identity);
  EXPECT_EQ(a.ranges, b.ranges);
  expect_same_film(a.film, b.film);
  expect_same_head(a.head, b.head);
  EXPECT_EQ(a.kept, b.kept);
  expect_same_layers(a.layers, b.layers);
}

// Of at least one. They are named by their numbers, from 1 on.
inline Checkpoint merge(std::vector<Checkpoint> parts) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts.size(); ++i) names.push_back("checkpoint " + std::to_string(i + 1));
  require_mergeable(parts, names);
  Checkpoint sum = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) add_samples(sum, std::move(parts[i]), names[i]);
  return sum;
}

}  // namespace oclair::test
