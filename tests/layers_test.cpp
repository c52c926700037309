// From the film and its layers to the parts of a file: through the file, by an independent reader.
#include "../host/layers.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "../host/film.h"
#include "exr_reader.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using Names = std::vector<std::string>;

// 3x2 pixels of 64 samples each. All samples of pixel i are (i + 1, 2 (i + 1), 0.5), but for those of its last replica,
// which are 0.
Film film_3_by_2() {
  Film film;
  film.width = 3;
  film.height = 2;
  film.exponent = 3;
  film.samples = 64;
  film.replicas = 4;
  film.pixels.resize(6);
  film.errors.resize(6);
  for (std::size_t i = 0; i < 6; ++i) {
    const double value[] = {static_cast<double>(i + 1), 2.0 * static_cast<double>(i + 1), 0.5};
    film.pixels[i].hits = 48;
    for (std::size_t c = 0; c < 3; ++c) {
      const double replica = REPLICA_SAMPLES * value[c];
      film.pixels[i].sum[c][0] = static_cast<ulong>(std::ldexp(3 * replica, FILM_FRACTION_BITS - film.exponent));
      film.errors[i].sum[c][0] = film.pixels[i].sum[c][0];
      // 3 replica^2 in units of 2^(2 (exponent - FILM_SQUARE_FRACTION_BITS)): more than 64 bits.
      const long double square = std::ldexp(3.0L * replica * replica, 2 * (FILM_SQUARE_FRACTION_BITS - film.exponent));
      film.errors[i].square[c][1] = static_cast<ulong>(std::ldexp(square, -64));
      film.errors[i].square[c][0] =
          static_cast<ulong>(square - std::ldexp(static_cast<long double>(film.errors[i].square[c][1]), 64));
    }
  }
  return film;
}

std::vector<ExrPart> written(const Film& film, PixelFormat format, const std::vector<Layer>& layers = {}) {
  const TemporaryDirectory directory;
  write_exr(directory / "a.exr", {3, 2, 0, 0, 3, 2}, parts_of(film, format, "m", layers));
  return read_exr_parts(directory / "a.exr");
}

Names names(const std::vector<ExrPart>& parts) {
  Names result;
  for (const ExrPart& part : parts) result.push_back(part.name);
  return result;
}

}  // namespace

// Four replica means of v, v, v and 0: their mean is 3/4 v, their variance (4 of them) 3 (v/4)^2/3 + (3v/4)^2/3 = v^2/4, and
// the standard error of the mean v/4.
TEST(layers_test, colour_comes_first_and_its_standard_error_second) {
  const std::vector<ExrPart> parts = written(film_3_by_2(), PixelFormat::rgba);
  ASSERT_EQ(names(parts), (Names{"rgba", "standardError"}));
  const char* const colours[] = {"R", "G", "B"};
  for (std::size_t i = 0; i < 6; ++i) {
    const double value[] = {static_cast<double>(i + 1), 2.0 * static_cast<double>(i + 1), 0.5};
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(parts[0].floats.at(colours[c])[i], static_cast<float>(0.75 * value[c]));
      EXPECT_NEAR(parts[1].floats.at("standardError." + std::string(colours[c]))[i], 0.25 * value[c], 0x1p-24 * value[c]);
    }
    EXPECT_EQ(parts[0].floats.at("A")[i], 0.75f);
  }
  EXPECT_EQ(parts[0].floats.size(), 4u);
  EXPECT_EQ(parts[1].floats.size(), 3u);
}

TEST(layers_test, the_first_part_is_called_like_its_channels) {
  const std::pair<PixelFormat, const char*> formats[] = {{PixelFormat::luminance, "y"}, {PixelFormat::luminance_alpha, "ya"},
                                                         {PixelFormat::rgb, "rgb"},     {PixelFormat::rgba, "rgba"},
                                                         {PixelFormat::xyz, "xyz"},     {PixelFormat::xyza, "xyza"}};
  for (const auto& [format, name] : formats) {
    const ExrPart first = written(film_3_by_2(), format)[0];
    EXPECT_EQ(first.name, name);
    EXPECT_EQ(first.floats.size(), std::string(name).size());
    for (const auto& channel : first.floats) {
      EXPECT_EQ(channel.first.size(), 1u);
      EXPECT_NE(std::string(name).find(static_cast<char>(std::tolower(channel.first[0]))), std::string::npos);
    }
  }
}

TEST(layers_test, a_film_of_one_replica_tells_no_error) {
  Film film = film_3_by_2();
  film.samples = 16;
  film.replicas = 1;
  EXPECT_EQ(written(film, PixelFormat::rgb).size(), 1u);
}

TEST(layers_test, samples_are_counted_where_their_number_varies) {
  Film film = film_3_by_2();
  for (FilmPixel& pixel : film.pixels) pixel.rejected = 2;
  EXPECT_EQ(names(written(film, PixelFormat::rgb)), (Names{"rgb", "standardError"}));
  film.pixels[4].rejected = 5;
  const std::vector<ExrPart> parts = written(film, PixelFormat::rgb);
  ASSERT_EQ(names(parts), (Names{"rgb", "standardError", "sampleCount"}));
  EXPECT_EQ(parts[2].integers.at("sampleCount.Y"), (std::vector<std::uint32_t>{62, 62, 62, 62, 59, 62}));
}

TEST(layers_test, counts_beyond_32_bits_are_floats) {
  Film film = film_3_by_2();
  film.samples = std::uint64_t{1} << 33;
  film.pixels[4].rejected = std::uint64_t{1} << 32;
  const std::vector<ExrPart> parts = written(film, PixelFormat::rgb);
  EXPECT_EQ(parts.back().floats.at("sampleCount.Y"),
            (std::vector<float>{0x1p33f, 0x1p33f, 0x1p33f, 0x1p33f, 0x1p32f, 0x1p33f}));
}

TEST(layers_test, layers_of_one_name_share_a_part_and_ids_stay_integers) {
  std::vector<float> ids;
  for (const std::uint32_t id : {0u, 1u, 16777217u, 2139095041u, 4290772993u, 4294967295u})
    ids.push_back(std::bit_cast<float>(id));
  const std::vector<float> up = {0, 1, 2, 3, 4, 5}, down = {5, 4, 3, 2, 1, 0};
  const std::vector<ExrPart> parts =
      written(film_3_by_2(), PixelFormat::rgb, {{"uv.U", up}, {"uv.V", down}, {"depth.Z", up}, {"primitive.id", ids}});
  ASSERT_EQ(names(parts), (Names{"rgb", "standardError", "uv", "depth", "primitive"}));
  EXPECT_EQ(parts[2].floats.at("uv.U"), up);
  EXPECT_EQ(parts[2].floats.at("uv.V"), down);
  EXPECT_EQ(parts[3].floats.at("depth.Z"), up);
  EXPECT_EQ(parts[4].integers.at("primitive.id"), (std::vector<std::uint32_t>{0u, 1u, 16777217u, 2139095041u, 4290772993u,
                                                                              4294967295u}));  // some are NaN as floats
}
