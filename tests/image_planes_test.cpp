// Images as `oclair compare` reads them: what is taken of a file, and that a broken one takes neither memory nor the
// program.
#include "../host/image_planes.h"

#include <ImfRgbaFile.h>
#include <ImfTiledRgbaFile.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "../host/error.h"
#include "../host/image.h"
#include "encoders.h"
#include "files.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using oclair::test::exr_bytes;
namespace fs = std::filesystem;

// Its message, or "" if it is not refused.
std::string refusal(const fs::path& path) {
  try {
    read_image_planes(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit, Exit::scene);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find(path.string() + ": "), 0u) << error.what();
    return error.what();
  }
  return "";
}

// The most that was in use so far, KiB.
long peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

ImagePart counting(const std::string& name, const std::vector<std::string>& channels, float first) {
  const std::size_t count = channels.size();
  return {name, channels, ValuesOfPixel<float>([=](std::size_t pixel, std::span<float> v) {
            for (std::size_t c = 0; c < count; ++c) v[c] = first + static_cast<float>(pixel * count + c);
          })};
}

// Rows for several reads, some of them incomplete.
void write_image(const fs::path& path, unsigned width, unsigned height) {
  write_exr(path, {640, 480, 100, 7, width, height},
            {counting("rgb", {"R", "G", "B"}, 0.0f), counting("albedo", {"albedo.R", "albedo.G", "albedo.B"}, 1e6f),
             counting("standardError", {"standardError.R", "standardError.G", "standardError.B"}, 2e6f)},
            {{"sampleRanges", "0:64 128:16"}, {"seed", "5"}, {"sampler", "sobol"}, {"rejectedSamples", "0"}});
}

}  // namespace

TEST(image_planes_test, values_and_errors_are_those_of_the_file_pixel_by_pixel) {
  const TemporaryDirectory directory;
  write_image(directory / "a.exr", 5, 131);
  const ImagePlanes image = read_image_planes(directory / "a.exr");
  EXPECT_EQ(image.width, 5u);
  EXPECT_EQ(image.height, 131u);
  EXPECT_EQ(image.x, 100);
  EXPECT_EQ(image.y, 7);
  EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
  ASSERT_EQ(image.values.size(), 3u * 5 * 131);
  ASSERT_EQ(image.errors.size(), 3u * 5 * 131);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    ASSERT_EQ(image.values[i], static_cast<float>(i));
    ASSERT_EQ(image.errors[i], 2e6f + static_cast<float>(i));
  }
  EXPECT_EQ(image.ranges, (std::vector<SampleRange>{{0, 64}, {128, 16}}));
  EXPECT_EQ(image.seed, "5");
  EXPECT_EQ(image.sampler, "sobol");
  EXPECT_FALSE(image.rejected);
  EXPECT_TRUE(read_image_planes(directory / "a.exr", StandardErrors::skip).errors.empty());
}

// An image in X, Y, Z has a channel Y as well.
TEST(image_planes_test, colour_is_rgb_or_xyz_or_y) {
  const TemporaryDirectory directory;
  using Names = std::vector<std::string>;
  for (const Names& names : {Names{"R", "G", "B"}, Names{"X", "Y", "Z"}, Names{"Y"}}) {
    Names all = names;
    all.push_back("A");
    all.push_back("nested.X");
    write_exr(directory / "a.exr", {3, 2, 0, 0, 3, 2}, {counting("", all, 0.0f)});
    EXPECT_EQ(read_image_planes(directory / "a.exr").channels, names);
  }
}

TEST(image_planes_test, reads_tiles_and_luminance_beside_coarser_chroma) {
  const TemporaryDirectory directory;
  {
    Imf::TiledRgbaOutputFile file((directory / "a.exr").c_str(), 100, 70, 32, 16, Imf::ONE_LEVEL);
    std::vector<Imf::Rgba> pixels(100 * 70, Imf::Rgba(1.0f, 2.0f, 3.0f, 0.25f));
    pixels[42 * 100 + 99].g = 5.0f;
    file.setFrameBuffer(pixels.data(), 1, 100);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  const ImagePlanes tiles = read_image_planes(directory / "a.exr");
  ASSERT_EQ(tiles.values.size(), 21000u);
  for (std::size_t i = 0; i < 21000; ++i)
    ASSERT_EQ(tiles.values[i], i == 3 * 4299 + 1 ? 5.0f : static_cast<float>(i % 3 + 1)) << i;
  {
    Imf::RgbaOutputFile file((directory / "a.exr").c_str(), 300, 200, Imf::WRITE_YC);
    const std::vector<Imf::Rgba> pixels(300 * 200, Imf::Rgba(0.5f, 0.5f, 0.5f));
    file.setFrameBuffer(pixels.data(), 1, 300);
    file.writePixels(200);
  }
  const ImagePlanes grey = read_image_planes(directory / "a.exr");
  EXPECT_EQ(grey.channels, std::vector<std::string>{"Y"});
  ASSERT_EQ(grey.values.size(), 60000u);
  for (const float y : grey.values) ASSERT_NEAR(y, 0.5f, 1e-3f);  // half floats
}

TEST(image_planes_test, every_beginning_of_a_file_is_refused_on_one_line) {
  const TemporaryDirectory directory;
  write_image(directory / "whole", 3, 2);
  const std::string whole = content(directory / "whole");
  ASSERT_EQ(refusal(directory / "whole"), "");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put(directory / "a", whole.substr(0, length));
    EXPECT_NE(refusal(directory / "a"), "") << length << " of " << whole.size();
  }
}

// Some changes make another valid file; none may end the process or take much memory.
TEST(image_planes_test, no_changed_byte_does_harm) {
  const TemporaryDirectory directory;
  write_image(directory / "three", 3, 2);
  put(directory / "one", exr_bytes(4, 2, {{"Y", Imf::HALF, std::vector<float>(8, 1.0f)}}));
  std::size_t refused = 0;
  const long before = peak_memory();
  for (const char* name : {"three", "one"}) {
    const std::string whole = content(directory / name);
    for (std::size_t at = 0; at < whole.size(); ++at)
      for (const char changed : {'\x01', '\x7f', static_cast<char>(whole[at] ^ 0x80)}) {
        std::string bytes = whole;
        bytes[at] = changed;
        put(directory / "a", bytes);
        refused += refusal(directory / "a") != "";
      }
  }
  EXPECT_GT(refused, 100u);
  EXPECT_LT(peak_memory() - before, 64 * 1024);
}

// A file with a table of as many chunks as it claims, all of them the first one: 2^21 by 2^7 pixels, and 2^30 of them.
TEST(image_planes_test, pixels_that_are_claimed_take_no_memory) {
  const TemporaryDirectory directory;
  write_exr(directory / "whole", {2, 1, 0, 0, 2, 1}, {counting("", {"Y"}, 0.0f)});
  const std::string whole = content(directory / "whole");
  using std::string_literals::operator""s;
  const auto little_endian = [](std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text.push_back(static_cast<char>(value >> 8 * i));
    return text;
  };
  const auto claim = [&](std::uint32_t width, std::uint32_t height) {
    std::string file = whole;
    const std::string window = "dataWindow\0box2i\0"s;
    const std::size_t at = file.find(window);
    EXPECT_NE(at, std::string::npos);
    file.replace(at + window.size() + 4 + 8, 8, little_endian(width - 1, 4) + little_endian(height - 1, 4));
    const std::size_t chunk = file.rfind(little_endian(0, 4) + little_endian(8, 4));  // row 0, and 8 bytes of two floats
    EXPECT_NE(chunk, std::string::npos);
    const std::uint64_t chunks = (height + 15) / 16;
    std::string table;
    for (std::uint64_t i = 0; i < chunks; ++i) table += little_endian(chunk + 8 * (chunks - 1), 8);
    put(directory / "a", file.substr(0, chunk - 8) + table + file.substr(chunk));
    const long before = peak_memory();
    const std::string message = refusal(directory / "a");
    EXPECT_LT(peak_memory() - before, 100 * 1024) << message;
    return message;
  };
  ASSERT_EQ(claim(2, 1), "");
  EXPECT_NE(claim(1u << 21, 1u << 7), "");
  EXPECT_NE(claim(1u << 10, 1u << 18), "");
  EXPECT_NE(claim(1u << 20, 1u << 10).find("it has 1073741824 pixels, more than 268435456"), std::string::npos);
}
