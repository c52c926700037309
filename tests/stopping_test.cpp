#include "../host/stopping.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "random.h"
#include "synthetic_film.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr std::uint64_t block = ErrorMonitor::usual_block;
constexpr std::uint64_t fewest = block * (1 + 2 * 64);  // 8 x 8 pixels: the first block and 64 pairs

struct Render {
  Film film = empty_film(8, 8);
  Random random{5};

  // Adds samples whose sum in each pixel and channel is uniform in count * level * (1 +- noise).
  void samples(std::uint64_t count, double level, double noise, int channels = 7) {
    for (std::size_t p = 0; p < film.pixels.size(); ++p) {
      const double sum = static_cast<double>(count) * level * random.between(1.0 - noise, 1.0 + noise);
      for (int c = 0; c < 3; ++c)
        if (channels >> c & 1) add_sum(film, p, c, sum);
    }
    film.samples += count;
  }
};

}  // namespace

// The variance of a block is (noise level)^2 / 3 in every channel; its mean over 64 pixels and 400 pairs is known to 1 / sqrt(25600)
// times a relative deviation of less than sqrt(2), and the root to half that: 0.5 %; six of those.
TEST(stopping_test, the_estimate_is_the_root_of_the_relative_variance_of_the_mean) {
  for (const int channels : {1, 4, 7}) {
    Render render;
    ErrorMonitor monitor(0.01, 0.95);
    for (int i = 0; i <= 800; ++i) {
      render.samples(block, 3.0, 0.5, channels);
      monitor.add(render.film);
    }
    const double exact = 0.5 / std::sqrt(3.0 * 1.01 * 801.0);  // the floor is 0.01 of the square
    EXPECT_NEAR(*monitor.estimate(), exact, 0.03 * exact) << channels;
    EXPECT_GT(*monitor.bound(), *monitor.estimate());
    EXPECT_LT(*monitor.bound(), 1.4 * exact);
  }
}

TEST(stopping_test, a_picture_without_noise_is_certified_after_the_fewest_samples) {
  Render render;
  ErrorMonitor monitor(1e-6, 0.999);
  while (!monitor.certified() && render.film.samples < 2 * fewest) {
    render.samples(block, 1.0, 0.0);
    monitor.add(render.film);
  }
  EXPECT_EQ(render.film.samples, fewest);
  EXPECT_EQ(monitor.why_not(), "");
  EXPECT_LT(*monitor.estimate(), 1e-9);  // float rounding of the first block: 2^-24, over 64 pairs
}

TEST(stopping_test, nothing_is_said_before_there_is_something_to_say) {
  Render render;
  ErrorMonitor monitor(0.1, 0.95);
  EXPECT_FALSE(monitor.certified());
  EXPECT_EQ(monitor.estimate(), std::nullopt);
  monitor.add(render.film);  // no sample
  for (const std::string more : {"2048", "2032"}) {  // within a pair: the second block is missing
    render.samples(block, 1.0, 0.1);
    monitor.add(render.film);
    EXPECT_EQ(monitor.estimate(), std::nullopt);
    EXPECT_EQ(monitor.bound(), std::nullopt);
    EXPECT_EQ(monitor.samples_expected(), std::nullopt);
    EXPECT_EQ(monitor.why_not(), "the error is judged after " + more + " more samples per pixel");
  }
}

TEST(stopping_test, a_bound_above_the_target_is_named) {
  Render render;
  ErrorMonitor monitor(1e-4, 0.99);
  for (int i = 0; i <= 400; ++i) {
    render.samples(block, 1.0, 0.5);
    monitor.add(render.film);
  }
  EXPECT_FALSE(monitor.certified());
  char text[100];
  std::snprintf(text, sizeof text, "the error is below %.3g with 99 %% confidence, 0.0001 was asked for", *monitor.bound());
  EXPECT_EQ(monitor.why_not(), text);
  // The bound falls as one over the root of the samples.
  const double share = *monitor.bound() / 1e-4;
  EXPECT_NEAR(static_cast<double>(*monitor.samples_expected()), share * share * 401.0 * block, 1.0);
}

// What the pairs do not show, those before a resume say, lies in the film: an error of half of each pixel's level 1, from the squares of
// two replicas, sqrt(2 8^2 / 2) / 16. It is asked for last, being the dearest to compute.
TEST(stopping_test, the_error_of_all_samples_is_judged_where_the_bound_is_reached_and_only_there) {
  for (const double noise : {0.01, 0.5}) {
    Render render;
    render.film.errors.assign(render.film.pixels.size(), FilmErrors{});
    for (FilmErrors& errors : render.film.errors)
      for (auto& square : errors.square) square[1] = ulong{2 * 8 * 8} << (2 * FILM_SQUARE_FRACTION_BITS - 64);
    render.film.replicas = 2;
    ErrorMonitor monitor(0.01, 0.95);
    for (int i = 0; i <= 200; ++i) {
      render.samples(block, 1.0, noise);
      monitor.add(render.film);
      EXPECT_FALSE(monitor.certified());
    }
    const bool reached = *monitor.bound() <= 0.01;
    EXPECT_EQ(reached, noise < 0.1);
    EXPECT_EQ(monitor.why_not().find(reached ? "the error is estimated as 0.498 from all samples, 49." : "the error is below "), 0u)
        << monitor.why_not();
    render.film.replicas = 0;  // the film tells nothing
    render.samples(block, 1.0, noise);
    monitor.add(render.film);
    EXPECT_EQ(monitor.certified(), reached) << monitor.why_not();
  }
}

TEST(stopping_test, more_confidence_is_a_higher_bound) {
  double before = 0.0;
  for (const double confidence : {0.5, 0.9, 0.99, 0.9999, 1.0 - 1e-9}) {
    Render render;
    ErrorMonitor monitor(0.01, confidence);
    for (int i = 0; i <= 20; ++i) {
      render.samples(block, 1.0, 0.5);
      monitor.add(render.film);
    }
    EXPECT_GT(*monitor.bound(), before);
    before = *monitor.bound();
  }
  EXPECT_TRUE(std::isfinite(before));
}

TEST(stopping_test, light_scaled_by_a_power_of_two_changes_no_bit) {
  std::vector<double> first;
  for (const int exponent : {0, 40, -300, 300}) {
    Render render;
    ErrorMonitor monitor(0.01, 0.95);
    std::vector<double> bounds;
    for (int i = 0; i < 30; ++i) {
      render.film.exponent = 0;
      render.samples(block, 1.0, 0.5);
      render.film.exponent = exponent;  // the same sums in other units
      monitor.add(render.film);
      if (monitor.bound()) bounds.push_back(*monitor.bound());
    }
    EXPECT_EQ(bounds.size(), 26u);  // from the second pair on
    if (first.empty()) first = bounds;
    EXPECT_EQ(bounds, first) << exponent;
  }
}

// Pixels of which a sample holds no more than some units of the film, and pixels at its upper end.
TEST(stopping_test, radiances_at_both_ends_of_the_film_are_judged_alike) {
  for (const double level : {0x1p-40, 0x1p-20, 16.0}) {
    Render render;
    ErrorMonitor monitor(0.05, 0.95);
    while (!monitor.certified() && render.film.samples < 2 * fewest) {
      render.samples(block, level, 0.5);
      monitor.add(render.film);
    }
    EXPECT_EQ(render.film.samples, fewest) << level << monitor.why_not();
    const double exact = 0.5 / std::sqrt(3.0 * 1.01 * 129.0);
    EXPECT_NEAR(*monitor.estimate(), exact, 0.08 * exact);
  }
}

TEST(stopping_test, a_black_picture_is_never_certified) {
  Render render;
  ErrorMonitor monitor(0.5, 0.5);
  for (int i = 0; i < 300; ++i) {
    render.samples(block, 0.0, 0.0);
    monitor.add(render.film);
  }
  EXPECT_EQ(monitor.why_not(), "the picture is black so far");
  // Light that comes late counts in full.
  for (int i = 0; i < 100; ++i) {
    render.samples(block, 1.0, 0.5);
    monitor.add(render.film);
  }
  EXPECT_NE(monitor.why_not(), "the picture is black so far");
}

// One sample that brings as much as half of all the noise together: it is one pixel's, and the picture would be certified otherwise.
TEST(stopping_test, a_picture_whose_noise_is_a_single_sample_is_not_certified) {
  Render render;
  ErrorMonitor monitor(0.05, 0.95);
  for (int i = 0; i < 200; ++i) {
    render.samples(block, 1.0, 0.2);
    if (i == 150) add_sum(render.film, 20, 1, 300.0);
    monitor.add(render.film);
    if (i < 150) {
      EXPECT_EQ(monitor.certified(), render.film.samples >= fewest);
    }
  }
  ASSERT_LT(*monitor.bound(), 0.05);
  EXPECT_FALSE(monitor.certified());
  EXPECT_NE(monitor.why_not().find("% of the noise seen are a few samples in one block of 8 x 8 pixels"), std::string::npos)
      << monitor.why_not();
}

TEST(stopping_test, films_between_blocks_do_not_count_and_change_nothing) {
  Render render;
  ErrorMonitor all(0.01, 0.95), some(0.01, 0.95);
  for (int i = 0; i < 60; ++i) {
    for (const std::uint64_t part : {1, 2, 13}) {
      render.samples(part, 1.0, 0.5);
      all.add(render.film);
      all.add(render.film);
    }
    some.add(render.film);
  }
  EXPECT_EQ(all.bound(), some.bound());
}

// As after a resume, or when the render loop was not asked for a while.
TEST(stopping_test, a_gap_between_films_costs_samples_and_not_the_truth) {
  Render render;
  ErrorMonitor monitor(0.001, 0.95);
  for (int i = 0; i < 100; ++i) render.samples(block, 1.0, 0.2);
  render.samples(5, 1.0, 0.2);  // not a multiple
  monitor.add(render.film);
  render.samples(block - 5, 1.0, 0.2);
  for (int i = 0; i < 400; ++i) {
    monitor.add(render.film);
    const std::uint64_t blocks = i % 50 == 49 ? 7 : 1;  // a gap of 7 blocks, in the middle of a pair
    for (std::uint64_t b = 0; b < blocks; ++b) render.samples(block, 1.0, 0.5);
  }
  const double blocks = static_cast<double>(render.film.samples / block - 7);  // the last film that was added
  const double exact = 0.5 / std::sqrt(3.0 * 1.01 * blocks);
  EXPECT_NEAR(*monitor.estimate(), exact, 0.04 * exact);
}

TEST(stopping_test, samples_left_out_do_not_count_as_dark) {
  Render render;
  ErrorMonitor monitor(1e-6, 0.95);
  for (int i = 0; i < 140; ++i) {
    // Every pixel is 1, but of all but one a part of the samples is left out.
    for (std::size_t p = 0; p < render.film.pixels.size(); ++p) {
      const ulong left_out = p == 0 ? 15 : (p * 7 + static_cast<std::size_t>(i) * 5) % 16;
      add_sum(render.film, p, 0, static_cast<double>(block - left_out));
      render.film.pixels[p].rejected += left_out;
    }
    render.film.samples += block;
    monitor.add(render.film);
  }
  EXPECT_LT(*monitor.estimate(), 1e-8);
  EXPECT_TRUE(monitor.certified()) << monitor.why_not();
}

// Noise that would be certified; of one pixel a single block is left out, or every block, in the first or the second one of
// a pair, or all that was rendered before a resume.
TEST(stopping_test, a_pixel_whose_whole_block_was_left_out_prevents_certification) {
  const auto why_not = [](const std::function<bool(int block)>& leaves_out, int resumed_at) {
    Render render;
    ErrorMonitor monitor(0.1, 0.95);
    for (int i = 0; i < 200; ++i) {
      const std::array<ulong, 2> before = {render.film.pixels[9].sum[0][0], render.film.pixels[9].sum[0][1]};
      render.samples(block, 1.0, 0.2, 1);
      if (leaves_out(i)) {
        std::copy(before.begin(), before.end(), render.film.pixels[9].sum[0]);
        render.film.pixels[9].rejected += block;
      }
      if (i >= resumed_at) monitor.add(render.film);
    }
    return monitor.why_not();
  };
  const char* const unknown = "pixels of which all samples of a block were left out: 1; nothing is known of their error";
  EXPECT_EQ(why_not([](int) { return false; }, 0), "");
  EXPECT_EQ(why_not([](int) { return true; }, 0), unknown);
  for (const int only : {0, 101, 102}) EXPECT_EQ(why_not([&](int i) { return i == only; }, 0), unknown) << only;
  EXPECT_EQ(why_not([](int i) { return i <= 20; }, 20), unknown);
  EXPECT_EQ(why_not([](int i) { return i < 20; }, 21), "");  // of what came before the monitor only the whole counts
}

// Most of the light is found at block 40, or only after the pairs so far could have certified: what is judged then is what a
// monitor judges that begins there; in the second case with less of the risk left, 1/32 for 15/16.
TEST(stopping_test, light_that_is_found_late_begins_the_pairs_anew) {
  for (const int dark : {41, 201}) {
    Render render;
    const double risk = dark * block < fewest ? 0.05 : 0.05 / 30;
    ErrorMonitor all(0.01, 0.95), late(0.01, 1.0 - risk);
    for (int i = 0; i < dark; ++i) {
      render.samples(block, 0.01, 0.5);
      all.add(render.film);
    }
    for (int i = 0; i < 2; ++i) {  // in one pair the mean grows by more than a factor of 5
      render.samples(block, 5.0, 0.5);
      all.add(render.film);
    }
    EXPECT_EQ(all.bound(), std::nullopt) << "the pairs do not begin anew";
    EXPECT_FALSE(all.certified());
    late.add(render.film);
    for (int i = 0; i < 20; ++i) {
      render.samples(block, 0.01, 0.5);  // the mean falls again: nothing more begins anew
      all.add(render.film);
      late.add(render.film);
    }
    ASSERT_TRUE(all.bound() && late.bound());
    EXPECT_NEAR(*all.bound(), *late.bound(), 1e-9 * *late.bound());
  }
}

// The pair that brought the light was noise of a few samples: it is not forgotten.
TEST(stopping_test, a_single_sample_that_makes_the_pairs_begin_anew_prevents_certification) {
  Render render;
  ErrorMonitor monitor(0.3, 0.95);
  for (int i = 0; i <= 10; ++i) {
    render.samples(block, 0.5, 0.2);
    monitor.add(render.film);
  }
  add_sum(render.film, 20, 1, 511.0);
  add_sum(render.film, 20, 1, 511.0);
  add_sum(render.film, 21, 1, 511.0);
  for (int i = 0; i < 140; ++i) {
    render.samples(block, 0.5, 0.2);
    monitor.add(render.film);
    EXPECT_FALSE(monitor.certified());
  }
  ASSERT_LT(*monitor.bound(), 0.3);
  EXPECT_NE(monitor.why_not().find("% of the noise seen are a few samples"), std::string::npos) << monitor.why_not();
}

TEST(stopping_test, a_picture_of_one_pixel_has_an_error_too) {
  Render render;
  render.film = empty_film(1, 1);
  ErrorMonitor monitor(0.5, 0.95);
  for (int i = 0; i < 4000; ++i) {
    EXPECT_FALSE(monitor.certified());
    render.samples(block, 1.0, 0.5);
    monitor.add(render.film);
  }
  for (int i = 0; i < 5000; ++i) {
    render.samples(block, 1.0, 0.5);
    monitor.add(render.film);
  }
  EXPECT_TRUE(monitor.certified()) << monitor.why_not();
}
