// The colours of a signed difference, as bytes of its PNG.
#include "../host/difference_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../host/error.h"
#include "files.h"
#include "png_reader.h"
#include "temporary_directory.h"

using namespace oclair;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity(), not_a_number = std::numeric_limits<float>::quiet_NaN();

using Bytes = std::vector<std::uint8_t>;

Bytes picture(const std::vector<float>& differences, double scale) {
  const TemporaryDirectory directory;
  write_difference(directory / "a.png", static_cast<unsigned>(differences.size()), 1, differences, scale);
  return read_png(directory / "a.png");
}

}  // namespace

// Ends and middle are those of docs/compare.md; a fifth of the way is 225 - 11, 225 - 45, 225 - 39.8, and 225 - 45, 225 -
// 31, 225 - 7.4.
TEST(difference_image_test, differences_are_red_above_zero_and_blue_below_in_proportion_to_their_size) {
  EXPECT_EQ(picture({0.0f, 4.0f, -4.0f}, 4.0), (Bytes{225, 225, 225, 170, 0, 26, 0, 70, 188}));
  EXPECT_EQ(picture({-0.0f, 0.8f, -0.8f}, 4.0), (Bytes{225, 225, 225, 214, 180, 185, 180, 194, 218}));
}

TEST(difference_image_test, what_is_beyond_the_scale_has_its_colour_and_what_is_not_finite_is_black) {
  EXPECT_EQ(picture({1e30f, -1e30f}, 1e-3), (Bytes{170, 0, 26, 0, 70, 188}));
  EXPECT_EQ(picture({infinity, -infinity, not_a_number}, 1.0), (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(difference_image_test, without_a_scale_zero_is_grey) { EXPECT_EQ(picture({0.0f}, 0.0), (Bytes{225, 225, 225})); }

TEST(difference_image_test, the_bytes_in_memory_are_those_of_the_file) {
  const TemporaryDirectory directory;
  std::vector<float> differences;
  for (int i = 0; i < 40 * 50; ++i) differences.push_back(static_cast<float>(std::sin(i)));
  write_difference(directory / "a.png", 40, 50, differences, 1.0);
  EXPECT_EQ(difference_png(40, 50, differences, 1.0), content(directory / "a.png"));
}

// Of 1 to 200 and zeros: 198.
TEST(difference_image_test, the_scale_is_the_99th_percentile_of_what_differs) {
  std::vector<float> differences(1000, 0.0f);
  for (int k = 1; k <= 200; ++k) differences[5 * k - 1] = static_cast<float>(k % 2 ? k : -k);
  EXPECT_EQ(difference_scale(differences), 198.0);
  differences[0] = infinity;
  differences[1] = not_a_number;
  EXPECT_EQ(difference_scale(differences), 198.0);
  EXPECT_EQ(difference_scale(std::vector<float>{0.0f, infinity}), 0.0);
  EXPECT_EQ(difference_scale({}), 0.0);
}

TEST(difference_image_test, a_row_that_png_does_not_take_is_a_failure_of_output) {
  const std::vector<float> row(1'000'001, 0.0f);  // libpng's limit is a million
  try {
    difference_png(1'000'001, 1, row, 1.0);
    ADD_FAILURE() << "it was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::render_failed);
    EXPECT_NE(std::string(error.what()).find("expected a size that PNG allows"), std::string::npos) << error.what();
  }
}

// Rec. ITU-R BT.709: 0.2126 R + 0.7152 G + 0.0722 B, signed.
TEST(difference_image_test, luminance_differences_are_signed_and_weigh_the_channels) {
  const std::vector<float> a = {1.0f, 0.0f, 0.0f, 0.0f, 1.0f,     0.0f, 0.0f, 0.0f,
                                1.0f, 2.0f, 2.0f, 2.0f, infinity, 0.0f, 0.0f},
                           b = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f,     0.0f, 0.0f, 0.0f,
                                0.0f, 3.0f, 3.0f, 3.0f, infinity, 0.0f, 0.0f};
  const std::vector<float> d = luminance_differences(a, b);
  ASSERT_EQ(d.size(), 5u);
  EXPECT_EQ(d[0], 0.2126f);
  EXPECT_EQ(d[1], 0.7152f);
  EXPECT_EQ(d[2], 0.0722f);
  EXPECT_EQ(d[3], -1.0f);
  EXPECT_TRUE(std::isnan(d[4]));
}
